"""Does a factor graph with the walls of a plan gain over the particle smoother that starts it?

    python experiments/plan_in_graph.py --data DIR [--seeds 1] [--stride 1]

The walks of ILC20 on the plans of their floors, with the first true position and the phone's north. The graph starts
at the track of `particle`. Its unknowns are the poses, the logarithm of the length scale and the direction that
relative headings count from. It has the steps, the headings (robust ones with Cauchy's kernel), the first position, a
hinge for each pose that is closer to a wall than MARGIN_M on the side where it is, and the directions of the nearest
walls as `particle` has them, but not its preference for some distances from them. Gauss-Newton steps on a sparse
matrix solve it; the covariances are those of the last linear system. `cold` is the same graph started at the track of
`factor-graph` without the plan.

`more_m` is the mean difference from the error of `particle`, with its standard error.

Writes experiments/results/plan_in_graph.json and .txt.
"""

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from recorded import command_line, write
from scipy import ndimage, sparse
from scipy.sparse.linalg import spsolve
from walks_on_plans import WalkOnPlan, walks_on_plans

from pdr_est import Config
from pdr_est.estimators import estimate_walk
from pdr_est.estimators.common.timeline import Timeline, timelines_of
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.plan.nearest_walls import DIRECTION_WAY_M, SIGMA_ALONG_RAD, nearest_walls
from pdr_est.estimators.particle.plan.plan_grid import PlanGrid, grid_of
from pdr_est.evaluate.consistency import coverage95
from pdr_est.evaluate.held_out_fixes import WAYPOINT_SIGMA_M
from pdr_est.frames import Array, wrap_angle
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.measurements import DeviceMeasurements, StartPose
from pdr_est.types.track import Track

MARGIN_M, CELL_M = 0.5, 0.2
ROUNDS, LONGEST_M, ENOUGH_M = 30, 2.0, 1e-3
Rows = tuple[Array, NDArray[np.integer], Array]  # residuals (m,), columns (m, k) and derivatives (m, k)
T = TypeVar("T")
SIGMA_SCALE = Config().odometry.sigma_length_scale


class Walls:
    """Distances from the walls of a plan, positive on walkable ground, and directions of the nearest ones."""

    def __init__(self, plan: FloorPlan) -> None:
        self.grid: PlanGrid = grid_of(replace(plan, sigma_m=0.0), CELL_M)
        free = self.grid.walkable > 0.5
        inside, outside = (ndimage.distance_transform_edt(side) for side in (free, ~free))
        self.distance_m = CELL_M * np.where(free, inside - 0.5, 0.5 - outside)
        self.nearest = nearest_walls(plan, self.grid)
        self.sigma_m = plan.sigma_m

    def at(self, place_m: Array) -> tuple[Array, Array]:
        """Return distances (n,), m, of places (2, n) and their gradients (2, n)."""
        cell = (place_m - self.grid.origin_m[:, None]) / CELL_M - 0.5

        def look(off: tuple[float, float]) -> Array:
            found: Array = ndimage.map_coordinates(self.distance_m, (cell + np.array(off)[:, None])[::-1], order=1)
            return found

        east, north = look((0.5, 0.0)) - look((-0.5, 0.0)), look((0.0, 0.5)) - look((0.0, -0.5))
        return look((0.0, 0.0)), np.array([east, north]) / CELL_M

    def along(self, place_m: Array) -> tuple[Array, Array]:
        """Return directions (n,) of the walls nearest to places (2, n), rad, and how probable a way along them is."""
        found = self.nearest
        if found is None:
            return np.zeros(place_m.shape[1]), np.zeros(place_m.shape[1])
        column, row = ((place_m - found.origin_m[:, None]) / found.cell_m).astype(np.int64)
        rows, columns = found.direction_rad.shape
        cell = row.clip(0, rows - 1), column.clip(0, columns - 1)
        return found.direction_rad[cell], found.along[cell]


class PlanGraph:
    """Graph of one device: three unknowns a node, then the log of the length scale and the reference direction."""

    def __init__(self, timeline: Timeline, walls: Walls, begin: Track) -> None:
        self.nodes, self.walls = timeline.nodes, walls
        self.count = len(self.nodes)
        heading = np.unwrap(begin.heading_rad)
        poses = np.column_stack([begin.position_m, heading]).ravel()
        relative = [(k, p) for k, node in enumerate(self.nodes) for p in node.priors if p.relative]
        turned = [np.exp(1j * (heading[k] - p.heading_rad)) for k, p in relative]
        reference = np.angle(np.sum(turned)) if turned else 0.0
        self.state = np.concatenate([poses, [np.log(begin.length_scale), reference]])
        self.length_m = np.array([node.length_m for node in self.nodes[1:]])
        chosen = [self._turn(k, heading) for k in range(1, self.count)]
        self.turn_rad = np.array([turn for turn, _ in chosen])
        self.roots = np.array([np.linalg.inv(np.linalg.cholesky(c + 1e-6 * np.eye(3))) for _, c in chosen])

    def _turn(self, k: int, heading: Array) -> tuple[float, Array]:
        """Return turn and covariance of a node: of several hypotheses, the one that fits the first track."""
        node, covariance = self.nodes[k], self.nodes[k].covariance.copy()
        if not node.turn_hypotheses:
            return node.heading_change_rad, covariance
        turned = heading[k] - heading[k - 1]
        best = min(node.turn_hypotheses, key=lambda one: abs(wrap_angle(turned - one.heading_change_rad)))
        covariance[2, :2] = covariance[:2, 2] = 0.0
        covariance[2, 2] = best.sigma_rad**2
        return best.heading_change_rad, covariance

    def solve(self) -> tuple[Array, Array]:
        """Return positions (n, 2) and their covariances (n, 2, 2) at the optimum."""
        for _ in range(ROUNDS):
            normal, slope = self._normal_equations()
            step = spsolve(normal, -slope)
            longest = np.abs(step[: 3 * self.count].reshape(-1, 3)[:, :2]).max()
            self.state += step * min(1.0, LONGEST_M / longest)
            if longest < ENOUGH_M:
                break
        inverse = np.linalg.inv(normal.toarray())
        covariance = [inverse[3 * k : 3 * k + 2, 3 * k : 3 * k + 2] for k in range(self.count)]
        return self.state[:-2].reshape(-1, 3)[:, :2], np.array(covariance)

    def _normal_equations(self) -> tuple[sparse.csc_matrix, Array]:
        parts = [*self._steps(), self._headings(), self._hinges(), self._directions(), *self._start()]
        residual = np.concatenate([part[0] for part in parts])
        widths = np.concatenate([np.full(len(part[0]), part[1].shape[1]) for part in parts])
        row = np.repeat(np.arange(len(residual)), widths)
        column, value = (np.concatenate([part[i].ravel() for part in parts]) for i in (1, 2))
        matrix = sparse.csr_matrix((value, (row, column)), shape=(len(residual), len(self.state)))
        return (matrix.T @ matrix + 1e-9 * sparse.identity(len(self.state))).tocsc(), matrix.T @ residual

    def _steps(self) -> Iterable[Rows]:
        poses = self.state[:-2].reshape(-1, 3)
        ahead = poses[:-1, 2] + self.turn_rad
        c, s, scaled_m = np.cos(ahead), np.sin(ahead), np.exp(self.state[-2]) * self.length_m
        (east, north), zero, one = np.diff(poses[:, :2], axis=0).T, np.zeros(len(c)), np.ones(len(c))
        forward, left = c * east + s * north, c * north - s * east
        residual = np.array([forward - scaled_m, left, wrap_angle(poses[1:, 2] - ahead)])
        jacobian = np.array(
            [
                [-c, -s, left, c, s, zero, -scaled_m],
                [s, -c, -forward, -s, c, zero, zero],
                [zero, zero, -one, zero, zero, one, zero],
            ]
        )
        residual, jacobian = (np.einsum("nij,j...n->ni...", self.roots, part) for part in (residual, jacobian))
        first = 3 * np.arange(len(c))[:, None]
        columns = np.hstack([first + np.arange(6), np.full_like(first, len(self.state) - 2)])
        return [(residual[:, i], columns, jacobian[:, i]) for i in range(3)]

    def _headings(self) -> Rows:
        found = [(k, prior) for k, node in enumerate(self.nodes) for prior in node.priors]
        if not found:
            return np.zeros(0), np.zeros((0, 2), dtype=np.int64), np.zeros((0, 2))
        place = np.array([3 * k + 2 for k, _ in found])
        relative = np.array([float(prior.relative) for _, prior in found])
        sigma = np.array([prior.sigma_rad for _, prior in found])
        expected = self.state[place] - relative * self.state[-1]
        off = wrap_angle(expected - np.array([prior.heading_rad for _, prior in found])) / sigma
        weight = np.where([prior.robust for _, prior in found], 1.0 / np.sqrt(1.0 + off**2), 1.0)
        columns = np.column_stack([place, np.full(len(place), len(self.state) - 1)])
        return weight * off, columns, np.column_stack([weight / sigma, -relative * weight / sigma])

    def _hinges(self) -> Rows:
        place = self.state[:-2].reshape(-1, 3)[:, :2].T
        distance_m, gradient = self.walls.at(place)
        active = np.flatnonzero(distance_m < MARGIN_M)
        columns = 3 * active[:, None] + np.arange(2)
        residual = (MARGIN_M - distance_m[active]) / self.walls.sigma_m
        return residual, columns, -gradient[:, active].T / self.walls.sigma_m

    def _directions(self) -> Rows:
        poses = self.state[:-2].reshape(-1, 3)
        direction_rad, along = self.walls.along(poses[1:, :2].T)
        off = poses[1:, 2] - direction_rad
        off = (off - np.pi * np.rint(off / np.pi)) / SIGMA_ALONG_RAD
        density = along * np.sqrt(0.5 * np.pi) / SIGMA_ALONG_RAD * np.exp(-0.5 * off**2)
        weight = np.sqrt(density / (density + 1.0 - along) * self.length_m / DIRECTION_WAY_M)
        return weight * off, 3 * np.arange(1, self.count)[:, None] + 2, weight[:, None] / SIGMA_ALONG_RAD

    def _start(self) -> Iterable[Rows]:
        fix = next(fix for node in self.nodes for fix in node.fixes)
        place = next(k for k, node in enumerate(self.nodes) if node.fixes)
        sigma_m = float(np.sqrt(fix.covariance_m2[0][0]))
        off = (self.state[3 * place : 3 * place + 2] - fix.position_m) / sigma_m
        yield off, 3 * place + np.arange(2)[:, None], np.full((2, 1), 1.0 / sigma_m)
        for column, value, sigma in ((-2, 0.0, SIGMA_SCALE), (-1, self.state[-1], 1e3)):
            index = np.array([[len(self.state) + column]])
            yield np.array([(self.state[column] - value) / sigma]), index, np.array([[1.0 / sigma]])


def tracks(walk: WalkOnPlan, walls: Walls, seed: int) -> dict[str, tuple[Track, float]]:
    """Return the tracks of a walk and their costs, CPU s; that of a graph is without the track that starts it."""
    given = replace(walk.measurements, measurements=(*walk.measurements.measurements, walk.plan))
    found = {
        "particle": timed(lambda: smoothed("particle", given, seed)),
        "factor-graph": timed(lambda: smoothed("factor-graph", walk.measurements, seed)),
    }
    timeline = timelines_of([walk.measurements], [])[0]
    for name, first in (("graph", "particle"), ("cold", "factor-graph")):
        begin = found[first][0]
        (position, covariance), cost_s = timed(PlanGraph(timeline, walls, begin).solve)
        found[name] = replace(begin, position_m=position, covariance_m2=covariance, region=None), cost_s
    return found


def smoothed(estimator: str, device: DeviceMeasurements, seed: int) -> Track:
    """Smooth a walk."""
    return estimate_walk(estimator, [device], StartPose(), SIGMA_SCALE, particle=ParticleParams(seed=seed))


def timed(work: Callable[[], T]) -> tuple[T, float]:
    """Do work, and return its result and its cost, CPU s."""
    begin = time.process_time()
    result = work()
    return result, time.process_time() - begin


Scored = Sequence[tuple[WalkOnPlan, Track, float]]


def mean_errors_m(scored: Scored) -> Array:
    """Compute the mean error of each walk at the true positions after the first one, m."""
    return np.array(
        [np.hypot(*(track.at(walk.time_s[1:])[0] - walk.truth_m[1:]).T).mean() for walk, track, _ in scored]
    )


def row(name: str, scored: Scored, reference: Scored) -> dict[str, float | str]:
    """Compute the numbers of an estimator over all walks, and its mean error beside that of a reference."""
    errors_m = mean_errors_m(scored)
    off_m, covariance_m2 = [], []
    more_m = errors_m - mean_errors_m(reference)
    for walk, track, _ in scored:
        at, covariance = track.at(walk.time_s[1:])
        off_m.append(at - walk.truth_m[1:])
        covariance_m2.append(covariance)
    outside = [1.0 - walk.plan.contains(track.position_m).mean() for walk, track, _ in scored]
    return {
        "estimator": name,
        "walks": len(scored),
        "mean_m": float(np.mean(errors_m)),
        "median_m": float(np.median(errors_m)),
        "p90_m": float(np.quantile(errors_m, 0.9)),
        "more_m": float(more_m.mean()),
        "+-_m": float(more_m.std() / np.sqrt(len(more_m))),
        "coverage95": coverage95(np.concatenate(off_m), np.concatenate(covariance_m2), WAYPOINT_SIGMA_M),
        "outside": float(np.mean(outside)),
        "cpu_s_per_min": sum(cost for _, _, cost in scored) / sum(walk.minutes for walk, _, _ in scored),
    }


def as_text(rows: Sequence[Mapping[str, float | str]]) -> str:
    """Write the rows as a table."""
    lines = ["".join(f"{name:>15}" for name in rows[0])]
    for one in rows:
        cells = [cell if isinstance(cell, str | int) else f"{cell:.3f}" for cell in one.values()]
        lines.append("".join(f"{cell:>15}" for cell in cells))
    return "\n".join(lines) + "\n"


def main() -> None:
    """Compare the tracks of all walks."""
    options = command_line(__doc__, {"--data": Path, "--seeds": 1, "--stride": 1})
    walls: dict[int, Walls] = {}
    scored: dict[str, list[tuple[WalkOnPlan, Track, float]]] = {}
    for walk in islice(walks_on_plans(options.data, fixes=1), 0, None, options.stride):
        if id(walk.plan) not in walls:
            walls[id(walk.plan)] = Walls(walk.plan)
        for seed in range(options.seeds):
            for name, (track, cost_s) in tracks(walk, walls[id(walk.plan)], seed).items():
                scored.setdefault(name, []).append((walk, track, cost_s))
    rows = [row(name, own, scored["particle"]) for name, own in scored.items()]
    write("plan_in_graph", as_text(rows), rows)


if __name__ == "__main__":
    main()
