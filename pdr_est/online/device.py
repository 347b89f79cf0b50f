"""The front end of one device, fed as its samples come."""

from dataclasses import dataclass

import numpy as np

from pdr_est.chains import level_chain, stepping
from pdr_est.config import Config
from pdr_est.front_end.heading import needs_magnetometer
from pdr_est.front_end.odometry import Odometry
from pdr_est.io.requirements import COARSE_S
from pdr_est.records import Channel, HeadingPrior, LevelBlock, SensorBlock, StepOdometry
from pdr_est.stage import Chain

_LOOK_S = 2.0  # of a device that nobody declared, until it is known how it records
_NEEDED = (Channel.SPECIFIC_FORCE, Channel.ROTATION_RATE)


@dataclass(frozen=True)
class ExpectedDevice:
    """A device that will send samples. own_attitude: whether to use the attitude that it records itself; None finds
    out from its first seconds, by the rule for recordings."""

    name: str
    own_attitude: bool | None = None


class DeviceFrontEnd:
    """Samples of one device to its odometry. start_s, end_s: first and last time that the front end could use, None
    until there is one. Accelerometer and gyroscope are needed: without one of them nothing ever comes out."""

    def __init__(self, device: ExpectedDevice, config: Config) -> None:
        self._config = config
        self._expected = device
        self._levels: Chain | None = None
        self._early: list[SensorBlock] = []
        self._steps = stepping(config)
        self._odometry = Odometry(device.name, config.odometry)
        self.start_s: float | None = None
        self.end_s: float | None = None

    @property
    def latency_s(self) -> float:
        """How long after a step its odometry comes, at most."""
        of_levels = 0.0 if self._levels is None else self._levels.latency_s
        return of_levels + self._steps.latency_s

    def push(self, block: SensorBlock) -> list[StepOdometry | HeadingPrior]:
        if self._levels is not None:
            return self._forward(self._levels.push(block))
        self._early.append(block)
        own_attitude = self._takes_own_attitude(at_end=False)
        return [] if own_attitude is None else self._begin(own_attitude)

    def flush(self) -> list[StepOdometry | HeadingPrior]:
        found: list[StepOdometry | HeadingPrior] = []
        if self._levels is None:
            found += self._begin(bool(self._takes_own_attitude(at_end=True)))
        if self._levels is not None:
            found += self._forward(self._levels.flush())
        return [*found, *self._to_odometry(self._steps.flush())]

    def _begin(self, own_attitude: bool) -> list[StepOdometry | HeadingPrior]:
        channels = (*_NEEDED, Channel.ATTITUDE) if own_attitude else _NEEDED
        optional = (Channel.MAGNETIC_FIELD,) if needs_magnetometer(self._config.heading) else ()
        _, self._levels = level_chain(channels, optional, own_attitude, self._config)
        early, self._early = self._early, []
        return self._forward([level for block in early for level in self._levels.push(block)])

    def _forward(self, levels: list[LevelBlock]) -> list[StepOdometry | HeadingPrior]:
        found: list[StepOdometry | HeadingPrior] = []
        for level in levels:
            if len(level):
                self.start_s = float(level.time_s[0]) if self.start_s is None else self.start_s
                self.end_s = float(level.time_s[-1])
            found += self._to_odometry(self._steps.push(level))
        return found

    def _to_odometry(self, steps: list[object]) -> list[StepOdometry | HeadingPrior]:
        return [measurement for step in steps for measurement in self._odometry.push(step)]  # type: ignore[arg-type]

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
        if len(look) < 2 or float(np.median(np.diff(look))) <= COARSE_S:
            return False
        if not at_end and rate_s[-1] - rate_s[0] < 2.0 * _LOOK_S:
            return None  # the attitude may come after the samples that it belongs to
        seen = (attitude_s >= look[0]) & (attitude_s <= look[-1])
        return int(seen.sum()) >= 0.9 * len(look)

    def _early_times(self, channel: Channel) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        times = [block.time_s for block in self._early if block.channel == channel]
        return np.concatenate([np.zeros(0), *times])
