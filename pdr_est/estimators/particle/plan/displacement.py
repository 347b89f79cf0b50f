"""Displacement of a floor plan against the frame of the walk, which particles learn from walls and fixes.

Most plans are as drawn, up to their standard deviation, which the raster of the plan accounts for. Others have a
wrong frame or scale: they are shifted, and stretched about the point that their frame is anchored at. That is the
origin of the map frame, or the corner of the plan that is nearest to it. Each particle says how its plan is
displaced: by three numbers, which are all 0 for a plan as drawn.
"""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array

SHARE_DISPLACED = 0.05
"""Probability that a plan is shifted or stretched; ours."""

_SIGMAS = np.array([[0.5], [0.5], [0.02]])  # shift to the east and north, m, and stretch; ours
_KERNEL = 0.1  # of resampled displacements, over their standard deviation
_BACKWARD_KERNEL = 0.2  # over their standard deviation, by which displacements along a path may differ
_LEAST = np.array([0.05, 0.05, 0.001])  # m, m and 1, by which they may differ at least
_APART = 1e-4  # variance of the indicator that a plan is displaced, so that no path changes it


def draw_displacements(count: int, rng: np.random.Generator) -> Array:
    """Draw displacements (3, count) of a plan before the walk: shift to the east and north, m, and stretch."""
    found = np.zeros((len(_SIGMAS), count))
    own = rng.random(count) < SHARE_DISPLACED
    found[:, own] = _SIGMAS * rng.standard_normal((len(_SIGMAS), int(own.sum())))
    return found


def shift_at(displacement: Array, position_m: Array, anchor_m: Array) -> Array:
    """Return by how much the plan lies beside positions (2, n) for displacements (3, n), m."""
    shift: Array = displacement[:2] + displacement[2] * (position_m - anchor_m[:, None])
    return shift


def roughened_displacement(displacement: Array, rng: np.random.Generator) -> Array:
    """Return displacements (3, n) of equally probable particles, moved by a slight kernel where there are any."""
    own = np.flatnonzero(_is_displaced(displacement))
    if len(own) < 2:
        return displacement
    before = displacement[:, own]
    mean, sigma = before.mean(axis=1, keepdims=True), before.std(axis=1, keepdims=True)
    found = displacement.copy()
    found[:, own] = mean + np.sqrt(1.0 - _KERNEL**2) * (before - mean)
    found[:, own] += _KERNEL * sigma * rng.standard_normal(before.shape)
    return found


def displacement_terms(path: Array, particles: Array) -> tuple[Array, Array]:
    """Return how well the displacements of particles (3, n) fit those of paths (3, m).

    Their differences have a normal distribution, and a plan that is displaced never follows one that is not.

    Returns
    -------
    Array, Array
        Terms (k, m) of the paths and factors (k, n) of the particles: the products are -2 times the log density.
    """
    displaced = _is_displaced(particles)
    spread = particles[:, displaced].std(axis=1) if displaced.any() else np.zeros(len(_SIGMAS))
    precision = 1.0 / np.array([_APART, *((_BACKWARD_KERNEL * spread) ** 2 + _LEAST**2)])[:, None]
    on_path = np.array([_is_displaced(path), *path], dtype=np.float64)
    own = np.array([displaced, *particles], dtype=np.float64)
    one = np.ones((1, own.shape[1]))
    factors = np.concatenate([one, -2.0 * precision * own, (precision * own**2).sum(axis=0, keepdims=True)])
    squares = (precision * on_path**2).sum(axis=0, keepdims=True)
    return np.concatenate([squares, on_path, np.ones((1, on_path.shape[1]))]), factors


def _is_displaced(displacement: Array) -> NDArray[np.bool_]:
    return np.asarray(displacement[2] != 0.0)
