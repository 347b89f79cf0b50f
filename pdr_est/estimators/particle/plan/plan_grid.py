"""Raster of a floor plan: how probable it is that a point is walkable, for many points at once.

The plan is drawn into square cells by the even-odd rule. The drawing may be off by its standard deviation; blurring
the raster by a Gaussian of that size gives, at each point, the probability that the point is walkable when the
drawing is shifted by such an error: beside a long wall it is the normal distribution function of the distance to it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from pdr_est.errors import EstimationError
from pdr_est.frames import Array
from pdr_est.types.floor_plan import FloorPlan

_MARGIN_CELLS = 2
_MOST_CELLS = 40_000_000  # which bounds the memory


@dataclass(frozen=True)
class PlanGrid:
    """Raster of a floor plan.

    Attributes
    ----------
    walkable
        (rows, columns) probability that the centre of a cell is walkable; row 0 is the southernmost. The outermost
        cells are not walkable.
    origin_m
        (2,) east and north of the south-western corner, m.
    cell_m
        Size of a cell, m.
    """

    walkable: NDArray[np.float32]
    origin_m: Array
    cell_m: float

    def at(self, east_m: Array, north_m: Array) -> NDArray[np.float32]:
        """Return the probability that points (any shape) are walkable; it is 0 outside the plan."""
        return self.in_cells(self.cells(np.array([east_m, north_m])))

    def cells(self, position_m: Array) -> NDArray[np.float32]:
        """Return column and row (2, ...) of positions (2, ...), in cells.

        Those outside the raster are moved to its border, where no cell is walkable, so that straight ways between
        them stay inside.
        """
        rows, columns = self.walkable.shape
        shape = 2, *[1] * (position_m.ndim - 1)
        found = ((position_m - self.origin_m.reshape(shape)) * (1.0 / self.cell_m)).astype(np.float32)
        last = np.array([columns - 0.5, rows - 0.5], dtype=np.float32).reshape(shape)
        return np.minimum(np.maximum(found, np.float32(0.0), out=found), last, out=found)

    def in_cells(self, cells: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the probability that points (2, ...), in cells as `cells` returns them, are walkable."""
        column, row = cells.astype(np.int32)
        row *= self.walkable.shape[1]
        row += column
        found: NDArray[np.float32] = self.walkable.ravel().take(row)
        return found

    def along(self, begin: NDArray[np.float32], end: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the least probability of a point on each of many straight ways, without their beginnings.

        Parameters
        ----------
        begin, end
            (2, ...) ends of the ways, in cells as `cells` returns them. The points of a way are at most a cell apart.
        """
        way = end - begin
        squared = way * way
        points = max(int(np.ceil(np.sqrt((squared[0] + squared[1]).max(initial=0.0)))), 1)
        share = np.arange(1, points + 1, dtype=np.float32) / np.float32(points)
        cells = np.multiply.outer(share, way)
        cells += begin
        least: NDArray[np.float32] = self.in_cells(np.moveaxis(cells, 1, 0)).min(axis=0)
        return least


Window = tuple[Array, Array]
"""South-western and north-eastern corner of a part of a plan, m."""


def grid_of(plan: FloorPlan, cell_m: float, window_m: Window | None = None) -> PlanGrid:
    """Draw a floor plan into a raster, or the part of it inside a window.

    Raises EstimationError for a plan without area, and for one that is too large for cells of that size.
    """
    outlines = [np.asarray(ring, dtype=np.float64) for ring in plan.rings_m() if len(ring) >= 3]
    if not outlines:
        raise EstimationError(f"floor plan {plan.name!r} has no walkable area: give it at least one outline")
    corners = np.concatenate(outlines)
    low, high = corners.min(axis=0), corners.max(axis=0)
    if window_m is not None:
        low, high = np.clip(window_m[0], low, high), np.clip(window_m[1], low, high)
    margin_m = (_MARGIN_CELLS + np.ceil(3.0 * plan.sigma_m / cell_m)) * cell_m
    origin_m = low - margin_m
    columns, rows = (int(n) for n in np.ceil((high - low + 2.0 * margin_m) / cell_m) + 1)
    if rows * columns > _MOST_CELLS:
        raise EstimationError(
            f"floor plan {plan.name!r} is {high[0] - low[0]:.0f} m by {high[1] - low[1]:.0f} m: too large for cells "
            f"of {cell_m} m; check its units, or set estimator.particle.cell_m"
        )
    inside = _filled([(ring - origin_m) / cell_m for ring in outlines], rows, columns)
    walkable = inside.astype(np.float32)
    if plan.sigma_m > 0.0:
        ndimage.gaussian_filter(walkable, plan.sigma_m / cell_m, output=walkable, mode="constant", truncate=3.0)
    walls = np.asarray(plan.walls_m, dtype=np.float64).reshape(-1, 2, 2)
    _draw_walls(walkable, (walls - origin_m) / cell_m)
    walkable[[0, -1]] = 0.0
    walkable[:, [0, -1]] = 0.0
    return PlanGrid(walkable, origin_m, cell_m)


def _filled(rings: list[Array], rows: int, columns: int) -> NDArray[np.bool_]:
    """Return which cells (rows, columns) have their centre inside an odd number of rings (n, 2), in cells."""
    begin = np.concatenate(rings)
    end = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    low, high = np.minimum(begin[:, 1], end[:, 1]), np.maximum(begin[:, 1], end[:, 1])
    first = np.ceil(low - 0.5).astype(np.int64)
    count = np.ceil(high - 0.5).astype(np.int64) - first  # rows whose centres an edge crosses
    edge = np.repeat(np.arange(len(begin)), count)
    row = first[edge] + np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)
    slope = (end[edge, 0] - begin[edge, 0]) / (end[edge, 1] - begin[edge, 1])
    crossing = begin[edge, 0] + (row + 0.5 - begin[edge, 1]) * slope
    drawn = (row >= 0) & (row < rows) & (crossing < columns - 1)
    row, column = row[drawn], np.maximum(np.ceil(crossing[drawn] - 0.5).astype(np.int64), 0)
    toggles = np.bincount(row * columns + column, minlength=rows * columns).reshape(rows, columns)
    return np.asarray(np.bitwise_and(np.cumsum(toggles.astype(np.uint8), axis=1, dtype=np.uint8), 1).astype(np.bool_))


def _draw_walls(walkable: NDArray[np.float32], walls: Array) -> None:
    """Make the cells not walkable that walls (n, 2, 2), in cells, touch, without gaps at their corners."""
    for begin, end in walls:
        share = np.linspace(0.0, 1.0, int(4.0 * np.abs(end - begin).max()) + 2)[:, None]
        column, row = (begin + share * (end - begin)).T
        for beside in ((0.0, 0.0), (0.35, 0.0), (0.0, 0.35)):
            cells = np.floor([row + beside[0], column + beside[1]]).astype(np.int64)
            inside = (cells >= 0).all(axis=0) & (cells[0] < walkable.shape[0]) & (cells[1] < walkable.shape[1])
            walkable[cells[0, inside], cells[1, inside]] = 0.0
