"""Estimation of the walkers' length scales beside the graph.

The length scale of a device would connect one variable to every step and make the system dense. It stays outside the
graph: linear systems at neighbouring scales give the slope and the curvature of the optimal error with respect to the
scales. For a linear walk the result is that of a variable in the graph.

The prior is that of the logarithm of a scale, with mean 0, so that no measurement makes a scale negative. The error
is quadratic in the scales themselves; its minimum together with the prior is therefore found by an iteration of its
own (`most_probable_scales`), which needs no further linear systems.
"""

from dataclasses import dataclass

import gtsam
import numpy as np

from pdr_est.estimators.factor_graph.marginals import in_map
from pdr_est.estimators.factor_graph.newton import ROUGHLY
from pdr_est.estimators.factor_graph.smoothing_problem import LengthScales, Point, SmoothingProblem, as_values
from pdr_est.frames import Array

_PROBE = 0.05  # distance of the neighbouring scales; of no influence, because the systems are linear
_TOLERANCE = 1e-2  # share of the sigma of the logarithm; the rest is of second order
_LARGEST_STEP = 0.5  # of a logarithm in one round, because the walk is not linear in its poses; ours
_MOST_ITERATIONS, _MOST_HALVINGS, _NEGLIGIBLE = 50, 30, 1e-12
_ARMIJO = 1e-4  # share of the decrease that the slope predicts


def optimise_with_scales(
    problem: SmoothingProblem,
    at: Point,
    scales: LengthScales,
    sigma: float,
    tolerance: float,
    rounds: int,
) -> tuple[LengthScales, Point]:
    """Optimise the poses, and the length scales where they are observable.

    Parameters
    ----------
    problem : SmoothingProblem
        The walk.
    at, scales
        Initial values of poses and references, and initial scales.
    sigma : float
        Standard deviation of the prior of the logarithm of each scale, whose mean is 0; 0 for known scales.
    tolerance : float
        As for `newton.minimised`.
    rounds : int
        Largest number of Newton steps on the scales.
    """
    at = problem.optimised(at, scales.value, tolerance)
    if sigma <= 0.0 or not problem.scale_is_observable:
        return scales, at
    values = as_values(at)
    for _ in range(rounds):
        before = scales.value
        scales, values = _improved(problem, values, before, sigma)
        if np.all(np.abs(np.log(scales.value / before)) < _TOLERANCE * np.sqrt(np.diag(scales.log_covariance))):
            break
        values = as_values(problem.optimised(values, scales.value, ROUGHLY))
    return scales, values


def _improved(
    problem: SmoothingProblem, values: gtsam.Values, scale: Array, sigma: float
) -> tuple[LengthScales, gtsam.Values]:
    """Make one Newton step on the length scales, and move the poses along. `values`: optimum at `scale`.

    The error of a linear system in which the step lengths of a device are scaled is quadratic in the scale, with a
    known curvature (`motion_information`), so that its values at two scales give the slope. The error minimised over
    the poses has the same slope as the error at the optimal poses. Its curvature is the change of this slope as the
    poses follow the scale.
    """
    here, change = _solved(problem, values, scale)
    others = [_solved(problem, values, scale + axis) for axis in _PROBE * np.eye(len(scale))]
    direct = problem.motion_information()

    def slopes(at: gtsam.VectorValues) -> Array:
        differences = [(there.error(at) - here.error(at)) / _PROBE for there, _ in others]
        return np.array(differences) - 0.5 * _PROBE * direct

    slope: Array = slopes(change)
    bend = np.array([(slopes(followed) - slope) / _PROBE for _, followed in others]) + np.diag(direct)
    error = ScaleError(scale, slope, _positive_semidefinite(0.5 * (bend + bend.T)))
    improved = most_probable_scales(error, sigma)
    per_scale = [followed.subtract(change).scale(1.0 / _PROBE) for _, followed in others]
    for amount, direction in zip(improved - scale, per_scale, strict=True):
        change = change.add(direction.scale(float(amount)))
    heading = problem.poses(values)[:, 2]
    moved: Array = np.stack([in_map(direction, heading) for direction in per_scale], axis=2)
    off: Array = np.stack([problem.wandering.changes(direction) for direction in per_scale], axis=2)
    covariance = error.log_covariance(improved, sigma)
    return LengthScales(improved, covariance, moved * improved, off * improved), values.retract(change)


@dataclass(frozen=True)
class ScaleError:
    """Error of a linear system, minimised over the poses, as a quadratic function of d length scales.

    Attributes
    ----------
    at : (d,) array
        Length scales about which the error is expanded.
    slope : (d,) array
        Its derivatives there.
    curvature : (d, d) array
        Its second derivatives.
    """

    at: Array
    slope: Array
    curvature: Array

    def with_prior(self, log_scale: Array, sigma: float) -> float:
        """Return the change of the error since `at`, and the cost of the prior, at logarithms (d,) of scales."""
        step = np.exp(log_scale) - self.at
        return float(step @ (self.slope + 0.5 * self.curvature @ step) + 0.5 * np.sum((log_scale / sigma) ** 2))

    def log_covariance(self, scale: Array, sigma: float) -> Array:
        """Return the covariance (d, d) of the logarithms, linearised at scales (d,), as in the Kalman filter."""
        information = scale[:, None] * self.curvature * scale + np.eye(len(scale)) / sigma**2
        return np.asarray(np.linalg.inv(information))


def most_probable_scales(error: ScaleError, sigma: float) -> Array:
    """Minimise the error together with the prior of the logarithms, by Newton's method.

    Parameters
    ----------
    error : ScaleError
        Error as a function of the scales.
    sigma : float
        Standard deviation of the prior of each logarithm, whose mean is 0.

    Returns
    -------
    (d,) array
        Positive scales, none farther from `error.at` than the largest step of one round.
    """
    begin: Array = np.log(error.at)
    log_scale, here = begin, error.with_prior(begin, sigma)
    for _ in range(_MOST_ITERATIONS):
        scale = np.exp(log_scale)
        of_error = scale * (error.slope + error.curvature @ (scale - error.at))
        slope = of_error + log_scale / sigma**2
        # The second derivative of exp counts where it makes the curvature larger, so that it stays positive.
        curvature = scale[:, None] * error.curvature * scale + np.diag(1.0 / sigma**2 + np.maximum(of_error, 0.0))
        step = np.clip(-np.linalg.solve(curvature, slope), -_LARGEST_STEP, _LARGEST_STEP)
        if np.abs(step).max() < _NEGLIGIBLE:
            break
        for halving in range(_MOST_HALVINGS):
            there = log_scale + 0.5**halving * step
            error_there = error.with_prior(there, sigma)
            if error_there <= here + _ARMIJO * 0.5**halving * float(slope @ step):
                break
        else:  # no decrease beyond rounding
            break
        log_scale, here = there, error_there
    return np.asarray(np.exp(np.clip(log_scale, begin - _LARGEST_STEP, begin + _LARGEST_STEP)))


def _positive_semidefinite(bend: Array) -> Array:
    """Remove from a symmetric matrix (d, d) what rounding may have made negative."""
    variance, axes = np.linalg.eigh(bend)
    return np.asarray((axes * np.maximum(variance, 0.0)) @ axes.T)


def _solved(
    problem: SmoothingProblem, values: gtsam.Values, scale: Array
) -> tuple[gtsam.GaussianFactorGraph, gtsam.VectorValues]:
    """Return the linear system at some length scales about `values`, and its solution."""
    system = problem.linear(values, scale)
    return system.factors, system.solution(problem.variables)
