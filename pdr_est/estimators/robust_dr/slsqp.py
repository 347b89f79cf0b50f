"""Constrained maximum a posteriori positions of three or more devices, by sequential quadratic programming.

The problem of Robust DR (section IV-B) for any number of devices is convex: minimise the sum over devices of
(l - e)' S^-1 (l - e) / 2 subject to |l_a - l_b| <= d for each tethered pair. SLSQP of scipy solves it. Very unequal
covariances make the Hessian of the Lagrangian ill-conditioned, and the quasi-Newton updates of SLSQP start at the
identity matrix. Each run therefore uses coordinates in which the Hessian at the best known multipliers is the
identity, and starts at the optimum of the run before. One or two runs are usually enough.

References
----------
D. Kraft, A software package for sequential quadratic programming, DFVLR-FB 88-28, 1988.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag
from scipy.optimize import minimize, nnls

from pdr_est.errors import EstimationError
from pdr_est.frames import Array

_MAX_RUNS = 12  # one or two are usual
_MAX_ITERATIONS = 100  # of SLSQP in one run
_COST_TOLERANCE = 1e-20  # of a cost of order one: SLSQP goes on until rounding stops it
_CONVERGED = 1e-8  # relative error of the conditions of the optimum that no further run can improve
_ACCEPTED = 1e-5  # largest relative error of the conditions of a usable optimum
_LEAST_CURVATURE = 1e-16  # relative to the largest: rounding of a symmetric matrix


@dataclass(frozen=True)
class _Problem:
    """Constrained problem with positions relative to the information-weighted mean of the estimates.

    Attributes
    ----------
    estimate_m : Array
        Estimated positions of the n devices, (2 n,), m.
    whitening : Array
        Matrix (2 n, 2 n), 1/m, which turns errors of the positions into errors of unit covariance.
    separation : Array
        Matrices (k, 2, 2 n), 1/m, which turn positions into the separation of each pair in units of its limit.
    """

    estimate_m: Array
    whitening: Array
    separation: Array

    def excess(self, position_m: Array) -> float:
        """Return the largest distance of a pair in units of its limit; above one it is too large."""
        return float(np.linalg.norm(self.separation @ position_m, axis=1).max())


def constrained_optimum(
    estimates_m: Array, covariances_m2: Array, pairs: Sequence[tuple[int, int]], max_distance_m: Array
) -> Array:
    """Find the most probable positions of devices whose pairs are at most some distance apart.

    Parameters
    ----------
    estimates_m
        Estimated positions, (n, 2), m. At least one pair must be farther apart than its limit.
    covariances_m2
        Positive definite covariances of the estimates, (n, 2, 2), m^2.
    pairs
        Indices of the devices of each tethered pair.
    max_distance_m
        Largest distance of each pair, (k,), m.

    Returns
    -------
    Array
        Positions, (n, 2), m, of which no pair is farther apart than its limit (to rounding).

    Raises
    ------
    EstimationError
        If SLSQP does not arrive at the optimum.
    """
    variance_m2, axes = np.linalg.eigh(covariances_m2)
    whitening = np.swapaxes(axes, 1, 2) / np.sqrt(variance_m2)[:, :, None]
    information = np.swapaxes(whitening, 1, 2) @ whitening
    centre_m = np.linalg.solve(information.sum(axis=0), np.einsum("nij,nj->i", information, estimates_m))
    separation = np.zeros((len(pairs), 2, len(estimates_m), 2))
    for row, ((a, b), limit_m) in enumerate(zip(pairs, max_distance_m, strict=True)):
        separation[row, :, a], separation[row, :, b] = np.eye(2) / limit_m, -np.eye(2) / limit_m
    estimate_m = (estimates_m - centre_m).ravel()
    problem = _Problem(estimate_m, block_diag(*whitening), separation.reshape(len(pairs), 2, -1))
    position_m = _solve(problem, _first_multipliers(problem, covariances_m2))
    # Rounding may leave pairs outside their limits by a few units in the last place.
    return np.asarray(centre_m + position_m.reshape(-1, 2) / max(1.0, problem.excess(position_m)))


def _first_multipliers(problem: _Problem, covariances_m2: Array) -> Array:
    """Guess the multiplier of each pair as if it were the only one and its covariance along the line isotropic."""
    apart = problem.separation @ problem.estimate_m
    spread = problem.separation @ block_diag(*covariances_m2) @ np.swapaxes(problem.separation, 1, 2)
    distance = np.maximum(np.linalg.norm(apart, axis=1), 1.0)
    along = np.einsum("ki,kij,kj->k", apart, spread, apart) / distance**2
    guess: Array = (distance - 1.0) / np.where(distance > 1.0, along, 1.0)
    return guess * 2.0 / len(covariances_m2)  # pairs share the work


def _solve(problem: _Problem, multipliers: Array) -> Array:
    """Repeat SLSQP, each time in coordinates fitted to the last multipliers, until the optimum is stationary."""
    # Estimates drawn together about the centre until all pairs are within their limits: a feasible start.
    position_m = problem.estimate_m / max(1.0, problem.excess(problem.estimate_m))
    size = float(np.linalg.norm(problem.whitening @ (position_m - problem.estimate_m)))
    unbalanced = excess = np.inf
    for _ in range(_MAX_RUNS):
        axes_m = _axes(problem, multipliers) * size
        position_m = position_m + axes_m @ _run_slsqp(problem, position_m, axes_m, size)
        scaled, unbalanced = _balance(problem, position_m, axes_m, size)
        multipliers, excess = scaled * size**2, problem.excess(position_m)
        if unbalanced <= _CONVERGED and excess <= 1.0 + _CONVERGED:
            break
    if not (unbalanced <= _ACCEPTED and excess <= 1.0 + _ACCEPTED):
        raise EstimationError(
            f"the fused positions of {len(position_m) // 2} devices were not found: after {_MAX_RUNS} runs of SLSQP "
            f"{unbalanced:.1e} of the gradient is left and a pair is {excess:.6f} times its limit apart; check the "
            "covariances of the devices, or use map-closed-form"
        )
    return position_m


def _axes(problem: _Problem, multipliers: Array) -> Array:
    """Return coordinates, as columns, in which the Hessian of the Lagrangian is the identity matrix."""
    hessian = problem.whitening.T @ problem.whitening
    hessian = hessian + np.einsum("k,kci,kcj->ij", multipliers, problem.separation, problem.separation)
    curvature, axes = np.linalg.eigh(hessian)
    return np.asarray(axes / np.sqrt(np.maximum(curvature, _LEAST_CURVATURE * curvature.max())))


def _run_slsqp(problem: _Problem, position_m: Array, axes_m: Array, size: float) -> Array:
    """Return the step y (2 n,) of SLSQP to position + axes y; the cost is in units of size squared."""
    whitened = problem.whitening @ axes_m / size
    gradient = whitened.T @ (problem.whitening @ (position_m - problem.estimate_m)) / size
    separation, before = problem.separation @ axes_m, problem.separation @ position_m
    slack = 0.5 * (1.0 - np.sum(before**2, axis=1))

    # Differences to the starting point keep the digits that would cancel in the cost and the slack themselves.
    def cost(y: Array) -> tuple[float, Array]:
        error = whitened @ y
        return float(gradient @ y + 0.5 * error @ error), gradient + whitened.T @ error

    def slack_at(y: Array) -> Array:
        moved = separation @ y
        return np.asarray(slack - np.sum(moved * (before + 0.5 * moved), axis=1))

    def slack_gradient(y: Array) -> Array:
        return np.asarray(-np.einsum("kc,kci->ki", before + separation @ y, separation))

    constraint = {"type": "ineq", "fun": slack_at, "jac": slack_gradient}
    options = {"ftol": _COST_TOLERANCE, "maxiter": _MAX_ITERATIONS}
    start = np.zeros(len(position_m))
    return np.asarray(minimize(cost, start, jac=True, method="SLSQP", constraints=constraint, options=options).x)


def _balance(problem: _Problem, position_m: Array, axes_m: Array, size: float) -> tuple[Array, float]:
    """Return the multipliers (k,) that fit the conditions of an optimum best, and the relative part that is left.

    The conditions of Karush, Kuhn and Tucker: the gradients of the slacks balance that of the cost, the multipliers
    are not negative, and that of a pair within its limit is zero.
    """
    gradient = (problem.whitening @ axes_m / size).T @ (problem.whitening @ (position_m - problem.estimate_m)) / size
    before = problem.separation @ position_m
    pull = np.einsum("kc,kci->ik", before, problem.separation @ axes_m)
    slack = np.maximum(0.5 * (1.0 - np.sum(before**2, axis=1)), 0.0)
    conditions = np.concatenate([pull, np.diag(slack)])
    multipliers, left = nnls(conditions, np.concatenate([-gradient, np.zeros(len(slack))]))
    return multipliers, float(left / np.linalg.norm(gradient))
