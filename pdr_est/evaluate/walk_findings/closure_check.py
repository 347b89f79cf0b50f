"""Comparison of a walk that is said to end where it began with the way that its steps lead."""

import math
from collections.abc import Sequence

import numpy as np

from pdr_est.estimators.fix_checks import DeadReckonedPath
from pdr_est.evaluate.walk_findings.fix_residuals import FALSE_ALARMS, chance_limit
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import DeviceMeasurements, LoopClosure, StepOdometry

_FAR = chance_limit(FALSE_ALARMS)


def closure_findings(devices: Sequence[DeviceMeasurements], sigma_length_scale: float) -> list[Finding]:
    """Find the devices whose steps lead farther from the start than their errors allow though the walk is closed.

    The steps alone tell it, so that it does not depend on how the track gave way.

    Parameters
    ----------
    devices
        What the estimator was given.
    sigma_length_scale
        Standard deviation of the logarithm of the length scale over walkers.
    """
    found = [_of_device(one, sigma_length_scale) for one in devices]
    return [finding for finding in found if finding is not None]


def _of_device(one: DeviceMeasurements, sigma_length_scale: float) -> Finding | None:
    sigmas_m = [m.sigma_m for m in one.measurements if isinstance(m, LoopClosure) and m.device == one.device]
    steps = [m for m in one.measurements if isinstance(m, StepOdometry) and m.device == one.device]
    if not sigmas_m or not steps:
        return None
    path = DeadReckonedPath(one.start_s, steps)
    if len(path.lost):
        return None
    end = path.at(path.time_s[-1:])
    (way_m,), (steps_m2,) = end.position_m, path.variance(end, 0)
    covariance_m2 = steps_m2 + sigma_length_scale**2 * np.outer(way_m, way_m) + min(sigmas_m) ** 2 * np.eye(2)
    squared, distance_m = float(way_m @ np.linalg.solve(covariance_m2, way_m)), float(np.hypot(*way_m))
    if squared <= _FAR:
        return None
    return Finding(
        FindingKind.CLOSURE,
        f"the walk is said to end where it began (--closed), but its steps lead {distance_m:.1f} m away, "
        f"{math.sqrt(squared):.1f} times the standard deviation: the track is bent or stretched to close it; leave "
        "--closed out if the walk ended elsewhere",
        device=one.device,
        value=distance_m,
        sigma=distance_m / math.sqrt(squared),
    )
