"""Numbers about the places of a walk: heights, the floor plan, and positions that are not decided."""

from dataclasses import asdict
from typing import Any

import numpy as np

from pdr_est.pipeline import SmoothedWalk
from pdr_est.report.walk.visited_floors import visited_floors, within_spans
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.height import HeightProfile
from pdr_est.types.region import PoseRegion
from pdr_est.types.track import Track

_MOST_TIMES = 12  # of a search for the place that are listed


def describe_height(profile: HeightProfile | None) -> dict[str, Any] | None:
    """Describe the floors that were visited, and how the walker changed them."""
    if profile is None:
        return None
    return {
        "floors": sorted(set(profile.floor.tolist())),
        "lowest_m": float(profile.height_m.min()),
        "highest_m": float(profile.height_m.max()),
        "floor_probability": float(profile.floor_probability.min()),
        "moves": [asdict(move) | {"kind": move.kind.value} for move in profile.moves],
    }


def describe_places(region: PoseRegion) -> dict[str, Any]:
    """Describe where a device may be, where one ellipse does not say it: how often, and at the end."""
    end = region.rows(slice(-1, None)).ellipses()
    return {
        "share_of_poses_with_several": float((region.components > 1).mean()),
        "at_the_end": [
            {"probability": probability, "position_m": place_m}
            for probability, place_m in zip(end.weight.tolist(), end.centre_m.tolist(), strict=True)
        ],
    }


def describe_search(track: Track) -> dict[str, Any] | None:
    """Describe where on its plan a walk was whose start is not known, and since when the place was unique."""
    if track.places is None:
        return None
    search = track.places
    since = search.unique_since
    chosen = np.unique(np.linspace(0, len(search.filtered) - 1, _MOST_TIMES).astype(np.int64))
    times = {one.time_s: one for one in (*(search.filtered[number] for number in chosen), since) if one is not None}
    return {
        "words": search.words,
        "unique_since": since,
        "start": search.start,
        "end": search.end,
        "filtered": [times[time_s] for time_s in sorted(times)],
    }


def describe_walk_on_plans(walk: SmoothedWalk) -> list[dict[str, Any]]:
    """Describe the floor plan, or those of the floors that were visited, the lowest first."""
    track = walk.track.of_device(walk.track.devices[-1])
    if walk.floors:
        return [
            _on_plan(track.rows_where(within_spans(track.time_s, one.on_plan_s)), one.plan)
            for one in visited_floors(walk)
        ]
    return [] if walk.plan is None else [_on_plan(track, walk.plan)]


def _on_plan(track: Track, plan: FloorPlan) -> dict[str, Any]:
    """Describe a floor plan, and how much of the track on its floor lies outside of it."""
    outside = ~plan.contains(track.position_m)
    return {
        "name": plan.name,
        "floor": plan.floor,
        "walkable_m2": plan.area_m2,
        "sigma_m": plan.sigma_m,
        "poses": len(track),
        "share_of_track_outside": float(outside.mean()) if len(track) else None,
        "notes": plan.notes,
    }
