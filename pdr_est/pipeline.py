"""The top of the system: a recording becomes measurements, measurements become a track."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.estimators import estimate_track
from pdr_est.front_end.attitude import DeviceAttitude, VqfAttitude
from pdr_est.front_end.heading.step_yaw import StepYaw
from pdr_est.front_end.mode import FixedMode
from pdr_est.front_end.odometry import Odometry
from pdr_est.front_end.step_length import StepLength
from pdr_est.front_end.steps.band_peaks import BandPeaks
from pdr_est.front_end.steps.mmpdr import MmpdrSteps
from pdr_est.front_end.steps.segmentation import StepSegmentation
from pdr_est.io.recording import DeviceRecording, Recording
from pdr_est.io.resample import Resampler
from pdr_est.records import CarryingMode, Channel, Gap, LevelBlock, PositionFix, Step, StepOdometry
from pdr_est.stage import Chain, Stage
from pdr_est.track import Track, concatenate


@dataclass(frozen=True)
class DeviceWalk:
    """What the front end found in one device's recording. start_s: time of the first usable sample."""

    device: str
    start_s: float
    level: tuple[LevelBlock, ...]
    steps: tuple[Step, ...]
    odometry: tuple[StepOdometry, ...]
    gaps: tuple[Gap, ...] = ()
    dropped_samples: dict[str, int] = field(default_factory=dict)


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

    Raises RecordingError if a device lacks a sensor that the configuration needs.
    """
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
        warnings=tuple(f"{walk.device}: no step found" for walk in devices if not walk.steps),
    )


def analyse(recording: Recording, config: Config) -> tuple[DeviceWalk, ...]:
    """The front end on every device of a recording."""
    return tuple(_analyse_device(device, recording.name, config) for device in recording.devices)


def estimate(walks: Sequence[DeviceWalk], config: Config, fixes: Sequence[PositionFix] = ()) -> Track:
    """The configured estimator on the measurements of every device."""
    return concatenate(
        [
            estimate_track(
                config.estimator.name,
                walk.device,
                walk.start_s,
                [*walk.odometry, *fixes],
                config.start.pose(),
                config.odometry.sigma_length_scale,
            )
            for walk in walks
        ]
    )


def levelling(device: DeviceRecording, place: str, config: Config) -> tuple[Resampler, Chain]:
    """Chain SensorBlock -> LevelBlock for a device, and its first stage, which knows the gaps."""
    rate_hz = config.resample.rate_hz
    resampler = Resampler(_needed_channels(device, place, config), config.resample)
    attitude = VqfAttitude(rate_hz, config.attitude) if config.attitude.source == "vqf" else DeviceAttitude()
    return resampler, Chain([resampler, attitude, FixedMode(CarryingMode[config.mode.mode])])


def stepping(config: Config) -> Chain:
    """Chain LevelBlock -> Step with length and heading."""
    rate_hz = config.resample.rate_hz
    return Chain(
        [
            StepSegmentation(step_detector(config), config.steps.segmentation),
            StepLength(rate_hz, config.walker, config.step_length),
            StepYaw(),
        ]
    )


def step_detector(config: Config) -> Stage:
    """The configured step detector, a stage LevelBlock -> StepEvent."""
    match config.steps.detector:
        case "band-peaks":
            return BandPeaks(config.resample.rate_hz, config.steps.band_peaks)
        case "mmpdr":
            return MmpdrSteps(config.resample.rate_hz, config.steps.mmpdr)


def _analyse_device(device: DeviceRecording, recording_name: str, config: Config) -> DeviceWalk:
    place = f"{recording_name} ({device.name})"
    resampler, to_level = levelling(device, place, config)
    level = _run(to_level, device.blocks())
    if not level:
        raise RecordingError(f"{place}: {_why_nothing(device)}")
    steps = _run(stepping(config), level)
    odometry = _run(Odometry(device.name, config.odometry), steps)
    return DeviceWalk(
        device=device.name,
        start_s=float(level[0].time_s[0]),
        level=tuple(level),
        steps=tuple(steps),
        odometry=tuple(odometry),
        gaps=resampler.gaps,
        dropped_samples=resampler.dropped,
    )


def _run(stage: Any, items: Any) -> list[Any]:
    outputs = [output for item in items for output in stage.push(item)]
    return outputs + list(stage.flush())


def _needed_channels(device: DeviceRecording, place: str, config: Config) -> tuple[Channel, ...]:
    if device.specific_force is None or not len(device.specific_force):
        raise RecordingError(f"{place}: no accelerometer: nothing can be done without it; record it and try again")
    if device.rotation_rate is None or not len(device.rotation_rate):
        raise RecordingError(
            f"{place}: no gyroscope, so no heading and no track; `pdr-est inspect` still describes the recording"
        )
    needed = (Channel.SPECIFIC_FORCE, Channel.ROTATION_RATE)
    if config.attitude.source == "vqf":
        return needed
    if device.attitude is None or not len(device.attitude):
        raise RecordingError(f"{place}: the device recorded no attitude: use --attitude vqf")
    return (*needed, Channel.ATTITUDE)


def _why_nothing(device: DeviceRecording) -> str:
    spans = [(block.channel.value, block.time_s[0], block.time_s[-1]) for block in device.blocks()]
    if max(start for _, start, _ in spans) >= min(end for _, _, end in spans):
        text = ", ".join(f"{name} {start:.2f} to {end:.2f} s" for name, start, end in spans)
        return f"the channels do not overlap in time ({text}): check the clocks of the recorder"
    return "too few samples for a single point of the working grid: record for longer"
