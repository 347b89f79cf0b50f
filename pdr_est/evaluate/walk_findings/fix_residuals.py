"""Distance of each position fix from the track that the other measurements give, compared with what is plausible."""

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.common.huber import HUBER
from pdr_est.frames import Array
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import PositionFix
from pdr_est.types.track import Track, bracketing_poses

FALSE_ALARMS = 0.01
"""Probability (ours) that any fix of a walk is a finding although all stated accuracies are right."""

_INTERPOLATION_M = 0.05
"""Error of the interpolation between two poses in each coordinate, m: half a step of usual noise (ours)."""

_STEP_NOISE = 0.1
"""Error of a step over its length, in each coordinate (ours)."""

_LEAST_FREE = 0.1
"""A smoothed position of which a fix alone tells more than all but this share cannot judge the fix any better (ours);
it also bounds the error of a covariance that an estimator has raised because of doubts."""


@dataclass(frozen=True)
class FixResidual:
    """Fix compared with the track without it.

    Attributes
    ----------
    fix
        The fix.
    error_m
        (2,) fix minus the position that the rest of the walk gives, m.
    squared
        Squared error in units of its covariance: chi-squared with 2 degrees of freedom if everything is right.
    """

    fix: PositionFix
    error_m: Array
    squared: float

    @property
    def distance_m(self) -> float:
        """Length of the error, m."""
        return float(np.hypot(*self.error_m))

    @property
    def sigma_m(self) -> float:
        """Standard deviation of the error in its own direction, m."""
        return self.distance_m / math.sqrt(self.squared)


def chance_limit(probability: float) -> float:
    """Return the squared distance that chance exceeds with a probability (chi-squared, 2 degrees of freedom)."""
    return -2.0 * math.log(probability)


def fix_findings(track: Track, fixes: Sequence[PositionFix], used: bool = True) -> list[Finding]:
    """Find the fixes that disagree with the rest of the walk by more than is plausible for their number.

    A fix of a walk with several devices must disagree with the track of each of them. One that lies inside the time
    span of a finding about fixes that the track already has is not told again.

    Parameters
    ----------
    track
        Track of all devices at the centre of the body.
    fixes
        Fixes of the walk.
    used
        True for an estimator that takes fixes as measurements.
    """
    tracks = [track.of_device(name) for name in track.devices]
    residuals = [min(found, key=lambda one: one.squared) for fix in fixes if (found := _of_fix(fix, tracks, used))]
    if not residuals:
        return []
    limit = chance_limit(1.0 - (1.0 - FALSE_ALARMS) ** (1.0 / len(residuals)))
    told = [
        (finding.begin_s, finding.end_s)
        for finding in track.findings
        if finding.kind is FindingKind.FIXES and finding.begin_s is not None and finding.end_s is not None
    ]
    by_source: defaultdict[str, list[FixResidual]] = defaultdict(list)
    count = defaultdict[str, int](int)
    for one in residuals:
        count[one.fix.source] += 1
        if one.squared > limit and not any(begin_s <= one.fix.time_s <= end_s for begin_s, end_s in told):
            by_source[one.fix.source].append(one)
    return [disagreement(source, found, count[source]) for source, found in by_source.items()]


def fix_residual(fix: PositionFix, track: Track, devices: int = 1, used: bool = True) -> FixResidual | None:
    """Compare a fix with the track of one device as it would be without the fix.

    With a filtered track this is the innovation: the last pose before the fix is moved on by the step until then. A
    pose of a smoothed track contains the fix, and its share is taken out again: P = (P0⁻¹ + R⁻¹)⁻¹ gives the
    covariance P0 without the fix, and its residual grows by 1 + P0 R⁻¹. A fix whose error wanders, or which is robust
    and an outlier, has little weight in a smoothed track: it is compared with the track as it is.

    Parameters
    ----------
    fix
        The fix.
    track
        Track of the device.
    devices
        Number of devices of the walk, each of which was given the fix with so many times its covariance.
    used
        True for an estimator that takes fixes as measurements.

    Returns
    -------
    FixResidual or None
        None where the position or its covariance is not known, and for a filtered track that begins with the fix.
    """
    at_s = np.array([fix.time_s])
    (before,), (after,), (share,) = bracketing_poses(track.time_s, track.moving_from_s, at_s)
    around = [before, after]
    if not (np.isfinite(track.position_m[around]).all() and np.isfinite(track.covariance_m2[around]).all()):
        return None
    noise_m2 = fix.total_covariance_m2
    if used and track.kind == "filtered":
        return _innovation(fix, noise_m2, track, *((after, share) if share > 0.0 else (before, 1.0)))
    shares = np.array([1.0 - share, share])
    covariance_m2 = np.einsum("p,pij->ij", shares, track.covariance_m2[around])
    error_m = np.asarray(fix.position_m - shares @ track.position_m[around])
    outlier = fix.robust and float(error_m @ np.linalg.solve(noise_m2, error_m)) > HUBER**2
    if not used or outlier or fix.sigma_wander_m > 0.0:
        return _compared(fix, error_m, noise_m2 + covariance_m2)
    return _left_out(fix, error_m, noise_m2, covariance_m2, devices)


def _innovation(fix: PositionFix, noise_m2: Array, track: Track, row: int, share: float) -> FixResidual | None:
    """Compare a fix with the pose before row, moved on by a share of the step to that row."""
    if row == 0:
        return None
    heading_rad, length_m = track.heading_rad[row], share * track.step_length_m[row]
    position_m = track.position_m[row - 1] + length_m * np.array([np.cos(heading_rad), np.sin(heading_rad)])
    step_m2 = (_STEP_NOISE * length_m) ** 2 * np.eye(2)
    return _compared(fix, fix.position_m - position_m, noise_m2 + track.covariance_m2[row - 1] + step_m2)


def _of_fix(fix: PositionFix, tracks: Sequence[Track], used: bool) -> list[FixResidual]:
    found = [fix_residual(fix, track, len(tracks), used) for track in tracks]
    return [one for one in found if one is not None]


def _compared(fix: PositionFix, error_m: Array, covariance_m2: Array) -> FixResidual:
    covariance_m2 = covariance_m2 + _INTERPOLATION_M**2 * np.eye(2)
    return FixResidual(fix, error_m, float(error_m @ np.linalg.solve(covariance_m2, error_m)))


def _left_out(fix: PositionFix, error_m: Array, noise_m2: Array, covariance_m2: Array, devices: int) -> FixResidual:
    """Take the fix out of the pose that contains it with `devices` times its covariance noise_m2."""
    root = np.linalg.cholesky(devices * noise_m2)
    whiten = np.linalg.inv(root)
    known, axes = np.linalg.eigh(whiten @ covariance_m2 @ whiten.T)  # 1: nothing but the fix tells the position
    known = np.clip(known, 0.0, 1.0 - _LEAST_FREE)
    free = 1.0 - known + _INTERPOLATION_M**2 * np.square(whiten.T @ axes).sum(axis=0)
    error = (axes.T @ whiten @ error_m) / free
    variance = 1.0 / devices + known / free
    return FixResidual(fix, np.asarray(root @ axes @ error), float((error**2 / variance).sum()))


def disagreement(source: str, found: Sequence[FixResidual], of: int) -> Finding:
    """Make one finding of the disagreeing fixes of a source: a wrong one lets its neighbours disagree as well.

    Parameters
    ----------
    source
        Name of the source.
    found
        Its disagreeing fixes in order of time, at least one.
    of
        Number of all its fixes.
    """
    worst = max(found, key=lambda one: one.squared)
    size = f"{worst.distance_m:.1f} m, {math.sqrt(worst.squared):.1f} times its standard deviation"
    begin_s, end_s = found[0].fix.time_s, found[-1].fix.time_s
    if len(found) == 1:
        text = f"the position fix ({source}) at {begin_s:.1f} s disagrees with the rest of the walk by {size}"
        cause = "its position, accuracy or time is wrong, or the steps near it are"
    else:
        text = (
            f"{len(found)} of {of} position fixes ({source}) between {begin_s:.1f} s and {end_s:.1f} s disagree with "
            f"the rest of the walk, most the one at {worst.fix.time_s:.1f} s: {size}"
        )
        cause = "the position, accuracy or time of some is wrong, or the steps near them are"
    return Finding(
        FindingKind.FIXES,
        f"{text}: {cause}",
        begin_s=begin_s,
        end_s=end_s,
        value=worst.distance_m,
        sigma=worst.sigma_m,
    )
