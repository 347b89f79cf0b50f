"""Timeline: which pose a fix meets, that split steps add up to the whole, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import DEVICE, STEP_S, fix, heading_prior, step, straight, usual_covariance

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.timeline import Node, build_timeline
from pdr_est.frames import Array, rotation_matrix
from pdr_est.types.measurements import DeviceTether, Measurement


def nodes_of(measurements: list[Measurement]) -> tuple[Node, ...]:
    return build_timeline(DEVICE, 0.0, measurements).nodes


def composed(parts: tuple[Node, ...]) -> tuple[Array, Array]:
    """Pose after the parts, from the origin, and its covariance in the frame of the last one."""
    pose, covariance = np.zeros(3), np.zeros((3, 3))
    for part in parts:
        pose[2] += part.heading_change_rad
        pose[:2] += rotation_matrix(pose[2]) @ [part.length_m, 0.0]
        backwards = rotation_matrix(-part.heading_change_rad)
        carried = np.eye(3)
        carried[:2, :2] = backwards
        carried[1, 2] = part.length_m
        covariance = carried @ covariance @ carried.T + part.covariance
    return pose, covariance


FULL = np.array([[0.02, 0.003, -0.004], [0.003, 0.03, 0.002], [-0.004, 0.002, 0.01]])


@pytest.mark.parametrize("moments", [[0.5], [0.1, 0.9], [0.25, 0.5, 0.75]])
@pytest.mark.parametrize(
    ("length_m", "covariance"),
    [
        (0.7, usual_covariance(0.7)),
        (0.7, np.diag([0.01, 0.02, 0.003])),
        (0.7, FULL),
        (0.7, np.diag([0.01, 0.02, 0.0])),
        (0.0, np.diag([4.0, 4.0, 1.0])),
        (0.0, usual_covariance(0.0)),
    ],
    ids=["usual", "diagonal", "full", "no heading noise", "gap", "no length"],
)
def test_parts_of_a_split_step_add_up_to_the_whole(length_m: float, covariance: Array, moments: list[float]) -> None:
    whole = step(1, length_m, 0.4, covariance)
    parts = nodes_of([whole, *(fix(moment, 0, 0) for moment in moments)])[1:]
    pose, composed_covariance = composed(parts)
    assert len(parts) == len(moments) + 1
    assert pose == pytest.approx([length_m * np.cos(0.4), length_m * np.sin(0.4), 0.4], abs=1e-12)
    assert composed_covariance == pytest.approx(covariance, abs=1e-14)
    for part in parts:
        assert np.linalg.eigvalsh(part.covariance)[0] > -1e-14


def test_an_even_pace_shares_out_length_and_independent_noise() -> None:
    first, second = nodes_of([step(1, 0.8, 0.3, np.diag([0.04, 0.08, 0.0])), fix(0.25, 0, 0)])[1:]
    assert (first.length_m, second.length_m) == pytest.approx((0.2, 0.6))
    assert (first.heading_change_rad, second.heading_change_rad) == (0.3, 0.0)
    assert first.covariance == pytest.approx(np.diag([0.01, 0.02, 0.0]))
    assert second.covariance == pytest.approx(np.diag([0.03, 0.06, 0.0]))
    assert (first.is_step, second.is_step) == (False, True)
    assert (first.time_s, second.time_s) == pytest.approx((0.25 * STEP_S, STEP_S))


def test_a_fix_on_the_way_knows_how_far_the_heading_error_has_carried_the_walker() -> None:
    sigma = 0.1
    carried = np.array([0.0, 0.8, 1.0])  # left by the length, for a heading error from the turn
    first, _ = nodes_of([step(1, 0.8, 0.0, sigma**2 * np.outer(carried, carried)), fix(0.5, 0, 0)])[1:]
    half_way = np.array([0.0, 0.4, 1.0])
    assert first.covariance == pytest.approx(sigma**2 * np.outer(half_way, half_way))


def where(nodes: tuple[Node, ...]) -> list[tuple[float, int]]:
    """Time and number of fixes of the nodes that have some."""
    return [(node.time_s, len(node.fixes)) for node in nodes if node.fixes]


@pytest.mark.parametrize(
    ("moment", "time_s"),
    [(-3.0, 0.0), (0.0, 0.0), (1.0, 0.5), (2.0, 1.0), (2.7, 1.0), (4.0, 1.0), (5.0, 2.5), (99.0, 3.0)],
    ids=["before", "at the start", "at a step", "last before a pause", "standing", "pause ends", "after it", "later"],
)
def test_a_fix_without_motion_belongs_to_the_pose_before(moment: float, time_s: float) -> None:
    steps = [step(1), step(2), step(5), step(6)]  # the walker stands from 1.0 to 2.0 s
    nodes = nodes_of([*steps, fix(moment, 0, 0)])
    assert where(nodes) == [(time_s, 1)]
    assert [node.time_s for node in nodes] == [0.0, 0.5, 1.0, 2.5, 3.0]


def test_two_fixes_within_one_step_get_a_pose_each_in_order_of_time() -> None:
    nodes = nodes_of([*straight(2), fix(1.75, 2, 0), fix(1.25, 1, 0)])
    assert where(nodes) == [(0.625, 1), (0.875, 1)]
    assert [node.fixes[0].position_m[0] for node in nodes if node.fixes] == [1, 2]
    assert [node.is_step for node in nodes] == [True, True, False, False, True]
    assert [node.length_m for node in nodes[2:]] == pytest.approx([0.175, 0.35, 0.175])


def test_two_fixes_of_the_same_moment_share_a_pose() -> None:
    nodes = nodes_of([step(1), fix(0.5, 1, 0), fix(0.5, 2, 0)])
    assert where(nodes) == [(0.25, 2)]
    assert len(nodes) == 3


def test_a_step_that_took_no_time_is_never_divided_by_it() -> None:
    twin = replace(step(2), time_s=STEP_S, start_s=STEP_S)
    nodes = nodes_of([step(1), twin, step(2), fix(1.0, 0, 0)])
    assert [node.time_s for node in nodes] == [0.0, 0.5, 0.5, 1.0]
    assert where(nodes) == [(0.5, 1)]


@pytest.mark.parametrize(("moment", "index"), [(-1.0, 0), (0.0, 0), (0.4, 1), (1.0, 1), (1.2, 2), (9.0, 3)])
def test_a_heading_prior_belongs_to_the_first_pose_at_or_after_it(moment: float, index: int) -> None:
    nodes = nodes_of([*straight(3), heading_prior(moment, 1.0)])
    assert [len(node.priors) for node in nodes] == [int(i == index) for i in range(4)]


def test_only_the_device_s_own_odometry_and_headings_count() -> None:
    other = [replace(step(1), device="watch"), replace(heading_prior(1, 0.0), device="watch")]
    timeline = build_timeline(DEVICE, 0.0, [*straight(2), *other, DeviceTether(DEVICE, "watch", 0.0, 1.0, 0.1)])
    assert len(timeline.nodes) == 3
    assert not timeline.priors


def test_measurements_may_come_from_a_generator() -> None:
    measurements = [*straight(2), fix(1, 0, 0), heading_prior(2, 0)]
    timeline = build_timeline(DEVICE, 0.0, (one for one in measurements))
    assert (len(timeline.nodes), len(timeline.fixes), len(timeline.priors)) == (3, 1, 1)


def test_a_step_that_ended_before_the_first_sample_moves_the_start_there() -> None:
    nodes = nodes_of([replace(step(1), time_s=-0.01, start_s=-0.4), step(2)])
    assert [node.time_s for node in nodes] == [-0.01, -0.01, 1.0]


NAN = float("nan")


@pytest.mark.parametrize(
    ("measurements", "message"),
    [
        ([step(2), step(1)], r"phone goes back in time from 1\.000 s to 0\.500 s"),
        ([step(1), replace(step(2), time_s=NAN)], "step of phone at nan s"),
        ([step(1), replace(step(2), length_m=NAN)], r"step of phone at 1\.0 s .*length nan m"),
        ([step(1), replace(step(2), heading_change_rad=NAN)], r"step of phone at 1\.0 s .*turn nan rad"),
        ([step(1, covariance=np.full((3, 3), NAN))], r"step of phone at 0\.5 s"),
        ([step(1, covariance=np.diag([1.0, -1.0, 1.0]))], r"step of phone at 0\.500 s .*eigenvalue -1"),
        ([step(1), fix(1, NAN, 0)], r"position fix \(waypoint\) at 0\.5 s"),
        ([step(1), fix(1, 0, 0, sigma_m=0.0)], r"position fix \(waypoint\) at 0\.500 s .*sigma above 0"),
        ([step(1), heading_prior(1, NAN)], r"heading prior of phone at 0\.5 s"),
        ([step(1), heading_prior(1, 0.0, sigma_rad=0.0)], "sigma above 0"),
    ],
)
def test_unusable_measurements_are_refused_by_name_and_time(measurements: list[Measurement], message: str) -> None:
    with pytest.raises(EstimationError, match=message):
        build_timeline(DEVICE, 0.0, measurements)
