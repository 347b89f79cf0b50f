import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.preprocessing.trim import trim_recording
from pdr_est.types.ground_truth import TruePositions, TrueSteps, TrueTurns, Truth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Recording, Signal


@pytest.fixture
def recording():
    time = np.arange(10.0)
    return Recording(
        name="walk",
        format="by hand",
        devices=(
            DeviceRecording(
                specific_force=Signal(time, np.column_stack([time] * 3)),
                rotation_rate=Signal(time + 0.5, np.column_stack([time] * 3)),
                pressure=Signal(time, time[:, None]),
                decisions=("a decision",),
            ),
        ),
        truth=Truth(
            positions=TruePositions(time, np.column_stack([time, -time]), 0.7, "waypoints"),
            steps=TrueSteps(time, np.array(["L", "R"] * 5)),
            turns=TrueTurns(time, time / 10.0),
            step_count=10,
            distance_m=9.0,
            activity="walking",
        ),
        fixes=tuple(PositionFix(float(t), np.zeros(2), np.eye(2)) for t in time),
        epoch_s=1000.0,
    )


def test_both_ends_are_inside_and_the_clock_stays(recording):
    part = trim_recording(recording, 3.0, 5.0)
    (device,) = part.devices
    np.testing.assert_array_equal(device.specific_force.time_s, [3.0, 4.0, 5.0])
    np.testing.assert_array_equal(device.specific_force.values[:, 0], [3.0, 4.0, 5.0])
    np.testing.assert_array_equal(device.rotation_rate.time_s, [3.5, 4.5])
    np.testing.assert_array_equal(device.pressure.time_s, [3.0, 4.0, 5.0])
    assert device.magnetic_field is None
    assert part.epoch_s == 1000.0
    assert device.decisions == ("a decision",)


def test_acceleration_without_gravity_is_cut_and_is_reason_enough_to_keep_a_device():
    linear = DeviceRecording(linear_acceleration=Signal(np.arange(10.0), np.zeros((10, 3))))
    part = trim_recording(Recording(name="walk", format="by hand", devices=(linear,)), 3.0, 5.0)
    np.testing.assert_array_equal(part.devices[0].linear_acceleration.time_s, [3.0, 4.0, 5.0])
    assert part.devices[0].span_s == (3.0, 5.0)
    assert linear.with_times(lambda time_s: time_s + 1.0).span_s == (1.0, 10.0)


def test_truth_and_fixes_are_cut_too(recording):
    part = trim_recording(recording, 3.0, 5.0)
    np.testing.assert_array_equal(part.truth.positions.position_m, [[3, -3], [4, -4], [5, -5]])
    assert (part.truth.positions.sigma_m, part.truth.positions.source) == (0.7, "waypoints")
    assert part.truth.steps.foot.tolist() == ["R", "L", "R"]
    np.testing.assert_allclose(part.truth.turns.angle_rad, [0.3, 0.4, 0.5])
    assert [fix.time_s for fix in part.fixes] == [3.0, 4.0, 5.0]


def test_what_holds_for_the_whole_walk_only_is_forgotten_and_the_cut_is_noted(recording):
    part = trim_recording(recording, 3.0)
    assert part.truth.step_count is None
    assert part.truth.distance_m is None
    assert part.truth.activity == "walking"
    assert part.notes == ("cut to 3.000 to inf s",)


def test_a_clock_that_jumps_back_loses_only_what_lies_outside(recording):
    signal = Signal(np.array([4.0, 1.0, 5.0]), np.zeros((3, 3)))
    jumping = Recording(name="walk", format="by hand", devices=(DeviceRecording(specific_force=signal),))
    np.testing.assert_array_equal(trim_recording(jumping, 3.0, 9.0).devices[0].specific_force.time_s, [4.0, 5.0])


def test_the_original_is_not_changed(recording):
    trim_recording(recording, 3.0, 5.0)
    assert len(recording.devices[0].specific_force) == 10
    assert len(recording.fixes) == 10


def test_nothing_left_is_an_error_that_names_the_span(recording):
    with pytest.raises(RecordingError, match=r"walk: no sample between 100\.000 and 200\.000 s"):
        trim_recording(recording, 100.0, 200.0)
