"""The top of the system: a recording becomes measurements, measurements become a track."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from pdr_est.config import Config, check
from pdr_est.errors import EstimationError
from pdr_est.estimators import SMOOTHERS, DeviceMeasurements, estimate_walk
from pdr_est.estimators.fused import carried, fuse
from pdr_est.estimators.known_directions import tied_to_map
from pdr_est.estimators.ties import tethers_between
from pdr_est.front_end.attitude import AccelerometerTilt, DeviceAttitude, VqfAttitude
from pdr_est.front_end.gait import gait_stage
from pdr_est.front_end.heading import heading_stage, hindsight_stage, needs_magnetometer
from pdr_est.front_end.heading.dominant import DominantDirections
from pdr_est.front_end.mode import mode_stage
from pdr_est.front_end.odometry import Odometry
from pdr_est.front_end.step_length import StepLength
from pdr_est.front_end.steps import step_detector
from pdr_est.front_end.steps.segmentation import StepSegmentation
from pdr_est.io.doubts import doubts
from pdr_est.io.recording import DeviceRecording, Recording
from pdr_est.io.requirements import (
    better_attitude,
    has_gyroscope,
    needed_channels,
    refuse_without_magnetometer,
    refuse_without_track,
    why_nothing,
)
from pdr_est.io.resample import Resampler
from pdr_est.records import (
    Channel,
    Gap,
    HeadingPrior,
    LevelBlock,
    LoopClosure,
    PositionFix,
    Step,
    StepOdometry,
)
from pdr_est.stage import Chain, Stage
from pdr_est.synchronise import ClockEstimate, on_one_clock
from pdr_est.track import Track, concatenate


@dataclass(frozen=True)
class DeviceWalk:
    """What the front end found in one device's recording. start_s: time of the first usable sample.

    odometry: what it tells of its motion step by step, hindsight: the same with what the whole walk tells, for
    estimators that smooth; directions: the building's, as far as the walk tells them.
    clock: against that of the first device, where it was estimated. warnings: of the reader and of the clock.
    has_heading is False for a device without gyroscope: its steps have a length but no heading, and no odometry.
    """

    device: str
    start_s: float
    level: tuple[LevelBlock, ...]
    steps: tuple[Step, ...]
    odometry: tuple[StepOdometry | HeadingPrior, ...]
    hindsight: tuple[StepOdometry | HeadingPrior, ...] = ()
    directions: DominantDirections | None = None
    has_heading: bool = True
    clock: ClockEstimate | None = None
    warnings: tuple[str, ...] = ()
    gaps: tuple[Gap, ...] = ()
    dropped_samples: dict[str, int] = field(default_factory=dict)

    @property
    def span_s(self) -> tuple[float, float]:
        """Times of the first and the last sample that the front end could use."""
        return float(self.level[0].time_s[0]), float(self.level[-1].time_s[-1])

    @property
    def stepping_s(self) -> tuple[float, float]:
        """Times of the first usable sample and of the end of the last step, or of the last sample without any."""
        return self.start_s, max((m.time_s for m in self.odometry[-2:]), default=self.span_s[1])


@dataclass(frozen=True)
class SmoothedWalk:
    """A track with what led to it. timings_s: CPU seconds per part of the chain."""

    track: Track
    devices: tuple[DeviceWalk, ...]
    fixes: tuple[PositionFix, ...] = ()
    timings_s: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


def smooth(recording: Recording, config: Config, fixes: Sequence[PositionFix] = ()) -> SmoothedWalk:
    """The track of a recorded walk, with everything a report needs.

    Raises ConfigError for values out of range, RecordingError if a device lacks a sensor that is needed.
    """
    check(config)
    for device in recording.devices:
        refuse_without_track(device, _place(device, recording.name))
    started = time.process_time()
    devices = analyse(recording, config)
    analysed = time.process_time()
    track = estimate(devices, config, fixes)
    estimated = time.process_time()
    return SmoothedWalk(
        track=track,
        devices=devices,
        fixes=tuple(fixes),
        timings_s={"front_end": analysed - started, "estimator": estimated - analysed},
        warnings=warnings_of(recording, devices),
    )


def analyse(recording: Recording, config: Config) -> tuple[DeviceWalk, ...]:
    """The front end on every device of a recording; one without gyroscope has steps without heading.

    Raises RecordingError if a device has no accelerometer, or samples that cannot be used.
    """
    devices: list[tuple[DeviceRecording, ClockEstimate | None]] = [(device, None) for device in recording.devices]
    if len(devices) > 1 and config.devices.clock == "walk":
        devices = on_one_clock(recording.devices)
    return tuple(
        replace(_analyse_device(device, recording.name, config), clock=clock, warnings=device.warnings)
        for device, clock in devices
    )


def estimate(walks: Sequence[DeviceWalk], config: Config, fixes: Sequence[PositionFix] = ()) -> Track:
    """The configured estimator on the measurements of every device.

    Raises EstimationError for a device without gyroscope, and what `estimate_track` raises.
    """
    for walk in walks:
        if not walk.has_heading:
            raise EstimationError(
                f"{walk.device}: no gyroscope, so its {len(walk.steps)} steps have no direction and make no track: "
                "leave this device out"
            )
    known = [_measured(walk, config, fixes) for walk in walks]
    spans_s = {walk.device: walk.stepping_s for walk in walks}
    smooths = config.estimator.name in SMOOTHERS
    tethers = tethers_between(spans_s, config.devices.tether, at_end=smooths) if config.devices.tethered else []

    def track_from(devices: Sequence[DeviceMeasurements]) -> Track:
        start, sigma_scale, chosen = config.start.pose(), config.odometry.sigma_length_scale, config.estimator
        return estimate_walk(chosen.name, devices, start, sigma_scale, tethers, chosen.map_fusion, chosen.fixed_lag)

    track = track_from(known)
    direction_rad = config.heading.dominant.direction_rad
    if direction_rad is not None:
        track = track_from([_in_map(one, walk, track, direction_rad) for one, walk in zip(known, walks, strict=True)])
    return _with_person(track, config) if len(walks) > 1 else track


def _measured(walk: DeviceWalk, config: Config, fixes: Sequence[PositionFix]) -> DeviceMeasurements:
    own = walk.hindsight if config.estimator.name in SMOOTHERS else walk.odometry
    closure = [LoopClosure(walk.device, config.start.sigma_closed_m)] if config.start.closed else []
    return DeviceMeasurements(walk.device, walk.start_s, (*own, *closure, *fixes))


def _in_map(known: DeviceMeasurements, walk: DeviceWalk, track: Track, direction_rad: float) -> DeviceMeasurements:
    """The measurements with the walk's directions tied to one that is known in the map."""
    if walk.directions is None:
        return known
    own = track.of_device(walk.device)
    tied = tied_to_map(known.measurements, own, direction_rad, walk.directions.spacing_rad)
    return replace(known, measurements=tuple(tied))


def _with_person(track: Track, config: Config) -> Track:
    """The tracks of the devices, each where it sits on the body, and that of the person."""
    mountings = {name: config.devices.mounting_of(name) for name in track.devices}
    offsets_m = {name: (one.forward_m, one.left_m) for name, one in mountings.items()}
    return concatenate([*(carried(track.of_device(name), offsets_m[name]) for name in track.devices), fuse(track)])


def warnings_of(recording: Recording, walks: Sequence[DeviceWalk]) -> tuple[str, ...]:
    """What makes the walks of a recording's devices doubtful, in words: what the reader saw comes first."""
    found = []
    for device, walk in zip(recording.devices, walks, strict=True):
        words = [*walk.warnings, *doubts(device)]
        if walk.gaps:
            words.append(f"{_gaps_in_words(walk.gaps)}, listed by `pdr-est inspect`")
        if not walk.steps:
            words.append("no step found")
        found += [f"{walk.device}: {text}" for text in words]
    return tuple(found)


def _gaps_in_words(gaps: Sequence[Gap]) -> str:
    """Their number and length; gaps of several channels that overlap are one."""
    ends: list[float] = []
    total_s = 0.0
    for gap in sorted(gaps, key=lambda gap: gap.start_s):
        latest_s = ends[-1] if ends else gap.start_s
        total_s += max(gap.end_s - max(gap.start_s, latest_s), 0.0)
        if ends and gap.start_s < latest_s:
            ends[-1] = max(latest_s, gap.end_s)
        else:
            ends.append(gap.end_s)
    what = "1 gap or clock jump" if len(ends) == 1 else f"{len(ends)} gaps or clock jumps"
    return f"{what}, {total_s:.1f} s in all"


def levelling(device: DeviceRecording, place: str, config: Config) -> tuple[Resampler, Chain]:
    """Chain SensorBlock -> LevelBlock for a device, and its first stage, which knows the gaps.

    The magnetic field comes with it where the heading needs it; all else is the same with it and without.
    """
    source = config.attitude.source
    own_attitude = source == "device" or (source == "auto" and better_attitude(device))
    channels = needed_channels(device, place, with_attitude=own_attitude)
    optional: tuple[Channel, ...] = ()
    if needs_magnetometer(config.heading):
        refuse_without_magnetometer(device, place)
        optional = (Channel.MAGNETIC_FIELD,)
    return level_chain(channels, optional, own_attitude, config)


def level_chain(
    channels: tuple[Channel, ...], optional: tuple[Channel, ...], own_attitude: bool, config: Config
) -> tuple[Resampler, Chain]:
    """`levelling` for a device with these channels. own_attitude: whether to take the one that it recorded."""
    rate_hz = config.resample.rate_hz
    resampler = Resampler(channels, config.resample, optional)
    if Channel.ROTATION_RATE not in channels:
        tilt = AccelerometerTilt(rate_hz, config.attitude)
        # Modes are told apart by rotation: without it they stay unknown unless one is given.
        given = [mode_stage(rate_hz, config.mode)] if config.mode.method == "fixed" else []
        return resampler, Chain([resampler, tilt, *given])
    attitude: Stage = DeviceAttitude() if own_attitude else VqfAttitude(rate_hz, config.attitude)
    return resampler, Chain([resampler, attitude, mode_stage(rate_hz, config.mode)])


def stepping(config: Config) -> Chain:
    """Chain LevelBlock -> Step with gait, length and heading."""
    rate_hz = config.resample.rate_hz
    return Chain(
        [
            StepSegmentation(step_detector(rate_hz, config.steps), config.steps.segmentation),
            gait_stage(config.gait),
            StepLength(rate_hz, config.walker, config.step_length),
            heading_stage(rate_hz, config.heading),
        ]
    )


def _analyse_device(device: DeviceRecording, recording_name: str, config: Config) -> DeviceWalk:
    place = _place(device, recording_name)
    resampler, to_level = levelling(device, place, config)
    level = _run(to_level, device.blocks())
    if not level:
        raise why_nothing(device, place, config.resample.max_gap_s)
    steps = _run(stepping(config), level)
    has_heading = has_gyroscope(device)
    odometry = _run(Odometry(device.name, config.odometry), steps) if has_heading else []
    hindsight, directions = odometry, None
    whole_walk = hindsight_stage(config.heading) if has_heading else None
    if whole_walk is not None:
        hindsight = _run(Odometry(device.name, config.odometry), _run(whole_walk, steps))
        directions = whole_walk.found
    return DeviceWalk(
        device=device.name,
        start_s=float(level[0].time_s[0]),
        level=tuple(level),
        steps=tuple(steps),
        odometry=tuple(odometry),
        hindsight=tuple(hindsight),
        directions=directions,
        has_heading=has_heading,
        gaps=resampler.gaps,
        dropped_samples=resampler.dropped,
    )


def _place(device: DeviceRecording, recording_name: str) -> str:
    return f"{recording_name} ({device.name})"


def _run(stage: Any, items: Any) -> list[Any]:
    outputs = [output for item in items for output in stage.push(item)]
    return outputs + list(stage.flush())
