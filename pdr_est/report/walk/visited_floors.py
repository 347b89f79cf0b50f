"""The floors of a walk for which the plans of several were given, and when the walker was on each."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.pipeline import SmoothedWalk
from pdr_est.types.floor_plan import FloorPlan, PresentFloor
from pdr_est.types.height import HeightProfile
from pdr_est.types.track import Track

Spans = tuple[tuple[float, float], ...]
"""Begins and ends of times, s."""


@dataclass(frozen=True)
class VisitedFloor:
    """A floor that the walker was on.

    Attributes
    ----------
    plan
        Its plan.
    on_plan_s
        Times on the floor, s.
    shown_s
        The same with the ways to it and from it, on stairs and in lifts, s.
    """

    plan: FloorPlan
    on_plan_s: Spans
    shown_s: Spans

    @property
    def title(self) -> str:
        """Name of the floor in words."""
        return f"floor {self.plan.floor}"


def within_spans(time_s: Array, spans_s: Spans) -> NDArray[np.bool_]:
    """Tell which times (n,) lie within spans, each with its begin and without its end."""
    found = np.zeros(len(time_s), dtype=np.bool_)
    for begin_s, end_s in spans_s:
        found |= (time_s >= begin_s) & (time_s < end_s)
    return found


def part_on_floor(track: Track, floor: VisitedFloor) -> Track:
    """Select the poses on a floor and on the ways to it and from it; its line breaks between two visits.

    The first pose of a later visit has no position, so that no line leads there from the end of the one before.
    """
    inside = within_spans(track.time_s, floor.shown_s)
    part = track.rows_where(inside)
    begins = inside & ~np.concatenate([[True], inside[:-1]])
    again = (begins & (track.device == np.roll(track.device, 1)))[inside]
    again &= part.time_s > floor.shown_s[0][1]  # of later visits
    position_m, covariance_m2 = part.position_m.copy(), part.covariance_m2.copy()
    position_m[again], covariance_m2[again] = np.nan, np.nan
    return replace(part, position_m=position_m, covariance_m2=covariance_m2)


def visited_floors(walk: SmoothedWalk) -> tuple[VisitedFloor, ...]:
    """List the floors of a walk that have a plan, the lowest one first; none where not several plans were given."""
    floors = walk.floors
    ends_s = [one.time_s for one in floors[1:]] + [np.inf] * (len(floors) > 0)
    found: dict[int, VisitedFloor] = {}
    for place, (one, end_s) in enumerate(zip(floors, ends_s, strict=True)):
        if one.plan is None:
            continue
        wide = _begin_of_way(floors, place), _end_of_way(floors, ends_s, place)
        before = found.get(id(one.plan), VisitedFloor(one.plan, (), ()))
        on_plan_s, shown_s = _extended(before.on_plan_s, (one.time_s, end_s)), _extended(before.shown_s, wide)
        found[id(one.plan)] = VisitedFloor(one.plan, on_plan_s, shown_s)
    profile = walk.track.height
    return tuple(sorted(found.values(), key=lambda floor: _height_m(floor, profile)))


def _extended(spans_s: Spans, span_s: tuple[float, float]) -> Spans:
    """Return spans with a later one, joined to the last of them where there is no time between the two."""
    if spans_s and span_s[0] <= spans_s[-1][1]:
        return (*spans_s[:-1], (spans_s[-1][0], span_s[1]))
    return (*spans_s, span_s)


def _begin_of_way(floors: tuple[PresentFloor, ...], place: int) -> float:
    """Return when the way to a floor begins, s."""
    before = place - 1
    return floors[before].time_s if before >= 0 and floors[before].plan is None else floors[place].time_s


def _end_of_way(floors: tuple[PresentFloor, ...], ends_s: list[float], place: int) -> float:
    """Return when the way from a floor ends, s."""
    after = place + 1
    return ends_s[after] if after < len(floors) and floors[after].plan is None else ends_s[place]


def _height_m(floor: VisitedFloor, profile: HeightProfile | None) -> float:
    if profile is None:
        return 0.0
    inside = within_spans(profile.time_s, floor.on_plan_s)
    return float(np.median(profile.height_m[inside])) if inside.any() else 0.0
