"""Residuals of the measurements of a walk, many at once, with the costs and the Jacobians that GTSAM has for them.

The error of a motion, and of a pose with a prior, is the logarithm of the pose that is left over.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.huber import HUBER
from pdr_est.estimators.common.motion_model import MIN_SIGMA
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.pose_chains.linear_rows import LinearRows, to_map
from pdr_est.frames import Array, rotate_vectors, wrap_angle
from pdr_est.types.measurements import HeadingPrior, PositionFix

_SMALL_RAD = 1e-10  # below which a turn is none


@dataclass(frozen=True)
class RelativePoses:
    """Measured poses of m poses b, each seen from a pose a; Cauchy's kernel applies to robust ones.

    Attributes
    ----------
    pose
        Numbers (m, 2) of a and b.
    measured
        Poses (m, 3): forward m, left m, turn rad.
    whitening
        Matrices (m, 3, 3) that turn errors into standard deviations.
    robust
        Whether Cauchy's kernel applies (m,).
    """

    pose: NDArray[np.int64]
    measured: Array
    whitening: Array
    robust: NDArray[np.bool_]

    def cost(self, pose: Array) -> float:
        """Return the cost at poses (n, 3)."""
        return _cauchy_cost(self._white(self._seen(pose)), self.robust)

    def linearised(self, pose: Array) -> LinearRows:
        """Linearise at poses (n, 3), with the weights of the kernel."""
        seen = self._seen(pose)
        off = logarithm_between(self.measured, seen)
        white = _product(self.whitening, off)
        root = np.sqrt(_cauchy_weight(white, self.robust))
        c, s = np.cos(seen[:, 2]), np.sin(seen[:, 2])
        of_a = np.zeros((len(seen), 3, 3))  # minus the adjoint of the inverse of `seen`
        of_a[:, 0, 0], of_a[:, 0, 1], of_a[:, 1, 0], of_a[:, 1, 1], of_a[:, 2, 2] = -c, -s, s, -c, -1.0
        of_a[:, 0, 2] = c * seen[:, 1] - s * seen[:, 0]
        of_a[:, 1, 2] = -s * seen[:, 1] - c * seen[:, 0]
        own = root[:, None, None] * self.whitening @ logarithm_derivative(off)
        return LinearRows(self.pose, np.concatenate([own @ of_a, own], axis=2), -root[:, None] * white)

    def _seen(self, pose: Array) -> Array:
        a, b = pose[self.pose[:, 0]], pose[self.pose[:, 1]]
        return np.column_stack([rotate_vectors(b[:, :2] - a[:, :2], -a[:, 2]), b[:, 2] - a[:, 2]])

    def _white(self, seen: Array) -> Array:
        return _product(self.whitening, logarithm_between(self.measured, seen))


@dataclass(frozen=True)
class PosePriors:
    """Poses that are known with some uncertainty, m in number.

    Attributes
    ----------
    pose
        Numbers (m, 1) of the poses.
    expected
        Their expected values (m, 3).
    sigma
        Standard deviations (m, 3) of the logarithm of what is left over.
    """

    pose: NDArray[np.int64]
    expected: Array
    sigma: Array

    def cost(self, pose: Array) -> float:
        """Return the cost at poses (n, 3)."""
        return 0.5 * float(np.sum((logarithm_between(self.expected, pose[self.pose[:, 0]]) / self.sigma) ** 2))

    def linearised(self, pose: Array) -> LinearRows:
        """Linearise at poses (n, 3)."""
        off = logarithm_between(self.expected, pose[self.pose[:, 0]])
        return LinearRows(self.pose, logarithm_derivative(off) / self.sigma[:, :, None], -off / self.sigma)


@dataclass(frozen=True)
class MapHeadings:
    """Measured headings in the map of m poses; Cauchy's kernel applies to robust ones.

    Attributes
    ----------
    pose
        Numbers (m, 1) of the poses.
    heading_rad, sigma_rad
        Headings and standard deviations (m,).
    robust
        Whether Cauchy's kernel applies (m,).
    """

    pose: NDArray[np.int64]
    heading_rad: Array
    sigma_rad: Array
    robust: NDArray[np.bool_]

    @classmethod
    def of_priors(cls, priors: Sequence[tuple[int, HeadingPrior]]) -> "MapHeadings":
        """Make the headings of priors, each with the number of its pose."""
        return cls(
            np.array([pose for pose, _ in priors], dtype=np.int64)[:, None],
            np.array([prior.heading_rad for _, prior in priors], dtype=np.float64),
            np.array([max(prior.sigma_rad, MIN_SIGMA) for _, prior in priors], dtype=np.float64),
            np.array([prior.robust for _, prior in priors], dtype=np.bool_),
        )

    def cost(self, pose: Array) -> float:
        """Return the cost at poses (n, 3)."""
        return _cauchy_cost(self._white(pose), self.robust)

    def linearised(self, pose: Array) -> LinearRows:
        """Linearise at poses (n, 3), with the weights of the kernel."""
        white = self._white(pose)
        root = np.sqrt(_cauchy_weight(white, self.robust))
        jacobian = np.zeros((len(white), 1, 3))
        jacobian[:, 0, 2] = root / self.sigma_rad
        return LinearRows(self.pose, jacobian, -root[:, None] * white)

    def _white(self, pose: Array) -> Array:
        return np.asarray(wrap_angle(pose[self.pose[:, 0], 2] - self.heading_rad) / self.sigma_rad)[:, None]


@dataclass(frozen=True)
class MapPositions:
    """Measured positions of m poses; Huber's kernel applies to robust ones.

    Attributes
    ----------
    pose
        Numbers (m, 1) of the poses.
    position_m
        Positions (m, 2), m.
    whitening
        Matrices (m, 2, 2) that turn errors into standard deviations.
    threshold
        Length (m,) of the error in standard deviations from which on the kernel is linear.
    """

    pose: NDArray[np.int64]
    position_m: Array
    whitening: Array
    threshold: Array

    @classmethod
    def of_fixes(cls, fixes: Sequence[tuple[int, PositionFix]]) -> "MapPositions":
        """Make the positions of fixes, each with the number of its pose."""
        covariance = np.array([fix.covariance_m2 for _, fix in fixes], dtype=np.float64).reshape(-1, 2, 2)
        return cls(
            np.array([pose for pose, _ in fixes], dtype=np.int64)[:, None],
            np.array([fix.position_m for _, fix in fixes], dtype=np.float64).reshape(-1, 2),
            np.linalg.inv(np.linalg.cholesky(covariance)),
            np.array([HUBER if fix.robust else np.inf for _, fix in fixes], dtype=np.float64),
        )

    def cost(self, pose: Array) -> float:
        """Return the cost at poses (n, 3)."""
        distance = np.linalg.norm(self._white(pose), axis=1)
        within = np.minimum(distance, self.threshold)
        return float(np.sum(within * (distance - 0.5 * within)))

    def linearised(self, pose: Array) -> LinearRows:
        """Linearise at poses (n, 3), with the weights of the kernel."""
        white = self._white(pose)
        distance = np.maximum(np.linalg.norm(white, axis=1), np.finfo(np.float64).tiny)
        root = np.sqrt(np.minimum(self.threshold / distance, 1.0))
        jacobian = root[:, None, None] * self.whitening @ to_map(pose[self.pose[:, 0], 2])[:, :2]
        return LinearRows(self.pose, jacobian, -root[:, None] * white)

    def _white(self, pose: Array) -> Array:
        return _product(self.whitening, pose[self.pose[:, 0], :2] - self.position_m)


Residuals = RelativePoses | PosePriors | MapHeadings | MapPositions
"""Residuals of one kind."""


def motions(nodes: Sequence[Node], first: int, length_scale: float, whitening: Array) -> RelativePoses:
    """Make the motions of a device, whose first node is the pose `first`, with lengths times a scale.

    `whitening` (n - 1, 3, 3) turns errors of the motions to all nodes but the first into standard deviations.
    """
    turn_rad, length_m = np.array([(node.heading_change_rad, node.length_m) for node in nodes[1:]]).reshape(-1, 2).T
    ahead = rotate_vectors(np.stack([length_scale * length_m, np.zeros_like(length_m)], axis=1), turn_rad)
    before = first + np.arange(len(nodes) - 1)
    pose = np.stack([before, before + 1], axis=1)
    return RelativePoses(pose, np.column_stack([ahead, turn_rad]), whitening, np.zeros(len(pose), dtype=np.bool_))


def moved_by(pose: Array, change: Array) -> Array:
    """Apply changes (n, 3) to poses (n, 3), each along a circle, by the exponential map."""
    turn = change[:, 2]
    small = np.abs(turn) < _SMALL_RAD
    safe = np.where(small, 1.0, turn)
    straight = np.where(small, 1.0, np.sin(safe) / safe)
    bent = np.where(small, 0.0, (1.0 - np.cos(safe)) / safe)
    x, y = change[:, 0], change[:, 1]
    shift = np.stack([straight * x - bent * y, bent * x + straight * y], axis=1)
    return np.column_stack([pose[:, :2] + rotate_vectors(shift, pose[:, 2]), pose[:, 2] + turn])


def logarithm_between(a: Array, b: Array) -> Array:
    """Return the logarithms (m, 3) of poses b (m, 3) seen from poses a (m, 3)."""
    apart, turn = rotate_vectors(b[:, :2] - a[:, :2], -a[:, 2]), wrap_angle(b[:, 2] - a[:, 2])
    small = np.abs(turn) < _SMALL_RAD
    half = np.where(small, 1.0, 0.5 * turn)
    shrunk, across = np.where(small, 1.0, half / np.tan(half)), np.where(small, 0.0, half)
    x, y = apart[:, 0], apart[:, 1]
    return np.stack([shrunk * x + across * y, shrunk * y - across * x, turn], axis=1)


def logarithm_derivative(logarithm: Array) -> Array:
    """Return the derivatives (m, 3, 3) of logarithms (m, 3) by changes of the poses along their own axes."""
    x, y, turn = logarithm.T
    small = np.abs(turn) < _SMALL_RAD
    safe = np.where(small, 1.0, turn)
    half_cot = np.where(small, 0.0, 0.5 / np.tan(0.5 * safe))
    rest = np.where(small, 0.0, 1.0 / safe - half_cot)
    derivative = np.zeros((len(turn), 3, 3))
    derivative[:, 0, 0] = derivative[:, 1, 1] = np.where(small, 1.0, turn * half_cot)
    derivative[:, 0, 1], derivative[:, 1, 0] = -0.5 * turn, 0.5 * turn
    derivative[:, 0, 2], derivative[:, 1, 2] = rest * x + 0.5 * y, rest * y - 0.5 * x
    derivative[:, 2, 2] = 1.0
    return derivative


def _product(matrix: Array, vector: Array) -> Array:
    """Multiply matrices (m, k, k) by vectors (m, k)."""
    return np.asarray((matrix @ vector[:, :, None])[..., 0])


def _cauchy_weight(white: Array, robust: NDArray[np.bool_]) -> Array:
    return np.where(robust, 1.0 / (1.0 + np.sum(white**2, axis=1)), 1.0)


def _cauchy_cost(white: Array, robust: NDArray[np.bool_]) -> float:
    square = np.sum(white**2, axis=1)
    return 0.5 * float(np.sum(np.where(robust, np.log1p(square), square)))
