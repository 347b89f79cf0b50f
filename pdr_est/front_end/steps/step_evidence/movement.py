"""Measure the movement of a phone in any span of the recent past, from running sums."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.sensors import LevelBlock

MOVEMENT_COLUMNS = 14
ACCELERATION_COLUMNS, UP_COLUMNS = slice(0, 3), slice(6, 9)
_VERTICAL, _SQUARE, _VERTICAL_SQUARE = 3, 4, 5
_FIRST_PRODUCTS, _SECOND_PRODUCTS = slice(9, 12), slice(12, 14)  # of the upward components: xx, xy, xz; yy, yz
_HALVED_COLUMNS, _WHOLE_COLUMNS = range(4), range(4, MOVEMENT_COLUMNS)  # columns by halves of a span, and as a whole
_LEAST_STRENGTH_MPS2 = 0.02  # below the noise of phones
_SMOOTHING_S = 0.1  # averages out what engines and wheels shake above the frequencies of gait


class Movement(NamedTuple):
    """Movement of a phone in the recent past.

    Attributes
    ----------
    acceleration_mps2 : float
        Standard deviation of the acceleration within half of the time, all directions together, m/s^2.
    vertical_share : float
        Share of the vertical direction in its square, 0 to 1.
    sideways_tilt_rad : float
        Standard deviation of the tilt across the direction in which the phone tilts most, rad. A limb swings in one
        plane, so that a phone on it has little of it; a phone that is turned over in a hand has much.
    """

    acceleration_mps2: float
    vertical_share: float
    sideways_tilt_rad: float


class MovementSums:
    """Running sums over a segment, from differences of which the movement in any span follows.

    Parameters
    ----------
    rate_hz : float
        Sampling rate.
    """

    def __init__(self, rate_hz: float) -> None:
        self._width = max(round(_SMOOTHING_S * rate_hz), 1)
        self.reset()

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self._latest: Array | None = None  # (3, width - 1) acceleration at the latest samples
        self._last: Array = np.zeros((MOVEMENT_COLUMNS, 1))

    def push(self, block: LevelBlock) -> Array:
        """Return the sums (n, MOVEMENT_COLUMNS) up to and with each sample of a block."""
        rows = np.empty((MOVEMENT_COLUMNS, len(block) + 1))
        rows[:, :1] = self._last
        acceleration, up = rows[ACCELERATION_COLUMNS, 1:], rows[UP_COLUMNS, 1:]
        acceleration[...] = self._smoothed(block.acceleration_mps2)
        up[...] = block.up.T
        np.einsum("ij,ij->j", acceleration, acceleration, out=rows[_SQUARE, 1:])
        vertical = rows[_VERTICAL, 1:]
        np.einsum("ij,ij->j", acceleration, up, out=vertical)
        np.multiply(vertical, vertical, out=rows[_VERTICAL_SQUARE, 1:])
        # The products of the components; that of the third one follows from the length of the unit vector.
        np.multiply(up[0], up, out=rows[_FIRST_PRODUCTS, 1:])
        np.multiply(up[1], up[1:], out=rows[_SECOND_PRODUCTS, 1:])
        # The carry is the first term of the sum, so that the order of the additions does not depend on the cuts.
        sums: Array = np.cumsum(rows, axis=1, out=rows)
        self._last = sums[:, -1:].copy()
        return sums[:, 1:].T

    def _smoothed(self, acceleration: Array) -> Array:
        """Average the latest samples of the acceleration (n, 3); the first one lasted for ever. Return (3, n)."""
        count, width = len(acceleration), self._width
        if not count:
            return np.empty((3, 0))
        if self._latest is None:
            self._latest = np.repeat(acceleration[:1].T, width - 1, axis=1)
        known = np.concatenate([self._latest, acceleration.T], axis=1)
        self._latest = known[:, count:]
        # Every mean has a sum of its own, so that it does not depend on the cuts.
        total = known[:, :count].copy()
        for first in range(1, width):
            total += known[:, first : first + count]
        total /= width
        return total


class _Operations(NamedTuple):
    """Operations on one number, or on arrays of numbers; the rounding is the same."""

    root: Callable[[Any], Any]
    larger: Callable[[Any, Any], Any]
    smaller: Callable[[Any, Any], Any]


_ON_NUMBERS = _Operations(math.sqrt, max, min)
_ON_ARRAYS = _Operations(np.sqrt, np.maximum, np.minimum)


def movement_between(before: Array, middle: Array, end: Array, samples: int) -> Movement:
    """Compute the movement in a span from the running sums before it, in its middle and at its end.

    Parameters
    ----------
    before, middle, end : ndarray, shape (MOVEMENT_COLUMNS,)
        Rows that `MovementSums` returned.
    samples : int
        Number of samples of the span, at least 1.
    """
    return Movement(*_movement(before.tolist(), middle.tolist(), end.tolist(), 1.0 / samples, _ON_NUMBERS))


def movements_between(before: Array, middle: Array, end: Array, samples: NDArray[np.intp]) -> list[Movement]:
    """Compute `movement_between` of n spans at once, from (n, MOVEMENT_COLUMNS) and (n,)."""
    found = _movement(before.T, middle.T, end.T, 1.0 / samples, _ON_ARRAYS)
    return [Movement(*numbers) for numbers in zip(*(column.tolist() for column in found), strict=True)]


def _movement(a: Any, b: Any, c: Any, share: Any, on: _Operations) -> tuple[Any, Any, Any]:
    """Compute the fields of `Movement`; a, b and c are sequences of MOVEMENT_COLUMNS numbers or arrays."""
    squares, vertical_squares, x, y, z, xx, xy, xz, yy, yz = [(c[k] - a[k]) * share for k in _WHOLE_COLUMNS]
    # Each half has its own mean, so that a slow acceleration, such as a vehicle's, does not count.
    ax, ay, az, av = [(b[k] - a[k]) * (b[k] - a[k]) + (c[k] - b[k]) * (c[k] - b[k]) for k in _HALVED_COLUMNS]
    variance = on.larger(squares - 2.0 * share * share * (ax + ay + az), _LEAST_STRENGTH_MPS2**2)
    vertical = vertical_squares - 2.0 * share * share * av
    zz = 1.0 - xx - yy - z * z
    xx, xy, xz, yy, yz = xx - x * x, xy - x * y, xz - x * z, yy - y * y, yz - y * z
    # The third principal axis is along the vectors, where unit vectors hardly vary: two eigenvalues are left.
    total, product = xx + yy + zz, xx * yy + (xx + yy) * zz - xy * xy - yz * yz - xz * xz
    least = 0.5 * (total - on.root(on.larger(total * total - 4.0 * product, 0.0)))
    vertical_share = on.smaller(on.larger(vertical / variance, 0.0), 1.0)
    return on.root(variance), vertical_share, on.root(on.larger(least, 0.0))


def strength_between(before: Array, end: Array, samples: int) -> float:
    """Compute the standard deviation of the acceleration in a span, all directions together, m/s^2.

    Parameters
    ----------
    before, end : ndarray, shape (MOVEMENT_COLUMNS,)
        Rows that `MovementSums` returned.
    samples : int
        Number of samples of the span, at least 1.
    """
    return float(_strength(before.tolist(), end.tolist(), samples, _ON_NUMBERS))


def strengths_between(before: Array, end: Array, samples: NDArray[np.intp]) -> list[float]:
    """Compute `strength_between` of n spans at once, from (n, MOVEMENT_COLUMNS) and (n,)."""
    found: list[float] = _strength(before.T, end.T, samples, _ON_ARRAYS).tolist()
    return found


def _strength(first: Any, last: Any, samples: Any, on: _Operations) -> Any:
    x, y, z, square = last[0] - first[0], last[1] - first[1], last[2] - first[2], last[_SQUARE] - first[_SQUARE]
    variance = (square - (x * x + y * y + z * z) / samples) / samples
    return on.root(on.larger(variance, _LEAST_STRENGTH_MPS2**2))
