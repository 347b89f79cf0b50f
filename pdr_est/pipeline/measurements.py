"""Measurements of each device for the estimator."""

from collections.abc import Sequence
from dataclasses import replace

from pdr_est.config import Config
from pdr_est.errors import EstimationError
from pdr_est.estimators import EstimatorSpec
from pdr_est.estimators.common.fix_noise import fixes_with_noise
from pdr_est.estimators.common.tethers import tethers_between
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.floor_plan import FloorPlan, PresentFloor
from pdr_est.types.measurements import (
    DeviceMeasurements,
    DeviceTether,
    HeadingPrior,
    LoopClosure,
    Measurement,
    PositionFix,
)


def refuse_without_heading(walks: Sequence[DeviceWalk]) -> None:
    """Raise EstimationError for a device without gyroscope."""
    for walk in walks:
        if not walk.has_heading:
            raise EstimationError(
                f"{walk.device}: no gyroscope, or no gravity, so its {len(walk.steps)} steps have no direction and "
                "make no track: leave this device out"
            )


def measurements_of_all(
    walks: Sequence[DeviceWalk],
    config: Config,
    fixes: Sequence[PositionFix],
    spec: EstimatorSpec,
    plans: Sequence[FloorPlan | PresentFloor] = (),
) -> list[DeviceMeasurements]:
    """Collect the measurements of all devices of a walk.

    Headings in the map are left out where only some of the devices have any.
    """
    return without_partial_north([measurements_of(walk, config, fixes, spec, plans) for walk in walks])


def measurements_of(
    walk: DeviceWalk,
    config: Config,
    fixes: Sequence[PositionFix],
    spec: EstimatorSpec,
    plans: Sequence[FloorPlan | PresentFloor] = (),
) -> DeviceMeasurements:
    """Collect the measurements of a device.

    A smoother gets the headings that are known only at the end of the walk, a filter those that were known at the
    step. The fixes get the noise of their source. Floor plans are for estimators that make use of them.
    """
    odometry = walk.whole_walk_odometry if spec.smooths else walk.odometry
    closure = [LoopClosure(walk.device, config.start.sigma_closed_m)] if config.start.closed else []
    used = plans if spec.uses_plan else ()
    return DeviceMeasurements(
        walk.device, walk.start_s, (*odometry, *closure, *fixes_with_noise(fixes, config.fixes), *used)
    )


def without_partial_north(devices: Sequence[DeviceMeasurements]) -> list[DeviceMeasurements]:
    """Leave the headings in the map out of a walk in which only some of its devices have any.

    The others could not be placed beside them: how their headings differ is known only roughly.
    """
    if len(devices) == 1 or all(any(_in_map(m) for m in one.measurements) for one in devices):
        return list(devices)
    return [replace(one, measurements=tuple(m for m in one.measurements if not _in_map(m))) for one in devices]


def _in_map(measurement: Measurement) -> bool:
    return isinstance(measurement, HeadingPrior) and not measurement.relative


def tethers_of(walks: Sequence[DeviceWalk], config: Config, spec: EstimatorSpec) -> list[DeviceTether]:
    """Make the tethers between the devices, as configured; for a smoother also one at the end of the walk."""
    if not config.devices.tethered:
        return []
    spans_s = {walk.device: walk.walking_span_s for walk in walks}
    return tethers_between(spans_s, config.devices.tether, at_end=spec.smooths)
