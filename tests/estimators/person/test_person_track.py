"""The person's track from those of the devices: exact answers of covariance intersection, and whose steps count."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.estimators.person.track import NAME, at_lever_arm, fuse
from pdr_est.frames import Array
from pdr_est.types.region import PoseRegion
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track, concatenate


def track(
    device: str, times_s: Array, offset_m: float = 0.0, variance: float = 0.1, heading_rad: float = 0.0
) -> Track:
    """Straight to the east at 1.4 m/s, aside by offset_m."""
    count = len(times_s)
    covariance = np.tile(variance * np.eye(2), (count, 1, 1))
    return Track(
        time_s=times_s,
        moving_from_s=np.concatenate([times_s[:1], times_s[:-1]]),
        device=np.array([device] * count),
        position_m=np.stack([1.4 * times_s, np.full(count, offset_m)], axis=1),
        heading_rad=np.full(count, heading_rad),
        covariance_m2=covariance,
        sigma_heading_rad=np.full(count, np.sqrt(variance)),
        mode=np.full(count, CarryingMode.POCKET, dtype=np.int8),
        step_length_m=np.full(count, 0.7),
        kind="smoothed",
        estimator="factor-graph",
    )


STEPS_S = np.arange(0.0, 10.1, 0.5)


def test_equal_devices_meet_in_the_middle_and_nothing_is_counted_twice() -> None:
    person = fuse(concatenate([track("a", STEPS_S, 1.0), track("b", STEPS_S, -1.0)]))
    assert person.devices == (NAME,)
    np.testing.assert_allclose(person.time_s, STEPS_S)
    np.testing.assert_allclose(person.position_m[:, 1], 0.0, atol=1e-9)
    np.testing.assert_allclose(person.covariance_m2, np.tile(0.1 * np.eye(2), (len(STEPS_S), 1, 1)), rtol=1e-6)
    np.testing.assert_allclose(person.sigma_heading_rad, np.sqrt(0.1), rtol=1e-6)


def test_a_bad_device_has_little_say() -> None:
    person = fuse(concatenate([track("a", STEPS_S, 0.0, 0.1), track("b", STEPS_S, 11.0, 1.0)]))
    np.testing.assert_allclose(person.position_m[:, 1], 1.0, rtol=1e-6)  # information 10 to 1
    assert np.all(person.covariance_m2[:, 0, 0] < 0.2)


def test_the_person_may_be_where_the_better_known_device_may_be() -> None:
    def forked(one: Track, apart_m: float) -> Track:
        """Give the last pose two places."""
        region = PoseRegion.of_gaussians(one.position_m, one.covariance_m2)
        region.weight[-1, :2] = (0.6, 0.4)
        region.mean_m[-1, 1] = one.position_m[-1] + np.array([0.0, apart_m])
        region.covariance_m2[-1, 1] = 0.2 * np.eye(2)
        return replace(one, region=region, on_plan=True)

    good, bad = forked(track("a", STEPS_S), 8.0), forked(track("b", STEPS_S, variance=1.0), 5.0)
    person = fuse(concatenate([bad, good]))
    assert person.on_plan
    assert person.region is not None
    assert person.region.components.tolist() == [1] * (len(STEPS_S) - 1) + [2]
    assert person.region.mean_m[-1, :2, 1] == pytest.approx([0.0, 8.0])
    assert person.region.mean_m[3, 0] == pytest.approx(person.position_m[3])
    assert person.region.covariance_m2[3, 0] == pytest.approx(person.covariance_m2[3])
    assert fuse(concatenate([track("a", STEPS_S), track("b", STEPS_S)])).region is None


def test_a_lever_arm_moves_the_region_too() -> None:
    one = track("a", STEPS_S)
    one = replace(one, region=PoseRegion.of_gaussians(one.position_m, one.covariance_m2))
    moved = at_lever_arm(one, (0.0, 0.5))
    assert moved.region is not None
    np.testing.assert_allclose(moved.region.mean_m[:, 0], moved.position_m)
    np.testing.assert_allclose(moved.position_m[:, 1], 0.5)


def test_headings_either_side_of_west() -> None:
    west = [track("a", STEPS_S, heading_rad=np.pi - 0.1), track("b", STEPS_S, heading_rad=-np.pi + 0.1)]
    person = fuse(concatenate(west))
    np.testing.assert_allclose(np.abs(person.heading_rad), np.pi, atol=1e-6)


def test_a_step_that_one_device_missed_counts_and_one_too_many_does_not() -> None:
    missed = np.delete(STEPS_S, 8)
    too_many = np.sort(np.append(STEPS_S, 5.25))
    person = fuse(concatenate([track("a", missed), track("b", too_many)]))
    assert len(person) == len(STEPS_S)
    np.testing.assert_allclose(person.time_s, STEPS_S, atol=0.13)  # the one too many lies beside a true one


def test_steps_seen_a_little_apart_are_one() -> None:
    late = np.concatenate([STEPS_S[:1], STEPS_S[1:] + 0.2])
    person = fuse(concatenate([track("a", STEPS_S), track("b", late)]))
    np.testing.assert_allclose(person.time_s[1:], STEPS_S[1:] + 0.1)


def test_a_device_is_seen_where_it_sits_on_the_body() -> None:
    moved = at_lever_arm(track("a", STEPS_S, heading_rad=np.pi / 2.0), (0.1, 0.2))
    assert moved.position_m[3] - track("a", STEPS_S).position_m[3] == pytest.approx([-0.2, 0.1])


def test_a_device_that_stops_earlier_does_not_hold_the_person_back() -> None:
    person = fuse(concatenate([track("a", STEPS_S, 1.0), track("b", STEPS_S[:10], -1.0)]))
    np.testing.assert_allclose(person.time_s, STEPS_S)
    np.testing.assert_allclose(person.position_m[:10, 1], 0.0, atol=1e-9)
    np.testing.assert_allclose(person.position_m[10:, 0], 1.4 * STEPS_S[10:], rtol=1e-6)
    np.testing.assert_allclose(person.position_m[10:, 1], 1.0, rtol=1e-6)


def test_the_mode_is_that_of_the_surest_device_that_is_there() -> None:
    hand = track("b", STEPS_S[:10], variance=0.01)
    hand = replace(hand, mode=np.full(10, CarryingMode.HOLDING, dtype=np.int8))
    person = fuse(concatenate([track("a", STEPS_S), hand]))
    assert set(person.mode[:10]) == {CarryingMode.HOLDING}
    assert set(person.mode[10:]) == {CarryingMode.POCKET}


def test_a_walk_without_steps_has_a_start() -> None:
    person = fuse(concatenate([track("a", STEPS_S[:1]), track("b", STEPS_S[:1])]))
    assert (len(person), person.devices) == (1, (NAME,))
