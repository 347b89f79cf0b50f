"""Kernels that keep particles different from each other after resampling.

Equal particles stay equal where the model has no noise, as in the length scale, or where one measurement leaves few
of them. A Gaussian kernel of a part of their own covariance moves them apart. At the same time they are drawn towards
their mean, so that mean and covariance stay what they are (Liu and West).

References
----------
J. Liu, M. West, "Combined parameter and state estimation in simulation-based filtering", in Sequential Monte Carlo
Methods in Practice, Springer 2001.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.particle.cloud import DEVICE_ROWS, HEADING, LOG_SCALE, NORTH, Cloud, systematic
from pdr_est.estimators.particle.plan.displacement import shift_at
from pdr_est.estimators.particle.plan.plan_model import PlanModel
from pdr_est.frames import Array, wrap_angle

_SCALE_KERNEL = 0.1  # standard deviation of the kernel over that of the particles, for the length scale alone
_KERNEL = 0.3  # the same for all states, where a measurement leaves few particles
_OPEN_RAD = 0.6  # standard deviation of a heading from which on its mean means nothing
_APART_RAD = 0.3  # between the headings of two modes
_BLOCKED = 0.5  # probability of being walkable below which a kernel moves no particle


def roughened_scale(log_scale: Array, rng: np.random.Generator) -> Array:
    """Return logarithms (n,) of length scales of equally probable particles that were moved by a slight kernel."""
    mean, sigma = log_scale.mean(), log_scale.std()
    kept = np.sqrt(1.0 - _SCALE_KERNEL**2)
    moved = mean + kept * (log_scale - mean) + _SCALE_KERNEL * sigma * rng.standard_normal(len(log_scale))
    return np.asarray(moved)


def moved_by_kernel(cloud: Cloud, rng: np.random.Generator, plan: PlanModel | None) -> Cloud:
    """Return a cloud resampled and moved by a kernel; no particle is moved through a wall of the plan."""
    count = len(cloud)
    state = cloud.state[:, systematic(cloud.weights, count, float(rng.random()))]
    sampled = [DEVICE_ROWS * device + row for device in range(cloud.devices) for row in range(LOG_SCALE + 1)]
    before = state[sampled]
    after = before.copy()
    for own in _modes(before[HEADING]):
        after[:, own] = _moved(before[:, own], rng)
    if plan is not None:
        _stay_on_plan(plan, replace(cloud, state=state).displacement, before, after)
    state[sampled] = after
    return replace(cloud, state=state, log_weight=np.zeros(count))


def _modes(heading: Array) -> list[NDArray[np.int64]]:
    """Return the particles of each group of headings (n,) that lies apart from all others on the circle."""
    angle = wrap_angle(heading)
    order = np.argsort(angle, kind="stable")
    gaps = np.diff(angle[order], append=angle[order[0]] + 2.0 * np.pi)
    borders = np.flatnonzero(gaps > _APART_RAD) + 1
    if not len(borders):
        return [order]
    return np.split(np.roll(order, -borders[-1]), borders[:-1] + len(order) - borders[-1])


def _moved(before: Array, rng: np.random.Generator) -> Array:
    """Return states (4 devices, n) of one mode, moved by a kernel of their covariance."""
    centre = before.mean(axis=1, keepdims=True)
    apart = before - centre
    variance, axes = np.linalg.eigh(apart @ apart.T / before.shape[1])
    root = axes * np.sqrt(np.maximum(variance, 0.0))
    kept = np.full((len(apart), 1), np.sqrt(1.0 - _KERNEL**2))
    if any(apart[row].std() >= _OPEN_RAD for row in range(HEADING, len(apart), LOG_SCALE + 1)):
        kept[:] = 1.0  # poses on a ring about the start have no mean to be drawn to
        kept[LOG_SCALE :: LOG_SCALE + 1] = np.sqrt(1.0 - _KERNEL**2)
    return np.asarray(centre + kept * apart + _KERNEL * (root @ rng.standard_normal(before.shape)))


def _stay_on_plan(plan: PlanModel, displacement: Array, before: Array, after: Array) -> None:
    """Put particles (4 devices, n) back that a kernel moved through a wall of the plan, displaced by (3, n)."""
    for begin in range(0, len(before), LOG_SCALE + 1):
        place_m = slice(begin, begin + NORTH + 1)
        shift_m = shift_at(displacement, before[place_m], plan.anchor_m)
        old, new = plan.grid.cells(before[place_m] - shift_m), plan.grid.cells(after[place_m] - shift_m)
        blocked = plan.grid.along(old, new) < np.minimum(_BLOCKED, plan.grid.in_cells(old))
        after[:, blocked] = before[:, blocked]
