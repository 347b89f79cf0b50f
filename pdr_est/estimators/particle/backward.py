"""Backward simulation: paths drawn from the posterior of the whole walk, by the filter's particles.

A path begins at a particle of the end. Of the particles of the block before, each is its predecessor with the
probability of its weight, of the motion from it to the path, and of the way between them on the plan.

References
----------
S. Godsill, A. Doucet, M. West, "Monte Carlo smoothing for nonlinear time series", J. Am. Stat. Assoc. 99 (2004).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce

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
    START_EAST,
    Cloud,
    drawn_columns,
    systematic,
)
from pdr_est.estimators.particle.plan.displacement import displacement_terms, shift_at
from pdr_est.estimators.particle.plan.plan_model import PlanModel
from pdr_est.frames import Array

_CANDIDATES = 3  # predecessors that are drawn for each path before the plan chooses among them
_MOST_PARTICLES = 600  # among which the predecessors of a path are sought; ours
_KERNEL = 0.3  # over the standard deviation of the particles: by how much what is constant may differ
_LEAST_SPREAD = 1e-6  # of particles, below which they count as equal
_REFERENCE_SIGMA_RAD = 0.03  # by how much reference directions may differ


DrawnPaths = tuple[list[Array], Array, list[Array]]
"""Poses of each device, logarithms of its length scale, and shifts of the plan; see `simulate_backward`."""


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
    plan
        Plan of the floor of the block; None without one.
    """

    cloud: Cloud
    nodes: tuple[tuple[Node, ...], ...]
    present: tuple[bool, ...]
    plan: PlanModel | None = None


def simulate_backward(
    blocks: Sequence[Block], closed: Sequence[bool], paths: int, rng: np.random.Generator
) -> DrawnPaths:
    """Draw paths from the posterior of a walk.

    Parameters
    ----------
    blocks
        Blocks in order of time; the first one holds the particles at the start.
    closed
        Whether the walk of each device ends where it began.
    paths
        Number of paths.
    rng
        Source of random numbers.

    Returns
    -------
    list of Array
        For each device the poses (n, 3, paths) at its nodes: east, north, heading.
    Array
        (devices, paths) logarithms of the length scales at the end.
    list of Array
        For each device by how much (n, 2, paths) the plan lies beside its poses, m.
    """
    last = blocks[-1].cloud
    path = last.state[:, systematic(last.weights, paths, float(rng.random()))]
    final = path
    poses: list[list[Array]] = [[] for _ in range(last.devices)]
    shifts: list[list[Array]] = [[] for _ in range(last.devices)]
    for before, block in zip(blocks[-2::-1], blocks[:0:-1], strict=True):
        motions = [
            block_motions(nodes) if nodes and here else []
            for nodes, here in zip(block.nodes, block.present, strict=True)
        ]
        cloud, plan = thinned_cloud(before.cloud, rng), block.plan
        candidates = _candidates(cloud, path, final, motions, closed, 1 if plan is None else _CANDIDATES, rng)
        shift_m = _shift(plan, cloud.with_state(path))
        between = _ways(cloud.state[:, candidates], path, motions)
        best = np.zeros(paths, dtype=np.int64) if plan is None else _chosen(plan, between, shift_m, rng)
        row = np.arange(paths)
        for device, nodes in enumerate(block.nodes):
            own = between[device]
            shifts[device] += [np.repeat(shift_m[None], len(nodes), axis=0)] if nodes else []
            if own is not None:
                poses[device].append(own[1:, :, row, best])
            elif nodes:  # the device enters the walk here
                poses[device].append(np.repeat(_pose(path, device)[None], len(nodes), axis=0))
        path = cloud.state[:, candidates[row, best]]
    for device, nodes in enumerate(blocks[0].nodes):
        if nodes:
            poses[device].append(_pose(path, device)[None])
            shifts[device].append(_shift(blocks[0].plan, last.with_state(path))[None])
    scales = final[LOG_SCALE::DEVICE_ROWS][: last.devices]
    return [np.concatenate(own[::-1]) for own in poses], scales, [np.concatenate(own[::-1]) for own in shifts]


def thinned_cloud(cloud: Cloud, rng: np.random.Generator) -> Cloud:
    """Return a cloud of no more particles than predecessors are sought among, equally probable ones."""
    if len(cloud) <= _MOST_PARTICLES:
        return cloud
    kept = systematic(cloud.weights, _MOST_PARTICLES, float(rng.random()))
    return replace(cloud, state=cloud.state[:, kept], log_weight=np.zeros(_MOST_PARTICLES))


def _pose(state: Array, device: int) -> Array:
    """Return east, north and heading (3, ...) of a device."""
    return state[DEVICE_ROWS * device : DEVICE_ROWS * device + HEADING + 1]


def _shift(plan: PlanModel | None, cloud: Cloud) -> Array:
    """Return by how much the plan lies beside the poses (2, paths) of the first device, m."""
    place_m = cloud.device(0)[: NORTH + 1]
    return np.zeros(place_m.shape) if plan is None else shift_at(cloud.displacement, place_m, plan.anchor_m)


def _candidates(
    cloud: Cloud,
    path: Array,
    final: Array,
    motions: Sequence[Sequence[BlockMotion]],
    closed: Sequence[bool],
    draws: int,
    rng: np.random.Generator,
) -> NDArray[np.int64]:
    """Draw particles (m, draws) that may be the predecessors of paths, walls apart."""
    common = [(np.ones((1, path.shape[1])), -2.0 * cloud.log_weight[None])]
    if cloud.displacement.any():
        common.append(displacement_terms(cloud.with_state(path).displacement, cloud.displacement))
    logs = []
    for device, own in enumerate(motions):
        if own:
            begin = DEVICE_ROWS * device
            logs.append(_log_fit(cloud.device(device), path[begin:], final[begin:], own, closed[device], common))
            common = []
    if common:
        logs.append(_log_density(common))
    return drawn_columns(reduce(np.add, logs), draws, rng)


def _ways(begin: Array, path: Array, motions: Sequence[Sequence[BlockMotion]]) -> list[Array | None]:
    """Return the poses (k + 1, 3, m, c) of each device from candidates (rows, m, c) to paths; None for no motion."""
    ways: list[Array | None] = []
    for device, own in enumerate(motions):
        if not own:
            ways.append(None)
            continue
        first, log_scale = _pose(begin, device), begin[DEVICE_ROWS * device + LOG_SCALE]
        last = np.broadcast_to(_pose(path, device)[:, :, None], first.shape)
        ways.append(np.concatenate([first[None], _poses_between(own, first, last, log_scale)]))
    return ways


def _chosen(
    plan: PlanModel, ways: Sequence[Array | None], shift_m: Array, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Draw one of the candidates (m,) by how probable its ways are on the plan."""
    log = sum(_log_way(plan, one[:, :2] - shift_m[:, :, None]) for one in ways if one is not None)
    weight = np.exp(log - np.max(log, axis=1, keepdims=True))
    total = np.cumsum(weight, axis=1)
    drawn = (total < rng.random((len(total), 1)) * total[:, -1:]).sum(axis=1)
    return np.asarray(np.minimum(drawn, total.shape[1] - 1), dtype=np.int64)


def _log_way(plan: PlanModel, poses: Array) -> Array:
    """Return the log probabilities (m, c) of the ways of a device over a block, (k + 1, 2, m, c), on the plan."""
    flat = np.moveaxis(poses, 1, 0)
    begin, end = flat[:, :-1].reshape(2, -1), flat[:, 1:].reshape(2, -1)
    return np.asarray(plan.log_way(begin, end).reshape(len(poses) - 1, *poses.shape[2:]).sum(axis=0))


def _poses_between(motions: Sequence[BlockMotion], begin: Array, end: Array, log_scale: Array) -> Array:
    """Return the poses (k, 3, ...) between ends (3, ...), for each by the turn hypothesis that fits best."""
    found = poses_between(motions[0], begin, end, log_scale)
    if len(motions) == 1:
        return found
    turned = end[HEADING] - begin[HEADING]
    best = np.array([np.abs(turned - one.poses[-1, 2]) for one in motions]).argmin(axis=0)
    for number, one in enumerate(motions[1:], 1):
        found = np.where(best == number, poses_between(one, begin, end, log_scale), found)
    return found


def _log_fit(
    rows: Array,
    path: Array,
    final: Array,
    motions: Sequence[BlockMotion],
    closed: bool,
    common: Sequence[tuple[Array, Array]],
) -> Array:
    """Return the log densities (m, n) of motions from n particles to m paths, and of the rest of their states.

    The quadratic forms are products of matrices: of terms of the paths with terms of the particles. Those in
    `common` come on top.
    """
    centre = path[: HEADING + 1].mean(axis=1)
    east, north, heading = path[: HEADING + 1] - centre[:, None]
    one = np.ones(len(east))
    terms = np.array(
        [east**2, north**2, heading**2, east * north, east * heading, north * heading, east, north, heading, one]
    )
    rest = [*_constant_terms(rows, path, final, closed), *common]
    if len(motions) == 1:  # whose factor is that of all
        return _log_density([(terms, _quadratic_terms(motions[0], rows, centre)), *rest])
    logs = [
        motion.log_factor + _log_density([(terms, _quadratic_terms(motion, rows, centre)), *rest])
        for motion in motions
    ]
    return np.asarray(np.logaddexp.reduce(logs))


def _log_density(forms: Sequence[tuple[Array, Array]]) -> Array:
    """Return minus half of the sums (m, n) of products of terms (k, m) of paths with factors (k, n) of particles."""
    terms, factors = zip(*forms, strict=True)
    return np.asarray(np.concatenate(terms).T @ (-0.5 * np.concatenate(factors)))


def _constant_terms(rows: Array, path: Array, final: Array, closed: bool) -> list[tuple[Array, Array]]:
    """Return terms (3, m) of paths and factors (3, n) of particles for what is constant along paths.

    The length scale and, of closed walks, the start have a kernel about those at the end of the path. The direction
    that relative headings count from has the variance of what the measurements of the block told of it.
    """
    found = []
    for kept in ([LOG_SCALE], [START_EAST, START_EAST + 1])[: 2 if closed else 1]:
        spread = float(np.sqrt(rows[kept].var(axis=1).mean()))
        if spread > _LEAST_SPREAD:
            variance = np.full(rows.shape[1], (_KERNEL * spread) ** 2)
            found += [_squared(final[row], rows[row], variance) for row in kept]
    least = min(float(path[REFERENCE_VARIANCE].min()), float(rows[REFERENCE_VARIANCE].min()))
    wide = np.maximum(rows[REFERENCE_VARIANCE] - least, 0.0) + _REFERENCE_SIGMA_RAD**2
    terms, factors = _squared(path[REFERENCE], rows[REFERENCE], wide)
    factors[2] += np.log(wide)
    return [*found, (terms, factors)]


def _squared(path: Array, particles: Array, variance: Array) -> tuple[Array, Array]:
    """Return terms (3, m) and factors (3, n), whose products are squared differences over variances (n,)."""
    middle = path.mean()
    off, own = path - middle, particles - middle
    factors = np.array([1.0 / variance, -2.0 * own / variance, own**2 / variance])
    return np.array([off**2, off, np.ones(len(off))]), factors


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
