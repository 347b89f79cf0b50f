"""Fit constant bias and gains of a gyroscope, so that the gravity that it carries along stays where it is.

A small error of the rate turns the axes of a sample by its integral, and gravity with them. The movement of gravity
is therefore linear in bias and gains, and Gauss-Newton steps find the most probable ones. Each has the errors of good
sensors as prior knowledge; the gain of one axis may be set free. Constants are ours.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array
from pdr_est.io.conversion.gravity_drift import (
    WalkerVelocity,
    hann_means,
    independent_share,
    log_likelihood,
    usual_variance,
)
from pdr_est.io.conversion.gravity_windows import GravityWindows, cross_matrices, turned_by

_BIAS_SIGMA_RADPS = 0.05  # raw gyroscopes of belts have up to 0.1 rad/s
_GAIN_SIGMA = 0.02
_FREE_GAIN_SIGMA = 0.5
_STEPS = 4
_LEAST_GAIN = 1e-3  # expected of a step in the logarithm of the posterior; less changes no probability that is told
_COMPONENTS = 9.0  # degrees of freedom of four means of three components about their common mean


@dataclass(frozen=True)
class GyroscopeFit:
    """Most probable errors of a gyroscope.

    Attributes
    ----------
    bias_radps
        (3,) rate that the axes read too much.
    corrections
        (3,) factors less 1 by which the axes must be multiplied.
    sigmas
        (3,) standard deviations of these.
    variance
        (k,) movement of gravity that is left in the windows, m²/s⁴.
    log_likelihood
        Log likelihood of that movement.
    log_evidence
        Logarithm of the evidence of the model by Laplace's method, up to a constant.
    """

    bias_radps: Array
    corrections: Array
    sigmas: Array
    variance: Array
    log_likelihood: float
    log_evidence: float


@dataclass(frozen=True)
class _Linearised:
    """Movement of gravity for given errors, and its change with them.

    Attributes
    ----------
    errors
        (6,) bias and corrections.
    variance
        (k,) movement of gravity, m²/s⁴.
    log_posterior
        Log likelihood and log prior of the errors.
    information
        (6, 6) information about the errors.
    step
        (6,) change of the errors to the most probable ones.
    """

    errors: Array
    variance: Array
    log_posterior: float
    information: Array
    step: Array


def fit_gyroscope(rate_radps: Array, windows: GravityWindows, free_axis: int | None = None) -> GyroscopeFit:
    """Find the most probable bias and gains of a gyroscope.

    Parameters
    ----------
    rate_radps
        (k, n, 3) rotation rate in the windows, in the order and signs of axes that are tried.
    windows
        Windows with the specific force.
    free_axis
        Number of the axis whose gain may be far from 1; None for a sensor as it should be.
    """
    prior = np.array([_BIAS_SIGMA_RADPS] * 3 + [_GAIN_SIGMA] * 3)
    if free_axis is not None:
        prior[3 + free_axis] = _FREE_GAIN_SIGMA
    best = _linearise(np.zeros(6), rate_radps, windows, prior)
    step = best.step
    for _ in range(_STEPS):
        if 0.5 * float(step @ best.information @ step) < _LEAST_GAIN:
            break
        tried = _linearise(best.errors + step, rate_radps, windows, prior)
        if tried.log_posterior < best.log_posterior:
            step = 0.5 * step
        else:
            best, step = tried, tried.step
    occam = float(np.log(prior).sum()) + 0.5 * float(np.linalg.slogdet(best.information)[1])
    return GyroscopeFit(
        bias_radps=best.errors[:3],
        corrections=best.errors[3:],
        sigmas=np.sqrt(np.diag(np.linalg.inv(best.information))[3:]),
        variance=best.variance,
        log_likelihood=log_likelihood(best.variance, windows),
        log_evidence=best.log_posterior - occam,
    )


def _linearise(errors: Array, rate_radps: Array, windows: GravityWindows, prior: Array) -> _Linearised:
    """Compute the movement of gravity with errors (6,), its slopes, and the step to the most probable errors."""
    turned = turned_by(rate_radps * (1.0 + errors[3:]) - errors[:3], windows.period_s)
    force = np.einsum("kjab,kjb->kja", turned, windows.force_mps2)
    walker = WalkerVelocity.of(turned, windows)
    means = hann_means(force, windows.period_s)
    variance = walker.scatter(means)
    per_bias = np.cumsum(turned, axis=1) * windows.period_s
    per_gain = np.cumsum(turned * rate_radps[:, :, None, :], axis=1) * windows.period_s
    slopes = hann_means(cross_matrices(force) @ np.concatenate([per_bias, -per_gain], axis=3), windows.period_s)
    slopes = (slopes - slopes.mean(axis=1, keepdims=True)).reshape(len(windows), -1, 6)
    movement = (means - means.mean(axis=1, keepdims=True)).reshape(len(windows), -1)
    unexplained = walker.removed_from(slopes)
    # Robust weights: a window whose gravity moves for another reason must not decide.
    usual = usual_variance(windows)
    weight = 4.0 * independent_share(len(windows)) / _COMPONENTS / (usual + variance)
    information = np.einsum("k,kib,kic->bc", weight, slopes, unexplained) + np.diag(1.0 / np.square(prior))
    gradient = np.einsum("k,kib,ki->b", weight, unexplained, movement) + errors / np.square(prior)
    return _Linearised(
        errors=errors,
        variance=variance,
        log_posterior=log_likelihood(variance, windows) - 0.5 * float(np.square(errors / prior).sum()),
        information=information,
        step=-np.linalg.solve(information, gradient),
    )
