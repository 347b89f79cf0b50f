"""Particles at the start of a walk: drawn from what is known there, and from the first measurement of the rest."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from pdr_est.estimators.common.initial_state import StartPrior
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.particle.cloud import (
    DEVICE_ROWS,
    EAST,
    HEADING,
    LOG_SCALE,
    NORTH,
    PLAN_ROWS,
    REFERENCE,
    REFERENCE_VARIANCE,
    START_EAST,
    Cloud,
)
from pdr_est.estimators.particle.plan.plan_grid import PlanGrid
from pdr_est.frames import Array, rotation_matrix, wrap_angle
from pdr_est.types.measurements import HeadingPrior, PositionFix

_WIDER = 1.3  # standard deviation of drawn states over that of the measurement they are drawn from
_ANYWHERE = 0.25  # share of headings that are drawn from the whole circle, for a measurement that is wrong
_NEAR_S = 10.0  # headings up to this long after the start tell the start heading


def initial_cloud(
    priors: Sequence[StartPrior], nodes: Sequence[Sequence[Node]], count: int, rng: np.random.Generator
) -> Cloud:
    """Draw the particles at the start.

    The devices of a walker start at the same place in the same direction as far as both are known alike.

    Parameters
    ----------
    priors
        Prior of each device at its start.
    nodes
        Nodes of each device.
    count
        Number of particles.
    rng
        Source of random numbers.
    """
    state, log_weight = np.zeros((DEVICE_ROWS * len(priors) + PLAN_ROWS, count)), np.zeros(count)
    common = np.array([normal_strata(count, rng) for _ in range(2)])
    for number, (prior, own) in enumerate(zip(priors, nodes, strict=True)):
        rows = state[DEVICE_ROWS * number : DEVICE_ROWS * (number + 1)]
        mean, sigma = prior.state.mean, np.sqrt(np.diag(prior.state.covariance))
        rows[LOG_SCALE] = mean[LOG_SCALE] + sigma[LOG_SCALE] * normal_strata(count, rng)
        rows[REFERENCE], rows[REFERENCE_VARIANCE] = mean[4], sigma[4] ** 2
        if prior.heading_open:
            rows[HEADING], more = _open_headings(own, count, rng)
            log_weight = log_weight + more
        else:
            rows[HEADING] = mean[2] + sigma[2] * normal_strata(count, rng)
        if prior.position_open:
            rows[: NORTH + 1], more = _open_positions(own, rows, rng)
            log_weight = log_weight + more
        else:
            turned = rotation_matrix(0.0 if prior.heading_open else mean[2]) @ common  # with the start the walk turns
            rows[EAST], rows[NORTH] = mean[:2, None] + sigma[:2, None] * turned
        rows[START_EAST:] = rows[: NORTH + 1]
    return Cloud(state, log_weight, len(priors))


def spread_over_plan(cloud: Cloud, grid: PlanGrid, rng: np.random.Generator) -> Cloud:
    """Return a cloud that begins anywhere on the walkable ground of a plan, all devices in one place."""
    density = np.cumsum(grid.walkable.ravel(), dtype=np.float64)
    wanted = (rng.permutation(len(cloud)) + rng.random(len(cloud))) / len(cloud) * density[-1]
    row, column = np.divmod(np.searchsorted(density, wanted), grid.walkable.shape[1])
    inside = rng.random((2, len(cloud)))
    state = cloud.state.copy()
    for device in range(cloud.devices):
        rows = state[DEVICE_ROWS * device : DEVICE_ROWS * (device + 1)]
        rows[EAST] = grid.origin_m[0] + (column + inside[0]) * grid.cell_m
        rows[NORTH] = grid.origin_m[1] + (row + inside[1]) * grid.cell_m
        rows[START_EAST:] = rows[: NORTH + 1]
    return replace(cloud, state=state)


def turned_anywhere(cloud: Cloud, rng: np.random.Generator) -> Cloud:
    """Return a cloud whose walks so far are turned about their starts to every direction."""
    uniform = 2.0 * np.pi * (rng.permutation(len(cloud)) + rng.random(len(cloud))) / len(cloud) - np.pi
    return _turned(cloud, uniform)


def turned_to_heading(cloud: Cloud, device: int, prior: HeadingPrior, rng: np.random.Generator) -> Cloud:
    """Return a cloud in which a heading tells the direction of the walk, of which nothing was known before.

    The walk of each particle so far turns about its start, by the same angle for all devices.
    """
    drawn = prior.heading_rad + prior.sigma_rad * normal_strata(len(cloud), rng)
    return _turned(cloud, wrap_angle(drawn - cloud.device(device)[HEADING]))


def placed_at_fix(
    cloud: Cloud, device: int, fix: PositionFix, position_open: bool, heading_open: bool, rng: np.random.Generator
) -> Cloud:
    """Return a cloud in which the first fix places a walk whose position or direction is open.

    A direction that is open may be any; a position that is open is that of the fix, up to its error.
    """
    if heading_open:
        cloud = turned_anywhere(cloud, rng)
    if not position_open:
        return cloud
    root = np.linalg.cholesky(np.asarray(fix.total_covariance_m2, dtype=np.float64))
    error = root @ np.array([normal_strata(len(cloud), rng) for _ in range(2)])
    place = np.asarray(fix.position_m, dtype=np.float64)[:, None] + error
    move = place - cloud.device(device)[: NORTH + 1]
    state = cloud.state.copy()
    for begin in range(0, DEVICE_ROWS * cloud.devices, DEVICE_ROWS):
        state[begin : begin + NORTH + 1] += move
        state[begin + START_EAST : begin + DEVICE_ROWS] += move
    return replace(cloud, state=state)


def _turned(cloud: Cloud, angle_rad: Array) -> Cloud:
    """Return a cloud whose particles have turned about their starts by angles (n,)."""
    state, c, s = cloud.state.copy(), np.cos(angle_rad), np.sin(angle_rad)
    for begin in range(0, DEVICE_ROWS * cloud.devices, DEVICE_ROWS):
        rows = state[begin : begin + DEVICE_ROWS]
        east, north = rows[: NORTH + 1] - rows[START_EAST:]
        rows[EAST], rows[NORTH] = rows[START_EAST] + c * east - s * north, rows[START_EAST + 1] + s * east + c * north
        rows[HEADING] = wrap_angle(rows[HEADING] + angle_rad)
    return replace(cloud, state=state)


def normal_strata(count: int, rng: np.random.Generator) -> Array:
    """Draw normal numbers (count,), one from each of so many strata of equal probability, in random order."""
    return np.asarray(ndtri((rng.permutation(count) + rng.random(count)) / count))


def _open_headings(nodes: Sequence[Node], count: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Draw start headings (count,), and log weights that make up for where more of them were drawn."""
    uniform = 2.0 * np.pi * (rng.permutation(count) + rng.random(count)) / count - np.pi
    found = _first_heading(nodes)
    if found is None:
        return uniform, np.zeros(count)
    heading_rad, sigma_rad = found
    near = rng.random(count) >= _ANYWHERE
    drawn = np.where(near, wrap_angle(heading_rad + sigma_rad * normal_strata(count, rng)), uniform)
    off = wrap_angle(drawn - heading_rad) / sigma_rad
    density = _ANYWHERE / (2.0 * np.pi)
    density = density + (1.0 - _ANYWHERE) * np.exp(-0.5 * off**2) / (sigma_rad * np.sqrt(2.0 * np.pi))
    return drawn, -np.log(density)


def _first_heading(nodes: Sequence[Node]) -> tuple[float, float] | None:
    """Return the start heading that the best heading of the first seconds tells, and its standard deviation."""
    turned, variance = 0.0, 0.0
    best: tuple[float, float] | None = None
    for number, node in enumerate(nodes):
        if node.time_s > nodes[0].time_s + _NEAR_S or node.turn_hypotheses:
            break
        if number:
            turned, variance = turned + node.heading_change_rad, variance + float(node.covariance[2, 2])
        for prior in node.priors:
            sigma_rad = _WIDER * float(np.sqrt(prior.sigma_rad**2 + variance))
            if not prior.relative and (best is None or sigma_rad < best[1]):
                best = float(wrap_angle(prior.heading_rad - turned)), sigma_rad
    return best if best is not None and best[1] < 1.0 else None


def _open_positions(nodes: Sequence[Node], rows: Array, rng: np.random.Generator) -> tuple[Array, Array]:
    """Draw start positions (2, n) from the first fix, back along the steps, and log weights that make up for it."""
    count = rows.shape[1]
    east, north, heading = np.zeros(count), np.zeros(count), rows[HEADING].copy()
    variance_m2 = 0.0
    for number, node in enumerate(nodes):
        if number:
            heading = heading + node.heading_change_rad
            ahead = np.exp(rows[LOG_SCALE]) * node.length_m
            east, north = east + ahead * np.cos(heading), north + ahead * np.sin(heading)
            variance_m2 += float(node.covariance[0, 0] + node.covariance[1, 1]) / 2.0
        if node.fixes:
            break
    fix: PositionFix = node.fixes[0]
    spread = np.asarray(fix.total_covariance_m2) + variance_m2 * np.eye(2)
    root = _WIDER * np.linalg.cholesky(spread)
    normal = np.array([normal_strata(count, rng) for _ in range(2)])
    place = np.asarray(fix.position_m, dtype=np.float64)[:, None] + root @ normal
    return place - np.array([east, north]), 0.5 * (normal**2).sum(axis=0)
