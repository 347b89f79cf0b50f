"""Numbers of the floors, from the changes of height between them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.normal_distribution import normal_cdf

_STOREYS_M = np.arange(2.3, 8.01, 0.05)
_MOST_STOREYS = 60  # of a rise
_NUMBERS = np.arange(-_MOST_STOREYS, _MOST_STOREYS + 1)
_HIGHER_ODDS = 0.7  # of a rise by n + 1 storeys over one by n
_NEGLIGIBLE = 1e-7  # probability of a number of storeys


class Rise(NamedTuple):
    """Change of height from one floor to another, m, and its variance, m²."""

    rise_m: float
    variance_m2: float


@dataclass(frozen=True)
class StoreyCount:
    """Knowledge of the number of the floor and of the building, by the changes of height so far.

    How many storeys a rise is depends on how high the storeys of the building are, and every rise tells something
    about that. The storeys of a building are alike, and those of different buildings are not.

    Attributes
    ----------
    log_weight
        (m,) log of the probability of each height of a storey, up to a constant.
    floors
        (m, k) probability of each number of the floor, if a storey is so high.
    """

    log_weight: Array
    floors: Array

    @staticmethod
    def at_start(parameters: HeightParams) -> "StoreyCount":
        """Return what is known on the first floor, which has the number 0."""
        floors = np.zeros((len(_STOREYS_M), len(_NUMBERS)))
        floors[:, _MOST_STOREYS] = 1.0
        return StoreyCount(-0.5 * ((_STOREYS_M - parameters.storey_m) / parameters.sigma_storey_m) ** 2, floors)

    def after(self, rise: Rise, parameters: HeightParams) -> "StoreyCount":
        """Return what is known on the next floor."""
        spread = (
            np.abs(_NUMBERS) * parameters.sigma_within_m**2
            + (parameters.sigma_air * rise.rise_m) ** 2
            + 2.0 * parameters.sigma_level_m**2
            + rise.variance_m2
        )
        off = rise.rise_m - _STOREYS_M[:, None] * _NUMBERS
        likelihood = np.exp(-0.5 * off**2 / spread) / np.sqrt(spread) * _HIGHER_ODDS ** np.abs(_NUMBERS)
        total = np.maximum(likelihood.sum(axis=1, keepdims=True), 1e-300)
        return StoreyCount(self.log_weight + np.log(total[:, 0]), _sums(self.floors, likelihood / total))

    def number(self, building: "StoreyCount | None" = None) -> tuple[int, float]:
        """Return the most probable number of the floor, and its probability.

        Parameters
        ----------
        building
            What is known about the building, if that is more than what was known on this floor.
        """
        of_number = (self if building is None else building).weight @ self.floors
        return int(of_number.argmax()) - _MOST_STOREYS, float(of_number.max())

    @property
    def weight(self) -> Array:
        """Return the probability of each height of a storey (m,)."""
        weight = np.exp(self.log_weight - self.log_weight.max())
        return np.asarray(weight / weight.sum())

    @property
    def storey_m(self) -> float:
        """Return the expected height of a storey, m."""
        return float(self.weight @ _STOREYS_M)

    def storeys_of(self, rise: Rise) -> tuple[int, float]:
        """Return how many storeys above the last floor the nearest floor is in a move, and with what probability."""
        sigma_m = np.sqrt(max(rise.variance_m2, 1e-6))
        nearest = np.clip(np.rint(rise.rise_m / self.storey_m) + np.arange(-2, 3), -_MOST_STOREYS, _MOST_STOREYS)
        above = (nearest[:, None] + 0.5) * _STOREYS_M - rise.rise_m
        share = (normal_cdf(above / sigma_m) - normal_cdf((above - _STOREYS_M) / sigma_m)) @ self.weight
        best = int(share.argmax())
        return int(nearest[best]), float(share[best])


def floor_numbers(counts: Sequence[StoreyCount]) -> tuple[list[int], list[float]]:
    """Return the numbers of floors, one after the other, and their probabilities, by what the last one tells."""
    found = [count.number(counts[-1]) for count in counts]
    return [number for number, _ in found], [probability for _, probability in found]


def _sums(floors: Array, storeys: Array) -> Array:
    """Return the distributions (m, k) of sums of independent numbers, counted from the middle of the arrays."""
    both = np.zeros_like(floors)
    size = floors.shape[1]
    for place in np.flatnonzero(storeys.max(axis=0) > _NEGLIGIBLE):
        by = int(place) - _MOST_STOREYS
        to, of = slice(max(by, 0), size + min(by, 0)), slice(max(-by, 0), size - max(by, 0))
        both[:, to] += storeys[:, place, None] * floors[:, of]
    return both
