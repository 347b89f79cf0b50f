"""Backward simulation: paths drawn from the posterior of the whole walk, by the filter's particles.

A path begins at a particle of the end. Of the particles of the block before, each is its predecessor with the
probability of its weight, of the motion from it to the path, and of the way between them on the plan.

References
----------
S. Godsill, A. Doucet, M. West, "Monte Carlo smoothing for nonlinear time series", J. Am. Stat. Assoc. 99 (2004).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.particle.blocks import BlockMotion, block_motions, poses_between
from pdr_est.estimators.particle.cloud import (
    DEVICE_ROWS,
    EAST,
    HEADING,
    LOG_SCALE,
    NORTH,
    REFERENCE,
    REFERENCE_VARIANCE,
    Cloud,
    systematic,
)
from pdr_est.estimators.particle.motion import log_way_weight
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.plan_grid import PlanGrid
from pdr_est.frames import Array

_CANDIDATES = 3  # predecessors that are drawn for each path before the plan chooses among them
_SCALE_KERNEL = 0.3  # over the standard deviation of the particles: by how much length scales may differ
_REFERENCE_SIGMA_RAD = 0.03  # by how much reference directions may differ


@dataclass(frozen=True)
class Block:
    """Part of a walk: the particles at its end, and the nodes of each device that led there.

    Attributes
    ----------
    cloud
        Particles at the end of the block, with the measurements there.
    nodes
        Nodes of each device inside the block; the last pose of a device is that of the last one.
    present
        Devices that had begun before the block.
    """

    cloud: Cloud
    nodes: tuple[tuple[Node, ...], ...]
    present: tuple[bool, ...]


def simulate_backward(
    blocks: Sequence[Block], parameters: ParticleParams, grid: PlanGrid | None, rng: np.random.Generator
) -> tuple[list[Array], Array]:
    """Draw paths from the posterior of a walk.

    Parameters
    ----------
    blocks
        Blocks in order of time; the first one holds the particles at the start.
    parameters
        Number of paths, and what the plan means.
    grid
        Raster of the plan, or None.
    rng
        Source of random numbers.

    Returns
    -------
    list of Array
        For each device the poses (n, 3, paths) at its nodes: east, north, heading.
    Array
        (devices, paths) logarithms of the length scales at the end.
    """
    last = blocks[-1].cloud
    devices = last.devices
    path = last.state[:, systematic(last.weights, parameters.paths, float(rng.random()))]
    final = path.copy()
    poses: list[list[Array]] = [[] for _ in range(devices)]
    for before, block in zip(blocks[-2::-1], blocks[:0:-1], strict=True):
        motions = [block_motions(nodes) if nodes and here else [] for nodes, here in zip(block.nodes, block.present, strict=True)]
        chosen, between = _predecessors(before.cloud, path, final, motions, parameters, grid, rng)
        for device, nodes in enumerate(block.nodes):
            if not nodes:
                continue
            if between[device] is None:  # it enters the walk here
                rows = path[DEVICE_ROWS * device : DEVICE_ROWS * device + HEADING + 1]
                poses[device].append(np.repeat(rows[None], len(nodes), axis=0))
            else:
                poses[device].append(between[device])  # type: ignore[arg-type]
        path = before.cloud.state[:, chosen]
    for device, nodes in enumerate(blocks[0].nodes):
        if nodes:
            poses[device].append(path[None, DEVICE_ROWS * device : DEVICE_ROWS * device + HEADING + 1])
    found = [np.concatenate(own[::-1]) for own in poses]
    return found, final[LOG_SCALE::DEVICE_ROWS][:devices]


def _predecessors(
    cloud: Cloud,
    path: Array,
    final: Array,
    motions: Sequence[Sequence[BlockMotion]],
    parameters: ParticleParams,
    grid: PlanGrid | None,
    rng: np.random.Generator,
) -> tuple[NDArray[np.int64], list[Array | None]]:
    """Draw the predecessors (m,) of paths, and return the poses (k, 3, m) of each device between them."""
    log = np.broadcast_to(cloud.log_weight, (path.shape[1], len(cloud)))
    for device, own in enumerate(motions):
        if own:
            log = log + _log_fit(cloud.device(device), path[DEVICE_ROWS * device :], final[DEVICE_ROWS * device :], own)
    count = path.shape[1]
    candidates = _drawn(log, _CANDIDATES if grid is not None else 1, rng)
    begin, row = cloud.state[:, candidates], np.arange(count)
    between, way = [], np.zeros(candidates.shape)
    for device, own in enumerate(motions):
        if not own:
            between.append(None)
            continue
        rows = slice(DEVICE_ROWS * device, DEVICE_ROWS * (device + 1))
        first, last = begin[rows], np.repeat(path[rows][:, :, None], candidates.shape[1], axis=2)
        motion = _chosen_motion(own, first, last)
        poses = motion
        between.append(poses)
        if grid is not None:
            way += _log_way(grid, first, poses, parameters)
    if grid is None:
        best = np.zeros(count, dtype=np.int64)
    else:
        weight = np.exp(way - way.max(axis=1, keepdims=True))
        total = np.cumsum(weight, axis=1)
        best = (total < rng.random(count)[:, None] * total[:, -1:]).sum(axis=1)
    return candidates[row, best], [None if one is None else one[:, :, row, best] for one in between]


def _chosen_motion(motions: Sequence[BlockMotion], begin: Array, end: Array) -> Array:
    """Return the poses (k, 3, ...) between ends, for each by the turn hypothesis that fits best."""
    found = poses_between(motions[0], begin[: HEADING + 1], end[: HEADING + 1], begin[LOG_SCALE])
    if len(motions) == 1:
        return found
    turned = end[HEADING] - begin[HEADING]
    costs = np.array([np.abs(turned - one.poses[-1, 2]) for one in motions])
    best = costs.argmin(axis=0)
    for number, one in enumerate(motions[1:], 1):
        other = poses_between(one, begin[: HEADING + 1], end[: HEADING + 1], begin[LOG_SCALE])
        found = np.where(best == number, other, found)
    return found


def _log_way(grid: PlanGrid, begin: Array, poses: Array, parameters: ParticleParams) -> Array:
    """Return the log probabilities (m, c) of the ways of a device over a block on the plan."""
    total = np.zeros(begin.shape[1:])
    here = begin[EAST].ravel(), begin[NORTH].ravel()
    for east, north in poses[:, :2]:
        there = east.ravel(), north.ravel()
        total += log_way_weight(grid, here, there, parameters).reshape(total.shape)
        here = there
    return total


def _drawn(log: Array, draws: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Draw numbers (m, draws) of columns by the logarithms (m, n) of their weights, for each row."""
    weights = np.exp((log - log.max(axis=1, keepdims=True)).astype(np.float32))
    total = np.cumsum(weights, axis=1, dtype=np.float64)
    total /= total[:, -1:]
    rows, columns = total.shape
    offset = 2.0 * np.arange(rows)[:, None]
    wanted = rng.random((rows, draws)) + offset
    found = np.searchsorted((total + offset).ravel(), wanted.ravel()).reshape(rows, draws)
    return np.minimum(found - columns * np.arange(rows)[:, None], columns - 1)


def _log_fit(rows: Array, path: Array, final: Array, motions: Sequence[BlockMotion]) -> Array:
    """Return the log densities (m, n) of motions from n particles to m paths, and of the rest of their states.

    The quadratic forms are products of matrices: of terms of the paths with terms of the particles.
    """
    centre = path[: HEADING + 1].mean(axis=1)
    east, north, heading = path[: HEADING + 1] - centre[:, None]
    one = np.ones(len(east))
    terms = np.array([east**2, north**2, heading**2, east * north, east * heading, north * heading, east, north, heading, one])
    rest = _log_rest(rows, path, final)
    logs = [one.log_probability - 0.5 * (terms.T @ _quadratic_terms(one, rows, centre)) for one in motions]
    found = logs[0] if len(logs) == 1 else np.logaddexp.reduce(logs)
    return np.asarray(found + rest)


def _quadratic_terms(motion: BlockMotion, rows: Array, centre: Array) -> Array:
    """Return the factors (10, n) of the terms of `_log_fit` for a motion from n particles."""
    c, s, scale = np.cos(rows[HEADING]), np.sin(rows[HEADING]), np.exp(rows[LOG_SCALE])
    forward, left, turn = motion.poses[-1]
    m0 = rows[EAST] + scale * (c * forward - s * left) - centre[EAST]
    m1 = rows[NORTH] + scale * (s * forward + c * left) - centre[NORTH]
    m2 = rows[HEADING] + turn - centre[HEADING]
    (ff, fl, fh), (_, ll, lh), (_, _, hh) = motion.information
    p00 = c * c * ff - 2.0 * c * s * fl + s * s * ll
    p11 = s * s * ff + 2.0 * c * s * fl + c * c * ll
    p01 = c * s * (ff - ll) + (c * c - s * s) * fl
    p02, p12, p22 = c * fh - s * lh, s * fh + c * lh, np.full(len(c), hh)
    l0, l1, l2 = p00 * m0 + p01 * m1 + p02 * m2, p01 * m0 + p11 * m1 + p12 * m2, p02 * m0 + p12 * m1 + p22 * m2
    squared = m0 * l0 + m1 * l1 + m2 * l2
    return np.array([p00, p11, p22, 2.0 * p01, 2.0 * p02, 2.0 * p12, -2.0 * l0, -2.0 * l1, -2.0 * l2, squared])


def _log_rest(rows: Array, path: Array, final: Array) -> Array:
    """Return the log densities (m, n) of the length scale and the reference direction of paths, by kernels."""
    spread = _SCALE_KERNEL * rows[LOG_SCALE].std() + 1e-4
    wide = rows[REFERENCE_VARIANCE] - min(float(path[REFERENCE_VARIANCE].min()), float(rows[REFERENCE_VARIANCE].min()))
    wide = np.maximum(wide, 0.0) + _REFERENCE_SIGMA_RAD**2
    scale, reference = final[LOG_SCALE], path[REFERENCE]
    one = np.ones(len(scale))
    middle = reference.mean()
    off, own = reference - middle, rows[REFERENCE] - middle
    terms = np.array([scale**2, scale, off**2, off, one])
    squared = (rows[LOG_SCALE] / spread) ** 2 + own**2 / wide + np.log(wide)
    factors = np.array(
        [np.full(len(own), spread**-2), -2.0 * rows[LOG_SCALE] / spread**2, 1.0 / wide, -2.0 * own / wide, squared]
    )
    return np.asarray(-0.5 * (terms.T @ factors))
