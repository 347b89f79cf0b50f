"""The front end of one device: its stages, put together as configured, and all of them run on a recording."""

from typing import Any

from pdr_est.config import Config
from pdr_est.front_end.attitude import AccelerometerTilt, DeviceAttitude, VqfAttitude
from pdr_est.front_end.gait import gait_stage
from pdr_est.front_end.heading import heading_stage, needs_magnetometer, whole_walk_stage
from pdr_est.front_end.mode import mode_stage
from pdr_est.front_end.odometry import Odometry
from pdr_est.front_end.step_length import StepLength
from pdr_est.front_end.steps import step_detector
from pdr_est.front_end.steps.segmentation import StepSegmentation
from pdr_est.preprocessing.quality.requirements import (
    explain_empty_grid,
    has_gyroscope,
    prefers_recorded_attitude,
    require_magnetometer,
    required_channels,
)
from pdr_est.preprocessing.resampling import Resampler
from pdr_est.stage import Chain, Stage
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.recording import DeviceRecording
from pdr_est.types.sensors import Channel


def analyse_device(device: DeviceRecording, place: str, config: Config) -> DeviceWalk:
    """The front end on one device's recording; one without gyroscope has steps without heading.

    place: what to call the device in messages. Raises RecordingError if it has no accelerometer, or samples that
    cannot be used.
    """
    resampler, to_level = levelling(device, place, config)
    level = _run(to_level, device.blocks())
    if not level:
        raise explain_empty_grid(device, place, config.resample.max_gap_s)
    steps = _run(stepping(config), level)
    has_heading = has_gyroscope(device)
    odometry = _run(Odometry(device.name, config.odometry), steps) if has_heading else []
    whole_walk_odometry, directions = odometry, None
    whole_walk = whole_walk_stage(config.heading) if has_heading else None
    if whole_walk is not None:
        whole_walk_odometry = _run(Odometry(device.name, config.odometry), _run(whole_walk, steps))
        directions = whole_walk.found
    return DeviceWalk(
        device=device.name,
        start_s=float(level[0].time_s[0]),
        level=tuple(level),
        steps=tuple(steps),
        odometry=tuple(odometry),
        whole_walk_odometry=tuple(whole_walk_odometry),
        directions=directions,
        has_heading=has_heading,
        gaps=resampler.gaps,
        dropped_samples=resampler.dropped,
    )


def levelling(device: DeviceRecording, place: str, config: Config) -> tuple[Resampler, Chain]:
    """Chain SensorBlock -> LevelBlock for a device, and its first stage, which knows the gaps.

    The magnetic field comes with it where the heading needs it; all else is the same with it and without.
    """
    source = config.attitude.source
    own_attitude = source == "device" or (source == "auto" and prefers_recorded_attitude(device))
    channels = required_channels(device, place, with_attitude=own_attitude)
    optional: tuple[Channel, ...] = ()
    if needs_magnetometer(config.heading):
        require_magnetometer(device, place)
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


def _run(stage: Any, items: Any) -> list[Any]:
    outputs = [output for item in items for output in stage.push(item)]
    return outputs + list(stage.flush())
