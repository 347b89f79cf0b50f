"""Motion of particles over one node."""

import numpy as np

from pdr_est.estimators.common.nodes import Node, with_heading_variance
from pdr_est.estimators.particle.cloud import EAST, HEADING, LOG_SCALE, NORTH
from pdr_est.frames import Array


def move_particles(rows: Array, node: Node, rng: np.random.Generator) -> None:
    """Move the particles of a device in place, each with an error of its own from the covariance of the node.

    Parameters
    ----------
    rows
        (8, n) rows of the device; they are changed.
    node
        Node that the motion leads to. Of turn hypotheses each particle takes one, by their probabilities.
    rng
        Source of random numbers.
    """
    count = rows.shape[1]
    error = motion_root(node.covariance) @ rng.standard_normal((3, count))
    turn_rad: Array | float = node.heading_change_rad
    if node.turn_hypotheses:
        turns = node.turn_hypotheses
        share = np.array([one.probability for one in turns])
        chosen = rng.choice(len(turns), size=count, p=share / share.sum())
        for number, one in enumerate(turns):
            own = np.flatnonzero(chosen == number)
            root = motion_root(with_heading_variance(node.covariance, one.sigma_rad**2))
            error[:, own] = root @ rng.standard_normal((3, len(own)))
        turn_rad = np.array([one.heading_change_rad for one in turns])[chosen]
    heading = rows[HEADING] + turn_rad
    c, s = np.cos(heading), np.sin(heading)
    ahead = np.exp(rows[LOG_SCALE]) * node.length_m + error[0]
    rows[EAST] += ahead * c - error[1] * s
    rows[NORTH] += ahead * s + error[1] * c
    rows[HEADING] = heading + error[2]


def motion_root(covariance: Array) -> Array:
    """Return a matrix (3, 3) whose product with its transpose is a covariance, which may be singular."""
    variance, axes = np.linalg.eigh(covariance)
    return np.asarray(axes * np.sqrt(np.maximum(variance, 0.0)))
