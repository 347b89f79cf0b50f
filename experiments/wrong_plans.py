"""Measure what plans that are wrong do to tracks on a floor plan.

    python experiments/wrong_plans.py --data DIR [--every N]

DIR holds the data sets. Each walk of ILC20 is smoothed by `particle` with its first waypoint as its only fix: with
the right plan of its floor, without any, and with wrong ones. Those are shifted, stretched about their centre or
about the origin, with the corridor closed that the walk takes, or of another floor or mall. A corridor is closed
over 8 m, from wall to wall, in the middle of the longest straight way between two waypoints. Writes
experiments/results/wrong_plans.json and .txt; --every N takes only each N-th walk.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from recorded import command_line, markdown_table, write
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from pdr_est import Config, read, read_floor_plan
from pdr_est.evaluate.consistency import coverage95
from pdr_est.evaluate.held_out_fixes import WAYPOINT_SIGMA_M, fixes_at
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.recording_files import recordings
from pdr_est.frames import Array
from pdr_est.pipeline import analyse_recording
from pdr_est.types.findings import FindingKind
from pdr_est.types.floor_plan import FloorPlan, WalkableArea
from pdr_est.types.recording import Recording

CLOSED_M, WIDEST_M = 8.0, 20.0  # length of the closed piece of a corridor, and how far it reaches to each side
LEFT_M = 4.0  # of the true way that must be off a plan so that the walk can tell
OTHER_FLOOR = {"site1/F1": "site1/F2", "site1/F2": "site1/F1"}
OTHER_MALL = {"site1/F1": "site2/F1", "site1/F2": "site2/F1", "site2/F1": "site1/F1"}
RIGHT, NONE = "right", "none"
Scores = dict[str, tuple[float, float, float, float]]
"""Of each walk the mean error, m, the share of waypoints in the 95 % ellipse, the probability with which it is told
that the plan does not fit (0 where it is not), and the length of the true way that is off the plan, m."""


def main() -> None:
    """Smooth all walks with all plans, and compare."""
    options = command_line(__doc__, {"--data": Path, "--every": 1})
    walks = list(recordings(options.data / "ilc20", "*.txt"))
    floors = {str(Path(name).parent): path.parent for name, path in walks}
    plans = {name: read_floor_plan(folder) for name, folder in floors.items()}
    scores: dict[str, Scores] = {}
    for name, path in walks[:: options.every]:
        recording = read(path)
        if recording.truth.positions is None or len(recording.truth.positions.time_s) < 2:
            continue
        config = replace(Config(), estimator=replace(Config().estimator, name="particle"))
        devices = analyse_recording(recording, config)
        for case, plan in plans_of(str(Path(name).parent), plans, way_of(recording)).items():
            walk = AnalysedWalk(recording, devices, config, plan="no plan" if plan is None else plan)
            scores.setdefault(case, {})[name] = scored(walk, plan)
    rows = {case: summary(own, scores[RIGHT], scores[NONE]) for case, own in scores.items()}
    headings = ("plan", *next(iter(rows.values())))
    table = markdown_table(headings, [[case, *map(in_words, row.values())] for case, row in rows.items()])
    write("wrong_plans", table + "\n", rows)


def way_of(recording: Recording) -> Array:
    """Return the true positions (n, 2) of a walk in order of time, m."""
    truth = recording.truth.positions
    return truth.position_m[np.argsort(truth.time_s, kind="stable")]


def plans_of(floor: str, plans: dict[str, FloorPlan], way_m: Array) -> dict[str, FloorPlan | None]:
    """Make the right plan of a walk and the wrong ones; only those that there are."""
    plan = plans[floor]
    west, south, east, north = plan.bounds_m
    centre = np.array([west + east, south + north]) / 2.0
    found: dict[str, FloorPlan | None] = {NONE: None, RIGHT: plan}
    for name, way in (("east", (1.0, 0.0)), ("north", (0.0, 1.0)), ("west", (-1.0, 0.0)), ("south", (0.0, -1.0))):
        found[f"shifted 1 m {name}"] = moved(plan, lambda x, way=way: x + np.array(way))  # type: ignore[misc]
    for factor in (1.02, 0.98):
        found[f"{factor:g} about its centre"] = moved(plan, lambda x, s=factor: centre + s * (x - centre))  # type: ignore[misc]
        found[f"{factor:g} about the origin"] = moved(plan, lambda x, s=factor: s * x)  # type: ignore[misc]
    closed = with_closed_corridor(plan, way_m)
    if closed is not None:
        found["corridor closed"] = closed
    for case, others in (("other floor", OTHER_FLOOR), ("other mall", OTHER_MALL)):
        if others.get(floor) in plans:
            found[case] = plans[others[floor]]
    return found


def moved(plan: FloorPlan, change: Callable[[Array], Array]) -> FloorPlan:
    """Return a plan whose points (n, 2) are elsewhere."""
    areas = tuple(
        WalkableArea(change(area.outline_m), tuple(change(hole) for hole in area.holes_m)) for area in plan.areas
    )
    return replace(plan, areas=areas, walls_m=change(plan.walls_m.reshape(-1, 2)).reshape(-1, 2, 2))


def shape_of(plan: FloorPlan) -> BaseGeometry:
    """Return the walkable area of a plan."""
    return unary_union([Polygon(area.outline_m, area.holes_m).buffer(0) for area in plan.areas])


def with_closed_corridor(plan: FloorPlan, way_m: Array) -> FloorPlan | None:
    """Return a plan without a piece of the corridor that a walk takes; None for a walk of short ways."""
    legs = np.diff(way_m, axis=0)
    length_m = np.hypot(*legs.T)
    shape = shape_of(plan)
    for leg in np.argsort(-length_m):
        if length_m[leg] < CLOSED_M:
            return None
        along = legs[leg] / length_m[leg]
        across, middle = np.array([-along[1], along[0]]), (way_m[leg] + way_m[leg + 1]) / 2.0
        half = 0.5 * CLOSED_M * along
        corners = [middle + s * half + t * WIDEST_M * across for s, t in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
        parts = shape.intersection(Polygon(corners))
        piece = min(getattr(parts, "geoms", [parts]), key=lambda part: part.distance(Point(middle)))
        if piece.distance(Point(middle)) < 1.0 < piece.distance(Point(way_m[0])):
            left = shape.difference(piece.buffer(1e-6))
            kept = [part for part in getattr(left, "geoms", [left]) if part.area > 0.5]
            return replace(plan, areas=tuple(map(area_of, kept)))
    return None


def area_of(part: Polygon) -> WalkableArea:
    """Return a polygon as a piece of floor."""
    outline, *holes = (np.array(ring.coords)[:-1] for ring in (part.exterior, *part.interiors))
    return WalkableArea(outline, tuple(holes))


def scored(walk: AnalysedWalk, plan: FloorPlan | None) -> tuple[float, float, float, float]:
    """Score the track of a walk on a plan, whose first waypoint is known; see `Scores`."""
    truth = walk.recording.truth.positions
    order = np.argsort(truth.time_s, kind="stable")
    time_s, true_m = truth.time_s[order], truth.position_m[order]
    fixes = fixes_at(time_s[:1], true_m[:1])
    track = walk.track(fixes) if plan is None else walk.track_on_plan(fixes)
    position_m, covariance_m2 = track.at(time_s[1:])
    error_m = position_m - true_m[1:]
    inside = coverage95(error_m, covariance_m2, WAYPOINT_SIGMA_M)
    told = max((one.value or 0.0 for one in track.findings if one.kind == FindingKind.PLAN), default=0.0)
    return float(np.hypot(*error_m.T).mean()), inside, told, way_off(plan, true_m)


def way_off(plan: FloorPlan | None, true_m: Array) -> float:
    """Return the length of the true way, straight from waypoint to waypoint, that is off a plan, m."""
    if plan is None:
        return 0.0
    share = np.linspace(0.0, 1.0, 50)[:, None]
    off_m = 0.0
    for begin, end in pairwise(true_m):
        off_m += float(np.hypot(*(end - begin))) * float(np.mean(~plan.contains(begin + share * (end - begin))))
    return off_m


def summary(own: Scores, right: Scores, none: Scores) -> dict[str, float | int | None]:
    """Compare the scores with a plan with those of the same walks with the right one and without any."""
    errors = np.array([one[0] for one in own.values()])
    off = [one for one in own.values() if one[3] > LEFT_M]
    return {
        "walks": len(own),
        "mean error, m": float(errors.mean()),
        "median, m": float(np.median(errors)),
        "over that with the right plan": float(errors.mean() / np.mean([right[name][0] for name in own])),
        "over that without a plan": float(errors.mean() / np.mean([none[name][0] for name in own])),
        "coverage": float(np.mean([one[1] for one in own.values()])),
        "told": float(np.mean([one[2] > 0.0 for one in own.values()])),
        "told with more than 50 %": float(np.mean([one[2] > 0.5 for one in own.values()])),
        f"told, of walks that leave it by {LEFT_M:g} m": float(np.mean([one[2] > 0.0 for one in off]))
        if off
        else None,
        "such walks": len(off),
    }


def in_words(value: float | int | None) -> str:
    """Format a cell of the table."""
    return "" if value is None else f"{value:.2f}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    main()
