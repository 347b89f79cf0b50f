"""Poses of the filter and of the smoother as updates: of each device where it sits on the body, and of the person."""

from collections.abc import Sequence
from math import inf

from pdr_est.config import DevicesParams
from pdr_est.online.device_front_end import DeviceFrontEnd
from pdr_est.online.person_estimates import Person, Recorded
from pdr_est.online.update import Kind, Pose, Update, placed, update_of


class Estimates:
    """fronts, names: of the devices, lists that go on. wait_s: how long the person waits for devices; behind_s: how
    much later than the filter's the poses of a kind come."""

    def __init__(
        self,
        names: Sequence[str],
        fronts: Sequence[DeviceFrontEnd],
        devices: DevicesParams,
        wait_s: float,
        behind_s: dict[Kind, float],
    ) -> None:
        self._names, self._fronts, self._devices = names, fronts, devices
        self._wait_s, self._behind_s = wait_s, behind_s
        self._persons: dict[Kind, Person] = {kind: Person(kind) for kind in behind_s}

    @property
    def waits(self) -> Kind | None:
        """A kind in which there may be something to say of the person."""
        if len(self._names) < 2:
            return None
        return next((kind for kind, person in self._persons.items() if person.waits), None)

    def recorded(self, device: int, from_s: float, to_s: float) -> None:
        """A device turns out to have recorded during that time."""
        for person in self._persons.values():
            person.recorded(device, from_s, to_s)

    def of_devices(self, kind: Kind, poses: Sequence[Pose]) -> list[Update]:
        """The ends of steps among some poses, where the devices sit on the body."""
        steps = [pose for pose in poses if pose.node.is_step]
        self._persons[kind].take(steps, len(self._names))
        return [self._of_device(kind, pose) for pose in steps]

    def of_person(self, kind: Kind, now_s: float, most: int | None = None) -> list[Update]:
        """The person's poses that are new or have changed. now_s: the newest data time, infinite at the end of the
        walk; most: how many to look at, at most."""
        if len(self._names) < 2:
            return []
        behind_s, devices = self._behind_s[kind], []
        for front in self._fronts:
            end_s = -inf if front.end_s is None else front.end_s
            known_s = now_s if now_s == inf else end_s - front.behind_end_s - behind_s
            devices.append(Recorded(front.spans_s, known_s))
        return self._persons[kind].give(devices, now_s - self._patience_s - behind_s, most)

    def last_of_person(self) -> list[Update]:
        """At the end of the walk."""
        return [update for kind in self._persons for update in self.of_person(kind, inf)]

    def forget(self, before_s: float) -> None:
        """The filter's poses before a time will not change any more."""
        for kind, person in self._persons.items():
            person.forget(before_s - self._patience_s - self._behind_s[kind])

    @property
    def _patience_s(self) -> float:
        """How long the person waits for the pose of a device that may not come."""
        return self._wait_s + max((front.behind_end_s for front in self._fronts), default=0.0)

    def _of_device(self, kind: Kind, pose: Pose) -> Update:
        name = self._names[pose.device]
        offset_m = self._devices.mounting_of(name).offset_m if len(self._names) > 1 else (0.0, 0.0)
        return placed(update_of(pose, name, kind), offset_m)
