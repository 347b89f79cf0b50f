"""Walks as one dense least-squares problem over all poses, the logarithm of the length scale and the direction that
relative heading priors count from: what the estimators must give."""

import numpy as np
from scipy.optimize import least_squares

from pdr_est.estimators.common.initial_state import VAGUE_SIGMA_RAD
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose


def solve_linear(timeline: Timeline, start: StartPose, sigma_scale: float) -> tuple[Array, Array]:
    """Normal equations of a straight walk east with an exact heading: all (x, y) and the logarithm of the scale.

    Returns the mean (2 n + 1,) and the covariance; the logarithm is last. Only it is not linear: the equations are
    solved again about each result. With sigma_scale 0 the scale is 1.
    """
    log_scale = 0.0
    for _ in range(100 if sigma_scale else 1):
        mean, covariance = _solve_about(log_scale, timeline, start, sigma_scale or 1e-12)
        log_scale = mean[-1]
    return mean, covariance


def _solve_about(log_scale: float, timeline: Timeline, start: StartPose, sigma_scale: float) -> tuple[Array, Array]:
    nodes = timeline.nodes
    size = 2 * len(nodes) + 1
    information, vector = np.zeros((size, size)), np.zeros(size)

    def add(rows: Array, value: Array, covariance: Array) -> None:
        nonlocal information, vector
        weight = np.linalg.inv(covariance)
        information = information + rows.T @ weight @ rows
        vector = vector + rows.T @ weight @ value

    def pick(i: int) -> Array:
        return np.eye(2, size, 2 * i)

    scale = np.eye(1, size, size - 1)
    assert start.position_m is not None
    add(pick(0), np.array(start.position_m), start.sigma_position_m**2 * np.eye(2))
    add(scale, np.zeros(1), np.array([[sigma_scale**2]]))
    for i, node in enumerate(nodes):
        if i:
            ahead = np.exp(log_scale) * np.array([[node.length_m], [0.0]])
            add(pick(i) - pick(i - 1) - ahead @ scale, ahead[:, 0] * (1.0 - log_scale), node.covariance[:2, :2])
        for fix in node.fixes:
            add(pick(i), fix.position_m, fix.covariance_m2)
    return np.linalg.solve(information, vector), np.linalg.inv(information)


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
        residuals += [_whitened(poses[i, :2] - fix.position_m, fix.covariance_m2) for fix in node.fixes]
        residuals += [
            np.array([_wrapped(poses[i, 2] - prior.heading_rad - (reference if prior.relative else 0.0))])
            / prior.sigma_rad
            for prior in node.priors
        ]
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
