"""Checks that refuse measurements which no estimator can use, and what is done about fixes that come too often."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.types.measurements import START_SOURCE, HeadingPrior, LoopClosure, PositionFix, StepOdometry

_REPEATED_S = 5.0  # within which exactly the same position of a source is a repetition; ours

_AVERAGED_S = 0.1  # fixes of a source within this time are one; ours: a walker goes straight on for 0.15 m meanwhile

GivenFixes = tuple[tuple[float, float, float], ...]
"""Times (s) and positions (east and north, m) that a source gave in the last seconds."""


def refuse_unusable(
    device: str,
    steps: Sequence[StepOdometry],
    fixes: Sequence[PositionFix],
    priors: Sequence[HeadingPrior],
    closures: Sequence[LoopClosure] = (),
) -> None:
    """Check the measurements of one device.

    Parameters
    ----------
    device
        Name of the device, for messages.
    steps, fixes, priors, closures
        Measurements of the device by kind.

    Raises
    ------
    EstimationError
        For odometry out of order, numbers that are not finite, and noise that is not a valid covariance.
    """
    _refuse_odometry(device, steps)
    for fix in fixes:
        shapes = np.shape(fix.position_m), np.shape(fix.covariance_m2)
        if shapes != ((2,), (2, 2)):
            raise EstimationError(
                f"position fix ({fix.source}) at {fix.time_s} s has a position of shape {shapes[0]} and a covariance "
                f"of shape {shapes[1]}: give (2,) and (2, 2), east and north"
            )
        if fix.source == START_SOURCE:
            raise EstimationError(
                f"position fix at {fix.time_s} s has the source {START_SOURCE!r}, which stands for the start: "
                "give it another name"
            )
        values = (fix.time_s, *fix.position_m, *np.ravel(fix.covariance_m2))
        if not np.isfinite(values).all():
            raise EstimationError(
                f"position fix ({fix.source}) at {fix.time_s} s has a value that is not finite: leave it out"
            )
        if np.linalg.eigvalsh(fix.covariance_m2)[0] <= 0.0:
            raise EstimationError(
                f"position fix ({fix.source}) at {fix.time_s:.3f} s has the covariance "
                f"{np.asarray(fix.covariance_m2).tolist()}, which is not positive definite: give it a sigma above 0"
            )
    told = np.array([(prior.time_s, prior.heading_rad, prior.sigma_rad) for prior in priors]).reshape(-1, 3)
    for row in np.flatnonzero(~(np.isfinite(told).all(axis=1) & (told[:, 2] > 0.0))):
        prior = priors[int(row)]
        raise EstimationError(
            f"heading prior of {device} at {prior.time_s} s is {prior.heading_rad} +- {prior.sigma_rad} rad: "
            "give it a heading and a sigma above 0"
        )
    for closure in closures:
        if not np.isfinite(closure.sigma_m) or closure.sigma_m <= 0.0:
            raise EstimationError(f"loop closure of {device} has the sigma {closure.sigma_m} m: give it one above 0")


def _refuse_odometry(device: str, steps: Sequence[StepOdometry]) -> None:
    """Check order, finite numbers and covariances of the steps."""
    if not steps:
        return
    motion = np.array([(step.time_s, step.start_s, step.length_m, step.heading_change_rad) for step in steps])
    covariance = np.array([step.covariance for step in steps])
    finite = np.isfinite(motion).all(axis=1) & np.isfinite(covariance).all(axis=(1, 2))
    if not finite.all():
        step = steps[int(np.argmin(finite))]
        raise EstimationError(
            f"step of {device} at {step.time_s} s has a value that is not finite (length {step.length_m} m, "
            f"turn {step.heading_change_rad} rad): look at the recording there"
        )
    backwards = np.flatnonzero(np.diff(motion[:, 0]) < 0.0)
    if len(backwards):
        before, after = motion[backwards[0] : backwards[0] + 2, 0]
        raise EstimationError(
            f"step odometry of {device} goes back in time from {before:.3f} s to {after:.3f} s: sort it"
        )
    least, most = np.linalg.eigvalsh(covariance)[:, [0, -1]].T
    wrong = np.flatnonzero(least < -1e-9 * np.maximum(most, 0.0))
    if len(wrong):
        raise EstimationError(
            f"step of {device} at {steps[wrong[0]].time_s:.3f} s has a covariance with the eigenvalue "
            f"{least[wrong[0]]:.3g}: a covariance has none below 0"
        )


def given_at(fix: PositionFix) -> tuple[float, float, float]:
    """Return time (s), east and north (m) of a fix."""
    east_m, north_m = fix.position_m
    return float(fix.time_s), float(east_m), float(north_m)


def is_repeated(earlier: GivenFixes, fix: PositionFix) -> bool:
    """Tell whether a source gave exactly the same position a few seconds before.

    A phone repeats its last position while it has no new one, and tables have rows twice. Independent measurements
    are never exactly the same, and a point that is marked twice in one place has the same error both times.
    """
    return any(given_at(fix)[1:] == one[1:] and abs(fix.time_s - one[0]) <= _REPEATED_S for one in earlier)


def with_given(earlier: GivenFixes, fix: PositionFix) -> GivenFixes:
    """Return what a source gave in the last seconds after one more fix."""
    kept = (one for one in earlier if fix.time_s - one[0] <= _REPEATED_S and one[1:] != given_at(fix)[1:])
    return (*kept, given_at(fix))


def averaged_fixes(fixes: Sequence[PositionFix]) -> tuple[PositionFix, ...]:
    """Average the fixes of a source that come faster than ten times a second, so that each makes no pose of its own.

    Parameters
    ----------
    fixes
        Fixes in order of time.

    Returns
    -------
    tuple of PositionFix
        Fixes in order of time: of those of one source within the same tenth of a second the mean position and time,
        weighted by their information, with the information of all, whose errors count as independent. An outlier
        among them is averaged with the others before it can be recognised. Positions that are repeated count once.
    """
    if len(fixes) < 2:
        return tuple(fixes)
    groups: defaultdict[tuple[object, ...], list[PositionFix]] = defaultdict(list)
    for fix in fixes:
        kind = (fix.source, fix.robust, fix.sigma_wander_m, fix.wander_time_s, fix.clock_known)
        groups[(int(fix.time_s // _AVERAGED_S), *kind)].append(fix)
    if len(groups) == len(fixes):
        return tuple(fixes)
    averaged = [one for group in groups.values() for one in _average(group)]
    return tuple(sorted(averaged, key=lambda fix: fix.time_s))


def _average(group: Sequence[PositionFix]) -> Sequence[PositionFix]:
    """Return the average of the fixes of a source; those that were given for exactly one time stay apart."""
    if group[0].time_s == group[-1].time_s:
        return group
    different = list({given_at(fix)[1:]: fix for fix in reversed(group)}.values())
    information = np.linalg.inv(np.array([fix.covariance_m2 for fix in different], dtype=np.float64))
    covariance = np.linalg.inv(information.sum(axis=0))
    position_m = np.array([fix.position_m for fix in different], dtype=np.float64)
    if len(different) > 1:
        position_m = (covariance @ np.einsum("nij,nj->i", information, position_m))[None]
    # A walker is at the mean of the positions at the mean of the times only if both have the same weights.
    times_s, weights = [fix.time_s for fix in different], np.trace(information, axis1=1, axis2=2)
    time_s = float(np.average(times_s, weights=weights))
    return [replace(different[0], time_s=time_s, position_m=position_m[0], covariance_m2=covariance)]
