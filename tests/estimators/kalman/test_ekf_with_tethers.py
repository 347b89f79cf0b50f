"""A tether tells the filter of two devices how they differ, and nothing about what they have in common."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import SIGMA_SCALE, STEP_S, step

from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.timeline import Timeline, build_timeline
from pdr_est.estimators.kalman import ekf
from pdr_est.estimators.kalman.filterpy_ekf import MultiDeviceEkf
from pdr_est.types.measurements import DeviceTether, StartPose
from pdr_est.types.track import Track

ORIGIN = StartPose((0.0, 0.0), 0.0, 0.01, 0.01)
STEPS = 60
REACH_M = 0.5
TETHERS = [DeviceTether("a", "b", 2.0 * k, REACH_M, 0.02) for k in range(1, int(STEPS * STEP_S / 2.0))]


def device(name: str, turn_rad: float, length_m: float = 0.7) -> Timeline:
    """A straight walk as a device sees it that turns by as much at each step, or finds other lengths."""
    steps = [replace(step(k, length_m, turn_rad), device=name) for k in range(1, STEPS + 1)]
    return build_timeline(name, 0.0, steps)


def of_first(first: Timeline, second: Timeline, tethers: list[DeviceTether] = TETHERS) -> Track:
    """Tracks, with the length scale of the first device."""
    return ekf.estimate([first, second], tethers, ORIGIN, SIGMA_SCALE)


def apart_m(track: Track, time_s: float) -> float:
    a, b = (track.of_device(name).at(np.array([time_s]))[0][0] for name in "ab")
    return float(np.hypot(*(a - b)))


def test_tracks_that_disagree_are_not_made_shorter() -> None:
    """Either device drifts by 34 degrees, to its own side."""
    left, right = device("a", 0.01), device("b", -0.01)
    tied = of_first(left, right), of_first(right, left)
    assert np.mean(np.log([track.length_scale for track in tied])) == pytest.approx(0.0, abs=1e-9)
    assert apart_m(tied[0], TETHERS[-1].time_s) < 1.2 * REACH_M
    assert apart_m(of_first(left, right, []), TETHERS[-1].time_s) > 10.0


def test_devices_that_find_other_lengths_meet_in_the_middle() -> None:
    short, long = device("a", 0.0, 0.65), device("b", 0.0, 0.75)
    tied = of_first(short, long), of_first(long, short)
    scales = [track.length_scale for track in tied]
    assert scales[0] > 1.03
    assert np.mean(np.log(scales)) == pytest.approx(0.0, abs=1e-9)
    ends_m = [tied[0].of_device(name).position_m[-1, 0] for name in "ab"]
    assert np.mean(ends_m) == pytest.approx(0.7 * STEPS, rel=0.01)
    # What both have in common stays as uncertain as the mean of two scales of which nothing is known.
    of_logarithms = [track.sigma_length_scale / track.length_scale for track in tied]
    assert np.mean(np.square(of_logarithms)) > 0.5 * SIGMA_SCALE**2


def test_a_device_that_has_not_begun_has_no_part_in_what_the_others_have_in_common() -> None:
    """The first one has walked, and would be nearer if its steps were shorter; the second one stands."""
    walked, stood = np.diag([1.0, 1.0, 0.0, SIGMA_SCALE**2, 0.0]), np.diag([1.0, 1.0, 0.0, SIGMA_SCALE**2, 0.0])
    walked[0, 3] = walked[3, 0] = 0.5 * SIGMA_SCALE
    scales = []
    for count in (2, 3):
        joint = MultiDeviceEkf(count)
        joint.set_state(GaussianState(np.array([3.0, 0.0, 0.0, 0.0, 0.0]), walked), 0)
        joint.set_state(GaussianState(np.zeros(5), stood), 1)
        joint.update_tether(0, 1, REACH_M, 0.02)
        scales.append(joint.x[[3, 8]])
        assert not joint.x[10:].any()
        assert not joint.P[10:].any()
    assert scales[0][0] < -0.02
    assert np.mean(scales[0]) == pytest.approx(0.0, abs=1e-12)
    assert scales[1] == pytest.approx(scales[0], abs=1e-12)
