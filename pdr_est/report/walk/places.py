"""Numbers about the floors of a walk: heights, and the floor plan."""

from dataclasses import asdict
from typing import Any

from pdr_est.pipeline import SmoothedWalk
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.height import HeightProfile


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


def describe_walk_on_plan(walk: SmoothedWalk, plan: FloorPlan) -> dict[str, Any]:
    """Describe the floor plan, and how much of the track lies outside of it."""
    outside = ~plan.contains(walk.track.of_device(walk.track.devices[-1]).position_m)
    return {
        "name": plan.name,
        "floor": plan.floor,
        "walkable_m2": plan.area_m2,
        "sigma_m": plan.sigma_m,
        "share_of_track_outside": float(outside.mean()),
        "notes": plan.notes,
    }
