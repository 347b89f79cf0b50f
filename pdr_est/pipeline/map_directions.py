"""Directions of the building that are known in the map, and which of them a walk follows."""

from collections.abc import Sequence
from dataclasses import replace
from math import pi

import numpy as np

from pdr_est.config import Config
from pdr_est.estimators import Estimator, EstimatorSpec, estimator_named
from pdr_est.estimators.common.map_directions import resolve_relative_priors
from pdr_est.frames import wrap_angle
from pdr_est.front_end.heading.whole_walk.wall_directions import wall_directions
from pdr_est.pipeline.estimation import run_estimator
from pdr_est.types.analysis import DeviceWalk, DominantDirections
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan, PresentFloor
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether, HeadingPrior, PositionFix, StartPose
from pdr_est.types.track import Track

_OTHER_DIRECTIONS = 0.1  # prior probability that a walk along directions follows others than those of the walls; ours
_DECIDED = 0.8  # least probability of the nearest direction of the walls; ours


def with_plan_directions(config: Config, plan: FloorPlan | BuildingPlan | None, spec: EstimatorSpec) -> Config:
    """Take the directions of the building from the walls of the plan, where the settings give none.

    This is for smoothers that make no use of the plan themselves. One that does would count the walls twice: the
    headings that are tied to them look like further evidence for the same way.
    """
    heading, dominant = config.heading, config.heading.dominant
    gives_priors = heading.method == "auto" and heading.use == "priors" and dominant.enabled
    if plan is None or not spec.smooths or spec.uses_plan or not gives_priors or dominant.given_number is not None:
        return config
    found = wall_directions(plan.all_floors if isinstance(plan, BuildingPlan) else plan)
    if found is None:
        return config
    direction_rad = float(wrap_angle(found.direction_rad))
    known = replace(dominant, number=found.number, direction_rad=direction_rad, certain=False)
    return replace(config, heading=replace(heading, dominant=known))


def needs_whole_walk(config: Config, spec: EstimatorSpec) -> bool:
    """Tell whether the front end has to look at the whole walk: for a smoother, and for known directions."""
    return spec.smooths or config.heading.dominant.direction_rad is not None


def along_map_directions(
    devices: Sequence[DeviceMeasurements],
    walks: Sequence[DeviceWalk],
    tethers: Sequence[DeviceTether],
    estimator: Estimator,
    config: Config,
) -> list[DeviceMeasurements]:
    """Tie the dominant directions that the walk of each device shows to one that is known in the map.

    A track without that knowledge selects the direction; an estimator that uses floor plans is not asked for it,
    because that takes long, and a factor graph finds the same heading. The directions of a floor plan
    (`heading.dominant.certain` is false) are left out where it is not decided which of them a walk follows.

    Parameters
    ----------
    devices
        Measurements of each device.
    walks
        Their analyses, with the dominant directions.
    tethers
        Tethers between the devices.
    estimator
        Estimator of the walk.
    config
        Settings; without a known direction nothing changes.
    """
    dominant = config.heading.dominant
    shown = [walk.directions for walk in walks]
    if dominant.direction_rad is None or not any(map(_first_relative, devices)):
        return list(devices)
    asked = estimator_named("factor-graph") if estimator.spec.uses_plan else estimator
    track = run_estimator([_without_plan(one) for one in devices], tethers, asked, config)
    tied = []
    for one, directions in zip(devices, shown, strict=True):
        own = track.of_device(one.device)
        if directions is not None and (
            dominant.certain or _decided(one, directions, own, dominant.direction_rad, config.start.pose())
        ):
            found = resolve_relative_priors(one.measurements, own, dominant.direction_rad, directions.spacing_rad)
            one = replace(one, measurements=tuple(found))
        tied.append(one)
    return tied


def _decided(
    known: DeviceMeasurements,
    directions: DominantDirections,
    own: Track,
    direction_rad: float,
    start: StartPose,
) -> bool:
    """Tell whether a walk most probably follows the known direction that is nearest to its heading.

    It may also follow another one of them, or directions of its own.
    """
    first = _first_relative(known)
    if not directions.used or first is None or not _has_heading(known, start):
        return False
    at = int(np.argmin(np.abs(own.time_s - first.time_s)))
    sigma_rad = float(np.hypot(own.sigma_heading_rad[at], first.sigma_rad))
    number = round(2.0 * pi / directions.spacing_rad)
    off_rad = wrap_angle(own.heading_rad[at] - direction_rad - directions.spacing_rad * np.arange(number))
    density = np.exp(-0.5 * (off_rad / sigma_rad) ** 2) / (np.sqrt(2.0 * pi) * sigma_rad * number)
    followed = (1.0 - _OTHER_DIRECTIONS) * density
    return bool(followed.max() >= _DECIDED * (followed.sum() + _OTHER_DIRECTIONS / (2.0 * pi)))


def _has_heading(known: DeviceMeasurements, start: StartPose) -> bool:
    """Tell whether anything but the directions gives the heading in the map."""
    in_map = any(isinstance(m, HeadingPrior) and not m.relative for m in known.measurements)
    positions = sum(isinstance(m, PositionFix) for m in known.measurements) + (start.position_m is not None)
    return in_map or start.heading_rad is not None or positions > 1


def _first_relative(known: DeviceMeasurements) -> HeadingPrior | None:
    return next((m for m in known.measurements if isinstance(m, HeadingPrior) and m.relative), None)


def _without_plan(known: DeviceMeasurements) -> DeviceMeasurements:
    return replace(
        known, measurements=tuple(m for m in known.measurements if not isinstance(m, FloorPlan | PresentFloor))
    )
