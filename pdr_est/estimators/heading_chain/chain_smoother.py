"""Smooth the devices of a walk whose positions nothing measures, each by itself."""

from collections.abc import Sequence

import numpy as np

from pdr_est.estimators.common.initial_state import start_prior, starts_of
from pdr_est.estimators.common.motion_model import MIN_SIGMA, regular_covariances
from pdr_est.estimators.common.timeline import Timeline, track_from_nodes
from pdr_est.estimators.factor_graph.initial_values import with_headings
from pdr_est.estimators.heading_chain.chain import HeadingChain, NodePriors
from pdr_est.estimators.heading_chain.chain_marginals import PositionChain, marginals
from pdr_est.estimators.heading_chain.initial_headings import initial_headings
from pdr_est.frames import Array, rotate_vectors, wrap_angle
from pdr_est.types.measurements import DeviceTether, StartPose
from pdr_est.types.track import Track, concatenate

NAME = "factor-graph"
_SMALL_RAD = 1e-6


def positions_follow(timelines: Sequence[Timeline], tethers: Sequence[DeviceTether]) -> bool:
    """Tell whether nothing measures positions, so that they follow from the headings."""
    return not tethers and not any(one.fixes or one.closure_sigma_m is not None for one in timelines)


def estimate(
    timelines: Sequence[Timeline],
    start: StartPose,
    sigma_length_scale: float,
    start_headings_rad: Sequence[float | None] = (),
) -> Track:
    """Smooth the walk of devices whose positions nothing measures.

    Parameters
    ----------
    timelines
        Measurements of each device.
    start
        Start of the walk.
    sigma_length_scale
        Standard deviation of the walker's length scale, which nothing measures.
    start_headings_rad
        Heading of each device at the start to linearise at, where it is unknown; by default it is searched for.

    Returns
    -------
    Track
        Smoothed track with marginal covariances in the map frame: that of the factor graph.
    """
    starts = starts_of(timelines, start)
    near = with_headings(starts, start_headings_rad)
    return concatenate(
        [
            _smoothed(timeline, own, at, sigma_length_scale)
            for timeline, own, at in zip(timelines, starts, near, strict=True)
        ]
    )


def _smoothed(timeline: Timeline, start: StartPose, near: StartPose, sigma_length_scale: float) -> Track:
    """Smooth one device; `near` has the start heading to linearise at."""
    nodes, prior = timeline.nodes, start_prior(timeline, start, 0.0)
    initial_rad, reference_rad = initial_headings(timeline, near)
    sigmas = np.maximum(np.sqrt(np.diag(prior.state.covariance)[:3]), MIN_SIGMA)
    begin_rad = float(initial_rad[0] if prior.heading_open else prior.state.mean[2])
    turn_rad, length_m = np.array([(node.heading_change_rad, node.length_m) for node in nodes[1:]]).reshape(-1, 2).T
    covariance = regular_covariances(nodes)
    chain = HeadingChain(
        begin_rad, sigmas[2] ** 2, reference_rad, turn_rad, covariance[:, 2, 2], NodePriors.of_nodes(nodes)
    )
    heading_rad, reference_rad = chain.optimum(initial_rad, reference_rad)
    start_covariance = _start_covariance(sigmas, float(heading_rad[0]) - begin_rad)
    moves, positions = _positions(heading_rad, turn_rad, length_m, covariance, start_covariance)
    spread = marginals(chain, chain.weights(heading_rad, reference_rad), positions)
    ahead = rotate_vectors(np.stack([length_m, np.zeros_like(length_m)], axis=1), heading_rad[:-1] + turn_rad)
    per_log = np.concatenate([np.zeros((1, 2)), np.cumsum(ahead, axis=0)])
    spread[:, :2, :2] += sigma_length_scale**2 * per_log[:, :, None] * per_log[:, None, :]
    place = prior.state.mean[:2] + np.concatenate([np.zeros((1, 2)), np.cumsum(moves, axis=0)])
    return track_from_nodes(timeline, place, heading_rad, spread, "smoothed", NAME, (1.0, sigma_length_scale))


def _start_covariance(sigmas: Array, off_rad: float) -> Array:
    """Return the covariance (2, 2) of the first position, which is the same in both axes.

    The error of a pose in GTSAM is its logarithm, whose first two components are V⁻¹ t, with the displacement t and
    the matrix V of the heading's error a. V Vᵀ is the unit matrix times (sin(a/2) / (a/2))².
    """
    half = 0.5 * float(wrap_angle(off_rad))
    shrunk = np.sin(half) / half if abs(half) > _SMALL_RAD else 1.0
    return np.asarray(shrunk**2 * np.diag(sigmas[:2] ** 2))


def _positions(
    heading_rad: Array, turn_rad: Array, length_m: Array, covariance: Array, start_covariance: Array
) -> tuple[Array, PositionChain]:
    """Return the most probable moves (n - 1, 2) for given headings, and their linear dependence on the headings.

    The error of a step is the logarithm of its pose, whose first two components are V⁻¹ t, with the displacement t
    and the matrix V of the error of the turn. Given that error they have the mean and covariance of a regression.
    """
    off_rad = np.asarray(wrap_angle(np.diff(heading_rad) - turn_rad))
    aside = covariance[:, :2, 2] / covariance[:, 2:, 2]  # displacement per error of the turn, m/rad
    rest = covariance[:, :2, :2] - aside[:, :, None] * covariance[:, None, :2, 2]
    ahead_rad = heading_rad[:-1] + turn_rad
    small = np.abs(off_rad) < _SMALL_RAD
    safe = np.where(small, 1.0, off_rad)
    straight = np.where(small, 1.0, np.sin(safe) / safe)
    bent = np.where(small, 0.5 * off_rad, (1.0 - np.cos(safe)) / safe)
    curve = np.stack([straight, -bent, bent, straight], axis=1).reshape(-1, 2, 2)
    displaced = np.einsum("nij,nj->ni", curve, aside) * off_rad[:, None]
    displaced[:, 0] += length_m
    moves = rotate_vectors(displaced, ahead_rad)
    after = rotate_vectors(aside, heading_rad[1:])
    before = np.stack([-moves[:, 1], moves[:, 0]], axis=1) - after
    c, s = np.cos(ahead_rad), np.sin(ahead_rad)
    to_map = np.stack([c, -s, s, c], axis=1).reshape(-1, 2, 2) @ curve
    return moves, PositionChain(start_covariance, before, after, to_map @ rest @ to_map.transpose(0, 2, 1))
