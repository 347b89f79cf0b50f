"""Modes of a posterior of positions: connected regions with most of the probability."""

import numpy as np
from scipy import ndimage

from pdr_est.estimators.particle.cloud import NORTH, Cloud
from pdr_est.frames import Array
from pdr_est.types.on_plan.places import PlaceMode, PlacesAt

_CELL_M = 1.0  # of the histogram, and the standard deviation by which it is smoothed; half the width of a corridor
_COVERED = 0.99  # probability of all regions together
_LEAST = 0.01  # probability of a region that counts as a mode


def places_at(cloud: Cloud, time_s: float, walked_m: float) -> PlacesAt:
    """Return the places where the first device of particles may be."""
    return PlacesAt(time_s, walked_m, place_modes(cloud.device(0)[: NORTH + 1], cloud.weights))


def place_modes(position_m: Array, weights: Array) -> tuple[PlaceMode, ...]:
    """Find the modes of weighted positions.

    The modes are the connected parts of the smallest region that holds 99 % of a smoothed histogram.

    Parameters
    ----------
    position_m
        (2, n) east and north, m.
    weights
        (n,) weights, which add up to 1.

    Returns
    -------
    tuple of PlaceMode
        At least one mode, the most probable one first.
    """
    low = position_m.min(axis=1, keepdims=True) - 4.0 * _CELL_M
    column, row = ((position_m - low) / _CELL_M).astype(np.int64)
    rows, columns = int(row.max()) + 5, int(column.max()) + 5
    histogram = np.bincount(row * columns + column, weights, rows * columns).reshape(rows, columns)
    density = ndimage.gaussian_filter(histogram, 1.0, mode="constant", truncate=3.0)
    falling = np.sort(density, axis=None)[::-1]
    total = np.cumsum(falling)
    threshold = falling[np.searchsorted(total, _COVERED * total[-1])]
    region, count = ndimage.label(density >= max(threshold, 1e-12), np.ones((3, 3)))
    own = region[row, column]
    probability = np.bincount(own, weights, count + 1)[1:]
    best = int(probability.argmax())
    found = [number for number in np.argsort(-probability) if probability[number] >= _LEAST or number == best]
    return tuple(_mode(position_m[:, own == number + 1], weights[own == number + 1]) for number in found)


def _mode(position_m: Array, weights: Array) -> PlaceMode:
    """Return the mode of the positions (2, k) of a region and their weights (k,)."""
    probability = float(weights.sum())
    share = weights / probability
    mean = position_m @ share
    off = position_m - mean[:, None]
    variance_m2 = np.linalg.eigvalsh((share * off) @ off.T)[-1]
    return PlaceMode(min(probability, 1.0), (float(mean[0]), float(mean[1])), float(np.sqrt(max(variance_m2, 0.0))))
