"""Distance and direction of the nearest walls of a floor plan, which tell where and whither people walk.

People walk beside walls and along them. On 318 legs of more than 4 m between surveyed points on three floors of two
malls (ILC20), seven tenths of the way within 1.5 m of a wall lead along it within ten degrees, but a third of that
farther away; by chance it would be 11 %. Between 0.6 and 1 m from a wall there is 1.7 times as much way as an even
spread over the walkable ground would have, beyond 6 m less than half as much.

The numbers below come from these three floors together. Only the share of ways along the wall was checked with one
floor left out: fitted to the other two, it explains the ways on that floor better than a constant share does, for
each of the three. The others were chosen with all floors in view, so that scores on these floors are too good by what
that choice gained.

The heading of a walker is therefore that of the nearest wall, in either sense and up to a Gaussian error, with a
probability that falls with the distance; otherwise it may be any.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from pdr_est.estimators.particle.plan.plan_grid import PlanGrid
from pdr_est.frames import Array
from pdr_est.types.floor_plan import FloorPlan

_ALONG_NEAR, _ALONG_FAR = 0.93, 0.33  # share of ways along a wall beside it, and far away; fitted to those legs
_NEAR_M = 1.3  # distance at which the share is the mean of both
_STEEPNESS = 4  # power of the distance with which it falls
SIGMA_ALONG_RAD = 0.14
"""Standard deviation of the angle between a way and the wall that it leads along, rad; fitted to those legs."""

DIRECTION_WAY_M = 24.0
"""Way after which a direction counts anew, m: three legs. Legs are not independent: they follow one another along
the same building. It was chosen among 8, 16, 24 and 40 m by the tracks of all three floors: the shortest gives them
the least coverage; on two floors 24 and 40 m make the surveyed points most probable, on the third it makes no
difference."""

_PLACE_M = 8.0  # way after which the distance from walls counts anew: the mean length of those legs
_PLACE_DISTANCE_M = (0.15, 0.45, 0.8, 1.25, 1.75, 2.5, 3.5, 5.0, 7.0)
_PLACE_RATIO = (0.6, 1.0, 1.7, 1.1, 0.95, 0.9, 1.0, 0.85, 0.45)
"""Ways at distances from the nearest wall over those of an even spread, counted on the three floors together. On each
plan, their mean over the walkable ground is made 1."""

_FAR_M = 8.0  # from the nearest wall, from which on it tells nothing
_SHORTEST_M = 1.0  # wall that counts
_COARSER = 2  # cells of the plan's raster to one cell of this one


@dataclass(frozen=True)
class NearestWalls:
    """Raster of what the nearest wall tells.

    Attributes
    ----------
    direction_rad
        (rows, columns) direction of the nearest wall, rad; 0 far from all walls.
    along
        (rows, columns) probability that a way leads along that wall; 0 far from all walls.
    log_place
        (rows, columns) logarithm of how probable a way is there, against an even spread.
    origin_m
        (2,) east and north of the south-western corner, m.
    cell_m
        Size of a cell, m.
    """

    direction_rad: NDArray[np.float32]
    along: NDArray[np.float32]
    log_place: NDArray[np.float32]
    origin_m: Array
    cell_m: float

    def log_weight(self, rows: Array, length_m: float) -> Array:
        """Return the logarithms (n,) of how probable places and headings are, against an even spread of both.

        Parameters
        ----------
        rows
            East, north and heading of n particles, and further rows.
        length_m
            Length of the way, m. Successive ways are much the same, so that a way counts for its share of a leg.
        """
        cells_across, cells_along = self.direction_rad.shape
        cells = ((rows[:2] - self.origin_m[:, None]) * (1.0 / self.cell_m)).astype(np.int32)
        last = np.array([[cells_along - 1], [cells_across - 1]], dtype=np.int32)
        column, row = np.minimum(np.maximum(cells, 0, out=cells), last, out=cells)
        row *= cells_along
        row += column
        off = rows[2].astype(np.float32)
        off -= self.direction_rad.ravel().take(row)
        off -= np.float32(np.pi) * np.rint(off * np.float32(1.0 / np.pi))
        off *= np.float32(1.0 / SIGMA_ALONG_RAD)
        peak = np.float32(np.sqrt(0.5 * np.pi) / SIGMA_ALONG_RAD)  # over the uniform density on half the circle
        ratio = peak * np.exp(np.float32(-0.5) * off * off)
        ratio -= np.float32(1.0)
        ratio *= self.along.ravel().take(row)
        ratio += np.float32(1.0)
        place = self.log_place.ravel().take(row)
        return np.asarray(np.log(ratio) * (length_m / DIRECTION_WAY_M) + place * (length_m / _PLACE_M), np.float64)


def nearest_walls(plan: FloorPlan, grid: PlanGrid) -> NearestWalls | None:
    """Make the raster of a plan; None for a plan without walls that are long enough."""
    cell_m = _COARSER * grid.cell_m
    shape = tuple(int(np.ceil(n / _COARSER)) for n in grid.walkable.shape)
    segments = plan.barriers_m
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
    nearest = np.full(shape, -1, dtype=np.int32)
    nearest[row[inside], column[inside]] = wall[inside]
    at = ndimage.distance_transform_edt(nearest < 0, return_distances=False, return_indices=True)
    found = nearest.ravel().take(at[0] * shape[1] + at[1])
    down, across = at[0] - np.arange(shape[0], dtype=np.int32)[:, None], at[1] - np.arange(shape[1], dtype=np.int32)
    squared = np.minimum(down * down + across * across, int((_FAR_M / cell_m) ** 2) + 1)  # distances in cells
    distance_m = np.sqrt(np.arange(squared.max() + 1)) * cell_m
    along = _ALONG_FAR + (_ALONG_NEAR - _ALONG_FAR) / (1.0 + (distance_m / _NEAR_M) ** _STEEPNESS)
    along[distance_m > _FAR_M] = 0.0
    log_ratio = np.interp(distance_m, _PLACE_DISTANCE_M, np.log(_PLACE_RATIO))
    ground = np.bincount(squared.ravel(), grid.walkable[::_COARSER, ::_COARSER].ravel())
    if ground.any():  # most of a hall is far from walls
        log_ratio -= np.log(np.exp(log_ratio) @ ground / ground.sum())
    direction_rad = np.arctan2(way_m[:, 1], way_m[:, 0])
    return NearestWalls(
        direction_rad.astype(np.float32)[found],
        along.astype(np.float32)[squared],
        log_ratio.astype(np.float32)[squared],
        grid.origin_m,
        cell_m,
    )
