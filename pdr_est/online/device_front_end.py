"""Front end of one device online: its samples become odometry piece by piece, as they come."""

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pdr_est.config import Config
from pdr_est.errors import EstimationError
from pdr_est.frames import Array
from pdr_est.front_end.heading.north import NorthReference
from pdr_est.parts import NO_PARTS, Parts
from pdr_est.pipeline.front_end_chain import level_chain, measuring, optional_channels, stepping
from pdr_est.preprocessing.quality.requirements import COARSE_SAMPLING_S
from pdr_est.stage import Chain, Stage
from pdr_est.types.measurements import HeadingPrior, StepOdometry
from pdr_est.types.sensors import Channel, LevelBlock, SensorBlock

_LOOK_S = 2.0  # samples of an undeclared device that are looked at to find out how it records
_MOST_SPANS = 1000
_NEEDED = (Channel.SPECIFIC_FORCE, Channel.ROTATION_RATE)
_WIDTH = {channel: channel.width for channel in Channel}


@dataclass(frozen=True)
class ExpectedDevice:
    """Device that will send samples.

    Attributes
    ----------
    name
        Name of the device.
    own_attitude
        True to use the attitude that the device records itself, False to compute it from the rotation rate; None to
        decide from its first seconds, by the rule for recordings.
    north
        Source of headings against north; None for none.
    restarts_s
        Restarts of its clock that are known beforehand, as `DeviceRecording.restarts_s`.
    """

    name: str
    own_attitude: bool | None = None
    north: NorthReference | None = None
    restarts_s: tuple[float, ...] = ()


class DeviceFrontEnd:
    """Front end of one device: `push` makes level samples, and each `work` processes them one part further.

    Accelerometer and gyroscope are needed: without one of them nothing ever comes out.

    Parameters
    ----------
    device
        The device.
    config
        Parameters of all stages.

    Attributes
    ----------
    start_s
        Time of the first sample that has been processed completely; None before it.
    end_s
        Time of the last one.
    spans_s
        Begin and end of each run of such samples without a gap; the latest thousand.
    """

    def __init__(self, device: ExpectedDevice, config: Config, parts: Parts = NO_PARTS) -> None:
        self._config = config
        self._parts_given = parts
        self._device = device
        self._levelling: Chain | None = None
        self._early: list[SensorBlock] = []  # samples before it is known whether to use the device's attitude
        self._parts = _parts_of_equal_work(stepping(config, parts), measuring(device.name, config, device.north))
        self._step_latency_s = sum(part.latency_s for part in self._parts)
        self._waiting: tuple[list[Any], ...] = tuple([] for _ in self._parts)  # input of each part
        self._in_process: list[LevelBlock] = []  # taken by the first part since all others had nothing to do
        self._segment = -1
        self.start_s: float | None = None
        self.end_s: float | None = None
        self.spans_s: deque[tuple[float, float]] = deque(maxlen=_MOST_SPANS)

    @property
    def latency_s(self) -> float:
        """Largest time from a step to its odometry, s."""
        levelling_s = 0.0 if self._levelling is None else self._levelling.latency_s
        return levelling_s + self.step_latency_s

    @property
    def step_latency_s(self) -> float:
        """Largest time from a step to its odometry, s, counted in level samples, as `end_s` is."""
        return self._step_latency_s

    @property
    def pending(self) -> bool:
        """Tell whether `work` has something to do."""
        return any(self._waiting)

    def push(self, block: SensorBlock) -> bool:
        """Add samples; return True if they gave some on the working grid, so that the push has cost much already."""
        if self._levelling is None:
            self._early.append(block)
            own_attitude = self._uses_own_attitude(at_end=False)
            if own_attitude is not None:
                self._begin(own_attitude)
            return own_attitude is not None
        resampler, *to_level = self._levelling.stages
        resampled = resampler.push(block)
        if resampled:
            self._waiting[0].extend(Chain(to_level).push_all(resampled))
        return bool(resampled)

    def work(self) -> list[StepOdometry | HeadingPrior]:
        """Process what waits, starting with what is furthest, one part further; return the measurements."""
        last = len(self._parts) - 1
        number = next((number for number in range(last, 0, -1) if self._waiting[number]), 0)
        items = self._waiting[number].copy()
        self._waiting[number].clear()
        found = self._parts[number].push_all(items)
        if number == 0:
            self._in_process += items
        if number < last:
            self._waiting[number + 1].extend(found)
        if not any(self._waiting[1:]):
            self._extend_spans()
        return found if number == last else []

    def flush(self) -> list[StepOdometry | HeadingPrior]:
        """End the recording; return the remaining measurements."""
        if self._levelling is None:
            self._begin(bool(self._uses_own_attitude(at_end=True)))
        if self._levelling is not None:
            self._waiting[0].extend(self._levelling.flush())
        found: list[StepOdometry | HeadingPrior] = []
        while self.pending:
            found += self.work()
        return [*found, *Chain(self._parts).flush()]

    def _begin(self, own_attitude: bool) -> None:
        """Make the levelling stages, and give them the samples so far."""
        channels = (*_NEEDED, Channel.ATTITUDE) if own_attitude else _NEEDED
        optional = optional_channels(channels, self._config, self._parts_given, self._device.north)
        _, self._levelling = level_chain(
            channels, optional, own_attitude, self._config, self._parts_given, self._device.restarts_s
        )
        early, self._early = _joined(self._early), []
        self._waiting[0].extend(level for block in early for level in self._levelling.push(block))

    def _extend_spans(self) -> None:
        """Take note that all samples have been processed completely."""
        for level in self._in_process:
            if not len(level):
                continue
            begin_s, end_s = float(level.time_s[0]), float(level.time_s[-1])
            self.start_s = begin_s if self.start_s is None else self.start_s
            self.end_s = end_s
            if level.segment == self._segment:
                begin_s, _ = self.spans_s.pop()
            self.spans_s.append((begin_s, end_s))
            self._segment = level.segment
        self._in_process.clear()

    def _uses_own_attitude(self, at_end: bool) -> bool | None:
        """Decide whether to use the attitude that the device records; None while that is not known."""
        source = self._config.attitude.source
        if source != "auto":
            return source == "device"
        if self._device.own_attitude is not None:
            return self._device.own_attitude
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

    def _early_times(self, channel: Channel) -> Array:
        times = [block.time_s for block in self._early if block.channel == channel]
        return np.concatenate([np.zeros(0), *times])


def _joined(blocks: Sequence[SensorBlock]) -> Iterator[SensorBlock]:
    """Join the blocks of each channel: single samples of two seconds one by one would take 40 ms.

    The needed channels come last, because the resampler waits for the others only while it gets these.
    """
    for channel in sorted({block.channel for block in blocks}, key=lambda one: (one in _NEEDED, one.value)):
        own = [block for block in blocks if block.channel == channel]
        yield SensorBlock(
            channel, np.concatenate([block.time_s for block in own]), np.concatenate([block.values for block in own])
        )


def _parts_of_equal_work(to_steps: Chain, to_measurements: Stage) -> tuple[Chain, ...]:
    """Divide the stages from level samples to measurements so that no part takes much longer than the others."""
    detection, gait, length, *rest = to_steps.stages
    heading = [part for stage in rest for part in (stage.stages if isinstance(stage, Chain) else (stage,))]
    return Chain([detection]), Chain([gait, length]), Chain(heading[:1]), Chain([*heading[1:], to_measurements])


def refuse_malformed(device: str, block: SensorBlock) -> None:
    """Check the form of pushed samples.

    Single samples that are not finite or not in order of time are left out later, as in recordings.

    Raises
    ------
    EstimationError
        For a name or a block that cannot be used.
    """
    if not isinstance(device, str) or not device:
        raise EstimationError(f"device {device!r}: give it a name, which is a text that is not empty")
    if not isinstance(block, SensorBlock):
        raise EstimationError(f"{device}: samples of type {type(block).__name__}: give a SensorBlock")
    if block.channel not in _WIDTH:
        raise EstimationError(f"{device}: channel {block.channel!r}: choose one of {', '.join(Channel)}")
    for name, values, dimensions in (("time_s", block.time_s, 1), ("values", block.values, 2)):
        if not isinstance(values, np.ndarray) or values.ndim != dimensions or values.dtype.kind not in "fiu":
            raise EstimationError(
                f"{device}, {block.channel}: {name} is {_described(values)}: give an array of numbers of "
                f"{dimensions} dimension{'s' * (dimensions > 1)}"
            )
    expected = (len(block.time_s), _WIDTH[Channel(block.channel)])
    if block.values.shape != expected:
        raise EstimationError(
            f"{device}, {block.channel}: values of shape {block.values.shape} at {len(block.time_s)} times: give the "
            f"shape {expected}, a row a sample"
        )


def _described(values: object) -> str:
    if isinstance(values, np.ndarray):
        return f"an array of shape {values.shape} of {values.dtype}"
    return f"a {type(values).__name__}"
