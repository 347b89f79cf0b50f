"""Motion of particles over one node."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.nodes import Node, with_heading_variance
from pdr_est.estimators.particle.cloud import EAST, HEADING, LOG_SCALE, NORTH
from pdr_est.frames import Array


def chosen_turns_of(node: Node, count: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Draw the number (count,) of a turn hypothesis for each particle; 0 for a node without any."""
    if not node.turn_hypotheses:
        return np.zeros(count, dtype=np.int64)
    share = np.array([one.probability for one in node.turn_hypotheses])
    return rng.choice(len(share), size=count, p=share / share.sum())


def move_particles(rows: Array, node: Node, chosen: NDArray[np.int64], rng: np.random.Generator) -> None:
    """Move the particles of a device in place, each with an error of its own from the covariance of the node.

    Parameters
    ----------
    rows
        (8, n) rows of the device; they are changed.
    node
        Node that the motion leads to.
    chosen
        Number (n,) of the turn hypothesis of each particle.
    rng
        Source of random numbers.
    """
    normal = rng.standard_normal((3, rows.shape[1]))
    turn_rad: Array | float = node.heading_change_rad
    if node.turn_hypotheses:
        turns, error = node.turn_hypotheses, np.empty(normal.shape)
        for number, one in enumerate(turns):
            own = np.flatnonzero(chosen == number)
            error[:, own] = motion_root(with_heading_variance(node.covariance, one.sigma_rad**2)) @ normal[:, own]
        turn_rad = np.array([one.heading_change_rad for one in turns])[chosen]
    else:
        error = motion_root(node.covariance) @ normal
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
