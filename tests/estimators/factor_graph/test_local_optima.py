"""Walks with several optima: the factor graph finds the lowest one, whatever the filter believed first."""

import numpy as np
import pytest
from estimator_walks import (
    DEVICE,
    SimulatedWalk,
    fix,
    heading_prior,
    simulate,
    smooth_as_given,
    straight,
    with_near_fixes,
)

from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.estimators.factor_graph.build import build_graph
from pdr_est.estimators.factor_graph.local_optima import starting_points
from pdr_est.types.measurements import HeadingPrior, StartPose

UNKNOWN = StartPose()


def rounds(seed: int) -> SimulatedWalk:
    """A walk in rounds of 4.5 m, some of them back, with a fix of 0.7 m every twelve seconds."""
    rng = np.random.default_rng(seed)
    turns_rad = 0.1 * np.pi * rng.choice([1.0, 1.0, 1.0, -1.0], 240)
    return with_near_fixes(simulate(rng, turns_rad, fix_every=24, first_fix=24, sigma_fix_m=0.7))


def opposite_north(walk: SimulatedWalk) -> list[HeadingPrior]:
    """North by a phone that is held the wrong way round, which seems to be exact before the first fix."""
    return [
        heading_prior(k, float(walk.truth[k, 2]) + np.pi, 0.05 if k == 12 else 0.9, robust=True)
        for k in range(12, 240, 10)
    ]


@pytest.mark.parametrize("seed", [0, 2])
def test_a_wrong_north_before_the_first_fix_does_not_hide_the_lower_optimum(seed: int) -> None:
    """The Kalman filter believes the north that comes first, and its track is an optimum of its own, 3 m off."""
    walk = rounds(seed)
    track = smooth_as_given([*walk.measurements, *opposite_north(walk)], UNKNOWN)
    off_m = np.hypot(*(track.position_m - walk.truth[:, :2]).T)
    assert off_m.mean() < 0.6


def test_the_graph_for_users_is_at_the_same_optimum() -> None:
    walk = rounds(0)
    measurements = [*walk.measurements, *opposite_north(walk)]
    track = smooth_as_given(measurements, UNKNOWN)
    built = build_graph(measurements, start=UNKNOWN, sigma_length_scale=0.1, optimised=True)
    assert built.track_from().position_m == pytest.approx(track.position_m, abs=0.01)


def test_only_a_doubtful_heading_that_matters_makes_a_second_start() -> None:
    """The second start costs an optimisation of its own: where both agree, there is none."""
    fixes = [fix(k, 0.7 * k, 0.0) for k in (10, 20)]

    def count(prior: HeadingPrior, start: StartPose = UNKNOWN) -> int:
        timeline = build_timeline(DEVICE, 0.0, [*straight(20), prior, *fixes])
        return len(starting_points([timeline], [], [start], 0.1))

    assert count(heading_prior(1, np.pi, robust=True)) == 2
    assert count(heading_prior(1, 0.1, robust=True)) == 1
    assert count(heading_prior(1, np.pi, robust=False)) == 1
    assert count(heading_prior(1, np.pi, robust=True), StartPose((0.0, 0.0), 0.0)) == 1
