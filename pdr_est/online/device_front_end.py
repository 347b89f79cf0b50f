"""The front end of one device, fed as its samples come."""

from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np

from pdr_est.config import Config
from pdr_est.front_end.odometry import Odometry
from pdr_est.parts import NO_PARTS, Parts
from pdr_est.pipeline.front_end_chain import heading_needs_magnetometer, level_chain, stepping
from pdr_est.preprocessing.quality.requirements import COARSE_SAMPLING_S
from pdr_est.stage import Chain
from pdr_est.types.measurements import HeadingPrior, StepOdometry
from pdr_est.types.sensors import Channel, LevelBlock, SensorBlock

_LOOK_S = 2.0  # of a device that nobody declared, until it is known how it records
_REMEMBERED = 1000  # stretches without a gap
_NEEDED = (Channel.SPECIFIC_FORCE, Channel.ROTATION_RATE)


@dataclass(frozen=True)
class ExpectedDevice:
    """A device that will send samples. own_attitude: whether to use the attitude that it records itself; None finds
    out from its first seconds, by the rule for recordings."""

    name: str
    own_attitude: bool | None = None


class DeviceFrontEnd:
    """Samples of one device to its odometry, piece by piece: `push` makes level samples, which wait, and each `work`
    takes what waits a part of the way.

    start_s, end_s: first and last time of what went all the way, None until there is one; spans_s: begin and end of
    each stretch of it without a gap, the last thousand. Accelerometer and gyroscope are needed: without one of them
    nothing ever comes out.
    """

    def __init__(self, device: ExpectedDevice, config: Config, parts: Parts = NO_PARTS) -> None:
        self._config = config
        self._parts_given = parts
        self._expected = device
        self._levels: Chain | None = None
        self._early: list[SensorBlock] = []
        to_steps = stepping(config, parts).stages
        heading = Chain([*to_steps[3:], Odometry(device.name, config.odometry)])
        self._parts = (Chain(to_steps[:1]), Chain(to_steps[1:3]), heading)  # about the same work each
        self._waiting: tuple[list[Any], ...] = ([], [], [])  # for each part
        self.start_s: float | None = None
        self.end_s: float | None = None
        self.spans_s: deque[tuple[float, float]] = deque(maxlen=_REMEMBERED)
        self._segment = -1
        self._seen: list[LevelBlock] = []  # by the first part, since all others had nothing to do

    @property
    def latency_s(self) -> float:
        """How long after a step its odometry comes, at most."""
        of_levels = 0.0 if self._levels is None else self._levels.latency_s
        return of_levels + self.behind_end_s

    @property
    def behind_end_s(self) -> float:
        """The same in the time of `end_s`, which is late itself."""
        return sum(part.latency_s for part in self._parts)

    @property
    def waits(self) -> bool:
        """Whether there is something to do for `work`."""
        return any(self._waiting)

    def push(self, block: SensorBlock) -> bool:
        """Take samples; return whether level samples came of them."""
        before = len(self._waiting[0])
        if self._levels is None:
            self._early.append(block)
            own_attitude = self._takes_own_attitude(at_end=False)
            if own_attitude is not None:
                self._begin(own_attitude)
        else:
            self._waiting[0].extend(self._levels.push(block))
        return len(self._waiting[0]) > before

    def work(self) -> list[StepOdometry | HeadingPrior]:
        """Take what waits, what has come furthest first, a part further; return what came out at the end."""
        number = next((number for number in (2, 1, 0) if self._waiting[number]), 0)
        items = self._waiting[number].copy()
        self._waiting[number].clear()
        found = [output for item in items for output in self._parts[number].push(item)]
        if number == 0:
            self._seen += items
        if number < 2:
            self._waiting[number + 1].extend(found)
        if not self._waiting[1] and not self._waiting[2]:
            self._reach()
        return found if number == 2 else []

    def flush(self) -> list[StepOdometry | HeadingPrior]:
        if self._levels is None:
            self._begin(bool(self._takes_own_attitude(at_end=True)))
        if self._levels is not None:
            self._waiting[0].extend(self._levels.flush())
        found: list[StepOdometry | HeadingPrior] = []
        while self.waits:
            found += self.work()
        return [*found, *Chain(self._parts).flush()]

    def _begin(self, own_attitude: bool) -> None:
        channels = (*_NEEDED, Channel.ATTITUDE) if own_attitude else _NEEDED
        needs_field = heading_needs_magnetometer(self._config, self._parts_given)
        optional = (Channel.MAGNETIC_FIELD,) if needs_field else ()
        _, self._levels = level_chain(channels, optional, own_attitude, self._config, self._parts_given)
        early, self._early = self._early, []
        self._waiting[0].extend(level for block in early for level in self._levels.push(block))

    def _reach(self) -> None:
        """All that was seen went all the way."""
        for level in self._seen:
            if not len(level):
                continue
            begin_s, end_s = float(level.time_s[0]), float(level.time_s[-1])
            self.start_s = begin_s if self.start_s is None else self.start_s
            self.end_s = end_s
            if level.segment == self._segment:
                begin_s, _ = self.spans_s.pop()
            self.spans_s.append((begin_s, end_s))
            self._segment = level.segment
        self._seen.clear()

    def _takes_own_attitude(self, at_end: bool) -> bool | None:
        """None while it cannot be told yet."""
        source = self._config.attitude.source
        if source != "auto":
            return source == "device"
        if self._expected.own_attitude is not None:
            return self._expected.own_attitude
        rate_s, attitude_s = self._early_times(Channel.ROTATION_RATE), self._early_times(Channel.ATTITUDE)
        if not at_end and (len(rate_s) < 2 or rate_s[-1] - rate_s[0] < _LOOK_S):
            return None
        look = rate_s[rate_s <= rate_s[0] + _LOOK_S] if len(rate_s) else rate_s
        if len(look) < 2 or float(np.median(np.diff(look))) <= COARSE_SAMPLING_S:
            return False
        if not at_end and rate_s[-1] - rate_s[0] < 2.0 * _LOOK_S:
            return None  # the attitude may come after the samples that it belongs to
        seen = (attitude_s >= look[0]) & (attitude_s <= look[-1])
        return int(seen.sum()) >= 0.9 * len(look)

    def _early_times(self, channel: Channel) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        times = [block.time_s for block in self._early if block.channel == channel]
        return np.concatenate([np.zeros(0), *times])
