"""The whole way from a recording to a track: golden numbers, several devices, gaps, and recordings that give none."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.config import Config, EstimatorParams, StartParams
from pdr_est.errors import ConfigError, EstimationError, RecordingError
from pdr_est.estimators import SPECS, EstimatorName
from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.front_end.attitude import AttitudeParams
from pdr_est.front_end.heading import HeadingParams
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams
from pdr_est.front_end.mode import ModeParams
from pdr_est.front_end.step_length import StairParams, StepLengthParams
from pdr_est.front_end.steps import StepsParams
from pdr_est.io import read
from pdr_est.pipeline import SmoothedWalk
from pdr_est.pipeline.warnings import warnings_of
from pdr_est.simulate import DeviceParams, SensorParams, SimulatedWalk, preset, simulate_walk
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Recording, Signal
from pdr_est.types.sensors import Gap
from pdr_est.types.steps import CarryingMode

FIX = PositionFix(5.0, np.zeros(2), np.eye(2))
DEAD_RECKONING = Config(estimator=EstimatorParams(name="dead-reckoning"))


@cache
def simulated(*devices: DeviceParams) -> SimulatedWalk:
    """30 m east, then 20 m north."""
    return simulate_walk(replace(preset("l_shape"), devices=devices or (DeviceParams(),)))


def with_device(**signals: Signal | None) -> Recording:
    """The simulated walk with signals of its device replaced."""
    recording = simulated().recording
    return replace(recording, devices=(replace(recording.devices[0], **signals),))


def some(of: Callable[[Signal], Signal]) -> Recording:
    """The simulated walk with accelerometer and gyroscope changed in the same way."""
    device = simulated().recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    return with_device(specific_force=of(device.specific_force), rotation_rate=of(device.rotation_rate))


def gyroscope() -> Signal:
    signal = simulated().recording.devices[0].rotation_rate
    assert signal is not None
    return signal


def without_gyroscope(*devices: DeviceParams) -> Recording:
    """The simulated walk as devices with nothing but an accelerometer recorded it."""
    recording = simulated(*devices).recording
    return replace(recording, devices=tuple(replace(device, rotation_rate=None) for device in recording.devices))


def shown(walk: SmoothedWalk) -> tuple[int, float, float, float, float]:
    """Number of steps, distance, end point and last heading."""
    track = walk.track
    return (
        len(walk.devices[0].steps),
        track.distance_m,
        *map(float, track.position_m[-1]),
        float(track.heading_rad[-1]),
    )


@pytest.mark.parametrize(
    ("config", "golden"),
    [
        (DEAD_RECKONING, (69, 47.767201, 28.785941, 19.161341, 1.611659)),
        (
            replace(DEAD_RECKONING, steps=StepsParams(detector="mmpdr")),
            (70, 48.310662, 29.101895, 19.300638, 1.577322),
        ),
    ],
    ids=["defaults", "mmpdr"],
)
def test_golden_numbers(config: Config, golden: tuple[float, ...]) -> None:
    """Recorded from this code. A change that is meant to move them moves them here, and the changelog says why."""
    walk = pipeline.smooth_recording(simulated().recording, config)
    assert shown(walk) == pytest.approx(golden, abs=1e-6)
    assert walk.warnings == ()


def test_the_golden_walk_is_near_the_truth() -> None:
    walk, truth = pipeline.smooth_recording(simulated().recording, DEAD_RECKONING), simulated()
    assert len(walk.devices[0].steps) == truth.step_count
    assert walk.track.distance_m == pytest.approx(truth.distance_m, rel=0.08)
    assert np.rad2deg(walk.track.heading_rad[-1]) == pytest.approx(90.0, abs=6.0)


@pytest.mark.parametrize("name", [name for name in get_args(EstimatorName) if not SPECS[name].sampled])
def test_without_fixes_every_estimator_gives_the_dead_reckoned_positions(name: EstimatorName) -> None:
    """But for a building's directions and its stairs, of which only a smoother makes use."""
    expected = pipeline.smooth_recording(simulated().recording, DEAD_RECKONING)
    config = Config(
        heading=HeadingParams(dominant=DominantParams(enabled=False)),
        step_length=StepLengthParams(stairs=StairParams(enabled=False)),
    )
    walk = pipeline.smooth_recording(simulated().recording, config.with_estimator(name))
    np.testing.assert_allclose(walk.track.position_m, expected.track.position_m, atol=1e-5)
    assert walk.track.estimator == name


def test_a_start_pose_moves_and_turns_the_track() -> None:
    start = StartParams(x_m=100.0, y_m=-50.0, heading_rad=np.pi / 2)
    track = pipeline.smooth_recording(simulated().recording, replace(DEAD_RECKONING, start=start)).track
    own = pipeline.smooth_recording(simulated().recording, DEAD_RECKONING).track.position_m
    np.testing.assert_allclose(track.position_m, np.stack([100.0 - own[:, 1], -50.0 + own[:, 0]], axis=1), atol=1e-9)


def test_the_devices_own_attitude_gives_nearly_the_same_track() -> None:
    walk = simulated(DeviceParams(sensors=SensorParams(record_attitude=True)))
    by_vqf, by_device = (
        pipeline.smooth_recording(
            walk.recording, replace(DEAD_RECKONING, attitude=AttitudeParams(source=source))
        ).track
        for source in ("vqf", "device")
    )
    assert len(by_vqf) == len(by_device)
    assert np.linalg.norm(by_vqf.position_m - by_device.position_m, axis=1).max() < 1.5


def test_each_device_of_a_walk_has_its_part() -> None:
    recording = simulated(DeviceParams(name="left"), DeviceParams(name="right")).recording
    walk = pipeline.smooth_recording(recording, DEAD_RECKONING)
    assert [part.device for part in walk.devices] == ["left", "right"]
    assert walk.track.devices == ("left", "right", "fused")
    for part in walk.devices:
        assert {measurement.device for measurement in part.odometry} == {part.device}
        assert len(walk.track.of_device(part.device)) == len(part.steps) + 1
        assert part.start_s == part.level[0].time_s[0]


def test_a_gap_is_reported_and_bridged() -> None:
    recording = simulated(DeviceParams(sensors=SensorParams(gaps_s=((12.0, 16.0),)))).recording
    walk = pipeline.smooth_recording(recording, DEAD_RECKONING)
    (part,) = walk.devices
    assert {gap.channel for gap in part.gaps} == {"specific_force", "rotation_rate"}
    for gap in part.gaps:
        assert (gap.start_s, gap.end_s) == pytest.approx((12.0, 16.0), abs=0.02)
    (bridge,) = [measurement for measurement in part.odometry if not measurement.observed]
    assert bridge.start_s < 12.1
    assert bridge.time_s > 15.9
    spread = np.trace(walk.track.covariance_m2, axis1=1, axis2=2)
    resumed = int(np.searchsorted(walk.track.time_s, bridge.time_s))
    assert spread[resumed] > spread[resumed - 1] + 5.0


def test_dropped_samples_are_counted() -> None:
    def spoiled(signal: Signal) -> Signal:
        values = signal.values.copy()
        values[100] = np.nan
        return Signal(np.where(np.arange(len(signal)) == 200, signal.time_s[199], signal.time_s), values)

    (part,) = pipeline.analyse_recording(some(spoiled), DEAD_RECKONING)
    assert part.dropped_samples == {
        f"{channel}: {reason}": 1
        for channel in ("specific_force", "rotation_rate")
        for reason in ("not finite", "duplicate time")
    }


def test_gentle_steps_after_a_standstill_are_not_measured_by_brisk_ones_before() -> None:
    """18 steps with crests of 6 m/s^2, four seconds of standing, then 18 with a fifth of that."""
    time_s = np.arange(1300) / 50.0
    height = np.select([(time_s > 1.0) & (time_s < 11.0), (time_s > 15.0) & (time_s < 25.0)], [6.0, 1.2], 0.0)
    up = np.tile([0.0, 0.0, 1.0], (len(time_s), 1))
    force = (STANDARD_GRAVITY_MPS2 + height * np.sin(2.0 * np.pi * 1.8 * time_s))[:, None] * up
    device = DeviceRecording(specific_force=Signal(time_s, force), rotation_rate=Signal(time_s, 0.0 * up))
    (part,) = pipeline.analyse_recording(Recording("sine", "made up", (device,)), Config())
    found_s = np.array([step.event.time_s for step in part.steps])
    assert np.count_nonzero(found_s < 13.0) == pytest.approx(18, abs=1)
    assert np.count_nonzero(found_s > 13.0) == pytest.approx(18, abs=1)


def test_cpu_time_and_fixes_are_handed_on() -> None:
    fixes = simulated().with_fixes(every_s=10.0, sigma_m=0.5).recording.fixes
    walk = pipeline.smooth_recording(simulated().recording, Config().with_estimator("ekf"), fixes)
    assert walk.fixes == fixes
    assert set(walk.timings_s) == {"front_end", "estimator"}
    assert all(seconds >= 0.0 for seconds in walk.timings_s.values())


@pytest.mark.parametrize("name", get_args(EstimatorName))
def test_a_walk_without_steps_is_one_point_and_a_warning(name: EstimatorName) -> None:
    standing = some(lambda signal: Signal(signal.time_s[:250], signal.values[:250]))
    walk = pipeline.smooth_recording(standing, Config().with_estimator(name))
    assert walk.warnings == ("device: no step found",)
    assert len(walk.track) == 1
    np.testing.assert_allclose(walk.track.position_m, [[0.0, 0.0]], atol=1e-9)
    assert np.isfinite(walk.track.covariance_m2).all()


NOTHING = Signal(np.empty(0), np.empty((0, 3)))


@pytest.mark.parametrize("missing", [None, NOTHING], ids=["no channel", "empty channel"])
@pytest.mark.parametrize(
    ("channel", "message"),
    [
        ("specific_force", r"^l_shape \(device\): no accelerometer, .*record it and try again$"),
        ("rotation_rate", r"^l_shape \(device\): no gyroscope, .*no track.*`pdr-est steps` still finds the steps"),
    ],
)
def test_a_missing_sensor_is_named_with_what_remains(channel: str, message: str, missing: Signal | None) -> None:
    with pytest.raises(RecordingError, match=message):
        pipeline.smooth_recording(with_device(**{channel: missing}), Config())


@pytest.mark.parametrize("missing", [None, NOTHING], ids=["no channel", "empty channel"])
def test_an_accelerometer_alone_gives_steps_with_length_and_without_heading(missing: Signal | None) -> None:
    (part,) = pipeline.analyse_recording(with_device(rotation_rate=missing), Config())
    (full,) = pipeline.analyse_recording(simulated().recording, Config())
    assert full.has_heading
    assert not part.has_heading
    assert part.odometry == ()
    assert len(part.steps) == pytest.approx(simulated().step_count, abs=1)
    found_s, expected_s = (np.array([step.event.time_s for step in walk.steps]) for walk in (part, full))
    assert np.abs(found_s[:, None] - expected_s).min(axis=0).max() < 0.15
    assert np.isnan([step.heading_rad for step in part.steps]).all()
    assert {step.event.mode for step in part.steps} == {CarryingMode.UNKNOWN}
    length_m, expected_m = (sum(step.length_m for step in walk.steps) for walk in (part, full))
    assert length_m == pytest.approx(expected_m, rel=0.05)
    assert warnings_of(simulated().recording, [part]) == ()


def test_a_given_mode_is_used_without_gyroscope_too() -> None:
    given = replace(Config(), mode=ModeParams(method="fixed", fixed="SWING"))
    (walk,) = pipeline.analyse_recording(without_gyroscope(), given)
    assert {step.event.mode for step in walk.steps} == {CarryingMode.SWING}
    assert len(walk.steps) == pytest.approx(simulated().step_count, abs=2)
    (walk,) = pipeline.analyse_recording(without_gyroscope(), replace(Config(), mode=ModeParams(method="mmpdr")))
    assert {step.event.mode for step in walk.steps} == {CarryingMode.UNKNOWN}


def test_a_gap_of_both_sensors_is_one_and_as_long_as_it_is() -> None:
    def with_hours(signal: Signal) -> Signal:
        return Signal(np.where(signal.time_s < 20.0, signal.time_s, signal.time_s + 3600.0), signal.values)

    recording = some(with_hours)
    walks = pipeline.analyse_recording(recording, Config())
    assert len(walks[0].gaps) == 2
    (words,) = warnings_of(recording, walks)
    assert words.startswith("device: 1 gap or clock jump, 3600.0 s in all")
    later = Gap("rotation_rate", 4000.0, 4001.0, "gap")
    (words,) = warnings_of(recording, [replace(walks[0], gaps=(*walks[0].gaps, later))])
    assert words.startswith("device: 2 gaps or clock jumps, 3601.0 s in all")


def test_what_the_reader_doubts_is_a_warning_of_the_walk_too() -> None:
    recording = simulated().recording
    doubtful = replace(recording, devices=(replace(recording.devices[0], warnings=("the unit is a guess",)),))
    assert pipeline.smooth_recording(doubtful, DEAD_RECKONING).warnings == ("device: the unit is a guess",)


@pytest.mark.parametrize(("channel", "value"), [("specific_force", 1e30), ("rotation_rate", -1e6)])
def test_one_impossible_sample_changes_next_to_nothing(channel: str, value: float) -> None:
    (device,) = simulated().recording.devices
    signal = getattr(device, channel)
    values = signal.values.copy()
    values[len(values) // 2, 1] = value
    damaged = with_device(**{channel: Signal(signal.time_s, values)})
    walk, usual = (
        pipeline.smooth_recording(recording, DEAD_RECKONING) for recording in (damaged, simulated().recording)
    )
    assert shown(walk) == pytest.approx(shown(usual), abs=0.02)
    assert walk.devices[0].dropped_samples == {f"{channel}: impossible": 1}
    assert walk.warnings[0].startswith("device: 1 of ")


def test_one_device_without_gyroscope_leaves_the_other_as_it_is() -> None:
    recording = simulated(DeviceParams(name="left"), DeviceParams(name="right")).recording
    left, right = recording.devices
    mixed = replace(recording, devices=(replace(left, rotation_rate=None), right))
    bare, whole = pipeline.analyse_recording(mixed, Config())
    assert (bare.has_heading, whole.has_heading) == (False, True)
    assert len(whole.odometry) == len(whole.steps) > 0


@pytest.mark.parametrize("name", get_args(EstimatorName))
def test_steps_without_heading_are_refused_by_every_estimator(name: EstimatorName) -> None:
    walks = pipeline.analyse_recording(without_gyroscope(), Config())
    refused = r"^device: no gyroscope, or no gravity, so its \d+ steps have no direction .*: leave"
    with pytest.raises(EstimationError, match=refused):
        pipeline.estimate_tracks(walks, Config().with_estimator(name))


def test_a_track_is_refused_before_any_work_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    recording = without_gyroscope(DeviceParams(name="left"), DeviceParams(name="right"))
    whole = simulated(DeviceParams(name="left"), DeviceParams(name="right")).recording.devices[0]
    monkeypatch.setattr(pipeline, "analyse_recording", lambda *_: pytest.fail("the front end ran"))
    with pytest.raises(RecordingError, match=r"^l_shape \(right\): no gyroscope"):
        pipeline.smooth_recording(replace(recording, devices=(whole, recording.devices[1])), Config())


def test_the_devices_own_attitude_needs_its_gyroscope_too() -> None:
    walk = simulated(DeviceParams(sensors=SensorParams(record_attitude=True))).recording
    bare = replace(walk, devices=(replace(walk.devices[0], rotation_rate=None),))
    with pytest.raises(
        RecordingError, match=r"^l_shape \(device\): no gyroscope, .*: set attitude.source: vqf in the "
    ):
        pipeline.analyse_recording(bare, replace(Config(), attitude=AttitudeParams(source="device")))


def test_a_missing_attitude_of_the_device_names_the_other_source() -> None:
    config = replace(Config(), attitude=AttitudeParams(source="device"))
    with pytest.raises(
        RecordingError,
        match=r"^l_shape \(device\): the device recorded no attitude: set attitude.source: vqf in the ",
    ):
        pipeline.smooth_recording(simulated().recording, config)


def test_channels_without_overlap_are_shown_with_their_times() -> None:
    later = Signal(gyroscope().time_s + 1000.0, gyroscope().values)
    message = r"^l_shape \(device\): .* do not overlap in time \(.*, gyroscope 1000\.00 to 1043\.42 s\): check "
    with pytest.raises(RecordingError, match=message):
        pipeline.smooth_recording(with_device(rotation_rate=later), Config())


def test_too_short_a_recording_says_so() -> None:
    with pytest.raises(RecordingError, match=r"^l_shape \(device\): too few samples .*: record for longer$"):
        pipeline.smooth_recording(some(lambda signal: Signal(signal.time_s[:3], signal.values[:3])), Config())


@pytest.mark.parametrize(
    ("recording", "message"),
    [
        (some(lambda signal: Signal(signal.time_s[:1], signal.values[:1])), "single sample.*: record for longer"),
        (with_device(rotation_rate=Signal(gyroscope().time_s[::100], gyroscope().values[::100])), "s apart.*0.5"),
    ],
    ids=["one sample", "one sample a second"],
)
def test_other_reasons_for_an_empty_grid_are_given(recording: Recording, message: str) -> None:
    with pytest.raises(RecordingError, match=message):
        pipeline.smooth_recording(recording, Config())


@pytest.mark.parametrize(
    ("recording", "config", "fixes", "error", "message"),
    [
        (
            "walk.csv",
            Config(),
            (),
            RecordingError,
            r"^recording = 'walk.csv': is no recording: read it first: pdr_est",
        ),
        (Path("walk.csv"), Config(), (), RecordingError, r"walk.csv'\): is no recording: read it first"),
        (
            None,
            "settings.yaml",
            (),
            ConfigError,
            r"^config = 'settings.yaml': is no configuration: load it with load_",
        ),
        (None, {}, (), ConfigError, r"^config = \{\}: is no configuration: give a Config"),
        (None, Config(), FIX, RecordingError, r"^fixes = PositionFix.*: is no list: give a list of PositionFix"),
        (None, Config(), "fixes.csv", RecordingError, r"^fixes = 'fixes.csv': is no list"),
        (None, Config(), [FIX, (1.0, 2.0)], RecordingError, r"^fixes\[1\] = \(1.0, 2.0\): is no PositionFix: give"),
        (
            None,
            Config(),
            [FIX, replace(FIX, time_s=99.0)],
            RecordingError,
            r"^fixes\[1\]: time 99.000 s is outside the recording \(-0.001 to 43.420 s\): use the recording's clock$",
        ),
    ],
)
def test_inputs_that_are_none_are_refused(
    recording: Any, config: Any, fixes: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        pipeline.smooth_recording(simulated().recording if recording is None else recording, config, fixes)
    if recording is not None:
        with pytest.raises(error, match=message):
            pipeline.analyse_recording(recording, config)


def test_fixes_of_the_recorder_may_come_before_its_samples() -> None:
    early = replace(FIX, time_s=-5.0)
    recording = replace(simulated().recording, fixes=(early,))
    assert pipeline.smooth_recording(recording, Config(), recording.fixes).fixes == (early,)
    with pytest.raises(RecordingError, match=r"fixes\[0\]: time -5.000 s is outside"):
        pipeline.smooth_recording(recording, Config(), [replace(early)])


def test_every_device_must_be_usable() -> None:
    good: DeviceRecording = simulated().recording.devices[0]
    recording = replace(simulated().recording, devices=(good, replace(good, name="other", rotation_rate=None)))
    with pytest.raises(RecordingError, match=r"^l_shape \(other\): no gyroscope"):
        pipeline.smooth_recording(recording, Config())


def test_steps_of_real_phones_by_the_accelerometer_alone(shared_data: Path) -> None:
    """Between the first and the last true step: before and after it the phones are put away and taken out."""
    folders = sorted((shared_data / "oxford-steps").iterdir())
    for folder in folders[:: max(len(folders) // 5, 1)]:
        recording = read(folder)
        assert recording.truth.steps is not None
        assert recording.truth.step_count is not None
        true_s = recording.truth.steps.time_s
        (part,) = pipeline.analyse_recording(recording, Config())
        found_s = np.array([step.event.time_s for step in part.steps])
        found_s += np.median([true_s[np.argmin(np.abs(true_s - time_s))] - time_s for time_s in found_s])
        inside = (found_s > true_s[0] - 0.3) & (found_s < true_s[-1] + 0.3)
        assert np.count_nonzero(inside) == pytest.approx(recording.truth.step_count, rel=0.02), folder.name
