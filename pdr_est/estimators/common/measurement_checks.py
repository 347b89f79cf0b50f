"""Checks that refuse measurements which no estimator can use, before any of them computes with them."""

from collections.abc import Sequence

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.types.measurements import START_SOURCE, HeadingPrior, LoopClosure, PositionFix, StepOdometry


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
    for prior in priors:
        if not np.isfinite((prior.time_s, prior.heading_rad, prior.sigma_rad)).all() or prior.sigma_rad <= 0.0:
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
