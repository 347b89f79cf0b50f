"""Motion of particles over one node."""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.nodes import Node, with_heading_variance
from pdr_est.estimators.particle.cloud import EAST, HEADING, LOG_SCALE, NORTH
from pdr_est.frames import Array

_LEAST_PIVOT = 1e-16  # m² or rad², below which a variance is a rounding error


@dataclass(frozen=True)
class ParticleMotion:
    """Motion to a node as the particles make it: one of some turns, each with errors of its own.

    Attributes
    ----------
    length_m
        Length of the way, m.
    turns_rad, probabilities
        Possible turns (k,), rad, and their probabilities.
    roots
        (k, 3, 3) matrices that make the errors (forward, left, heading) of normal numbers.
    """

    length_m: float
    turns_rad: Array
    probabilities: Array
    roots: Array

    @classmethod
    def to(cls, node: Node) -> "ParticleMotion":
        """Return the motion to a node, with its turn hypotheses if it has any."""
        turns = node.turn_hypotheses
        if not turns:
            only = np.array([node.heading_change_rad]), np.ones(1), motion_root(node.covariance)[None]
            return cls(node.length_m, *only)
        roots = [motion_root(with_heading_variance(node.covariance, one.sigma_rad**2)) for one in turns]
        share = np.array([one.probability for one in turns])
        return cls(
            node.length_m, np.array([one.heading_change_rad for one in turns]), share / share.sum(), np.array(roots)
        )

    def chosen(self, count: int, rng: np.random.Generator) -> NDArray[np.int64]:
        """Draw the number (count,) of the turn of each particle."""
        if len(self.turns_rad) == 1:
            return np.zeros(count, dtype=np.int64)
        return rng.choice(len(self.turns_rad), size=count, p=self.probabilities)

    def move(self, rows: Array, chosen: NDArray[np.int64], rng: np.random.Generator) -> None:
        """Move the particles of a device in place.

        Parameters
        ----------
        rows
            (8, n) rows of the device; they are changed.
        chosen
            Number (n,) of the turn of each particle.
        rng
            Source of random numbers.
        """
        rows[: HEADING + 1] = self.draw(self.mean_ends(rows, chosen), chosen, 1, rng)[:, 0]

    def mean_ends(self, rows: Array, chosen: NDArray[np.int64]) -> Array:
        """Return the poses (3, n) after the motion without its errors, and cosine and sine of the headings (2, n).

        Parameters
        ----------
        rows
            (8, n) rows of the device before the motion.
        chosen
            Number (n,) of the turn of each particle.
        """
        turn = self.turns_rad[0] if len(self.turns_rad) == 1 else self.turns_rad[chosen]
        heading = rows[HEADING] + turn
        single = heading.astype(np.float32)  # which is exact enough, and faster
        c, s = np.cos(single), np.sin(single)
        ahead = np.exp(rows[LOG_SCALE]) * self.length_m
        return np.array([rows[EAST] + ahead * c, rows[NORTH] + ahead * s, heading, c, s])

    def draw(self, mean_ends: Array, chosen: NDArray[np.int64], draws: int, rng: np.random.Generator) -> Array:
        """Draw poses (3, draws, n) after the motion, several for each particle.

        Parameters
        ----------
        mean_ends
            (5, n) as `mean_ends` returns them.
        chosen
            Number (n,) of the turn of each particle.
        draws
            Number of poses for each particle.
        rng
            Source of random numbers.
        """
        count = mean_ends.shape[1]
        normal = rng.standard_normal((3, draws * count))
        if len(self.turns_rad) == 1:
            error: Array = self.roots[0] @ normal
        else:
            error, each = np.empty(normal.shape), np.tile(chosen, draws)
            for number, root in enumerate(self.roots):
                own = np.flatnonzero(each == number)
                error[:, own] = root @ normal[:, own]
        forward, left, turn = error.reshape(3, draws, count)
        east, north, heading, c, s = mean_ends
        return np.array([forward * c - left * s + east, forward * s + left * c + north, turn + heading])


def motion_root(covariance: Array) -> Array:
    """Return a matrix (3, 3) whose product with its transpose is a covariance, which may be singular.

    It is Cholesky's, with the heading first.
    """
    (xx, _, _), (xy, yy, _), (xz, yz, zz) = np.asarray(covariance).tolist()
    a, b, c = _root_and_quotients(zz, xz, yz)
    d, e, _ = _root_and_quotients(xx - b * b, xy - b * c, 0.0)
    f, _, _ = _root_and_quotients(yy - c * c - e * e, 0.0, 0.0)
    return np.array([[b, d, 0.0], [c, e, f], [a, 0.0, 0.0]])


def _root_and_quotients(pivot: float, first: float, second: float) -> tuple[float, float, float]:
    """Return the root of a pivot and two numbers over it; all are 0 where rounding leaves nothing of the pivot."""
    if pivot <= _LEAST_PIVOT:
        return 0.0, 0.0, 0.0
    root = sqrt(pivot)
    return root, first / root, second / root
