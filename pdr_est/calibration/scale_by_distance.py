"""The length scale that a walk of known length shows, as far as the recording holds it."""

import math
from collections.abc import Sequence

from pdr_est.calibration.scale_by_fixes import LARGEST_SIGMA
from pdr_est.calibration.step_length_fit import (
    CalibrationSteps,
    NotLearnt,
    ScaleObservation,
    observe_distance,
    refuse_distance,
)
from pdr_est.pipeline import DeviceWalk

_MOST_MISSING = 1.0 - math.exp(-math.sqrt(12.0) * LARGEST_SIGMA)  # see `observe_distance`: half of the way


def observe_known_distance(
    walks: Sequence[DeviceWalk], distance_m: float, place: str
) -> ScaleObservation | NotLearnt:
    """Observe the scale of a walk of known length by the devices that recorded most of it.

    Parameters
    ----------
    walks
        Devices of the walk, with steps whose lengths are those of the model, without personal constants.
    distance_m
        True length of the whole way, m.
    place
        Name of the walk in messages.

    Returns
    -------
    ScaleObservation or NotLearnt
        The reason if so much of the recording is missing that the distance hardly tells the scale.

    Raises
    ------
    RecordingError
        As `observe_distance`.
    """
    shares = [missing_share(walk) for walk in walks]
    least = min(shares)
    steps = [
        CalibrationSteps.from_steps(walk.steps) for walk, share in zip(walks, shares, strict=True) if share <= least
    ]
    refuse_distance(distance_m, place)
    if least <= _MOST_MISSING:
        return observe_distance(steps, distance_m, place, least)
    gaps = f"up to {100.0 * least:.0f} % of the way lie in its gaps" if least < 1.0 else "its clock restarts"
    return NotLearnt(
        f"{gaps}, so that the distance of {distance_m:g} m tells little of its steps: give a recording without gaps, "
        "or --fixes"
    )


def missing_share(walk: DeviceWalk) -> float:
    """Compute the largest share of the walking that a recording misses: if the walker walked on in all of its gaps.

    It is 1 for a clock that restarts, since nobody knows how long the gap is, and without steps.
    """
    missing_s = sum(block.hole.duration_s for block in walk.level if block.hole is not None)
    if missing_s == 0.0:
        return 0.0
    walked_s = sum(step.event.time_s - step.start_s for step in walk.steps)
    return missing_s / (missing_s + walked_s) if math.isfinite(missing_s) else 1.0
