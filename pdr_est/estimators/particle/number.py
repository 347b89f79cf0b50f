"""Number of particles that a posterior needs, after how far it is spread.

References
----------
D. Fox, "Adapting the sample size in particle filters through KLD-sampling", Int. J. Robotics Research 22 (2003).
"""

import numpy as np

from pdr_est.estimators.particle.cloud import DEVICE_ROWS, EAST, HEADING, NORTH, Cloud
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.frames import Array

_MOST_BINS = 2.0**40  # on each side of 0: far beyond what anybody walks, and an integer
_BIN_M, _BIN_RAD = 1.0, 0.35  # of the histogram: half the width of a corridor, and a quarter of a right angle
_ERROR = 0.1  # bound of the Kullback-Leibler distance to the histogram of the posterior
_FINER = 4  # times as many particles for the probabilities of places; ours, see `wanted_number`
_QUANTILE = 1.645  # of the normal distribution: the bound holds with a probability of 95 %


def wanted_number(cloud: Cloud, weights: Array, parameters: ParticleParams, anywhere: bool = False) -> int:
    """Return the number of particles to go on with, for their weights (n,).

    It is that of KLD sampling within the bounds of the settings. What began with more particles, because its start
    was open, loses at most half of those beyond the bound each time. A walk that may have begun `anywhere` on a plan
    gets more, for the probabilities of its places: of two equal buildings, each keeps half of the probability with a
    standard deviation of 0.06 over the random numbers (ten seeds).
    """
    probable = weights > 0.01 / len(weights)
    cells = np.zeros(int(probable.sum()), dtype=np.int64)
    for device in range(cloud.devices):
        for row, size in ((EAST, _BIN_M), (NORTH, _BIN_M), (HEADING, _BIN_RAD)):
            place = np.floor(cloud.state[DEVICE_ROWS * device + row, probable] / size)
            bins = np.clip(place, -_MOST_BINS, _MOST_BINS).astype(np.int64)
            cells = cells * 2053 + (bins - bins.min())
    wanted = kld_number(len(np.unique(cells)))
    if anywhere:
        most = max(parameters.most_particles, parameters.most_start_particles)
        return int(np.clip(_FINER * wanted, parameters.most_particles, most))
    most = max(parameters.most_particles, min(len(cloud), parameters.most_start_particles) // 2)
    return int(np.clip(wanted, parameters.least_particles, most))


def kld_number(bins: int) -> int:
    """Return the number of particles for which the histogram of so many occupied bins is as exact as wanted."""
    if bins < 2:
        return 1
    share = 2.0 / (9.0 * (bins - 1))
    return int(np.ceil((bins - 1) / (2.0 * _ERROR) * (1.0 - share + np.sqrt(share) * _QUANTILE) ** 3))
