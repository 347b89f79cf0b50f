"""Model of a floor plan for the ways of particles: walls, ground that is not walkable, and directions."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.particle.cloud import HEADING, NORTH
from pdr_est.estimators.particle.motion import ParticleMotion
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.plan.nearest_walls import NearestWalls, nearest_walls
from pdr_est.estimators.particle.plan.plan_grid import PlanGrid, Window, grid_of
from pdr_est.frames import Array
from pdr_est.types.floor_plan import FloorPlan

_DRAWS = (3, 8)
"""Numbers of further draws, at once, of a step that leads through a wall; ours. A walker avoids a wall where the
errors of the step leave room for it. With few draws, a posterior prefers whatever meets few walls by chance: short
steps, above all. They were chosen by the tracks of ILC20 with all three floors in view, none left out: with these
rather than two draws, the surveyed points are likelier on each of them."""

_PER_M2 = 100.0  # particles of a walk that may begin anywhere, where the settings allow as many; ours


@dataclass(frozen=True)
class PlanModel:
    """A floor plan in the form in which the filter looks it up.

    Attributes
    ----------
    name
        Name of the plan.
    grid
        Raster of the walkable ground.
    directions
        Directions of the nearest walls; None without any.
    free_path_m
        Mean length of straight ways on the walkable ground up to the next wall, m.
    area_m2
        Area of the walkable ground, m².
    walkable_share
        Share of the rectangle about the plan that is walkable.
    pass_probability, stray_length_m
        As in the settings.
    anchor_m
        (2,) east and north of the point about which the plan may be stretched, m.
    """

    name: str
    grid: PlanGrid
    directions: NearestWalls | None
    free_path_m: float
    area_m2: float
    walkable_share: float
    pass_probability: float
    stray_length_m: float
    anchor_m: Array

    @classmethod
    def of(cls, plan: FloorPlan, parameters: ParticleParams, window_m: Window | None = None) -> "PlanModel":
        """Make the model of a plan, or of the part of it inside a window that the walk cannot leave."""
        grid = grid_of(plan, parameters.cell_m, window_m)
        walls, area_m2 = plan.barriers_m, plan.area_m2
        corners_m = walls.reshape(-1, 2)
        length_m = float(np.hypot(*(walls[:, 1] - walls[:, 0]).T).sum())
        return cls(
            name=plan.name,
            grid=grid,
            directions=nearest_walls(plan, grid),
            free_path_m=np.pi * area_m2 / length_m,  # Cauchy's formula of the mean chord
            area_m2=area_m2,
            walkable_share=area_m2 / float(np.prod(np.ptp(corners_m, axis=0))),
            pass_probability=parameters.pass_probability,
            stray_length_m=parameters.stray_length_m,
            anchor_m=np.clip(0.0, corners_m.min(axis=0), corners_m.max(axis=0)),
        )

    def particles_anywhere(self, parameters: ParticleParams) -> int:
        """Return the number of particles of a walk that may begin anywhere on the plan in any direction."""
        count = int(np.ceil(_PER_M2 * self.area_m2))
        return min(max(count, parameters.most_particles), parameters.most_start_particles)

    def log_place(self, rows: Array) -> Array:
        """Return the logarithms (n,) of the probabilities that a walker is in a place, at least that of passing."""
        passing = self.pass_probability
        return np.asarray(np.log(passing + (1.0 - passing) * self.grid.at(rows[0], rows[1])), dtype=np.float64)

    def move(self, rows: Array, node: Node, rng: np.random.Generator) -> Array:
        """Move the particles of a device over a motion, and return the log probabilities (n,) of their ways.

        A step through a wall is drawn again, and the first draw that meets none is taken; without any the particle
        goes through, with the probability of passing as its weight.

        Parameters
        ----------
        rows
            (8, n) rows of the device; they are changed.
        node
            Node that the motion leads to.
        rng
            Source of random numbers.
        """
        before, motion = rows[: NORTH + 1].copy(), ParticleMotion.to(node)
        turns = motion.chosen(rows.shape[1], rng)
        means = motion.mean_ends(rows, turns)
        ends = motion.draw(means, turns, 1, rng)
        rows[: HEADING + 1] = ends[:, 0]
        log = np.zeros(rows.shape[1])
        if node.length_m <= 0.0:
            return log
        begin = self.grid.cells(before)
        stays = self.grid.in_cells(begin) < self.pass_probability
        log[stays] = self._log_stray(before[:, stays], rows[: NORTH + 1, stays])
        again = np.flatnonzero(self._meets_wall(begin, ends, rng)[0] & ~stays)
        for draws in _DRAWS:
            if not len(again):
                break
            ends = motion.draw(means[:, again], turns[again], draws, rng)
            free = ~self._meets_wall(begin[:, again], ends, rng)
            found = free.any(axis=0)
            rows[: HEADING + 1, again[found]] = ends[:, free.argmax(axis=0)[found], np.flatnonzero(found)]
            again = again[~found]
        log[again] = np.log(self.pass_probability)
        return log

    def log_way(self, begin: Array, end: Array) -> Array:
        """Return the log probabilities (n,) of given straight ways, from and to east and north (2, n), m.

        A way is as probable as its least walkable point, at least as probable as passing a wall.
        """
        first, last = self.grid.cells(begin), self.grid.cells(end)
        off = self.grid.in_cells(first) < self.pass_probability
        free = self.grid.along(first, last)
        log = np.log(self.pass_probability + (1.0 - self.pass_probability) * free)
        if off.any():
            log[off] = self._log_stray(begin[:, off], end[:, off])
        return np.asarray(log, dtype=np.float64)

    def _log_stray(self, begin: Array, end: Array) -> Array:
        """Return the log probabilities (n,) of ways that begin off the walkable ground, where walls are unknown."""
        stays = np.exp(-np.hypot(*(end - begin)[: NORTH + 1]) / self.stray_length_m)
        return np.asarray(np.log(stays + (1.0 - stays) * self.grid.at(end[0], end[1])))

    def _meets_wall(self, begin: NDArray[np.float32], end: Array, rng: np.random.Generator) -> NDArray[np.bool_]:
        """Draw for ways whether a wall is in them (k, n), by the probability that all their points are walkable.

        Parameters
        ----------
        begin
            (2, n) beginnings, in cells.
        end
            (3, k, n) poses at k ends for each, m and rad.
        rng
            Source of random numbers.
        """
        free = self.grid.along(begin[:, None], self.grid.cells(end[: NORTH + 1]))
        return np.asarray(rng.random(free.shape) >= free)
