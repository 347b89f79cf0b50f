"""Track of a device from paths drawn from the posterior: poses, covariances about them, and regions."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from pdr_est.estimators.common.timeline import Timeline, track_from_nodes
from pdr_est.estimators.particle.paths.mixture_fit import fitted_region
from pdr_est.estimators.particle.plan.plan_grid import PlanGrid
from pdr_est.estimators.particle.plan.plans_in_time import PlansInTime
from pdr_est.frames import Array, wrap_angle
from pdr_est.types.track import Track

NAME = "particle"

_ROUNDS, _LEAST_M = 5, 1e-3  # of Weiszfeld's iteration, and the distance that counts at least
_WALKABLE = 0.5  # probability from which on a pose counts as on the plan


def track_of_paths(
    timeline: Timeline,
    poses: Array,
    log_scale: Array,
    plans: PlansInTime | None,
    shift_m: Array,
    chosen: int | None = None,
) -> Track:
    """Make the smoothed track of a device.

    Without a plan a pose is the mean of the paths. On a plan, the mean of ways round a wall may be inside of it: a
    pose is then the geometric median, which has the least mean distance from the paths, and where that is not
    walkable, the nearest walkable point of a path.

    Parameters
    ----------
    timeline
        Timeline with n nodes.
    poses
        (n, 3, paths) east, north and heading of each path at each node.
    log_scale
        (paths,) logarithms of the length scale.
    plans
        Plans of the floors of the walk, or None.
    shift_m
        (n, 2, paths) by how much the plan lies beside the poses, m.
    chosen
        Number of the path whose poses are taken, where the middle of all would lie between places; otherwise None.
    """
    place = poses[:, :2]
    position = place.mean(axis=2) if chosen is None else place[:, :, chosen]
    if plans is not None and chosen is None:
        grids = [plans.grid_at(node.time_s) for node in timeline.nodes]
        for begin, end in _stretches(grids):
            grid = grids[begin]
            if grid is not None:
                own = place[begin:end]
                position[begin:end] = _on_plan(geometric_median(own), own, grid, shift_m[begin:end])
    vector = np.exp(1j * poses[:, 2]).mean(axis=1)
    heading = np.angle(vector)
    off = np.concatenate([place - position[:, :, None], wrap_angle(poses[:, 2] - heading[:, None])[:, None]], axis=1)
    covariance = off @ off.transpose(0, 2, 1) / poses.shape[2]
    scale = np.exp(log_scale)
    found = float(scale.mean()), float(scale.std())
    track = track_from_nodes(timeline, position, heading, covariance, "smoothed", NAME, found)
    ends = [number for number, node in enumerate(timeline.nodes) if node.is_step]
    return replace(track, region=fitted_region(place[ends], track.position_m, track.covariance_m2))


def middlemost_path(place: Array) -> int:
    """Return the number of the path that has the least mean distance from all of them, (n, 2, paths)."""
    total = np.zeros((place.shape[2], place.shape[2]))
    for east, north in place:
        total += np.hypot(east[:, None] - east, north[:, None] - north)
    return int(np.argmin(total.sum(axis=1)))


def geometric_median(points: Array) -> Array:
    """Return the points (n, 2) of least mean distance from sets of points (n, 2, k), by Weiszfeld's iteration."""
    centre = points.mean(axis=2)
    for _ in range(_ROUNDS):
        east, north = points[:, 0] - centre[:, :1], points[:, 1] - centre[:, 1:]
        weight = 1.0 / np.maximum(np.sqrt(east * east + north * north), _LEAST_M)
        centre = (points @ weight[:, :, None])[:, :, 0] / weight.sum(axis=1)[:, None]
    return np.asarray(centre)


def _stretches(grids: Sequence[PlanGrid | None]) -> list[tuple[int, int]]:
    """Return begin and end of each run of nodes on the same plan."""
    changes = [k for k in range(1, len(grids)) if grids[k] is not grids[k - 1]]
    return list(pairwise([0, *changes, len(grids)]))


def _on_plan(position: Array, place: Array, grid: PlanGrid, shift_m: Array) -> Array:
    """Return positions (n, 2), those off the plan moved to the nearest walkable point of a path (n, 2, k)."""
    middle = np.median(shift_m, axis=2)
    position, place = position - middle, place - shift_m
    for row in np.flatnonzero(grid.at(position[:, 0], position[:, 1]) < _WALKABLE):
        walkable = place[row][:, grid.at(place[row, 0], place[row, 1]) >= _WALKABLE]
        if walkable.shape[1]:
            nearest = np.argmin(np.hypot(*(walkable - position[row][:, None])))
            position[row] = walkable[:, nearest]
    return np.asarray(position + middle)
