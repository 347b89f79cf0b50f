"""North online: the replay of a recording ends in the poses of the whole recording, from its first pose on."""

from dataclasses import replace

import numpy as np
import pytest
from test_tracker import same_poses
from two_phones import ONE_CLOCK, offline, push_all, recorded, slices

from pdr_est.online import OnlineParams, Tracker
from pdr_est.online.recording_stream import expected_devices
from pdr_est.simulate import NO_SENSOR_ERRORS, DeviceParams, PathParams, Scenario, SensorParams, simulate_walk
from pdr_est.types.recording import Recording
from pdr_est.types.sensors import AttitudeReference


@pytest.fixture(scope="module")
def recording() -> Recording:
    """Around one corner, first to the north."""
    sensors = SensorParams(magnetometer=NO_SENSOR_ERRORS, record_attitude=True)
    path = PathParams(vertices_m=((0.0, 0.0), (0.0, 9.0), (6.0, 9.0)))
    return simulate_walk(Scenario(path=path, devices=(DeviceParams(name="phone", sensors=sensors),))).recording


@pytest.mark.parametrize("reference", [AttitudeReference.UNKNOWN, AttitudeReference.TRUE_NORTH])
def test_a_replay_ends_in_the_offline_poses(recording: Recording, reference: AttitudeReference) -> None:
    device = replace(recording.devices[0], attitude_reference=reference)
    recording = replace(recording, devices=(device,))
    whole = offline(recording, ONE_CLOCK)
    assert whole.heading_rad[1] == pytest.approx(np.pi / 2.0, abs=0.2)  # north, and not the arbitrary zero
    first, second = whole.sigma_heading_rad[:2]
    assert 0.1 < second < 0.5 < first  # before the first step nothing is known
    for period_s in (0.05, 1.7):
        tracker = Tracker(ONE_CLOCK, expected_devices(recording, ONE_CLOCK), OnlineParams())
        same_poses(push_all(tracker, slices(recording, [np.arange(0.0, 60.0, period_s)])), whole)


def test_a_device_that_is_not_declared_has_a_direction_of_its_own(recording: Recording) -> None:
    tracker = Tracker(ONE_CLOCK, ["phone"])
    updates = push_all(tracker, slices(recording, [np.arange(0.0, 60.0, 1.0)]))
    assert updates[0].heading_rad == pytest.approx(0.0, abs=1e-9)
    assert recorded(1).devices[0].magnetic_field is None
