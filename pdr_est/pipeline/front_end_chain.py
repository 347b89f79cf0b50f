"""The front end of one device: its stages, put together as configured, and run on a recording.

The same chains run online. Each part may be one from outside the package: configured by its dotted name, or given as
an object in `Parts`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from pdr_est.config import Config
from pdr_est.front_end.attitude import AccelerometerTilt, DeviceAttitude, VqfAttitude
from pdr_est.front_end.gait import gait_stage
from pdr_est.front_end.heading import heading_stage, needs_magnetometer, whole_walk_stage
from pdr_est.front_end.heading.north import NorthPriors, NorthReference, north_reference
from pdr_est.front_end.heading.whole_walk.drift_correction import WholeWalkHeading
from pdr_est.front_end.height import height_profile
from pdr_est.front_end.mode import mode_stage
from pdr_est.front_end.odometry import Odometry
from pdr_est.front_end.step_length import stairs_stage, step_length_stage
from pdr_est.front_end.step_length.stairs import StairLengths
from pdr_est.front_end.steps import step_detector
from pdr_est.front_end.steps.segmentation import StepSegmentation
from pdr_est.parts import NO_PARTS, STAGE, Parts, StagePart, given_part
from pdr_est.pipeline.garbage_collection import collection_paused
from pdr_est.preprocessing.quality.clock_requirements import explain_empty_grid
from pdr_est.preprocessing.quality.requirements import (
    has_gyroscope,
    prefers_recorded_attitude,
    require_magnetometer,
    required_channels,
)
from pdr_est.preprocessing.resampling import Resampler
from pdr_est.stage import Chain, Parallel, Stage, run_through
from pdr_est.types.analysis import DeferredOdometry, DeviceWalk
from pdr_est.types.findings import Finding
from pdr_est.types.height import HeightProfile
from pdr_est.types.measurements import HeadingPrior, StepOdometry
from pdr_est.types.recording import DeviceRecording, Recording
from pdr_est.types.sensors import Channel


@collection_paused()
def analyse_device(
    device: DeviceRecording,
    place: str,
    config: Config,
    parts: Parts = NO_PARTS,
    north: NorthReference | None = None,
    at_the_end: bool = True,
) -> DeviceWalk:
    """Run the front end on the recording of one device; one without gyroscope has steps without heading.

    Parameters
    ----------
    device
        The recording.
    place
        What to call the device in messages.
    config, parts
        Choice of the stages and their parameters.
    north
        Source of headings against north, as `north_of` gives it; None for none.
    at_the_end
        False to leave out the corrections that need the whole walk.

    Raises
    ------
    RecordingError
        If the device has no accelerometer or no usable samples.
    ConfigError
        If a part cannot be made.
    """
    resampler, to_level = levelling(device, place, config, parts, north)
    level = run_through(to_level, tuple(device.blocks()))
    if not level:
        raise explain_empty_grid(device, place, config.resample.max_gap_s)
    steps = run_through(stepping(config, parts), level)
    has_heading = has_gyroscope(device)
    used = causal = measuring(device.name, config, north)
    corrections = whole_walk_corrections(config, parts) if at_the_end and has_heading else NO_CORRECTIONS
    odometry: Sequence[StepOdometry | HeadingPrior] = DeferredOdometry(partial(run_through, causal, steps))
    if not corrections.stages:
        odometry = tuple(odometry) if has_heading else ()
    whole_walk_odometry = odometry
    if corrections.stages:
        used = measuring(device.name, config, north, at_the_end=corrections.heading is not None)
        whole_walk_odometry = tuple(run_through(used, run_through(Chain(corrections.stages), steps)))
    return DeviceWalk(
        device=device.name,
        start_s=float(level[0].time_s[0]),
        level=tuple(level),
        steps=tuple(steps),
        odometry=odometry,
        whole_walk_odometry=whole_walk_odometry,
        directions=None if corrections.heading is None else corrections.heading.directions,
        has_heading=has_heading,
        gaps=resampler.gaps,
        dropped_samples=resampler.dropped,
        findings=_findings_of(used),
        height=_height(device, [step.event.time_s for step in steps], config),
    )


def _height(device: DeviceRecording, step_time_s: Sequence[float], config: Config) -> HeightProfile | None:
    """Estimate height and floor of the walker where the device recorded the air pressure."""
    if device.pressure is None or not config.height.enabled:
        return None
    return height_profile(device.pressure, np.array(step_time_s), config.height)


def _findings_of(measuring_stages: Parallel) -> tuple[Finding, ...]:
    """List what headings against north have found."""
    priors = [stage for stage in measuring_stages.stages if isinstance(stage, NorthPriors)]
    return tuple(found for stage in priors for found in stage.findings)


@dataclass(frozen=True)
class WholeWalkCorrections:
    """Stages Step -> Step that need the whole walk, so that only smoothers use them.

    Attributes
    ----------
    stairs
        Gives steps on stairs their length; None for none.
    heading
        Corrects the headings, and finds the dominant directions; None for none.
    """

    stairs: StairLengths | None = None
    heading: WholeWalkHeading | None = None

    @property
    def stages(self) -> tuple[Stage, ...]:
        """List those that there are, in the order in which a step passes through them."""
        return tuple(stage for stage in (self.stairs, self.heading) if stage is not None)


NO_CORRECTIONS = WholeWalkCorrections()
"""Steps stay as they were found online."""


def whole_walk_corrections(config: Config, parts: Parts = NO_PARTS) -> WholeWalkCorrections:
    """Make the stages that need the whole walk; none that would change the output of a part given in Python."""
    return WholeWalkCorrections(
        stairs=stairs_stage(config.step_length) if parts.step_length is None else None,
        heading=whole_walk_stage(config.heading) if parts.heading is None else None,
    )


def north_of(device: DeviceRecording, recording: Recording, config: Config) -> NorthReference | None:
    """Find the source of headings against north for a device of a recording; None for none."""
    if config.heading.method != "auto" or not has_gyroscope(device):
        return None
    return north_reference(device, recording.origin, recording.epoch_s, config.heading.north)


def measuring(device: str, config: Config, north: NorthReference | None = None, at_the_end: bool = False) -> Parallel:
    """Make the stage Step -> StepOdometry and HeadingPrior of a device.

    With `at_the_end` headings against north come at the end of the walk, when all its strides tell how the phone is
    held.
    """
    odometry = Odometry(device, config.odometry)
    if north is None:
        return Parallel([odometry])
    drift = config.odometry.sigma_heading_rad_per_sqrt_s
    return Parallel([odometry, NorthPriors(device, north, config.heading.north, drift, at_the_end)])


def levelling(
    device: DeviceRecording,
    place: str,
    config: Config,
    parts: Parts = NO_PARTS,
    north: NorthReference | None = None,
) -> tuple[Resampler, Chain]:
    """Make the chain SensorBlock -> LevelBlock for a device, and return its first stage, which knows the gaps, too.

    The magnetic field and the recorded attitude are resampled with the other channels where a heading needs them, and
    the air pressure where steps on stairs are searched for; they do not change those.
    """
    source = config.attitude.source
    own_attitude = source == "device" or (source == "auto" and prefers_recorded_attitude(device))
    channels = required_channels(device, place, with_attitude=own_attitude)
    if heading_needs_magnetometer(config, parts):
        require_magnetometer(device, place)
    optional = optional_channels(channels, config, parts, north)
    if device.pressure is not None and whole_walk_corrections(config, parts).stairs is not None:
        optional = (*optional, Channel.PRESSURE)
    return level_chain(channels, optional, own_attitude, config, parts, device.restarts_s)


def optional_channels(
    required: tuple[Channel, ...], config: Config, parts: Parts, north: NorthReference | None
) -> tuple[Channel, ...]:
    """List the channels that headings need, beside the required ones of every device."""
    needed = [Channel.MAGNETIC_FIELD] if heading_needs_magnetometer(config, parts) else []
    needed += [] if north is None else [north.channel]
    return tuple(channel for channel in dict.fromkeys(needed) if channel not in required)


def level_chain(
    channels: tuple[Channel, ...],
    optional: tuple[Channel, ...],
    own_attitude: bool,
    config: Config,
    parts: Parts = NO_PARTS,
    restarts_s: tuple[float, ...] = (),
) -> tuple[Resampler, Chain]:
    """Make the chain SensorBlock -> LevelBlock for given channels, and return its first stage too.

    Parameters
    ----------
    channels
        Channels that every sample needs.
    optional
        Channels that may be absent.
    own_attitude
        True to use the attitude that the device recorded.
    config, parts
        Choice of the stages and their parameters.
    restarts_s
        Restarts of the clock that are known beforehand, as `DeviceRecording.restarts_s`.
    """
    rate_hz = config.resample.rate_hz
    resampler = Resampler(channels, config.resample, optional, restarts_s)
    if Channel.ROTATION_RATE not in channels:
        tilt = AccelerometerTilt(rate_hz, config.attitude)
        # Carrying modes are recognised by rotation: without it they stay unknown unless one is given.
        given = [mode_stage(rate_hz, config.mode)] if config.mode.method == "fixed" else []
        return resampler, Chain([resampler, tilt, *given])
    attitude: Stage = DeviceAttitude() if own_attitude else VqfAttitude(rate_hz, config.attitude)
    mode = _given_or(parts.mode, "mode", rate_hz, lambda: mode_stage(rate_hz, config.mode))
    return resampler, Chain([resampler, attitude, mode])


def stepping(config: Config, parts: Parts = NO_PARTS) -> Chain:
    """Make the chain LevelBlock -> Step: step detection, gait, length and heading."""
    rate_hz, walker = config.resample.rate_hz, config.walker
    detector = _given_or(parts.step_detector, "step_detector", rate_hz, lambda: step_detector(rate_hz, config.steps))
    gait = _given_or(parts.gait, "gait", rate_hz, lambda: gait_stage(rate_hz, config.gait))
    length = _given_or(
        parts.step_length,
        "step_length",
        rate_hz,
        lambda: step_length_stage(rate_hz, walker, config.step_length),
        {"walker": walker},
    )
    heading = _given_or(parts.heading, "heading", rate_hz, lambda: heading_stage(rate_hz, config.heading))
    return Chain([StepSegmentation(detector, config.steps.segmentation), gait, length, heading])


def heading_needs_magnetometer(config: Config, parts: Parts = NO_PARTS) -> bool:
    """Check whether the heading stage needs the magnetic field with the samples of a step.

    One from outside the package needs it if it has an attribute `needs_magnetometer` that is true.
    """
    if parts.heading is not None:
        return bool(getattr(parts.heading, "needs_magnetometer", False))
    return needs_magnetometer(config.heading)


_NOTHING: Mapping[str, Any] = {}


def _given_or(
    part: StagePart | None,
    name: str,
    rate_hz: float,
    configured: Callable[[], Stage],
    offered: Mapping[str, Any] = _NOTHING,
) -> Stage:
    """Make the stage that was given in Python, else the configured one."""
    if part is None:
        return configured()
    own: Stage = given_part(part, STAGE, f"Parts: {name}", {"rate_hz": rate_hz, **offered})
    return own
