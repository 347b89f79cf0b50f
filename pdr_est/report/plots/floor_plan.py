"""Drawing of a floor plan below a track, or alone."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from pdr_est.frames import Array
from pdr_est.report.plots import figure as svg
from pdr_est.types.floor_plan import FloorPlan, WalkableArea

BELOW_TRACK = 0.4  # order of drawing: above the grid, below everything else


def draw_floor_plan(axes: Axes, plan: FloorPlan) -> None:
    """Draw the walkable areas as a shade with an edge, and further walls as lines."""
    for area in plan.areas:
        axes.add_patch(PathPatch(_path(area), facecolor=svg.MUTED, edgecolor="none", alpha=0.12, zorder=BELOW_TRACK))
        axes.add_patch(
            PathPatch(_path(area), facecolor="none", edgecolor=svg.MUTED, linewidth=0.7, zorder=BELOW_TRACK)
        )
    walls_m = np.reshape(plan.walls_m, (-1, 2, 2))
    if len(walls_m):
        axes.add_collection(
            LineCollection(list(walls_m), colors=svg.MUTED, linewidths=0.7, zorder=BELOW_TRACK), autolim=False
        )


def _path(area: WalkableArea) -> Path:
    """Make one path of the outline and the holes, which run the other way round and are therefore left out."""
    rings = [_turning(area.outline_m, 1.0), *(_turning(hole, -1.0) for hole in area.holes_m)]
    return Path.make_compound_path(*(Path(np.vstack([ring, ring[:1]]), closed=True) for ring in rings))


def _turning(ring_m: Array, sign: float) -> Array:
    """Return a ring in counter-clockwise order for a positive sign, else in clockwise order."""
    x, y = (ring_m - ring_m[0]).T
    doubled_area = float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    return ring_m if doubled_area * sign > 0.0 else ring_m[::-1]
