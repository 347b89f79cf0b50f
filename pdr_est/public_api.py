"""The functions that `pdr_est` offers under flat names: the whole pipeline, and its stages one by one.

Each takes defaults for everything but the data, and returns records of `pdr_est.types`. The modules below have more
arguments and more results.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby
from typing import Any

from numpy.typing import ArrayLike

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.errors import EstimationError, FloorPlanError
from pdr_est.estimators import AUTO, Estimator, estimator_named
from pdr_est.estimators.common.unknown_direction import with_unknown_direction
from pdr_est.estimators.person.track import fuse
from pdr_est.evaluate.walk_findings import findings_of
from pdr_est.params.validation_messages import brief
from pdr_est.parts import ESTIMATOR, NO_PARTS, Parts, given_part
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan, PresentFloor
from pdr_est.types.measurements import (
    DeviceMeasurements,
    DeviceTether,
    HeadingPrior,
    LoopClosure,
    PositionFix,
    StartPose,
    StepOdometry,
)
from pdr_est.types.on_plan.sound_plans import require_sound_floors, require_sound_plan
from pdr_est.types.recording import Recording
from pdr_est.types.steps import Step
from pdr_est.types.track import Track, concatenate

Odometry = Sequence[StepOdometry | HeadingPrior | LoopClosure] | Sequence[DeviceMeasurements]
"""Step odometry with heading priors of one or several devices, or the measurements of each device."""

_SIGMA_LENGTH_SCALE = Config().odometry.sigma_length_scale


def smooth(
    recording: Recording,
    config: Config | None = None,
    fixes: Sequence[PositionFix] = (),
    parts: Parts = NO_PARTS,
    plan: FloorPlan | BuildingPlan | None = None,
) -> Track:
    """Estimate the track of a recorded walk with the configured estimator (default: factor graph).

    Parameters
    ----------
    recording
        The walk, of one or several devices.
    config
        Settings; the defaults if omitted.
    fixes
        Known positions in the map frame.
    parts
        Stages and an estimator of your own, in place of those that the settings name.
    plan
        Floor plan in the map frame, as `read_floor_plan` returns it, or those of several floors by
        `read_building_plan`.

    Returns
    -------
    Track
        Poses of every device, and of the person ("fused") where there are several devices.
        `pdr_est.pipeline.smooth_recording`
        also returns the steps, warnings and timings.

    Raises
    ------
    PdrError
        If recording, settings, fixes or plan give no track.
    """
    return pipeline.smooth_recording(recording, Config() if config is None else config, fixes, parts, plan).track


def analyse(recording: Recording, config: Config | None = None, parts: Parts = NO_PARTS) -> tuple[DeviceWalk, ...]:
    """Run the front end: detect the steps of every device, with length, heading and odometry.

    Parameters
    ----------
    recording
        The walk. A device without gyroscope has steps without heading.
    config
        Settings; the defaults if omitted.
    parts
        Stages of your own, in place of those that the settings name.

    Returns
    -------
    tuple of DeviceWalk
        One for each device.

    Raises
    ------
    RecordingError
        If a device has no accelerometer or no usable samples, or if devices or their clocks do not belong together.
    """
    return pipeline.analyse_recording(recording, Config() if config is None else config, parts)


def detect_steps(
    time_s: ArrayLike,
    acc_mps2: ArrayLike,
    gyr_radps: ArrayLike | None = None,
    config: Config | None = None,
) -> tuple[Step, ...]:
    """Detect steps in the samples of one phone, with mode, length and heading of each step.

    Parameters
    ----------
    time_s
        (n,) s, strictly increasing.
    acc_mps2
        (n, 3) accelerometer including gravity, m/s², device axes, pointing up when the phone lies still.
    gyr_radps
        (n, 3) gyroscope, rad/s, device axes. Without it steps have no heading and the mode is unknown.
    config
        Settings; the defaults if omitted.

    Returns
    -------
    tuple of Step
        The steps in order of time.

    Raises
    ------
    RecordingError
        If an array has a wrong shape or values that cannot be in the stated unit.
    """
    (walk,) = analyse(Recording.from_arrays(time_s, acc_mps2, gyr_radps), config)
    return walk.steps


def estimate(
    odometry: Odometry,
    fixes: Sequence[PositionFix] = (),
    estimator: str | Estimator = AUTO,
    *,
    start: StartPose | None = None,
    tethers: Sequence[DeviceTether] = (),
    sigma_length_scale: float = _SIGMA_LENGTH_SCALE,
    plan: FloorPlan | Sequence[PresentFloor] | None = None,
) -> Track:
    """Estimate a track from step odometry, whatever front end it comes from.

    Parameters
    ----------
    odometry
        `StepOdometry`, with `HeadingPrior` and `LoopClosure` among them if wanted, of one or several devices, in
        order of time for each device; or one `DeviceMeasurements` for each device.
    fixes
        Known positions of the person in the map frame.
    estimator
        Name of an estimator, `module:attribute` of one from outside the package, or an object with the contract
        `pdr_est.Estimator`. "auto" is particle on a floor plan, and factor-graph without one.
    start
        Pose at the start of the walk, common to all devices; by default it is found from the fixes, and without
        fixes the track starts at the origin along x.
    tethers
        Bounds on the distance between devices.
    sigma_length_scale
        Standard deviation of the walker's step length relative to that of the odometry.
    plan
        Floor plan in the map frame, or the floors of the walk with their plans in order of time, for an estimator
        whose spec says `uses_plan`, such as particle; others take no notice of them.

    Returns
    -------
    Track
        Poses of every device, and of the person ("fused") where there are several devices, and what does not fit.

    Raises
    ------
    EstimationError, FloorPlanError
        If there is no odometry, it is out of order, no unique solution exists, or the plan cannot be used.
    """
    plans = _checked_plans(plan)
    devices = [
        DeviceMeasurements(one.device, one.start_s, (*one.measurements, *fixes, *plans))
        for one in _by_device(odometry)
    ]
    chosen: Estimator = (
        estimator_named(estimator, on_plan=bool(plans))
        if isinstance(estimator, str)
        else given_part(estimator, ESTIMATOR, "estimator", {})
    )
    known = start or StartPose()
    track = chosen.estimate(devices, tethers, known, sigma_length_scale)
    further = findings_of(track, devices, tethers, known, sigma_length_scale, chosen.spec)
    track = replace(track, findings=(*track.findings, *further))
    track = concatenate([track, fuse(track)]) if len(devices) > 1 else track
    return with_unknown_direction(track, devices, known)


def _checked_plans(plan: Any) -> tuple[FloorPlan | PresentFloor, ...]:
    """List the plan, or the floors with their plans; raise FloorPlanError for those that cannot be used."""
    if plan is None or isinstance(plan, FloorPlan):
        if plan is not None:
            require_sound_plan(plan)
        return () if plan is None else (plan,)
    if not isinstance(plan, Sequence) or not all(isinstance(one, PresentFloor) for one in plan):
        raise FloorPlanError(
            f"plan = {brief(plan)}: give a FloorPlan, or a PresentFloor for each change of the floor"
        )
    require_sound_floors(plan)
    return tuple(plan)


def _by_device(odometry: Odometry) -> list[DeviceMeasurements]:
    """Sort measurements by device, in order of first appearance; each walk starts with its first step."""
    devices = [one for one in odometry if isinstance(one, DeviceMeasurements)]
    if len(devices) == len(odometry) > 0:
        return devices
    single = [one for one in odometry if isinstance(one, StepOdometry | HeadingPrior | LoopClosure)]
    if not single or len(single) < len(odometry):
        kinds = sorted({type(one).__name__ for one in odometry}) or ["nothing"]
        raise EstimationError(
            f"odometry holds {', '.join(kinds)}: give a sequence of StepOdometry (with HeadingPrior and LoopClosure "
            "among them), or one DeviceMeasurements for each device; position fixes go into `fixes`"
        )
    order = {name: number for number, name in enumerate(dict.fromkeys(one.device for one in single))}
    grouped = groupby(sorted(single, key=lambda one: order[one.device]), key=lambda one: one.device)
    return [_device_measurements(name, tuple(measurements)) for name, measurements in grouped]


def _device_measurements(
    device: str, measurements: tuple[StepOdometry | HeadingPrior | LoopClosure, ...]
) -> DeviceMeasurements:
    first = next((one for one in measurements if isinstance(one, StepOdometry)), None)
    if first is None:
        raise EstimationError(
            f"{device}: no StepOdometry among its measurements: add its steps or leave the device out"
        )
    return DeviceMeasurements(device, first.start_s, measurements)
