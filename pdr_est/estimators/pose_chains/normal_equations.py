"""Least squares in the changes of poses that are connected to neighbours in time only, by a banded Cholesky factor.

In order of time all rows but those of the reference directions connect poses that are near each other. The normal
equations are then a band with a border, and their cost is linear in the length of a walk. They square the condition
number of the problem: positions are therefore unknowns relative to each other where nothing measures them
(`relative_positions`), and the solution is refined by what it leaves over, until that is nothing.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_solve, cholesky
from scipy.linalg.lapack import dpbtrf, dpbtrs

from pdr_est.estimators.pose_chains.band_marginals import covariances_in_time
from pdr_est.estimators.pose_chains.linear_rows import LinearRows
from pdr_est.estimators.pose_chains.relative_positions import RelativePositions
from pdr_est.frames import Array

_MOST_DIAGONALS = 200  # beyond them a band is no cheaper than an elimination without one; ours
_ROWS_AT_ONCE = 8192  # whose products are summed up together, which bounds the memory
_MOST_REFINEMENTS = 30
_REFINED = 1e-6  # last correction as a share of the change; what is left is about its square
_GOOD_ENOUGH = 1e-3  # likewise after the last refinement; Newton's next step makes up for the rest


class NotBandedError(ArithmeticError):
    """The normal equations have too wide a band, or are too ill-conditioned."""


@dataclass(frozen=True)
class _Places:
    """Places of the products of rows in the normal equations, those below the main diagonal left out.

    For band, border and corner: numbers of the products, and where they go; in the band that is the column and the
    distance from the main diagonal. `depth` is the largest such distance. Where the unknowns of all blocks follow the
    same pattern, `first` (m,) has the first one of each block, and `band` is that of one block, relative to it.
    """

    band: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]
    border: tuple[NDArray[np.int64], NDArray[np.int64]]
    corner: tuple[NDArray[np.int64], NDArray[np.int64]]
    depth: int
    first: NDArray[np.int32] | None = None

    def in_band(self, product: Array) -> tuple[Array, NDArray[np.int64], NDArray[np.int32]]:
        """Return the products in the band, their columns, and their distances from the main diagonal."""
        chosen, column, apart = self.band
        if self.first is None:
            return product[chosen], column.astype(np.int64), apart
        columns = self.first[:, None].astype(np.int64) + column
        own = product.reshape(len(self.first), -1)[:, chosen]
        return own.ravel(), columns.ravel(), np.broadcast_to(apart, columns.shape).ravel()


@dataclass(frozen=True)
class NormalEquations:
    """Sums of products of rows.

    Attributes
    ----------
    rows
        The rows.
    heading_rad
        Headings (n,) of the poses that they are linearised at.
    band
        For each column (n, d) what is on and below the main diagonal.
    border
        Rows (n, e) that the unknowns of the border have in common with the others.
    corner
        Those among themselves (e, e), below the main diagonal.
    """

    rows: tuple[LinearRows, ...]
    heading_rad: Array
    band: Array
    border: Array
    corner: Array

    def __add__(self, other: "NormalEquations") -> "NormalEquations":
        """Return the equations of the rows of both."""
        narrow, wide = sorted((self.band, other.band), key=lambda one: one.shape[1])
        band = wide.copy()
        band[:, : narrow.shape[1]] += narrow
        rows = (*self.rows, *other.rows)
        return NormalEquations(rows, self.heading_rad, band, self.border + other.border, self.corner + other.corner)


class Elimination:
    """Makes and solves normal equations.

    Parameters
    ----------
    order
        Numbers of all poses in the order of elimination. Those of the border come last.
    border
        Number of poses in the border, which may be connected to any other.
    relative
        Whether nothing measures positions but priors at the start, so that only their differences matter.
    """

    def __init__(self, order: Sequence[int], border: int, relative: bool = False) -> None:
        rank = np.empty(len(order), dtype=np.int64)
        rank[np.asarray(order)] = np.arange(len(order))
        self._unknowns = 3 * rank[:, None] + np.arange(3)  # by pose
        self._inner, self._outer = 3 * (len(order) - border), 3 * border
        self._known: dict[int, tuple[NDArray[np.int64], list[_Places]]] = {}
        most_poses = _MOST_DIAGONALS // 3
        self._relative = RelativePositions(order[: len(order) - border], most_poses) if relative else None

    def equations(
        self, given: Sequence[LinearRows], heading_rad: Array, keep_places: bool = False
    ) -> NormalEquations:
        """Sum up rows.

        Parameters
        ----------
        given
            Rows.
        heading_rad
            Headings (n,) of the poses that they are linearised at.
        keep_places
            Whether rows concern the same poses again and again, which are the same array.

        Raises
        ------
        NotBandedError
            If rows connect poses that are far from each other.
        """
        inner, outer = self._inner, self._outer
        unknown = [
            each for one in given if len(one.pose) for each in self._of_unknowns(one, heading_rad, keep_places)
        ]
        parts = [part for one in unknown for part in self._parts(one, keep_places)]
        depth = max((places.depth for _, places in parts), default=0) + 1
        band, border, corner = np.zeros(inner * depth), np.zeros(inner * outer), np.zeros(outer * outer)
        for one, places in parts:
            product = (one.jacobian.transpose(0, 2, 1) @ one.jacobian).ravel()
            own, column, apart = places.in_band(product)
            if len(own):
                begin = int(column.min())
                found = np.bincount((column - begin) * depth + apart, own)
                band[begin * depth : begin * depth + len(found)] += found
            for total, (numbers, place) in ((border, places.border), (corner, places.corner)):
                if len(numbers):
                    total += np.bincount(place, product[numbers], len(total))
        return NormalEquations(
            tuple(one for one, _ in parts),
            heading_rad,
            band.reshape(inner, depth),
            border.reshape(inner, outer),
            corner.reshape(outer, outer),
        )

    def solution(self, equations: NormalEquations) -> Array:
        """Return the changes (n, 3) of least error.

        Raises
        ------
        NotBandedError
            If the refinement does not converge: the problem has no unique solution within rounding.
        """
        inner, factor = self._inner, self._factor(equations)
        across, root = self._border(factor, equations) if self._outer else (equations.border, None)

        def solved(pull: Array) -> Array:
            found = np.empty_like(pull)
            found[:inner] = dpbtrs(factor, pull[:inner], lower=1)[0]
            if root is not None:
                found[inner:] = cho_solve((root, True), pull[inner:] - equations.border.T @ found[:inner])
                found[:inner] -= across @ found[inner:]
            return found

        change = np.asarray(self._refined(equations.rows, solved)[self._unknowns])
        return change if self._relative is None else self._relative.absolute(change, equations.heading_rad)

    def covariances(self, equations: NormalEquations) -> Array:
        """Return the covariances (n, 3, 3) of east m, north m, heading rad.

        They are those for known variables of the border, and the share of these.

        Raises
        ------
        NotBandedError
            For absolute positions, or if the problem has no unique solution within rounding.
        """
        if self._relative is None:
            raise NotBandedError("covariances need relative positions")
        factor = self._factor(equations)
        found = self._relative.by_number(covariances_in_time(factor))
        if self._outer:
            across, root = self._border(factor, equations)
            moved = self._relative.in_map(across[self._unknowns[: len(found)]])
            found += moved @ cho_solve((root, True), np.eye(self._outer)) @ moved.transpose(0, 2, 1)
        return found

    def _factor(self, equations: NormalEquations) -> Array:
        """Return the Cholesky factor of the band."""
        factor, info = dpbtrf(equations.band.T, lower=1)
        if info:
            raise NotBandedError("the band has no Cholesky factor")
        return np.asarray(factor)

    def _border(self, factor: Array, equations: NormalEquations) -> tuple[Array, Array]:
        """Return minus the change (n, e) of all other variables with those of the border, and the latter's factor."""
        across = np.asarray(dpbtrs(factor, equations.border, lower=1)[0])
        try:
            return across, cholesky(equations.corner - np.tril(equations.border.T @ across), lower=True)
        except LinAlgError as error:
            raise NotBandedError("the border has no Cholesky factor") from error

    def _of_unknowns(self, given: LinearRows, heading_rad: Array, keep: bool) -> list[LinearRows]:
        """Return rows in the unknowns of the normal equations."""
        rows = [given] if self._relative is None else self._relative.rows(given, heading_rad, keep)
        if rows is None:
            raise NotBandedError("rows over too many poses")
        return rows

    def _refined(self, rows: Sequence[LinearRows], solved: Callable[[Array], Array]) -> Array:
        """Solve the least squares of rows by conjugate gradients; `solved` solves their normal equations roughly."""
        change = np.zeros(self._inner + self._outer)
        pull = self._pull(rows, change[self._unknowns])
        direction = preconditioned = solved(pull)
        worth = float(pull @ preconditioned)
        if worth <= 0.0:
            return change
        for _ in range(_MOST_REFINEMENTS):
            along = sum(float(np.sum(one.product(direction[self._unknowns]) ** 2)) for one in rows)
            step = float(pull @ direction) / along * direction
            change = change + step
            if np.abs(step).max() <= _REFINED * np.abs(change).max():
                return change
            before, pull = pull, self._pull(rows, change[self._unknowns])
            preconditioned = solved(pull)
            turned, worth = float(preconditioned @ (pull - before)) / worth, float(pull @ preconditioned)
            direction = preconditioned + max(turned, 0.0) * direction
            if worth <= 0.0:
                break
        if np.abs(step).max() <= _GOOD_ENOUGH * np.abs(change).max():
            return change
        raise NotBandedError("the refinement does not converge")

    def _pull(self, rows: Sequence[LinearRows], change: Array) -> Array:
        """Return the right side of the normal equations of what is left over after a change (n, 3)."""
        pull = np.zeros(self._inner + self._outer)
        for one in rows:
            products = (one.left_over(change)[:, None, :] @ one.jacobian).ravel()
            pull += np.bincount(self._unknowns[one.pose].ravel(), products, len(pull))
        return pull

    def _parts(self, rows: LinearRows, keep: bool) -> list[tuple[LinearRows, _Places]]:
        """Divide rows into parts whose products fit into little memory, and find the places of these."""
        known = self._known.get(id(rows.pose))
        begins = range(0, len(rows.pose), _ROWS_AT_ONCE)
        own = [slice(begin, begin + _ROWS_AT_ONCE) for begin in begins]
        places = [self._places(rows.pose[one]) for one in own] if known is None else known[1]
        if keep:
            self._known[id(rows.pose)] = rows.pose, places  # the array is kept, so that its id stays its own
        parts = [LinearRows(rows.pose[one], rows.jacobian[one], rows.right[one]) for one in own]
        return list(zip(parts, places, strict=True))

    def _places(self, pose: NDArray[np.int64]) -> _Places:
        """Find the places of the products of rows in the changes of poses (m, k)."""
        inner = self._inner
        unknown = self._unknowns[pose].reshape(len(pose), -1)
        first, alike = unknown[:, :1], unknown[:1] - unknown[0, 0]
        if unknown.max() < inner and (unknown - first == alike).all():
            one, none = self._places_of(alike - alike.min()), (np.zeros(0, dtype=np.int64),) * 2
            return _Places(one.band, none, none, one.depth, (first[:, 0] + alike.min()).astype(np.int32))
        return self._places_of(unknown)

    def _places_of(self, unknown: NDArray[np.int64]) -> _Places:
        """Find the places of the products of rows in unknowns (m, 3 k)."""
        inner, outer = self._inner, self._outer
        row, column = np.broadcast_arrays(unknown[:, :, None], unknown[:, None, :])
        i, j = row.ravel(), column.ravel()
        in_band = np.flatnonzero((i >= j) & (i < inner))
        apart = i[in_band] - j[in_band]
        depth = int(apart.max(initial=0))
        if depth > _MOST_DIAGONALS:
            raise NotBandedError(f"{depth} diagonals")
        in_border, in_corner = np.flatnonzero((i >= inner) & (j < inner)), np.flatnonzero((i >= j) & (j >= inner))
        return _Places(
            (in_band.astype(np.int32), j[in_band].astype(np.int32), apart.astype(np.int32)),
            (in_border, j[in_border] * outer + i[in_border] - inner),
            (in_corner, (i[in_corner] - inner) * outer + j[in_corner] - inner),
            depth,
        )
