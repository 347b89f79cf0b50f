"""Poses of the person who carries several devices: the devices' poses at one time fused, as soon as they are known.

At the end of every step of every device, the poses of all devices that record at that time are fused in the same way
as their tracks in `estimators/person/track.py`. Between two poses a device moves at an even pace; a motion that takes
longer than a step can was not observed, and the device stays at the earlier pose. A fused pose depends on the device
poses next to it and on when the devices recorded, and on nothing else: it does not depend on how the samples come.
"""

from bisect import bisect_left, bisect_right
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from pdr_est.estimators.person.track import NAME, fuse_at_one_time
from pdr_est.frames import Array, wrap_angle
from pdr_est.online.update import Kind, PoseEstimate, Update

_LONGEST_STEP_S = 2.0  # ours; the step segmentation treats a longer pause as a standstill


@dataclass(frozen=True)
class DeviceCoverage:
    """Times at which one device recorded.

    Attributes
    ----------
    spans_s
        Begin and end of its latest recordings without a gap.
    known_s
        Time up to which its poses are known.
    """

    spans_s: Sequence[tuple[float, float]]
    known_s: float

    def recorded_at(self, time_s: float) -> bool:
        """Tell whether the device recorded at a time."""
        return any(begin_s <= time_s <= end_s for begin_s, end_s in reversed(self.spans_s))


class PersonEstimates:
    """Fuses poses of devices that are new or have changed into updates of the person.

    A pose of the person is given once every device that records at its time has a pose at or after it, can no longer
    have one, or was waited for long enough.

    Parameters
    ----------
    kind
        Kind of the poses.

    Attributes
    ----------
    pending
        True if poses of the person may have become known.
    """

    def __init__(self, kind: Kind) -> None:
        self._kind: Kind = kind
        self._times_s: list[list[float]] = []  # of the poses, by device
        self._poses: list[dict[float, PoseEstimate]] = []
        self._due: set[float] = set()  # times at which the pose of the person must be computed
        self._given: OrderedDict[float, Update] = OrderedDict()  # nearly in order of time
        self._last_s = -inf  # latest time of them
        self.pending = False

    @property
    def remembered(self) -> int:
        """Number of remembered poses: those that are due, and those that were given and may change."""
        return len(self._due) + len(self._given)

    def add(self, poses: Sequence[PoseEstimate], devices: int) -> None:
        """Add new or changed poses of devices.

        Parameters
        ----------
        poses
            Poses in order of time; none if only the times at which devices recorded have changed.
        devices
            Number of devices.
        """
        self.pending = True
        self._make_room(devices)
        for pose in poses:
            time_s, times_s = pose.node.time_s, self._times_s[pose.device]
            at = bisect_left(times_s, time_s)
            if time_s not in self._poses[pose.device]:
                times_s.insert(at, time_s)
            self._poses[pose.device][time_s] = pose
            self._recompute(times_s[at - 1] if at else -inf, times_s[at + 1] if at + 1 < len(times_s) else inf)
            self._due.add(time_s)

    def extend(self, device: int, from_s: float, to_s: float) -> None:
        """Take note that a device recorded between two times."""
        if device < len(self._times_s) and from_s < self._last_s:
            self._due |= {time_s for time_s in self._given if from_s < time_s <= to_s}

    def give(self, devices: Sequence[DeviceCoverage], waited_s: float, most: int | None = None) -> list[Update]:
        """Return the updates of the poses that are complete, in order of time.

        Parameters
        ----------
        devices
            Coverage of each device.
        waited_s
            Time before which no device is waited for any more.
        most
            Largest number of poses to look at; None for no limit.
        """
        self._make_room(len(devices))
        ready = [time_s for time_s in sorted(self._due) if time_s < waited_s or self._complete(time_s, devices)]
        self.pending = most is not None and len(ready) > most
        found = []
        for time_s in ready[:most]:
            self._due.discard(time_s)
            update = self._fused(time_s, devices)
            if update is not None and not _same(update, self._given.get(time_s)):
                self._given[time_s] = update
                self._last_s = max(self._last_s, time_s)
                found.append(update)
        return found

    def forget(self, before_s: float) -> None:
        """Forget poses before a time, which will not change any more."""
        # One pose of each device before that time stays, from which it moves on.
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

    def _recompute(self, after_s: float, before_s: float) -> None:
        """Mark all poses between two times as due."""
        for times_s in self._times_s:
            self._due.update(times_s[bisect_right(times_s, after_s) : bisect_left(times_s, before_s)])

    def _complete(self, time_s: float, devices: Sequence[DeviceCoverage]) -> bool:
        """Tell whether the poses of all devices around a time are known."""
        return all(
            (times_s and times_s[-1] >= time_s) or device.known_s >= time_s
            for times_s, device in zip(self._times_s, devices, strict=True)
        )

    def _fused(self, time_s: float, devices: Sequence[DeviceCoverage]) -> Update | None:
        """Fuse the poses of all devices that recorded at a time; None if no step ended then."""
        own = next((poses[time_s] for poses in self._poses if time_s in poses), None)
        if own is None:
            return None
        known = [
            pose
            for number, device in enumerate(devices)
            if number == own.device or device.recorded_at(time_s)
            if (pose := self._pose(number, time_s)) is not None
        ]
        poses, covariances = (np.array(column) for column in zip(*known, strict=True))
        position_m, covariance_m2, heading_rad, sigma_heading_rad = fuse_at_one_time(poses, covariances)
        return Update(
            device=NAME,
            time_s=time_s,
            position_m=position_m,
            covariance_m2=covariance_m2,
            heading_rad=heading_rad,
            sigma_heading_rad=sigma_heading_rad,
            kind=self._kind,
            step_length_m=own.node.step_length_m * own.scale[0],
            mode=own.node.mode,
            moving_from_s=own.node.moving_from_s,
        )

    def _pose(self, device: int, time_s: float) -> tuple[Array, Array] | None:
        """Interpolate the pose (3,) of a device and its covariance (3, 3); None before its first pose."""
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
        share, change = (time_s - begin_s) / span_s, following.pose - before.pose
        change[2] = wrap_angle(change[2])
        return before.pose + share * change, before.covariance + share * (following.covariance - before.covariance)


def _same(update: Update, other: Update | None) -> bool:
    """Tell whether two updates of one time have the same pose."""
    return other is not None and bool(
        (update.position_m == other.position_m).all()
        and (update.covariance_m2 == other.covariance_m2).all()
        and update.heading_rad == other.heading_rad
        and update.sigma_heading_rad == other.sigma_heading_rad
    )
