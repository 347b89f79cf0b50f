"""Find the dominant directions of a building from the walls on its floor plan."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from types import MappingProxyType

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.floor_plan import FloorPlan

# Prior probability of each number of directions, as for walks; walls have no sense, so that the number is even.
_NUMBER_PRIOR: Mapping[int, float] = MappingProxyType({2: 0.15, 4: 0.55, 6: 0.05, 8: 0.05})
_PRIOR_OF_NONE = 1.0 - sum(_NUMBER_PRIOR.values())
_LEAST_PROBABILITY = 0.95  # of a number of directions, against the others and none; ours
_SIGMA_RAD = np.deg2rad(2.0)  # of walls along one direction: a corner drawn 10 cm off turns 3 m of wall by that much
_SHARES = np.linspace(0.05, 0.95, 19)  # of the length of all walls that follows the directions
_GRID_RAD = np.deg2rad(0.25)


@dataclass(frozen=True)
class WallDirections:
    """Directions at equal angles that the walls of a building follow.

    Attributes
    ----------
    number : int
        Number of directions.
    direction_rad : float
        One of them in the map, rad, counter-clockwise from east.
    share : float
        Share of the length of all walls that follows them.
    """

    number: int
    direction_rad: float
    share: float


def wall_directions(plan: FloorPlan) -> WallDirections | None:
    """Estimate the directions of the walls; None where they follow none, or where their number is open.

    A share of the walls follows one of the directions up to how exactly they are drawn, the others go anywhere.
    """
    along_m = plan.barriers_m[:, 1] - plan.barriers_m[:, 0]
    length_m = np.hypot(*along_m.T)
    if not length_m.any():
        return None
    heading_rad, weight = np.arctan2(along_m[:, 1], along_m[:, 0]), length_m / length_m.sum()
    independent = 1.0 / float((weight**2).sum())  # number of walls of equal length that would tell as much
    fits = {number: _fit(heading_rad, weight * independent, number) for number in _NUMBER_PRIOR}
    log_none = np.log(_PRIOR_OF_NONE) - independent * np.log(2.0 * pi)
    log_posterior = {
        number: log_evidence + np.log(_NUMBER_PRIOR[number]) for number, (log_evidence, _) in fits.items()
    }
    best = max(log_posterior, key=lambda number: log_posterior[number])
    log_total = np.logaddexp.reduce([log_none, *log_posterior.values()])
    return fits[best][1] if log_posterior[best] - log_total >= np.log(_LEAST_PROBABILITY) else None


def _fit(heading_rad: Array, weight: Array, number: int) -> tuple[float, WallDirections]:
    """Compute the log evidence of a number of directions, and the most probable ones.

    Parameters
    ----------
    heading_rad : ndarray
        Headings of the walls (n,), rad.
    weight : ndarray
        Number of walls (n,) that each stands for.
    number : int
        Number of directions.
    """
    spacing_rad = 2.0 * pi / number
    direction_rad = np.arange(0.0, spacing_rad, _GRID_RAD)
    off_rad = (heading_rad[:, None] - direction_rad + spacing_rad / 2.0) % spacing_rad - spacing_rad / 2.0
    follows = np.exp(-0.5 * (off_rad / _SIGMA_RAD) ** 2) / (np.sqrt(2.0 * pi) * _SIGMA_RAD * number)
    log_likelihood = np.stack([weight @ np.log(share * follows + (1.0 - share) / (2.0 * pi)) for share in _SHARES])
    share, place = np.unravel_index(np.argmax(log_likelihood), log_likelihood.shape)
    log_evidence = float(np.logaddexp.reduce(log_likelihood, axis=None) - np.log(log_likelihood.size))
    return log_evidence, WallDirections(number, float(direction_rad[place]), float(_SHARES[share]))
