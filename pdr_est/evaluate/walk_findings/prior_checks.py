"""Findings about what was assumed of the walk before it: the walker's step length, and the direction of the start."""

import math
from collections.abc import Sequence

from pdr_est.estimators.common.unknown_direction import direction_is_unknown
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import DeviceMeasurements, StartPose

UNUSUAL_SIGMAS = 2.5
"""A length scale this many standard deviations from 1 is a finding (ours): about one walker in 80 has such steps, so
that a wrong measurement is the more likely cause."""


def length_scale_finding(length_scale: float, sigma_length_scale: float) -> Finding | None:
    """Compare a length scale with its prior; None for a usual one.

    Parameters
    ----------
    length_scale
        Estimated length scale of the walker.
    sigma_length_scale
        Standard deviation of the logarithm of the length scale over walkers, about 0.
    """
    if sigma_length_scale <= 0.0:
        return None
    ratio = math.log(length_scale) / sigma_length_scale if length_scale > 0.0 else -math.inf
    if abs(ratio) <= UNUSUAL_SIGMAS:
        return None
    return Finding(
        FindingKind.LENGTH_SCALE,
        f"length scale {length_scale:.2f} is {abs(ratio):.1f} sigma from the usual 1: a position fix, its "
        "stated accuracy or its time is wrong, the start heading is wrong, steps were missed or counted twice, or "
        "the walker has very unusual steps (then make a profile with `pdr-est calibrate`)",
        value=length_scale,
        sigma=sigma_length_scale,
    )


def unknown_direction_finding(devices: Sequence[DeviceMeasurements], start: StartPose) -> Finding | None:
    """Tell that the direction of a track in the map is unknown although its start position is known; else None.

    A position fix at another place or a heading in the map frame makes the direction known.

    Parameters
    ----------
    devices
        What the estimator was given of each device.
    start
        Start pose as far as it is known.
    """
    if not direction_is_unknown(devices, start):
        return None
    return Finding(
        FindingKind.START_HEADING,
        "the direction of the track is unknown: a start position without a heading does not tell in which direction "
        "the walk began, so that the track is turned arbitrarily about its start: give the heading of the first step "
        "(--heading) or a position fix later in the walk (--fixes)",
    )
