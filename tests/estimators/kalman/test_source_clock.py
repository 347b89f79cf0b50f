"""Doubt about the clock of a source: the path at other times, another prior afterwards, and walks with late fixes."""

from dataclasses import replace

import numpy as np
import pytest
from broken_fixes import corridor_turns, surveyed_points
from estimator_walks import DEVICE, run, simulate, step

from pdr_est.estimators.common.motion_model import CLOCK, STATES
from pdr_est.estimators.common.nodes import Node, split_step
from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.estimators.kalman.offline_filter import run_filter
from pdr_est.estimators.kalman.source_clock import PRIOR_VARIANCES_S2, RecentPath, repriored, with_node, wrong_after
from pdr_est.evaluate.consistency import coverage95
from pdr_est.types.measurements import StartPose


def trail() -> tuple[Node, ...]:
    """Six steps to the north and four to the west, seen from a walker who now goes west."""
    nodes: tuple[Node, ...] = ()
    for k in range(1, 11):
        (node,) = split_step(step(k, 0.7, np.pi / 2 if k == 7 else 0.0), 0.5 * (k - 1))
        nodes = with_node(nodes, node)
    return nodes


def test_a_late_fix_is_where_the_walker_was() -> None:
    path = RecentPath(trail(), 5.0)
    now, a_second_ago, before_the_corner = (path.shifted(at_s, 0.1) for at_s in (-1e-6, -1.0, -3.0))
    assert now.offset_m == pytest.approx([0.0, 0.0], abs=1e-3)
    assert a_second_ago.offset_m == pytest.approx([-1.4, 0.0])
    assert a_second_ago.per_s == pytest.approx([1.4, 0.0])
    assert before_the_corner.offset_m == pytest.approx([-2.8, 1.4])  # behind, and on the left, where he came from
    assert before_the_corner.per_s == pytest.approx([0.0, -1.4])


def test_an_early_fix_is_straight_ahead_with_an_error() -> None:
    ahead = RecentPath(trail(), 5.0).shifted(2.0, 0.1)
    assert ahead.offset_m == pytest.approx([2.8, 0.0])
    assert np.sqrt(ahead.noise_m2[1, 1]) > 1.0
    assert RecentPath(trail(), 60.0).shifted(2.0, 0.1).offset_m == pytest.approx([0.0, 0.0])  # he stands
    assert RecentPath((), 5.0).shifted(-2.0, 0.1).per_s == pytest.approx([0.0, 0.0])


def test_another_prior_afterwards_is_as_good_as_before() -> None:
    """Of a Gaussian: the update with the other prior from the beginning gives the same."""
    rows, noise, observed = np.array([[1.0, 1.4]]), np.array([[0.3]]), np.array([4.0])

    def updated(clock_s2: float) -> tuple[np.ndarray, np.ndarray]:
        prior = np.diag([0.8, clock_s2])
        gain = prior @ rows.T @ np.linalg.inv(rows @ prior @ rows.T + noise)
        return gain @ observed, prior - gain @ rows @ prior

    right, wrong = PRIOR_VARIANCES_S2
    mean, covariance = updated(right)
    again, spread = repriored(mean[None], covariance[None], 1, right, wrong)
    assert again[0] == pytest.approx(updated(wrong)[0], rel=1e-9)
    assert spread[0] == pytest.approx(updated(wrong)[1], rel=1e-9)


def test_the_probability_of_a_wrong_clock_follows_bayes_rule_and_never_ends() -> None:
    assert wrong_after(0.05, np.array([0.0, np.log(3.0)])) == pytest.approx(0.15 / (0.95 + 0.15))
    assert 0.0 < wrong_after(0.05, np.array([0.0, -500.0])) < 0.01
    assert 0.99 < wrong_after(0.05, np.array([-500.0, 0.0])) < 1.0


def test_a_clock_that_is_known_has_no_correction() -> None:
    rng = np.random.default_rng(6)
    walk = simulate(rng, corridor_turns(rng))
    for known in (True, False):
        points = surveyed_points(rng, walk.truth)
        late = [replace(one, time_s=one.time_s + 3.0, clock_known=known) for one in points]
        end = run_filter(build_timeline(DEVICE, 0.0, [*walk.odometry, *late]), StartPose((0.0, 0.0), 0.0), 0.1)[
            -1
        ].end
        clock = STATES + CLOCK
        assert (end.mean[clock] == 0.0 == end.covariance[clock, clock]) == known


@pytest.mark.parametrize("shift_s", [-4.0, 0.0, 3.0])
def test_walks_with_late_and_early_points_are_covered(shift_s: float) -> None:
    rng, shares = np.random.default_rng(5), []
    for _ in range(12):
        walk = simulate(rng, corridor_turns(rng))
        end_s = walk.odometry[-1].time_s
        points = [replace(one, time_s=one.time_s + shift_s) for one in surveyed_points(rng, walk.truth)]
        inside = [one for one in points if 0.0 <= one.time_s <= end_s]
        track = run("ekf", [*walk.odometry, *inside], StartPose((0.0, 0.0), 0.0, 0.1, 0.1))
        shares.append(coverage95(track.position_m - walk.truth[:, :2], track.covariance_m2, 1e-6))
    assert np.mean(shares) > (0.9 if shift_s == 0.0 else 0.75)
