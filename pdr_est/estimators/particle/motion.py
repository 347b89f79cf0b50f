"""Motion of particles over one node."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.nodes import Node, with_heading_variance
from pdr_est.estimators.particle.cloud import EAST, HEADING, LOG_SCALE, NORTH
from pdr_est.frames import Array


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
        normal = rng.standard_normal((3, rows.shape[1]))
        if len(self.turns_rad) == 1:
            error: Array = self.roots[0] @ normal
            heading = rows[HEADING] + self.turns_rad[0]
        else:
            error = np.empty(normal.shape)
            for number, root in enumerate(self.roots):
                own = np.flatnonzero(chosen == number)
                error[:, own] = root @ normal[:, own]
            heading = rows[HEADING] + self.turns_rad[chosen]
        c, s = np.cos(heading), np.sin(heading)
        ahead = np.exp(rows[LOG_SCALE]) * self.length_m + error[0]
        rows[EAST] += ahead * c - error[1] * s
        rows[NORTH] += ahead * s + error[1] * c
        rows[HEADING] = heading + error[2]


def motion_root(covariance: Array) -> Array:
    """Return a matrix (3, 3) whose product with its transpose is a covariance, which may be singular."""
    variance, axes = np.linalg.eigh(covariance)
    return np.asarray(axes * np.sqrt(np.maximum(variance, 0.0)))
