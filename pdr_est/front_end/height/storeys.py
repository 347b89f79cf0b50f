"""Numbers of the floors, from the changes of height between them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.height.height_params import HeightParams

_STOREYS_M = np.arange(2.3, 8.01, 0.05)
_MOST_STOREYS = 60  # of a rise
_HIGHER_ODDS = 0.7  # of a rise by n + 1 storeys over one by n


class Rise(NamedTuple):
    """Change of height from one floor to another, m, and its variance, m²."""

    rise_m: float
    variance_m2: float


def floor_numbers(rises: list[Rise], parameters: HeightParams) -> tuple[NDArray[np.int64], Array]:
    """Find the numbers of the floors between changes of height, counted from the first floor, which is 0.

    How many storeys a rise is depends on how high the storeys of the building are, and every rise tells something
    about that. The storeys of a building are alike, and those of different buildings are not.

    Parameters
    ----------
    rises
        The n changes of height, in order of time.
    parameters
        Heights of storeys.

    Returns
    -------
    number, probability : ndarray
        (n + 1,) most probable numbers, and the probabilities of these.
    """
    storeys = np.arange(-_MOST_STOREYS, _MOST_STOREYS + 1)
    floors = np.zeros((len(_STOREYS_M), len(storeys)))  # probability of each number, by the height of a storey
    floors[:, _MOST_STOREYS] = 1.0
    log_weight = -0.5 * ((_STOREYS_M - parameters.storey_m) / parameters.sigma_storey_m) ** 2
    passed = []
    for rise in rises:
        spread = (
            np.abs(storeys) * parameters.sigma_within_m**2
            + (parameters.sigma_air * rise.rise_m) ** 2
            + 2.0 * parameters.sigma_level_m**2
            + rise.variance_m2
        )
        off = rise.rise_m - _STOREYS_M[:, None] * storeys
        likelihood = np.exp(-0.5 * off**2 / spread) / np.sqrt(spread) * _HIGHER_ODDS ** np.abs(storeys)
        total = np.maximum(likelihood.sum(axis=1, keepdims=True), 1e-300)
        log_weight += np.log(total[:, 0])
        passed.append(likelihood / total)
    weight = np.exp(log_weight - log_weight.max())
    weight /= weight.sum()
    number, probability = [0], [1.0]
    for share in passed:
        floors = _sums(floors, share)
        of_number = weight @ floors
        number.append(int(of_number.argmax()) - _MOST_STOREYS)
        probability.append(float(of_number.max()))
    return np.array(number, dtype=np.int64), np.array(probability)


def _sums(floors: Array, storeys: Array) -> Array:
    """Return the distributions (m, n) of sums of independent numbers, counted from the middle of the arrays."""
    both = [np.convolve(one, other, mode="same") for one, other in zip(floors, storeys, strict=True)]
    return np.array(both)
