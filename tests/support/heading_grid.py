"""Posterior of a walk with an unknown start heading by summation over a fine grid: what a filter should find."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.common.timeline import Timeline
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose


@dataclass(frozen=True)
class GridPosterior:
    """Moments of the last pose, and the probability of each start heading.

    Attributes
    ----------
    headings_rad, probabilities
        Start headings (k,) and their probabilities (k,).
    mean_m, covariance_m2
        Mean (2,) and covariance (2, 2) of the last position.
    """

    headings_rad: Array
    probabilities: Array
    mean_m: Array
    covariance_m2: Array

    def probability_near(self, heading_rad: float, within_rad: float) -> float:
        """Return the probability of the start headings near a heading."""
        off = np.abs(np.angle(np.exp(1j * (self.headings_rad - heading_rad))))
        return float(self.probabilities[off < within_rad].sum())


def posterior_of(
    timeline: Timeline,
    start: StartPose,
    sigma_scale: float,
    turns_rad: Sequence[float] = (),
    headings: int = 1440,
    scales: int = 31,
) -> GridPosterior:
    """Sum over start heading and logarithm of the length scale; given these two, everything is linear and Gaussian.

    The steps must have isotropic noise and exact turns. turns_rad: turn of each node where it differs from the
    node's own.
    """
    assert start.position_m is not None
    nodes = timeline.nodes
    turns = np.array([node.heading_change_rad for node in nodes]) if not len(turns_rad) else np.asarray(turns_rad)
    ahead = np.exp(1j * np.cumsum(turns)) * np.array([node.length_m for node in nodes])
    way = np.cumsum(ahead)
    noise = np.cumsum([node.covariance[0, 0] for node in nodes])
    heading = np.linspace(-np.pi, np.pi, headings, endpoint=False)
    log_scale = np.linspace(-4.0 * sigma_scale, 4.0 * sigma_scale, scales) if sigma_scale else np.zeros(1)
    log_prior = -0.5 * (log_scale / sigma_scale) ** 2 if sigma_scale else np.zeros(1)
    similarity = np.exp(log_scale[None, :] + 1j * heading[:, None]).ravel()
    rows = [i for i, node in enumerate(nodes) for _ in node.fixes]
    fixes = [fix for node in nodes for fix in node.fixes]
    # One coordinate at a time: all noise is isotropic.
    spread = start.sigma_position_m**2 + np.minimum.outer(noise[rows], noise[rows])
    spread += np.diag([fix.covariance_m2[0, 0] for fix in fixes])
    across = start.sigma_position_m**2 + noise[rows]
    gain = np.linalg.solve(spread, across)
    origin = complex(*start.position_m)
    residual = np.array([complex(*fix.position_m) for fix in fixes]) - origin - similarity[:, None] * way[rows]
    squared = np.real(np.einsum("ki,ki->k", residual.conj(), np.linalg.solve(spread, residual.T).T))
    log_weight = np.tile(log_prior, headings) - 0.5 * squared
    weight = np.exp(log_weight - log_weight.max())
    weight /= weight.sum()
    last = origin + similarity * way[-1] + residual @ gain
    within = start.sigma_position_m**2 + noise[-1] - gain @ across
    mean = weight @ last
    apart = np.stack([(last - mean).real, (last - mean).imag], axis=1)
    covariance = within * np.eye(2) + np.einsum("k,ki,kj->ij", weight, apart, apart)
    by_heading = weight.reshape(headings, -1).sum(axis=1)
    return GridPosterior(heading, by_heading, np.array([mean.real, mean.imag]), covariance)
