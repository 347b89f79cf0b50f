"""Directions of the nearest walls of a floor plan, which people mostly walk along.

Of 318 legs of more than 4 m between surveyed points on three floors of two malls, about half lead along the nearest
wall within ten degrees, on each floor between 41 and 65 %; by chance it would be 11 %. With the probability `ALONG`,
the heading of a walker is therefore that of the nearest wall, in either sense and up to a Gaussian error; otherwise
it may be any.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from pdr_est.estimators.particle.plan.plan_grid import PlanGrid, segments_of
from pdr_est.frames import Array
from pdr_est.types.floor_plan import FloorPlan

ALONG = 0.5
"""Share of ways along the nearest wall; see above."""

_SIGMA_RAD = 0.12  # of the angle between a way and the wall that it leads along
_LEG_M = 8.0  # way after which the direction is chosen anew: the mean length of those legs
_FAR_M = 8.0  # from the nearest wall, from which on it tells no direction
_SHORTEST_M = 1.0  # wall that counts
_COARSER = 3  # cells of the plan's raster to one cell of the directions


@dataclass(frozen=True)
class NearestWalls:
    """Raster of the direction of the nearest wall.

    Attributes
    ----------
    direction_rad
        (rows, columns) direction of the nearest wall, rad; NaN far from all walls.
    origin_m
        (2,) east and north of the south-western corner, m.
    cell_m
        Size of a cell, m.
    """

    direction_rad: Array
    origin_m: Array
    cell_m: float

    def log_weight(self, rows: Array, length_m: float) -> Array:
        """Return the logarithms (n,) of how probable headings are at their places, against any other heading.

        Parameters
        ----------
        rows
            East, north and heading of n particles, and further rows.
        length_m
            Length of the way, m. The directions of successive ways are much the same, so that a way counts for its
            share of a leg.
        """
        cells_across, cells_along = self.direction_rad.shape
        column = ((rows[0] - self.origin_m[0]) / self.cell_m).astype(np.int64)
        row = ((rows[1] - self.origin_m[1]) / self.cell_m).astype(np.int64)
        for index, count in ((column, cells_along), (row, cells_across)):
            np.minimum(np.maximum(index, 0, out=index), count - 1, out=index)
        off = rows[2] - self.direction_rad.ravel().take(row * cells_along + column)
        off -= np.pi * np.rint(off / np.pi)
        peak = ALONG * np.sqrt(0.5 * np.pi) / _SIGMA_RAD  # over the uniform density on half the circle
        ratio = 1.0 - ALONG + peak * np.exp(-0.5 * (off / _SIGMA_RAD) ** 2)
        return np.asarray(np.nan_to_num(np.log(ratio)) * (length_m / _LEG_M))


def nearest_walls(plan: FloorPlan, grid: PlanGrid) -> NearestWalls | None:
    """Make the raster of directions of a plan; None for a plan without walls that are long enough."""
    cell_m = _COARSER * grid.cell_m
    shape = tuple(int(np.ceil(n / _COARSER)) for n in grid.walkable.shape)
    segments = segments_of(plan)
    way_m = segments[:, 1] - segments[:, 0]
    length_m = np.hypot(way_m[:, 0], way_m[:, 1])
    segments, way_m, length_m = (one[length_m > _SHORTEST_M] for one in (segments, way_m, length_m))
    if not len(segments):
        return None
    count = np.ceil(length_m / (0.7 * cell_m)).astype(np.int64) + 1
    wall = np.repeat(np.arange(len(segments)), count)
    place = np.arange(len(wall)) - np.repeat(np.cumsum(count) - count, count)
    points = segments[wall, 0] + (place / (count[wall] - 1))[:, None] * way_m[wall]
    column, row = np.floor((points - grid.origin_m) / cell_m).astype(np.int64).T
    inside = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1])
    if not inside.any():
        return None
    field = np.full(shape, np.nan)
    field[row[inside], column[inside]] = np.arctan2(way_m[:, 1], way_m[:, 0])[wall[inside]]
    distance, nearest = ndimage.distance_transform_edt(np.isnan(field), return_indices=True)
    direction = field[nearest[0], nearest[1]]
    direction[distance * cell_m > _FAR_M] = np.nan
    return NearestWalls(direction, grid.origin_m, cell_m)
