"""Heights of updates: each update gets what is known about its time, and comes again when that is revised."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import floor, inf

from pdr_est.front_end.height import HeightParams
from pdr_est.front_end.height.following import REVISED_S, HeightFollower
from pdr_est.front_end.height.seconds import Second
from pdr_est.online.heights.floors_with_plans import FloorsWithPlans
from pdr_est.online.heights.pressure_seconds import PressureSeconds
from pdr_est.online.update import Update
from pdr_est.types.height import WalkerHeight
from pdr_est.types.measurements import HeadingPrior, StepOdometry
from pdr_est.types.sensors import Channel, SensorBlock

_STEPS_LATE_S = 10  # longer than it takes the front end to be sure of a step
_Key = tuple[str, str, float]  # kind, device and time of an update


class ToldHeights:
    """Adds height and floor to updates.

    They are those of the walker, by the first device that sends the air pressure. An update comes again at once when
    the floor at its time turns out to be another, and when what is known about its time is settled and is not what
    was told.

    Parameters
    ----------
    parameters
        Rates of moves, storeys and noise.
    late_s
        Time by which the air pressure may come later than the poses, s.
    floors
        Floors with their plans, which get each second.
    """

    def __init__(self, parameters: HeightParams, late_s: float, floors: FloorsWithPlans) -> None:
        self._parameters, self._late_s, self._floors = parameters, late_s, floors
        self._seconds: dict[int, PressureSeconds] = {}  # by device
        self._followers: dict[int, HeightFollower] = {}
        self._told: dict[_Key, Update] = {}  # updates that may come again
        self._revised: dict[_Key, Update] = {}
        self._newest_s = -inf  # of the poses

    @property
    def remembered(self) -> int:
        """Number of updates that may come again."""
        return len(self._told)

    @property
    def latest(self) -> WalkerHeight | None:
        """Return what is known about the last second; None without air pressure."""
        follower = self._follower
        return None if follower is None else follower.latest

    def push(self, device: int, block: SensorBlock) -> None:
        """Take the samples of a device, of which only the air pressure counts."""
        if block.channel == Channel.PRESSURE and self._parameters.enabled:
            self._seconds.setdefault(device, PressureSeconds(_STEPS_LATE_S)).push(block)

    def extend(self, device: int, measurements: Iterable[StepOdometry | HeadingPrior], known_s: float) -> None:
        """Take the steps of a device, which are all known up to a time, and what follows for the heights."""
        if self._parameters.enabled:
            seconds = self._seconds.setdefault(device, PressureSeconds(_STEPS_LATE_S))
            steps_s = [one.time_s for one in measurements if isinstance(one, StepOdometry)]
            seconds.add_steps(steps_s, known_s)
            self._follow(device)

    def added_to(self, updates: Sequence[Update]) -> list[Update]:
        """Add what is known to new updates; return them after the older ones that it has changed."""
        found = []
        for update in updates:
            one = self._with_height(update)
            self._told[_key(update)] = replace(one, findings=())
            self._newest_s = max(self._newest_s, update.time_s)
            found.append(one)
        again, self._revised = self._revised, {}
        keys = {_key(update) for update in updates}
        self._forget()
        return [*(one for key, one in again.items() if key not in keys), *found]

    def last(self) -> list[Update]:
        """End the walk; return the updates that change once more."""
        for device in self._seconds:
            self._follow(device, at_end=True)
        self._settle(inf)
        return self.added_to([])

    @property
    def _source(self) -> int | None:
        """Return the device whose air pressure counts."""
        return min((device for device, one in self._seconds.items() if one.has_pressure), default=None)

    @property
    def _follower(self) -> HeightFollower | None:
        return None if self._source is None else self._followers.get(self._source)

    def _follow(self, device: int, at_end: bool = False) -> None:
        """Follow the heights by the seconds of a device that are complete."""
        for number, height_m, stepped_before in self._seconds[device].take(at_end):
            follower = self._followers.setdefault(device, HeightFollower(self._parameters))
            follower.add_steps(number - _STEPS_LATE_S, stepped_before)
            follower.add(number, Second(height_m, None))
            if device == self._source:
                self._floors.add(follower.latest)
                self._revise_floors()
                self._settle(float(number + 1 - REVISED_S))

    def _revise_floors(self) -> None:
        """Tell updates again whose floor has turned out to be another."""
        for key, update in self._told.items():
            one = self._with_height(update)
            if one.floor != update.floor:
                self._told[key] = self._revised[key] = one

    def _settle(self, before_s: float) -> None:
        """Tell updates before a time for the last time, if their height is not what was told."""
        for key in [key for key in self._told if floor(key[2]) + 1.0 <= before_s]:
            update = self._told.pop(key)
            one = self._with_height(update)
            if _height_of(one) != _height_of(update):
                self._revised[key] = one

    def _forget(self) -> None:
        """Forget updates for which the air pressure would come too late."""
        if self._told and next(iter(self._told))[2] < self._newest_s - self._late_s - REVISED_S:
            self._settle(self._newest_s - self._late_s - REVISED_S)

    def _with_height(self, update: Update) -> Update:
        follower = self._follower
        known = None if follower is None else follower.at(update.time_s)
        if known is None:
            return update
        return replace(
            update,
            height_m=round(known.height_m, 2) + 0.0,
            sigma_height_m=round(known.sigma_m, 2),
            floor=known.floor,
            floor_probability=round(known.floor_probability, 3),
        )


def _key(update: Update) -> _Key:
    return update.kind, update.device, update.time_s


def _height_of(update: Update) -> tuple[float | None, float | None, int | None, float | None]:
    return update.height_m, update.sigma_height_m, update.floor, update.floor_probability
