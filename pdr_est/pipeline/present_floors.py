"""The plan of the floor that the walker is on, second by second, from height and floor by the air pressure."""

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from pdr_est.errors import FloorPlanError
from pdr_est.frames import Array
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan, PresentFloor
from pdr_est.types.height import HeightProfile, WalkerHeight

AROUND_MOVE_S = 3
"""Time before and after a move for which no plan counts, s (ours): when it begins is known to a few seconds, and the
plan of a floor need not show its stairs as walkable. Landings of stairs are shorter than twice this time."""

_CLEARLY_M = 1.0  # the mean of a place round a corner lies off the floor

_BEFORE_S = 0.5  # by which a second begins before the time that its height is told for, its middle
_DIGITS = 2  # of the probability of a floor: smaller changes change no walls


class FloorSequence:
    """Turns the heights of consecutive seconds into the floors with their plans.

    What is known about a second is given `AROUND_MOVE_S` later.

    Parameters
    ----------
    building
        The plans, with the floor at the start.
    """

    def __init__(self, building: BuildingPlan) -> None:
        self._building = building
        self._seconds: deque[WalkerHeight] = deque(maxlen=2 * AROUND_MOVE_S + 1)
        self._given = PresentFloor(-inf, building.start_plan)

    @property
    def first(self) -> PresentFloor:
        """Floor at the start of the walk."""
        return PresentFloor(-inf, self._building.start_plan)

    def add(self, second: WalkerHeight) -> Iterator[PresentFloor]:
        """Take the next second; yield the floor of an earlier one if it is another than that before it."""
        self._seconds.append(second)
        if len(self._seconds) > AROUND_MOVE_S:
            yield from self._changed(self._seconds[-1 - AROUND_MOVE_S])

    def flush(self) -> Iterator[PresentFloor]:
        """End the walk; yield the floors of the last seconds that are others than those before."""
        for place in range(max(len(self._seconds) - AROUND_MOVE_S, 0), len(self._seconds)):
            yield from self._changed(self._seconds[place])

    def _changed(self, one: WalkerHeight) -> Iterator[PresentFloor]:
        plan, probability = None, 1.0
        near = (other for other in self._seconds if abs(other.time_s - one.time_s) <= AROUND_MOVE_S)
        if self._building.start is not None and not any(other.moving for other in near):
            plan, probability = self._building.plan_of(self._building.start + one.floor), one.floor_probability
        probability = 1.0 if plan is None else round(probability, _DIGITS)
        if plan is not self._given.plan or probability != self._given.probability:
            self._given = PresentFloor(one.time_s - _BEFORE_S, plan, probability)
            yield self._given


@dataclass(frozen=True)
class PlansOfWalk:
    """Plans of the floors of a walk.

    Attributes
    ----------
    floors
        The floors in order of time, with their plans; a single one for a walk on one plan, none without a plan.
    notes
        What had to be assumed, in words.
    """

    floors: tuple[PresentFloor, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def measurements(self) -> tuple[FloorPlan | PresentFloor, ...]:
        """Measurements for an estimator that uses plans: the plan alone if there is only one."""
        if len(self.floors) == 1 and self.floors[0].plan is not None:
            return (self.floors[0].plan,)
        return self.floors

    def main_plan(self, step_time_s: Sequence[float]) -> FloorPlan | None:
        """Return the plan that most steps were made on, by their times, s; None without a plan."""
        begins_s = [one.time_s for one in self.floors]
        steps = np.bincount(np.searchsorted(begins_s, step_time_s, side="right"), minlength=len(begins_s) + 1)[1:]
        of_plan: dict[int, int] = {}
        for one, count in zip(self.floors, steps.tolist(), strict=True):
            if one.plan is not None:
                of_plan[id(one.plan)] = of_plan.get(id(one.plan), 0) + count
        plans = {id(one.plan): one.plan for one in self.floors}
        return plans[max(of_plan, key=lambda key: of_plan[key])] if of_plan else None

    def share_outside(self, time_s: Array, position_m: Array) -> float:
        """Return the share of poses at times (n,), s, whose positions (n, 2), m, are clearly off the plan there.

        Poses between floors, and on floors without a plan, do not count; 0 without any other.
        """
        at = np.searchsorted([one.time_s for one in self.floors], time_s, side="right") - 1
        outside = []
        for number, one in enumerate(self.floors):
            if one.plan is not None:
                off_m = one.plan.distance_outside_m(position_m[at == number])
                outside.append(off_m > _CLEARLY_M + 3.0 * one.plan.sigma_m)
        found = np.concatenate(outside) if outside else np.zeros(0, dtype=bool)
        return float(found.mean()) if len(found) else 0.0


def plans_of_walk(plan: FloorPlan | BuildingPlan | None, walks: Sequence[DeviceWalk]) -> PlansOfWalk:
    """Find the floors of a walk and their plans.

    Parameters
    ----------
    plan
        Plan of the only floor, or of several; None for none.
    walks
        Devices of the walk; the first one with air pressure tells the floor.

    Raises
    ------
    FloorPlanError
        If the floor at the start is not given, and several are possible.
    """
    if plan is None:
        return PlansOfWalk()
    if isinstance(plan, FloorPlan):
        return PlansOfWalk((PresentFloor(-inf, plan),))
    profile = next((walk.height for walk in walks if walk.height is not None), None)
    building, notes = _with_start(plan, profile)
    sequence = FloorSequence(building)
    if profile is None:
        return PlansOfWalk((sequence.first,), (*notes, without_air_pressure(building)))
    found = [sequence.first]
    for second in _seconds(profile):
        found += sequence.add(second)
    found += sequence.flush()
    start = building.start or 0
    missing = sorted({start + number for number in _level_floors(profile)} - set(building.numbers))
    if missing:
        words = ", ".join(map(str, missing))
        notes = (*notes, f"no plan of floor {words}, where the walker was: the track is free there")
    return PlansOfWalk(tuple(found), notes)


def without_air_pressure(building: BuildingPlan) -> str:
    """Say what follows for a walk in a building if no air pressure was recorded."""
    floor = "" if building.start_plan is None else f" {building.start_plan.floor}"
    return f"no air pressure was recorded, so that the whole walk counts as one on floor{floor}"


def _with_start(plan: BuildingPlan, profile: HeightProfile | None) -> tuple[BuildingPlan, tuple[str, ...]]:
    """Find the floor at the start, if it is not given: the only one from which all floors visited have a plan."""
    if plan.start is not None:
        return plan, ()
    visited = [0] if profile is None else _level_floors(profile)
    possible = [start for start in plan.numbers if all(start + floor in plan.numbers for floor in visited)]
    if len(possible) == 1:
        found = replace(plan, start=possible[0])
        name = "" if found.start_plan is None else found.start_plan.floor
        words = f"the walk counts as one that begins on floor {name}: only then all visited floors have a plan"
        return found, (words,)
    raise FloorPlanError(
        f"{plan.name}: shows the floors {plan.floor_names}, and where the walk begins is not known: say on which of "
        "them (--floor NAME)"
    )


def _level_floors(profile: HeightProfile) -> list[int]:
    """Return the numbers of the floors on which the walker was, not only passed on the way."""
    return sorted(set(profile.floor[~profile.moving].tolist()))


def _seconds(profile: HeightProfile) -> Iterator[WalkerHeight]:
    columns = (profile.time_s, profile.height_m, profile.sigma_m, profile.floor, profile.floor_probability)
    for row in zip(*(column.tolist() for column in (*columns, profile.moving)), strict=True):
        yield WalkerHeight(*row)
