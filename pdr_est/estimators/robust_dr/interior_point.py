"""The constrained optimum of Robust DR for three devices and more: a primal-dual interior-point method.

Its points never leave the constraints, it does not mind which of them bind, and what it finds is sharpened by
Newton's method on the conditions of the optimum. S. Boyd and L. Vandenberghe, Convex Optimization, section 11.7.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from pdr_est.frames import Array

_ITERATIONS, _POLISHES = 200, 12
_ROUNDING = 1e-13
_GAP = 1e-12  # of the cost, which is of order one after scaling; ours, and so are the numbers below
_SHARPER = 20.0  # how much closer to the constraints each iteration aims
_NEWTON_SHARE = 0.99  # of the way to where a multiplier would vanish


@dataclass(frozen=True)
class Tied:
    """Pairs of devices that are held together. a, b: (m,) their rows; max_distance: (m,)."""

    a: NDArray[np.int64]
    b: NDArray[np.int64]
    max_distance: Array

    def slack(self, position: Array) -> Array:
        """(d^2 - |l_a - l_b|^2) / 2 of each pair at positions (2 n,); positive inside the constraints."""
        apart = self.apart(position)
        left: Array = 0.5 * (self.max_distance**2 - np.sum(apart**2, axis=1))
        return left

    def apart(self, position: Array) -> Array:
        points = position.reshape(-1, 2)
        difference: Array = points[self.a] - points[self.b]
        return difference

    def jacobian(self, position: Array) -> Array:
        """Of |l_a - l_b|^2 / 2, (m, 2 n)."""
        rows = np.zeros((len(self.a), len(position) // 2, 2))
        pair = np.arange(len(self.a))
        apart = self.apart(position)
        rows[pair, self.a] = apart
        rows[pair, self.b] = -apart
        return rows.reshape(len(self.a), -1)

    def curvature(self, multiplier: Array, count: int) -> Array:
        """Sum of the multipliers times the second derivatives, (2 n, 2 n)."""
        laplacian = np.zeros((count, count))
        for a, b, weight in zip(self.a, self.b, multiplier, strict=True):
            laplacian[[a, b], [a, b]] += weight
            laplacian[[a, b], [b, a]] -= weight
        bent: Array = np.kron(laplacian, np.eye(2)).astype(np.float64)
        return bent


@dataclass(frozen=True)
class _Problem:
    """Minimise (l - e)' P (l - e) / 2 subject to the ties. estimate: e (2 n,); information: P (2 n, 2 n)."""

    estimate: Array
    information: Array
    node_tethers: Tied

    def gradient(self, position: Array, multiplier: Array) -> Array:
        """Of the Lagrangian, zero at the optimum."""
        pull: Array = (
            self.information @ (position - self.estimate) + self.node_tethers.jacobian(position).T @ multiplier
        )
        return pull


def solve(estimates_m: Array, covariances_m2: Array, node_tethers: Tied) -> Array:
    """Positions (n, 2) nearest to the estimates (n, 2) by their covariances (n, 2, 2), positive definite.

    At least one pair of estimates must be farther apart than allowed.
    """
    inverse = np.linalg.inv(covariances_m2)
    together = np.linalg.solve(inverse.sum(axis=0), np.einsum("nij,nj->i", inverse, estimates_m))
    scale_m = float(np.max(node_tethers.max_distance))
    information = block_diag(*inverse)
    estimate = ((estimates_m - together) / scale_m).ravel()
    information = information / np.abs(information @ estimate).max()
    problem = _Problem(
        estimate, information, Tied(node_tethers.a, node_tethers.b, node_tethers.max_distance / scale_m)
    )
    position = _polish(problem, *_interior_point(problem))
    return together + scale_m * _within(position, problem.node_tethers).reshape(-1, 2)


def _interior_point(problem: _Problem) -> tuple[Array, Array]:
    """Positions (2 n,) and multipliers (m,), from all devices at one place."""
    node_tethers, position = problem.node_tethers, np.zeros_like(problem.estimate)
    multiplier = 1.0 / node_tethers.slack(position)
    for _ in range(_ITERATIONS):
        slack = node_tethers.slack(position)
        gap = float(slack @ multiplier)
        if gap < _GAP:
            break
        target = gap / (_SHARPER * len(slack))
        move, change = _newton_step(problem, position, multiplier, target)
        falling = change < 0.0
        share = min(1.0, _NEWTON_SHARE * float(np.min(-multiplier[falling] / change[falling], initial=np.inf)))
        before = _residual(problem, position, multiplier, target)
        while share > 1e-10:
            tried, weights = position + share * move, multiplier + share * change
            inside = np.all(node_tethers.slack(tried) > 0.0)
            if inside and _residual(problem, tried, weights, target) <= (1.0 - 0.01 * share) * before:
                break
            share *= 0.5
        else:
            break  # rounding leaves nothing to gain
        position, multiplier = tried, weights
    return position, multiplier


def _newton_step(problem: _Problem, position: Array, multiplier: Array, target: float) -> tuple[Array, Array]:
    """Towards a gradient of zero and slack times multiplier = target."""
    slack, jacobian = problem.node_tethers.slack(position), problem.node_tethers.jacobian(position)
    stiffness = problem.information + problem.node_tethers.curvature(multiplier, len(position) // 2)
    system = np.block([[stiffness, jacobian.T], [-multiplier[:, None] * jacobian, np.diag(slack)]])
    wanted = np.concatenate([-problem.gradient(position, multiplier), target - slack * multiplier])
    move = np.linalg.lstsq(system, wanted, rcond=None)[0]
    return move[: len(position)], move[len(position) :]


def _residual(problem: _Problem, position: Array, multiplier: Array, target: float) -> float:
    centre = problem.node_tethers.slack(position) * multiplier - target
    return float(np.hypot(np.linalg.norm(problem.gradient(position, multiplier)), np.linalg.norm(centre)))


def _polish(problem: _Problem, position: Array, multiplier: Array) -> Array:
    """The optimum to the last digits: which constraints bind is guessed, and corrected while it proves wrong.

    Without a consistent answer, which only rounding can cause, the positions stay as they are.
    """
    node_tethers = problem.node_tethers
    binds = multiplier > node_tethers.slack(position)
    for _ in range(4 * len(binds)):
        rows = np.flatnonzero(binds)
        held = Tied(node_tethers.a[rows], node_tethers.b[rows], node_tethers.max_distance[rows])
        found, weights = _on_the_rim(replace(problem, node_tethers=held), position, multiplier[rows])
        slack = np.where(binds, 0.0, node_tethers.slack(found))
        if np.any(slack < -_ROUNDING):
            binds[np.argmin(slack)] = True
        elif np.any(weights < -_ROUNDING):
            binds[rows[np.argmin(weights)]] = False
        else:
            return found
    return position


def _on_the_rim(problem: _Problem, position: Array, multiplier: Array) -> tuple[Array, Array]:
    """The stationary point with all constraints as equalities, by Newton's method for as long as it helps."""
    node_tethers, best = problem.node_tethers, (position, multiplier)
    for _ in range(_POLISHES):
        here, weights = best
        jacobian, count = node_tethers.jacobian(here), len(weights)
        stiffness = problem.information + node_tethers.curvature(weights, len(here) // 2)
        system = np.block([[stiffness, jacobian.T], [jacobian, np.zeros((count, count))]])
        wanted = np.concatenate([-problem.gradient(here, weights), node_tethers.slack(here)])
        move = np.linalg.lstsq(system, wanted, rcond=1e-15)[0]
        tried = (here + move[: len(here)], weights + move[len(here) :])
        if not _error(problem, *tried) < _error(problem, *best):
            break
        best = tried
    return best


def _error(problem: _Problem, position: Array, multiplier: Array) -> float:
    slack = np.abs(problem.node_tethers.slack(position)).max(initial=0.0)
    return float(max(np.abs(problem.gradient(position, multiplier)).max(), slack))


def _within(position: Array, node_tethers: Tied) -> Array:
    """The same, drawn together by what rounding left outside the constraints."""
    excess = float(np.max(np.hypot(*node_tethers.apart(position).T) / node_tethers.max_distance))
    return position / max(1.0, excess)
