"""Length scale."""

import gtsam
import numpy as np

from pdr_est.estimators.factor_graph.marginals import in_map
from pdr_est.estimators.factor_graph.newton import ROUGHLY
from pdr_est.estimators.factor_graph.walk_graph import _Scale, _WalkGraph
from pdr_est.frames import Array

_SCALE_PROBE = 0.05  # how far from the scale the neighbouring systems are; of no influence, they are linear


_SCALE_TOLERANCE = 1e-2  # of the scale's sigma; the rest is second order


def _at_scale(
    graph: "_WalkGraph", values: gtsam.Values, scale: _Scale, sigma: float, least_promise: float, rounds: int
) -> tuple[_Scale, gtsam.Values]:
    """The poses near the optimum, and the length scales if anything tells them."""
    values = graph.optimised(values, scale.value, least_promise)
    return _with_scale(graph, values, scale, sigma, rounds) if sigma > 0.0 and graph.tells_scale else (scale, values)


def _with_scale(
    graph: "_WalkGraph", values: gtsam.Values, scale: _Scale, sigma: float, rounds: int
) -> tuple[_Scale, gtsam.Values]:
    """The length scales and the poses near the optimum of both, after so many rounds at most."""
    for _ in range(rounds):
        before = scale.value
        scale, values = _improve_scale(graph, values, before, sigma)
        if np.all(np.abs(scale.value - before) < _SCALE_TOLERANCE * np.sqrt(np.diag(scale.covariance))):
            break
        values = graph.optimised(values, scale.value, ROUGHLY)
    return scale, values


def _improve_scale(
    graph: _WalkGraph, values: gtsam.Values, scale: Array, sigma: float
) -> tuple[_Scale, gtsam.Values]:
    """One Newton step on the length scales, and the poses moved along. values: optimum at `scale`; sigma: prior's.

    The error of a linear system with the lengths of a device scaled is quadratic in their scale, with a known bend
    (`motion_per_scale`), so that its values at two scales give the slope. The least error over the poses has the same
    slope as that of the optimum's poses, and bends by how the slope changes as the poses follow.
    """
    here, change = _solved(graph, values, scale)
    others = [_solved(graph, values, scale + axis) for axis in _SCALE_PROBE * np.eye(len(scale))]
    direct = graph.motion_per_scale()

    def slopes(at: gtsam.VectorValues) -> Array:
        differences = [(there.error(at) - here.error(at)) / _SCALE_PROBE for there, _ in others]
        return np.array(differences) - 0.5 * _SCALE_PROBE * direct

    slope: Array = slopes(change)
    bend = np.array([(slopes(followed) - slope) / _SCALE_PROBE for _, followed in others]) + np.diag(direct)
    curvature = _not_concave(0.5 * (bend + bend.T)) + np.eye(len(scale)) / sigma**2
    step: Array = np.asarray(-np.linalg.solve(curvature, slope + (scale - 1.0) / sigma**2))
    per_scale = [followed.subtract(change).scale(1.0 / _SCALE_PROBE) for _, followed in others]
    for amount, direction in zip(step, per_scale, strict=True):
        change = change.add(direction.scale(float(amount)))
    heading = graph.poses(values)[:, 2]
    moved: Array = np.stack([in_map(direction, heading) for direction in per_scale], axis=2)
    improved = _Scale(np.asarray(scale + step), np.asarray(np.linalg.inv(curvature)), moved)
    return improved, values.retract(change)


def _not_concave(bend: Array) -> Array:
    """The symmetric matrix (d, d) without what rounding may have made negative."""
    variance, axes = np.linalg.eigh(bend)
    return np.asarray((axes * np.maximum(variance, 0.0)) @ axes.T)


def _solved(
    graph: _WalkGraph, values: gtsam.Values, scale: Array
) -> tuple[gtsam.GaussianFactorGraph, gtsam.VectorValues]:
    """The graph at some length scales, linear about `values`, and the change of the variables of least error."""
    linear = graph.linear(values, scale, resisting=True)
    return linear, linear.eliminateSequential(graph.variables.ordering, gtsam.EliminateQR).optimize()
