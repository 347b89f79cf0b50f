"""Resampling that keeps particles at improbable places.

Among particles of a whole floor, those at the true place are often few for a long time: usual resampling loses them
by chance, and what is left becomes certain of a wrong place. Here places get particles after the square root of their
probability instead, and the particles of a place keep its probability in their weights.
"""

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.particle.cloud import EAST, HEADING, NORTH, Cloud
from pdr_est.frames import Array

_PLACE_M, _HEADING_RAD = 4.0, 0.7  # size of a place: of a hall, and of half a right angle; ours

_MOST_PLACES = 1_000_000  # that are counted one by one, occupied or not


def shares_by_place(cloud: Cloud, weights: Array) -> Array:
    """Return the probabilities (n,) with which particles of given weights (n,) are taken."""
    place = _places(cloud)
    probability = np.bincount(place, weights)
    share = weights / np.sqrt(np.maximum(probability, 1e-300))[place]
    return np.asarray(share / share.sum())


def _places(cloud: Cloud) -> NDArray[np.int64]:
    """Return the number (n,) of the place of each particle, by the first device."""
    rows = cloud.device(0)
    east, north = (np.floor((rows[row] - rows[row].min()) / _PLACE_M).astype(np.int64) for row in (EAST, NORTH))
    turns = int(np.ceil(2.0 * np.pi / _HEADING_RAD))
    heading = np.floor(np.mod(rows[HEADING], 2.0 * np.pi) / _HEADING_RAD).astype(np.int64)
    key = (north * (east.max() + 1) + east) * turns + heading
    if key.max() < _MOST_PLACES:
        return np.asarray(key)
    return np.asarray(np.unique(key, return_inverse=True)[1], dtype=np.int64)
