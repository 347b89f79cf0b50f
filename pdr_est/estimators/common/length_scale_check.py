"""Comparison of the length scale of a track with what is usual: the one text about an unusual one."""

import math
from collections.abc import Sequence

from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import DeviceMeasurements, LoopClosure, PositionFix, StartPose
from pdr_est.types.track import Track

UNUSUAL_SIGMAS = 2.5
"""A length scale this many standard deviations from 1 is a finding (ours): about one walker in 80 has such steps, so
that a wrong measurement is the more likely cause."""

_CLOSURE = "the walk does not end where it began (--closed)"
_FIXES = "a position fix, its stated accuracy or its time is wrong"
_HEADING = "the start heading is wrong"


def length_scale_finding(
    length_scale: float,
    sigma_usual: float,
    sigma: float | None = None,
    causes: Sequence[str] = (_FIXES, _HEADING),
) -> Finding | None:
    """Compare a length scale with its prior; None for a usual one.

    Parameters
    ----------
    length_scale
        Estimated length scale of the walker.
    sigma_usual
        Standard deviation of the logarithm of the length scale over walkers, about 0.
    sigma
        Standard deviation of the estimate, where it is known.
    causes
        Measurements that may have pulled it there, in words.
    """
    if sigma_usual <= 0.0:
        return None
    ratio = math.log(length_scale) / sigma_usual if length_scale > 0.0 else -math.inf
    if abs(ratio) <= UNUSUAL_SIGMAS:
        return None
    wrong = ", ".join((*causes, "steps were missed or counted twice"))
    return Finding(
        FindingKind.LENGTH_SCALE,
        f"length scale {length_scale:.2f} is {abs(ratio):.1f} sigma from usual: {wrong}, or the walker has very "
        "unusual steps (then make a profile with `pdr-est calibrate`)",
        value=length_scale,
        sigma=sigma if sigma is not None and math.isfinite(sigma) else None,
    )


def track_scale_finding(
    track: Track, devices: Sequence[DeviceMeasurements], start: StartPose, sigma_usual: float
) -> Finding | None:
    """Compare the length scale of a track with its prior, and name what was given that may be wrong.

    Parameters
    ----------
    track
        Track of all devices.
    devices, start
        What the estimator was given.
    sigma_usual
        Standard deviation of the logarithm of the length scale over walkers.
    """
    given = [one for device in devices for one in device.measurements]
    causes = [_CLOSURE] * any(isinstance(one, LoopClosure) for one in given)
    causes += [_FIXES] * any(isinstance(one, PositionFix) for one in given)
    causes += [_HEADING] * (start.heading_rad is not None)
    return length_scale_finding(track.length_scale, sigma_usual, track.sigma_length_scale, causes)
