"""The person whom several devices follow: their poses of one moment joined, as they become known.

At the end of every step of every device, the poses of all devices that record then are joined as `estimators.fused`
joins their tracks. Between two poses of a device its movement is even; a movement that takes longer than a step can
was not seen, and the device stays where it was. A moment depends on the poses next to it and on when the devices
recorded, and on nothing else: however the samples come, it ends up the same.
"""

from bisect import bisect_left, bisect_right
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from pdr_est.estimators.person.track import NAME, fuse
from pdr_est.frames import Array, wrap_angle
from pdr_est.online.update import Kind, Pose, Update
from pdr_est.types.track import Track

_LONGEST_STEP_S = 2.0  # ours; the segmentation of steps calls a longer pause a standstill


@dataclass(frozen=True)
class Recorded:
    """Of one device. spans_s: begin and end of what it recorded without a gap, the last ones; known_s: its poses up
    to then are known."""

    spans_s: Sequence[tuple[float, float]]
    known_s: float

    def at(self, time_s: float) -> bool:
        return any(begin_s <= time_s <= end_s for begin_s, end_s in reversed(self.spans_s))


class Person:
    """Takes poses of devices that are new or have changed, gives updates of the person likewise.

    A moment is given once every device that records then has a pose behind it, or cannot have one any more, or was
    waited for long enough.
    """

    def __init__(self, kind: Kind) -> None:
        self._kind: Kind = kind
        self._times_s: list[list[float]] = []  # of the poses, by device
        self._poses: list[dict[float, Pose]] = []
        self._due: set[float] = set()  # moments that are to be found, or found anew
        self._given: OrderedDict[float, Update] = OrderedDict()  # nearly in the order of time
        self._last_s = -inf  # the latest of them
        self.waits = False  # whether moments may have become complete

    def take(self, poses: Sequence[Pose], devices: int) -> None:
        """Take poses of some devices, or that more is known of when they recorded."""
        self.waits = True
        self._make_room(devices)
        for pose in poses:
            time_s, times_s = pose.node.time_s, self._times_s[pose.device]
            at = bisect_left(times_s, time_s)
            if time_s not in self._poses[pose.device]:
                times_s.insert(at, time_s)
            self._poses[pose.device][time_s] = pose
            self._again(times_s[at - 1] if at else -inf, times_s[at + 1] if at + 1 < len(times_s) else inf)
            self._due.add(time_s)

    def recorded(self, device: int, from_s: float, to_s: float) -> None:
        """A device turns out to have recorded during that time."""
        if device < len(self._times_s) and from_s < self._last_s:
            self._due |= {time_s for time_s in self._given if from_s < time_s <= to_s}

    def give(self, devices: Sequence[Recorded], waited_s: float, most: int | None = None) -> list[Update]:
        """The moments that are complete, in order of time. waited_s: of those before nobody is waited for.

        most: how many to look at, at most.
        """
        self._make_room(len(devices))
        ready = [time_s for time_s in sorted(self._due) if time_s < waited_s or self._complete(time_s, devices)]
        self.waits = most is not None and len(ready) > most
        found = []
        for time_s in ready[:most]:
            self._due.discard(time_s)
            update = self._at(time_s, devices)
            if update is not None and not _same(update, self._given.get(time_s)):
                self._given[time_s] = update
                self._last_s = max(self._last_s, time_s)
                found.append(update)
        return found

    def forget(self, before_s: float) -> None:
        """Moments before a time will not change any more."""
        # Of each device one stays, from which it moves on.
        counts = [max(bisect_left(times_s, before_s) - 1, 0) for times_s in self._times_s]
        for times_s, poses, count in zip(self._times_s, self._poses, counts, strict=True):
            for time_s in times_s[:count]:
                del poses[time_s]
            del times_s[:count]
        if any(counts):
            self._due = {time_s for time_s in self._due if time_s >= before_s}
        while self._given and next(iter(self._given)) < before_s:
            self._given.popitem(last=False)

    def _make_room(self, devices: int) -> None:
        for _ in range(len(self._times_s), devices):
            self._times_s.append([])
            self._poses.append({})

    def _again(self, after_s: float, before_s: float) -> None:
        """All moments between two times are due."""
        for times_s in self._times_s:
            self._due.update(times_s[bisect_right(times_s, after_s) : bisect_left(times_s, before_s)])

    def _complete(self, time_s: float, devices: Sequence[Recorded]) -> bool:
        return all(
            (times_s and times_s[-1] >= time_s) or device.known_s >= time_s
            for times_s, device in zip(self._times_s, devices, strict=True)
        )

    def _at(self, time_s: float, devices: Sequence[Recorded]) -> Update | None:
        own = next((poses[time_s] for poses in self._poses if time_s in poses), None)
        if own is None:
            return None
        known = [
            pose
            for number, device in enumerate(devices)
            if (number == own.device or device.at(time_s)) and (pose := self._pose(number, time_s)) is not None
        ]
        joined = fuse(_track(known, own, self._kind))
        return Update(
            device=NAME,
            time_s=time_s,
            position_m=joined.position_m[0],
            covariance_m2=joined.covariance_m2[0],
            heading_rad=float(joined.heading_rad[0]),
            sigma_heading_rad=float(joined.sigma_heading_rad[0]),
            kind=self._kind,
            step_length_m=own.node.step_length_m * own.scale[0],
            mode=own.node.mode,
            moving_from_s=own.node.moving_from_s,
        )

    def _pose(self, device: int, time_s: float) -> tuple[Array, Array] | None:
        """Pose (3,) and covariance (3, 3) of a device at a time; None before its first."""
        times_s, poses = self._times_s[device], self._poses[device]
        after = bisect_right(times_s, time_s)
        if not after:
            return None
        before = poses[times_s[after - 1]]
        if after == len(times_s) or before.node.time_s == time_s:
            return before.pose, before.covariance
        following = poses[times_s[after]]
        begin_s = max(following.node.moving_from_s, before.node.time_s)
        span_s = following.node.time_s - begin_s
        if time_s <= begin_s or span_s > _LONGEST_STEP_S:
            return before.pose, before.covariance
        share, way = (time_s - begin_s) / span_s, following.pose - before.pose
        way[2] = wrap_angle(way[2])
        return before.pose + share * way, before.covariance + share * (following.covariance - before.covariance)


def _track(known: Sequence[tuple[Array, Array]], own: Pose, kind: Kind) -> Track:
    """Poses of one moment as tracks of one pose each."""
    pose, covariance = np.array([pose for pose, _ in known]), np.array([spread for _, spread in known])
    at_once = np.full(len(known), own.node.time_s)
    return Track(
        time_s=at_once,
        moving_from_s=at_once,
        device=np.array([str(number) for number in range(len(known))]),
        position_m=pose[:, :2],
        heading_rad=pose[:, 2],
        covariance_m2=covariance[:, :2, :2],
        sigma_heading_rad=np.sqrt(covariance[:, 2, 2]),
        mode=np.full(len(known), own.node.mode, dtype=np.int8),
        step_length_m=np.zeros(len(known)),
        kind=kind,
        estimator="",
    )


def _same(update: Update, other: Update | None) -> bool:
    return other is not None and bool(
        (update.position_m == other.position_m).all()
        and (update.covariance_m2 == other.covariance_m2).all()
        and update.heading_rad == other.heading_rad
        and update.sigma_heading_rad == other.sigma_heading_rad
    )
