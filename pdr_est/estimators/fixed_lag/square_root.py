"""Least squares of a growing window by square roots: new variables are added, old ones forgotten, none is squared.

Standard deviations in a window range from a tenth of a millimetre to hundreds of metres, more than the normal
equations could hold. The window is therefore kept as the triangular factor R and the right side d of min |R x - d|²,
and each new measurement is merged into it by orthogonal transformations (square-root information filter, G. J.
Bierman, "Factorization Methods for Discrete Sequential Estimation", 1977).

Measurements concern the *present* variables only: the last pose of each device, and what lives on with the walk. When
a variable is followed by another one, its rows of R are complete. They stay for as long as something before them is
asked for, in the order in which the variables were followed, with a narrow band where they refer to each other.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dgeqrf, dtbtrs, dtrtrs

from pdr_est.frames import Array

_FIRST_CAPACITY, _FIRST_HEIGHT = 512, 16  # columns and rows of the band; both grow


@dataclass(frozen=True)
class PresentRows:
    """Rows of the variables that are present at some time: all that is known of them from what was measured by then.

    Attributes
    ----------
    root : (s, s) array
        Upper triangular factor.
    right : (s,) array
        Right side.
    complete : int
        Number of rows that were complete by then.
    born : tuple of int
        For each present variable the number of rows that were complete before it was added.
    """

    root: Array
    right: Array
    complete: int
    born: tuple[int, ...]


class SquareRootWindow:
    """Factor of a window.

    Parameters
    ----------
    known
        Rows of the variables that are present at its begin.
    """

    def __init__(self, known: PresentRows) -> None:
        size = len(known.right)
        self.present = known
        self._base = self._begin = known.complete  # number of the row that is the first in memory, and of use
        self._band = np.zeros((_FIRST_HEIGHT, _FIRST_CAPACITY), order="F")  # as LAPACK stores upper triangular bands
        self._side = np.zeros((_FIRST_CAPACITY, size))  # columns of the present variables
        self._right = np.zeros(_FIRST_CAPACITY)

    @property
    def begin(self) -> int:
        """Number of the first row that has not been forgotten."""
        return self._begin

    def merge(self, rows: Array, right: Array) -> None:
        """Add rows (m, s) of the present variables with right sides (m,)."""
        size = len(self.present.right)
        matrix = np.empty((size + len(right), size + 1), order="F")
        matrix[:size, :size], matrix[:size, size] = self.present.root, self.present.right
        matrix[size:, :size], matrix[size:, size] = rows, right
        factor = _triangular(matrix)
        root = np.triu(factor[:size, :size])
        self.present = PresentRows(root, factor[:size, size], self.present.complete, self.present.born)

    def follow(self, place: slice, before: Array, rows: Array, right: Array) -> int:
        """Put a new variable in the place of one of the same size k, and return the number of its first row.

        Parameters
        ----------
        place
            Its columns among the present variables.
        before
            Coefficients (m, k) of the variable that is followed.
        rows
            Coefficients (m, s) of the present variables, with the new one in its place.
        right
            Right sides (m,).
        """
        known, own, size = self.present, place.stop - place.start, len(self.present.right)
        matrix = np.empty((size + len(right), own + size + 1), order="F")
        matrix[:size, :own], matrix[size:, :own] = known.root[:, place], before
        matrix[:size, own:-1], matrix[size:, own:-1] = known.root, rows
        matrix[:size, own + place.start : own + place.stop] = 0.0
        matrix[:size, -1], matrix[size:, -1] = known.right, right
        factor = _triangular(matrix)
        self._complete(place, factor[:own])
        root = np.triu(factor[own : own + size, own:-1])
        first, born = known.complete, list(known.born)
        born[place] = [first] * own
        self.present = PresentRows(root, factor[own : own + size, -1], first + own, tuple(born))
        return first

    def forget(self, complete: int) -> None:
        """Forget the rows before one: what has been complete before is not asked for any more."""
        self._begin = max(complete, self._begin)
        unused, used = self._begin - self._base, self.present.complete - self._base
        if unused < _FIRST_CAPACITY // 2 or unused < used // 2:
            return
        kept = slice(unused, used)
        self._band[:, : used - unused] = self._band[:, kept].copy()
        self._side[: used - unused] = self._side[kept].copy()
        self._right[: used - unused] = self._right[kept].copy()
        self._base = self._begin

    def present_changes(self) -> Array:
        """Return the optimal present variables (s,).

        Raises
        ------
        ArithmeticError
            If they are not unique.
        """
        found = _solved(dtrtrs(self.present.root, self.present.right))
        if not np.isfinite(found).all():
            raise ArithmeticError("a pose is not finite")
        return found

    def complete_changes(self, present: Array) -> Array:
        """Return the optimal variables of all rows that are complete, given the present ones (s,)."""
        kept = self._in_memory(self._begin)
        if kept.start == kept.stop:
            return np.zeros(0)
        right = self._right[kept] - self._side[kept] @ present
        return _solved(dtbtrs(self._band[:, kept], right[:, None], uplo="U"))[:, 0]

    def of_complete(self, row: int, size: int) -> tuple[Array, Array]:
        """Return the optimal value (k,) of the variable whose first row is given, and its covariance (k, k)."""
        kept = self._in_memory(row)
        unit = np.zeros((kept.stop - kept.start, size), order="F")
        unit[range(size), range(size)] = 1.0
        along = _solved(dtbtrs(self._band[:, kept], unit, uplo="U", trans="T", overwrite_b=1))
        across = self._side[kept].T @ along
        carried = _solved(dtrtrs(self.present.root, across, trans=1))
        value = self._right[kept] @ along - self.present.right @ carried
        return value, along.T @ along + carried.T @ carried

    def of_present(self, place: slice) -> tuple[Array, Array]:
        """Return the optimal value (k,) of a present variable, and its covariance (k, k)."""
        unit = np.zeros((len(self.present.right), place.stop - place.start), order="F")
        unit[range(place.start, place.stop), range(unit.shape[1])] = 1.0
        carried = _solved(dtrtrs(self.present.root, unit, trans=1))
        return self.present.right @ carried, carried.T @ carried

    def _in_memory(self, row: int) -> slice:
        """Return where the rows from one on are."""
        return slice(max(row, self._begin) - self._base, self.present.complete - self._base)

    def _complete(self, place: slice, rows: Array) -> None:
        """Keep the rows (k, k + s + 1) of the variable in a place, which is about to be followed."""
        own, first = len(rows), self.present.complete - self._base
        born = max(self.present.born[place.start], self._begin) - self._base
        self._reserve(first + own, first + own - born)
        diagonal = len(self._band) - 1
        for i in range(own):
            column = self._band[:, first + i]
            column[:] = 0.0
            column[diagonal - i : diagonal + 1] = rows[: i + 1, i]
            column[diagonal - i - (first - born) : diagonal - i] = self._side[born:first, place.start + i]
        self._side[born:first, place] = 0.0
        self._side[first : first + own], self._right[first : first + own] = rows[:, own:-1], rows[:, -1]

    def _reserve(self, rows: int, height: int) -> None:
        """Make room for rows, and for columns of a height."""
        more_rows, more_height = rows > len(self._right), height > len(self._band)
        if more_height:
            wider = np.zeros((max(height, 2 * len(self._band)), self._band.shape[1]), order="F")
            wider[len(wider) - len(self._band) :] = self._band
            self._band = wider
        if more_rows:
            added = len(self._right)
            self._band = np.asfortranarray(np.pad(self._band, ((0, 0), (0, added))))
            self._side = np.pad(self._side, ((0, added), (0, 0)))
            self._right = np.pad(self._right, (0, added))


def present_rows(rows: Array, right: Array) -> PresentRows:
    """Make the rows of the variables at the begin of a window from those of their prior, (s, s) and (s,)."""
    size = len(right)
    factor = _triangular(np.column_stack([rows, right]))
    return PresentRows(np.triu(factor[:, :size]), factor[:, size], 0, (0,) * size)


def _triangular(matrix: Array) -> Array:
    """Return a matrix of the same products whose upper part is triangular; what is below it is of no use."""
    factor: Array = dgeqrf(np.asfortranarray(matrix), overwrite_a=1)[0]
    return factor


def _solved(found: tuple[Array, int]) -> Array:
    """Return the solution of a triangular system by LAPACK, or raise ArithmeticError."""
    solution, info = found
    if info:
        raise ArithmeticError(f"row {info} of the window is zero")
    return np.asarray(solution)
