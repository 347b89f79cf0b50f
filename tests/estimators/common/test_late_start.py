"""A device that began late begins where the others were by then, and leaves their tracks as they are."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.config import Config, StartParams
from pdr_est.estimators import EstimatorName, estimate_walk
from pdr_est.estimators.common.late_start import extend_late_devices, without_extension
from pdr_est.performance.odometry import SIGMA_SCALE, START, walk_of
from pdr_est.pipeline.estimation import run_estimator
from pdr_est.types.measurements import DeviceMeasurements, PositionFix, StepOdometry
from pdr_est.types.track import Track

LATE_START_S = 5.0


def begun_at(device: DeviceMeasurements, start_s: float) -> DeviceMeasurements:
    """The same device, with the front end's zero of headings at its first step."""
    steps = [m for m in device.measurements if isinstance(m, StepOdometry) and m.start_s >= start_s]
    return replace(device, start_s=start_s, measurements=(replace(steps[0], heading_change_rad=0.0), *steps[1:]))


def reckoned(devices: list[DeviceMeasurements]) -> Track:
    extended = extend_late_devices(devices, LATE_START_S)
    return without_extension(estimate_walk("dead-reckoning", extended, START, SIGMA_SCALE), devices, extended)


@pytest.mark.parametrize("first", [0, 1])
def test_a_late_device_begins_where_the_other_one_is(first: int) -> None:
    """first: the number of the device that begins early, so that the late one is also the first of the list."""
    known, _ = walk_of(120, 2)
    late_s = 30.2
    devices = [one if k == first else begun_at(one, late_s) for k, one in enumerate(known)]
    track = reckoned(devices)
    early, late = (track.of_device(known[k].device) for k in (first, 1 - first))
    assert late.time_s[0] == late_s
    assert late.step_length_m[0] == 0.0
    place_m, covariance_m2 = early.at(late.time_s[:1])
    assert late.position_m[0] == pytest.approx(place_m[0], abs=0.15)
    assert np.linalg.norm(place_m[0]) > 10.0
    assert np.trace(late.covariance_m2[0]) == pytest.approx(np.trace(covariance_m2[0]), rel=0.05)  # not 0
    gaps_m = np.linalg.norm(late.position_m - early.at(late.time_s)[0], axis=1)
    assert gaps_m.max() < 8.0  # two phones reckoned apart, with 0.2 rad between their first directions


def test_the_graph_leaves_the_complete_device_where_it_is() -> None:
    known, tethers = walk_of(120, 2)
    together = [replace(tether, sigma_m=0.1) for tether in tethers if tether.time_s > 30.0]
    config = Config(start=StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0)).with_estimator("factor-graph")
    alone = run_estimator(known[:1], [], config.estimator.make(), config)
    both = run_estimator([known[0], begun_at(known[1], 30.2)], together, config.estimator.make(), config).of_device(
        "phone1"
    )
    apart_m = np.linalg.norm(both.position_m - alone.position_m, axis=1)
    radius_m = np.sqrt(np.trace(alone.covariance_m2, axis1=1, axis2=2))
    assert np.all(apart_m <= radius_m + 0.05)
    assert np.linalg.norm(both.at(np.array([30.2]))[0]) > 10.0  # not drawn back to the start


@pytest.mark.parametrize("name", ["dead-reckoning", "map-closed-form", "map-general", "factor-graph"])
def test_every_offline_estimator_does_it(name: EstimatorName) -> None:
    known, tethers = walk_of(60, 2)
    config = Config(start=StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0)).with_estimator(name)
    together = [tether for tether in tethers if tether.time_s > 15.0]
    track = run_estimator([known[0], begun_at(known[1], 15.0)], together, config.estimator.make(), config)
    late, early = track.of_device("phone2"), track.of_device("phone1")
    assert np.linalg.norm(late.position_m[0] - early.at(late.time_s[:1])[0][0]) < 0.7


def test_devices_that_begin_together_stay_the_same_objects() -> None:
    known, _ = walk_of(20, 2)
    assert all(a is b for a, b in zip(extend_late_devices(known, LATE_START_S), known, strict=True))
    track = estimate_walk("dead-reckoning", known, START, SIGMA_SCALE)
    kept = without_extension(track, known, known)
    assert np.array_equal(kept.time_s, track.time_s)
    assert np.array_equal(kept.step_length_m, track.step_length_m)


def test_one_that_nobody_recorded_with_at_its_start_stays_as_it_is() -> None:
    known, _ = walk_of(100, 2)
    early = replace(known[0], measurements=known[0].measurements[:20])
    late = begun_at(known[1], 30.0)
    assert extend_late_devices([early, late], LATE_START_S)[1] is late
    assert extend_late_devices([], LATE_START_S) == []


def test_a_late_device_may_be_a_donor_in_turn() -> None:
    known, _ = walk_of(100, 3)
    first = replace(known[0], measurements=known[0].measurements[:40])  # until 20 s
    devices = [begun_at(known[2], 30.0), first, begun_at(known[1], 10.0)]
    track = reckoned(devices)
    last, second = track.of_device("phone3"), track.of_device("phone2")
    assert last.position_m[0] == pytest.approx(second.at(last.time_s[:1])[0][0], abs=0.15)


def test_fixes_before_its_start_hold_on_the_steps_of_the_donor() -> None:
    known, _ = walk_of(60, 2)
    fixes = tuple(PositionFix(t, np.array([0.7 * t, 0.0]) / 0.5, 0.25 * np.eye(2)) for t in (2.0, 12.0))
    devices = [known[0], begun_at(known[1], 15.0)]
    devices = [replace(one, measurements=(*one.measurements, *fixes)) for one in devices]
    early, late = (reckoned(devices).of_device(name) for name in ("phone1", "phone2"))
    assert late.position_m[0] == pytest.approx(early.at(late.time_s[:1])[0][0], abs=0.15)


def test_a_late_device_without_a_step_stands_at_the_donor() -> None:
    known, _ = walk_of(60, 2)
    track = reckoned([known[0], replace(known[1], start_s=20.1, measurements=())])
    late, early = track.of_device("phone2"), track.of_device("phone1")
    assert len(late) == 1
    assert late.position_m[0] == pytest.approx(early.at(late.time_s)[0][0], abs=0.15)
