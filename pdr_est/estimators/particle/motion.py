"""Motion of particles over one node, and the weight that the plan gives to their ways."""

import numpy as np

from pdr_est.estimators.common.nodes import Node, with_heading_variance
from pdr_est.estimators.particle.cloud import EAST, HEADING, LOG_SCALE, NORTH
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.plan_grid import PlanGrid
from pdr_est.frames import Array


def move_particles(rows: Array, node: Node, rng: np.random.Generator) -> None:
    """Move the particles of a device in place, each with an error of its own from the covariance of the node.

    Parameters
    ----------
    rows
        (6, n) rows of the device; they are changed.
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
            own = chosen == number
            root = motion_root(with_heading_variance(node.covariance, one.sigma_rad**2))
            error[:, own] = root @ rng.standard_normal((3, int(own.sum())))
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


def log_way_weight(
    grid: PlanGrid, begin_m: tuple[Array, Array], end_m: tuple[Array, Array], parameters: ParticleParams
) -> Array:
    """Return the logarithms (n,) of the probabilities that a walker takes straight ways on a plan.

    A way on walkable ground is as probable as its least walkable point. It leads through a wall with the probability
    of passing. Off the walkable ground nothing is known of walls; ways there return after a mean length.

    Parameters
    ----------
    grid
        Raster of the plan.
    begin_m, end_m
        East and north (n,) of the ends of the ways, m.
    parameters
        Probability of passing, and length of ways off the walkable ground.
    """
    length_m = np.hypot(end_m[0] - begin_m[0], end_m[1] - begin_m[1])
    least = grid.along(begin_m, end_m, float(length_m.max(initial=0.0)))
    passing = parameters.pass_probability
    weight = passing + (1.0 - passing) * least
    begins_off = grid.at(*begin_m) < passing
    if begins_off.any():
        stays = np.exp(-length_m[begins_off] / parameters.stray_length_m)
        there = grid.at(end_m[0][begins_off], end_m[1][begins_off])
        weight[begins_off] = stays + (1.0 - stays) * there
    return np.asarray(np.log(weight), dtype=np.float64)
