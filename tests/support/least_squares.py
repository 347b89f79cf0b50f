"""Walks as one dense least-squares problem over all poses, the logarithm of the length scale and the direction that
relative heading priors count from: what the estimators must give."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares

from pdr_est.estimators.common.initial_state import VAGUE_SIGMA_RAD
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix, StartPose


def solve_linear(
    timelines: Sequence[Timeline], start: StartPose, sigma_scale: float
) -> tuple[list[Array], list[Array], Array, Array]:
    """Normal equations of straight walks east with exact headings: all (x, y) and the logarithms of the scales.

    Only the logarithms are not linear: the equations are solved again about each result. With sigma_scale 0 the
    scales are 1. The wandering errors of fixes are no unknowns but correlations of the fixes, common to all devices.

    Returns the positions (n, 2) of each device, their covariances (n, 2, 2), the logarithms (d,) and theirs (d, d).
    """
    log_scales, before = np.zeros(len(timelines)), np.full(len(timelines), np.inf)
    while np.abs(log_scales - before).max() > 1e-12:
        before = log_scales
        mean, covariance = _solve_about(log_scales, timelines, start, sigma_scale or 1e-9)
        log_scales = mean[-len(timelines) :]
    positions, spreads, begin = [], [], 0
    for timeline in timelines:
        rows = begin + 2 * np.arange(len(timeline.nodes))[:, None] + np.arange(2)
        positions.append(mean[rows])
        spreads.append(covariance[rows[:, :, None], rows[:, None, :]])
        begin = rows[-1, -1] + 1
    return positions, spreads, log_scales, covariance[begin:, begin:]


def _solve_about(
    log_scales: Array, timelines: Sequence[Timeline], start: StartPose, sigma_scale: float
) -> tuple[Array, Array]:
    counts = [len(timeline.nodes) for timeline in timelines]
    size = 2 * sum(counts) + len(counts)
    information, vector = np.zeros((size, size)), np.zeros(size)

    def add(rows: Array, value: Array, covariance: Array) -> None:
        nonlocal information, vector
        weight = np.linalg.inv(covariance)
        information = information + rows.T @ weight @ rows
        vector = vector + rows.T @ weight @ value

    def pick(i: int) -> Array:
        return np.eye(2, size, 2 * i)

    assert start.position_m is not None
    fixes, places = [], []
    for number, (timeline, log_scale) in enumerate(zip(timelines, log_scales, strict=True)):
        first = sum(counts[:number])
        scale = np.eye(1, size, size - len(counts) + number)
        add(pick(first), np.array(start.position_m), start.sigma_position_m**2 * np.eye(2))
        add(scale, np.zeros(1), np.array([[sigma_scale**2]]))
        for i, node in enumerate(timeline.nodes, first):
            if i > first:
                ahead = np.exp(log_scale) * np.array([[node.length_m], [0.0]])
                rows = pick(i) - pick(i - 1) - ahead @ scale
                add(rows, ahead[:, 0] * (1.0 - log_scale), node.covariance[:2, :2])
            fixes += node.fixes
            places += [pick(i) for _ in node.fixes]
    if fixes:
        measured = np.concatenate([fix.position_m for fix in fixes])
        add(np.concatenate(places), measured, fix_covariance(fixes))
    return np.linalg.solve(information, vector), np.linalg.inv(information)


def fix_covariance(fixes: Sequence[PositionFix]) -> Array:
    """Return the covariance (2 m, 2 m) of the errors of fixes, white and wandering, however often one is given.

    What two fixes of a source have in common is the error at the earlier one, of which a part has faded by the later.
    """
    covariance, variance = np.zeros((2 * len(fixes), 2 * len(fixes))), wander_variances(fixes)
    for i, one in enumerate(fixes):
        covariance[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = one.covariance_m2
    for i, one in enumerate(fixes):
        for j, other in enumerate(fixes):
            if one.source == other.source:
                earlier = min(one, other, key=lambda fix: fix.time_s)
                left = np.exp(-abs(one.time_s - other.time_s) / one.wander_time_s)
                common = variance[earlier.source, earlier.time_s] * left
                covariance[2 * i : 2 * i + 2, 2 * j : 2 * j + 2] += common * np.eye(2)
    return covariance


def wander_variances(fixes: Sequence[PositionFix]) -> dict[tuple[str, float], float]:
    """Return the variance of the wandering error by source and time: it grows at once, and shrinks by fading."""
    variances: dict[tuple[str, float], float] = {}
    last: dict[str, PositionFix] = {}
    for fix in sorted(fixes, key=lambda one: one.time_s):
        stated, variance = fix.sigma_wander_m**2, fix.sigma_wander_m**2
        if fix.source in last:
            before = last[fix.source]
            left = np.exp(-2.0 * (fix.time_s - before.time_s) / fix.wander_time_s)
            variance = max(stated, left * variances[before.source, before.time_s] + (1.0 - left) * stated)
        variances[fix.source, fix.time_s], last[fix.source] = variance, fix
    return variances


def solve(timeline: Timeline, start: StartPose, sigma_scale: float, guess: Array) -> tuple[Array, Array]:
    """Maximum a posteriori of a walk with turns: poses (n, 3) flattened, the direction that relative heading priors
    count from, if there are any, and the logarithm of the scale; with their covariance.

    guess: poses (n, 3). A step's error is measured in exponential coordinates, as GTSAM does; priors are not robust.
    """
    reference = [0.0] if any(prior.relative for prior in timeline.priors) else []
    solution = least_squares(
        lambda state: _residuals(timeline, start, sigma_scale, state),
        np.array([*guess.ravel(), *reference, 0.0]),
        method="lm",
        x_scale="jac",
        xtol=1e-12,
        ftol=1e-12,
    )
    return solution.x, np.linalg.inv(solution.jac.T @ solution.jac)


def _residuals(timeline: Timeline, start: StartPose, sigma_scale: float, state: Array) -> Array:
    poses, log_scale = state[: 3 * len(timeline.nodes)].reshape(-1, 3), state[-1]
    reference = state[-2]  # of no meaning without relative priors
    assert start.position_m is not None
    assert start.heading_rad is not None
    sigmas = [start.sigma_position_m, start.sigma_position_m, start.sigma_heading_rad]
    residuals = [
        _logarithm(np.array([*start.position_m, start.heading_rad]), poses[0], 0.0, 0.0) / sigmas,
        np.array([log_scale / sigma_scale]),
    ]
    for i, node in enumerate(timeline.nodes):
        if i:
            error = _logarithm(poses[i - 1], poses[i], node.heading_change_rad, np.exp(log_scale) * node.length_m)
            residuals.append(_whitened(error, node.covariance))
        residuals += [
            np.array([_wrapped(poses[i, 2] - prior.heading_rad - (reference if prior.relative else 0.0))])
            / prior.sigma_rad
            for prior in node.priors
        ]
    off = [poses[i, :2] - fix.position_m for i, node in enumerate(timeline.nodes) for fix in node.fixes]
    if off:
        residuals.append(_whitened(np.concatenate(off), fix_covariance(timeline.fixes)))
    if len(state) > poses.size + 1:
        residuals.append(np.array([reference / VAGUE_SIGMA_RAD]))
    if timeline.closure_sigma_m is not None:
        residuals.append((poses[-1, :2] - poses[0, :2]) / timeline.closure_sigma_m)
    return np.concatenate(residuals)


def _logarithm(before: Array, after: Array, turn_rad: float, length_m: float) -> Array:
    """Logarithm of the pose `after` seen from where a step leads from `before`."""
    heading = before[2] + turn_rad
    c, s = np.cos(heading), np.sin(heading)
    off = after[:2] - before[:2] - length_m * np.array([c, s])
    angle = _wrapped(after[2] - heading)
    half = angle / 2.0
    along = half / np.tan(half) if abs(half) > 1e-9 else 1.0
    return np.array([*(np.array([[along, half], [-half, along]]) @ np.array([[c, s], [-s, c]]) @ off), angle])


def _whitened(error: Array, covariance: Array) -> Array:
    return np.asarray(np.linalg.solve(np.linalg.cholesky(covariance), error))


def _wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)
