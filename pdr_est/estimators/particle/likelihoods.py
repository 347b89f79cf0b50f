"""Likelihoods of fixes, headings and tethers for many particles, and what those learn that are not sampled."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.estimators.common.huber import HUBER
from pdr_est.estimators.common.tethers import PairTether
from pdr_est.estimators.common.wandering_error import wander_to
from pdr_est.estimators.particle.cloud import (
    HEADING,
    NORTH,
    REFERENCE,
    REFERENCE_VARIANCE,
    START_EAST,
    Cloud,
    WanderingSource,
)
from pdr_est.frames import Array, wrap_angle
from pdr_est.types.measurements import HeadingPrior, PositionFix

_WRONG = 0.05  # probability that a robust heading in the map says nothing; ours


def heading_likelihood(cloud: Cloud, device: int, prior: HeadingPrior) -> Array:
    """Return the log likelihoods (n,) of a heading.

    A robust heading in the map is wrong with a small probability, and may then be any. The errors of a relative one
    are much the same from step to step; its tails are those of Cauchy's kernel, as in the graph.
    """
    residual, variance = _heading_residual(cloud.device(device), prior)
    squared = residual**2 / variance
    if prior.robust and prior.relative:
        return np.asarray(-0.5 * (np.log1p(squared) + np.log(variance)))
    log = -0.5 * (squared + np.log(2.0 * np.pi * variance))
    return np.logaddexp(log + np.log1p(-_WRONG), np.log(_WRONG / (2.0 * np.pi))) if prior.robust else log


def with_reference(cloud: Cloud, device: int, prior: HeadingPrior) -> Cloud:
    """Return a cloud whose particles have learnt from a relative heading the direction that it counts from."""
    if not prior.relative:
        return cloud
    state = cloud.state.copy()
    rows = cloud.with_state(state).device(device)
    residual, variance = _heading_residual(rows, prior)
    noise = prior.sigma_rad**2 * (1.0 + residual**2 / variance if prior.robust else 1.0)
    gain = rows[REFERENCE_VARIANCE] / (rows[REFERENCE_VARIANCE] + noise)
    rows[REFERENCE] -= gain * residual
    rows[REFERENCE_VARIANCE] *= 1.0 - gain
    return cloud.with_state(state)


def _heading_residual(rows: Array, prior: HeadingPrior) -> tuple[Array, Array]:
    """Return the innovations (n,) of a heading and their variances, (n,) or a single one."""
    if not prior.relative:
        return wrap_angle(prior.heading_rad - rows[HEADING]), np.array(prior.sigma_rad**2)
    expected = rows[HEADING] - rows[REFERENCE]
    return wrap_angle(prior.heading_rad - expected), rows[REFERENCE_VARIANCE] + prior.sigma_rad**2


def with_source(cloud: Cloud, device: int, fix: PositionFix) -> tuple[Cloud, int | None]:
    """Return a cloud in which the wandering error of a fix stands at the time of the fix, and its number.

    The number is None for a fix without wandering error.
    """
    if fix.sigma_wander_m <= 0.0:
        return cloud, None
    number = next((i for i, one in enumerate(cloud.sources) if (one.name, one.device) == (fix.source, device)), None)
    if number is None:
        new = WanderingSource(fix.source, device, fix.time_s, fix.sigma_wander_m, fix.sigma_wander_m**2 * np.eye(2))
        state = np.concatenate([cloud.state, np.zeros((2, len(cloud)))])
        return replace(cloud, state=state, sources=(*cloud.sources, new)), len(cloud.sources)
    before = cloud.sources[number]
    correlation, sigma_m = wander_to(fix, before.sigma_m, fix.time_s - before.time_s)
    factor = correlation * sigma_m / before.sigma_m
    covariance_m2 = factor**2 * before.covariance_m2 + (1.0 - correlation**2) * sigma_m**2 * np.eye(2)
    now = replace(before, time_s=fix.time_s, sigma_m=sigma_m, covariance_m2=covariance_m2)
    state = cloud.state.copy()
    state[cloud.source_rows(number)] *= factor
    sources = tuple(now if i == number else one for i, one in enumerate(cloud.sources))
    return replace(cloud, state=state, sources=sources), number


def fix_likelihood(cloud: Cloud, device: int, fix: PositionFix, source: int | None) -> Array:
    """Return the log likelihoods (n,) of a fix; those of a robust one fall linearly beyond Huber's threshold."""
    residual, spread = _fix_residual(cloud, device, fix, source)
    squared = np.einsum("in,in->n", residual, np.linalg.solve(spread, residual))
    if fix.robust:
        squared = np.where(squared > HUBER**2, 2.0 * HUBER * np.sqrt(squared) - HUBER**2, squared)
    return np.asarray(-0.5 * (squared + np.linalg.slogdet(spread)[1]))


def with_wandering_error(cloud: Cloud, device: int, fix: PositionFix, source: int | None) -> Cloud:
    """Return a cloud whose particles have learnt from a fix the wandering error of its source."""
    if source is None:
        return cloud
    residual, spread = _fix_residual(cloud, device, fix, source)
    one = cloud.sources[source]
    gain = np.linalg.solve(spread, one.covariance_m2).T
    state = cloud.state.copy()
    state[cloud.source_rows(source)] += gain @ residual
    left = one.covariance_m2 - gain @ one.covariance_m2
    learnt = replace(one, covariance_m2=0.5 * (left + left.T))
    sources = tuple(learnt if i == source else other for i, other in enumerate(cloud.sources))
    return replace(cloud, state=state, sources=sources)


def _fix_residual(cloud: Cloud, device: int, fix: PositionFix, source: int | None) -> tuple[Array, Array]:
    """Return the innovations (2, n) of a fix and their covariance (2, 2)."""
    residual = np.asarray(fix.position_m, dtype=np.float64)[:, None] - cloud.device(device)[: NORTH + 1]
    spread = np.asarray(fix.covariance_m2, dtype=np.float64)
    if source is None:
        return residual, spread
    return residual - cloud.state[cloud.source_rows(source)], spread + cloud.sources[source].covariance_m2


def tether_likelihood(cloud: Cloud, tethers: Sequence[PairTether]) -> Array:
    """Return the log likelihoods (n,) of tethers: Gaussian in what a distance is beyond the largest one."""
    total = np.zeros(len(cloud))
    for tether in tethers:
        apart = cloud.device(tether.device_a)[: NORTH + 1] - cloud.device(tether.device_b)[: NORTH + 1]
        beyond = np.maximum(np.hypot(*apart) - tether.max_distance_m, 0.0)
        total -= 0.5 * (beyond / tether.sigma_m) ** 2
    return total


def closure_likelihood(cloud: Cloud, device: int, sigma_m: float) -> Array:
    """Return the log likelihoods (n,) of a walk that ends where it began."""
    rows = cloud.device(device)
    apart = rows[: NORTH + 1] - rows[START_EAST:]
    return np.asarray(-0.5 * (apart**2).sum(axis=0) / sigma_m**2)
