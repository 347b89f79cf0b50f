"""Height of the walker over time, and the floors: what the air pressure tells."""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pdr_est.frames import Array


class MoveKind(StrEnum):
    """The way a walker changes height."""

    STAIRS = "stairs"
    ESCALATOR = "escalator"
    LIFT = "lift"


@dataclass(frozen=True)
class VerticalMove:
    """Change of height from one level to another.

    Attributes
    ----------
    begin_s, end_s
        Times of begin and end, s.
    kind
        The most probable kind.
    rise_m, sigma_m
        Change of height, upwards positive, and its standard deviation, m.
    """

    begin_s: float
    end_s: float
    kind: MoveKind
    rise_m: float
    sigma_m: float


@dataclass(frozen=True)
class WalkerHeight:
    """Height and floor of the walker at one time.

    Attributes
    ----------
    time_s
        Time, s.
    height_m, sigma_m
        Height above the floor at the start, and its standard deviation, m.
    floor
        Number of the nearest floor, counted from that at the start, which is 0.
    floor_probability
        Probability of that number.
    moving
        True on stairs, an escalator or a lift.
    """

    time_s: float
    height_m: float
    sigma_m: float
    floor: int
    floor_probability: float
    moving: bool = False

    def equals(self, other: "WalkerHeight | None") -> bool:
        """Tell whether height and floor are the same at another time."""
        return other is not None and replace(other, time_s=self.time_s) == self


@dataclass(frozen=True)
class HeightProfile:
    """Height and floor of the walker, second by second.

    Attributes
    ----------
    time_s
        (n,) s, in order.
    height_m
        (n,) m above the floor at the start.
    sigma_m
        (n,) m, standard deviation of the height.
    floor
        (n,) number of the nearest floor, counted from that at the start, which is 0.
    floor_probability
        (n,) probability of that number.
    moves
        Changes of height, in order.
    """

    time_s: Array
    height_m: Array
    sigma_m: Array
    floor: NDArray[np.int64]
    floor_probability: Array
    moves: tuple[VerticalMove, ...] = ()

    @property
    def moving(self) -> NDArray[np.bool_]:
        """Seconds in which the walker changes height (n,)."""
        found = np.zeros(len(self.time_s), dtype=np.bool_)
        for move in self.moves:
            found |= (self.time_s >= move.begin_s) & (self.time_s < move.end_s)
        return found

    def nearest(self, time_s: ArrayLike) -> NDArray[np.intp]:
        """Return the places (k,) of the seconds that are nearest to some times (k,), s."""
        wanted = np.asarray(time_s, dtype=np.float64)
        after = np.clip(np.searchsorted(self.time_s, wanted), 1, max(len(self.time_s) - 1, 1))
        if len(self.time_s) == 1:
            return np.zeros(len(wanted), dtype=np.intp)
        nearer_before = wanted - self.time_s[after - 1] < self.time_s[after] - wanted
        places: NDArray[np.intp] = np.where(nearer_before, after - 1, after)
        return places
