"""Assembly of updates from the poses of filter and smoother: those of each device, and those of the person."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf

import numpy as np

from pdr_est.config import Config
from pdr_est.estimators.common.unknown_direction import tells_direction
from pdr_est.evaluate.walk_findings import FindingsSoFar
from pdr_est.online.device_front_end import DeviceFrontEnd
from pdr_est.online.heights.floors_with_plans import FloorsWithPlans
from pdr_est.online.heights.told_heights import ToldHeights
from pdr_est.online.params import OnlineParams
from pdr_est.online.person_estimates import DeviceCoverage, PersonEstimates
from pdr_est.online.update import Kind, PoseEstimate, Update, at_mounting, in_unknown_direction, update_of
from pdr_est.types.height import WalkerHeight
from pdr_est.types.measurements import HeadingPrior, PositionFix, StepOdometry
from pdr_est.types.sensors import SensorBlock


class UpdateAssembly:
    """Makes updates of the devices, each where it is mounted on the body, and of the person.

    Parameters
    ----------
    names, front_ends
        Name and front end of each device; lists that may grow.
    config
        Start pose, mounting of the devices, uncertainty of the length scale, and heights.
    online
        Waiting.
    delays_s
        Time by which poses of each kind come later than those of the filter.
    floors
        Floors with their plans, which get the heights.
    """

    def __init__(
        self,
        names: Sequence[str],
        front_ends: Sequence[DeviceFrontEnd],
        config: Config,
        online: OnlineParams,
        delays_s: dict[Kind, float],
        floors: FloorsWithPlans,
    ) -> None:
        start = config.start.pose()
        unknown = start.heading_rad is None and start.position_m is not None
        self._turned_about_m = np.array(start.position_m) if unknown else None  # while nothing tells the direction
        self._findings = FindingsSoFar(config.odometry.sigma_length_scale)
        self._names, self._front_ends, self._devices = names, front_ends, config.devices
        self._wait_s, self._delays_s = online.wait_s, delays_s
        self._persons: dict[Kind, PersonEstimates] = {kind: PersonEstimates(kind) for kind in delays_s}
        self._heights = ToldHeights(config.height, online.horizon_s + max(delays_s.values()), floors)

    @property
    def height(self) -> WalkerHeight | None:
        """Return height and floor of the walker at the last second for which they are known."""
        return self._heights.latest

    def listen(self, device: str, block: SensorBlock) -> None:
        """Take the samples of a device from which the height is known."""
        self._heights.push(self._names.index(device), block)

    @property
    def pending_person(self) -> Kind | None:
        """Return a kind for which new poses of the person may be known; None if there is none."""
        if len(self._names) < 2:
            return None
        return next((kind for kind, person in self._persons.items() if person.pending), None)

    def extend(
        self, device: int, from_s: float, to_s: float, measurements: Sequence[StepOdometry | HeadingPrior]
    ) -> None:
        """Take note that a device recorded between two times, and of what was measured then."""
        if self._turned_about_m is not None and any(tells_direction(one) for one in measurements):
            self._turned_about_m = None
        for person in self._persons.values():
            person.extend(device, from_s, to_s)
        self._heights.extend(device, measurements, to_s - self._front_ends[device].step_latency_s)

    def add_fix(self, fix: PositionFix) -> None:
        """Take note of a fix, which the poses after it are compared with."""
        self._findings.add_fix(fix)
        self._turned_about_m = None

    def of_devices(self, kind: Kind, poses: Sequence[PoseEstimate]) -> list[Update]:
        """Make the updates of device poses; only the ends of steps have one. New findings come with the last one."""
        steps = [pose for pose in poses if pose.node.is_step]
        self._persons[kind].add(steps, len(self._names))
        centred = [update_of(pose, self._names[pose.device], kind) for pose in steps]
        updates = [self._turned(self._mounted(update)) for update in centred]
        if kind == "filtered" and steps:
            findings = self._findings.add(centred, steps[-1].scale[0])
            updates[-1] = replace(updates[-1], findings=tuple(findings)) if findings else updates[-1]
        return self._heights.added_to(updates)

    def of_person(self, kind: Kind, now_s: float, most: int | None = None) -> list[Update]:
        """Make the updates of the person's poses that are new or have changed.

        Parameters
        ----------
        kind
            Kind of the poses.
        now_s
            Newest data time; infinity at the end of the walk.
        most
            Largest number of poses to look at; None for no limit.
        """
        if len(self._names) < 2:
            return []
        delay_s, devices = self._delays_s[kind], []
        for front_end in self._front_ends:
            end_s = -inf if front_end.end_s is None else front_end.end_s
            known_s = now_s if now_s == inf else end_s - front_end.step_latency_s - delay_s
            devices.append(DeviceCoverage(front_end.spans_s, known_s))
        given = self._persons[kind].give(devices, now_s - self._patience_s - delay_s, most)
        return self._heights.added_to([self._turned(update) for update in given])

    def last(self, delayed: Sequence[PoseEstimate] | None) -> list[Update]:
        """Make the remaining updates at the end of the walk: delayed, of the person, and of revised heights.

        Parameters
        ----------
        delayed
            Remaining delayed poses; None where there are no such estimates.
        """
        found = [] if delayed is None else self.of_devices("delayed", delayed)
        found += [update for kind in self._persons for update in self.of_person(kind, inf)]
        return [*found, *self._heights.last()]

    def forget(self, before_s: float) -> None:
        """Forget poses of the filter before a time, which will not change any more."""
        for kind, person in self._persons.items():
            person.forget(before_s - self._patience_s - self._delays_s[kind])

    @property
    def _patience_s(self) -> float:
        """Time for which the person waits for the pose of a device that may not come."""
        return self._wait_s + max((front_end.step_latency_s for front_end in self._front_ends), default=0.0)

    def _turned(self, update: Update) -> Update:
        return update if self._turned_about_m is None else in_unknown_direction(update, self._turned_about_m)

    def _mounted(self, update: Update) -> Update:
        offset_m = self._devices.mounting_of(update.device).offset_m if len(self._names) > 1 else (0.0, 0.0)
        return at_mounting(update, offset_m)
