"""Estimation of the walkers' length scales beside the graph.

The length scale of a device would connect one variable to every step and make the system dense. It stays outside the
graph: linear systems at neighbouring scales give the slope and the curvature of the optimal error with respect to the
scales. For a linear walk the result is that of a variable in the graph.
"""

import gtsam
import numpy as np

from pdr_est.estimators.factor_graph.marginals import in_map
from pdr_est.estimators.factor_graph.newton import ROUGHLY
from pdr_est.estimators.factor_graph.smoothing_problem import LengthScales, SmoothingProblem
from pdr_est.frames import Array

_PROBE = 0.05  # distance of the neighbouring scales; of no influence, because the systems are linear
_TOLERANCE = 1e-2  # share of the scale's sigma; the rest is of second order


def optimise_with_scales(
    problem: SmoothingProblem,
    values: gtsam.Values,
    scales: LengthScales,
    sigma: float,
    tolerance: float,
    rounds: int,
) -> tuple[LengthScales, gtsam.Values]:
    """Optimise the poses, and the length scales where they are observable.

    Parameters
    ----------
    problem : SmoothingProblem
        The walk.
    values, scales
        Initial values of poses and references, and initial scales.
    sigma : float
        Standard deviation of the prior of each scale, whose mean is 1; 0 for known scales.
    tolerance : float
        As for `newton.minimised`.
    rounds : int
        Largest number of Newton steps on the scales.
    """
    values = problem.optimised(values, scales.value, tolerance)
    if sigma <= 0.0 or not problem.scale_is_observable:
        return scales, values
    for _ in range(rounds):
        before = scales.value
        scales, values = _improved(problem, values, before, sigma)
        if np.all(np.abs(scales.value - before) < _TOLERANCE * np.sqrt(np.diag(scales.covariance))):
            break
        values = problem.optimised(values, scales.value, ROUGHLY)
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
    curvature = _positive_semidefinite(0.5 * (bend + bend.T)) + np.eye(len(scale)) / sigma**2
    step: Array = np.asarray(-np.linalg.solve(curvature, slope + (scale - 1.0) / sigma**2))
    per_scale = [followed.subtract(change).scale(1.0 / _PROBE) for _, followed in others]
    for amount, direction in zip(step, per_scale, strict=True):
        change = change.add(direction.scale(float(amount)))
    heading = problem.poses(values)[:, 2]
    moved: Array = np.stack([in_map(direction, heading) for direction in per_scale], axis=2)
    improved = LengthScales(np.asarray(scale + step), np.asarray(np.linalg.inv(curvature)), moved)
    return improved, values.retract(change)


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
