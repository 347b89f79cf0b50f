"""Step detection by the crests of the vertical acceleration in the band of walking cadences.

Not from a paper. A steep low-pass below the second harmonic of slow walking leaves one hump a step whatever the shape
of the raw signal, so that counting humps needs no shape rules; a threshold relative to the recent humps refuses the
small ones between steps and while standing. It serves every position of the phone but one.

A swinging hand rises at both ends of its arc, when a foot strikes and the trunk is lowest: the two cancel, in some
people altogether, and only strides are left in the vertical acceleration. While the phone swings its rate of rotation
takes the place of the acceleration. It is smallest at the ends of the arc, near the strikes, whatever the arm's
strength or the phone's orientation.

In a pocket, a slow leg adds a third hump to the two of a stride: its swing has the third and fourth harmonics of the
stride, which lie in the band of cadences for who walks slowly. Humps that follow too soon for a step of the strides
that the signal shows are refused, unless they are much higher, as a runner's.

Where the mode changes, arm and trunk may hide a step from each other. A pause of two steps between two steps in
different known modes is filled with the one in between, unless it is long enough for a standstill.
"""

from dataclasses import replace

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.signal.filters import CausalBandPass
from pdr_est.front_end.signal.trigger import far_enough, local_maxima
from pdr_est.front_end.signal.vectors import dot
from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.front_end.steps.stride_period import StridePeriod, StridePeriodParams
from pdr_est.params import Fraction, NonNegative, Positive, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, StepEvent


@params
class AutoStepParams:
    """low_hz, high_hz: band of cadences. threshold_mps2: least height of a hump in the band; relative_threshold:
    its least share of the recent humps' height, and relative_threshold_holding the same for a phone held in
    front of the body, which feels both feet alike. min_interval_s: between steps; interval_share: the same as a
    share of the recent intervals where that is less, because a runner's steps come faster, but never less than
    running_interval_s. memory: weight of the past in the recent height and interval. standstill_s: after this
    long without a step the walk is over. A walk begins with two crests at most first_interval_s apart, so that a
    single jolt is no step; the first of them is a step if it has first_share of the second's height.
    strike_lead_s: the foot strikes the ground this long before the trunk's acceleration crests; a step's time is
    that of the strike. pocket_interval_share: of half a stride (see `StridePeriod`), between steps of a phone in a
    pocket, unless the later one is higher than twice the recent ones. swing_gain_mps: acceleration in m/s^2 that
    counts as much as a rate of rotation of 1 rad/s while the phone swings."""

    low_hz: Positive = 0.3
    high_hz: Positive = 2.0
    threshold_mps2: NonNegative = 0.3
    relative_threshold: Fraction = 0.25
    relative_threshold_holding: Fraction = 0.45
    min_interval_s: NonNegative = 0.3
    interval_share: Fraction = 0.55
    running_interval_s: NonNegative = 0.24
    memory: Fraction = 0.8
    standstill_s: Positive = 2.0
    first_interval_s: Positive = 1.3
    first_share: Fraction = 0.4
    strike_lead_s: NonNegative = 0.08
    swing_gain_mps: Positive = 2.0
    pocket_interval_share: Fraction = 0.6
    stride: StridePeriodParams = StridePeriodParams()


_SWING = np.int8(CarryingMode.SWING)
_HIGH = 2.0  # times the recent humps: not one between two steps


class BandpassPeakDetector:
    """Stage LevelBlock -> StepEvent.

    The confidence of a step grows from 0 for a hump as high as the threshold to 1 for one far above it. It is 0 for
    a step that a change of the mode hid.
    """

    def __init__(self, rate_hz: float, parameters: AutoStepParams) -> None:
        self._parameters = parameters
        self._filter = CausalBandPass(parameters.low_hz, parameters.high_hz, rate_hz)
        delay_s = self._filter.delay_s + parameters.strike_lead_s
        self._samples = SampleBuffer(rate_hz, delay_s)
        self._stride = StridePeriod(rate_hz, parameters.stride)
        self._begin_walk()
        # The first step of a walk waits for the second one, a hidden one for the next.
        self.latency_s = delay_s + max(parameters.first_interval_s, 0.5 * parameters.standstill_s) + 1.0 / rate_hz

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        if item.segment != self._samples.segment:
            self._samples.begin(item)
            self._filter.reset()
            self._stride.clear()
            self._begin_walk()
        humps = self._humps(item)
        self._samples.append(item, humps)
        self._stride.append(humps, len(self._samples.signal))
        return self._decide()

    def flush(self) -> list[StepEvent]:
        return []

    def _begin_walk(self) -> None:
        self._last_crest_s = -np.inf
        self._recent_height = 0.0  # of the walk under way; 0 before its second step
        self._first: tuple[StepEvent, float] | None = None
        self._rhythm = _Rhythm(self._parameters.memory, self._parameters.standstill_s)

    def _humps(self, block: LevelBlock) -> Array:
        """The signal with one hump a step, (n,)."""
        columns = np.empty((len(block), 2))
        columns[:, 0] = block.vertical_mps2
        columns[:, 1] = horizontal_rate(block)
        vertical, rotation = self._filter.push(columns).T
        # A given mode may be SWING without a gyroscope.
        seen_swinging = (block.mode == _SWING) & np.isfinite(rotation)
        humps: Array = np.where(seen_swinging, -self._parameters.swing_gain_mps * rotation, vertical)
        return humps

    def _decide(self) -> list[StepEvent]:
        """Judge all samples that have both neighbours, then forget them."""
        signal = self._samples.signal
        if len(signal) < 3:
            return []
        crests = np.flatnonzero(local_maxima(signal) & (signal > self._parameters.threshold_mps2))
        events = [step for i in crests for event in self._judge(int(i)) for step in self._rhythm.completed(event)]
        self._samples.drop(len(signal) - 2)
        return events

    def _judge(self, i: int) -> list[StepEvent]:
        """The steps that crest i makes certain: its own, and with the second of a walk also the first."""
        p, time_s, height = self._parameters, self._samples.time_s(i), float(self._samples.signal[i])
        elapsed = time_s - self._last_crest_s
        if not far_enough(elapsed, self._min_interval_s()):
            return []
        if elapsed > p.standstill_s:
            self._recent_height, self._first = 0.0, None
        held = int(self._samples.mode[i]) == CarryingMode.HOLDING
        share = p.relative_threshold_holding if held else p.relative_threshold
        threshold = max(p.threshold_mps2, share * self._recent_height)
        if height < threshold or self._between_steps(i, elapsed, height):
            return []
        self._last_crest_s = time_s
        event = self._samples.event(i, confidence=1.0 - (threshold / height) ** 2)
        if self._recent_height > 0.0:
            self._recent_height = p.memory * self._recent_height + (1.0 - p.memory) * height
            return [event]
        first, self._first = self._first, (event, height)
        if first is None or time_s - first[0].time_s > p.first_interval_s:
            return []
        self._recent_height, self._first = 0.5 * (first[1] + height), None
        return [first[0], event] if first[1] >= p.first_share * height else [event]

    def _between_steps(self, i: int, elapsed: float, height: float) -> bool:
        """Whether a hump in a pocket comes too soon to be a step of the strides before it."""
        p = self._parameters
        longest_s = 0.5 * p.pocket_interval_share * p.stride.longest_s
        if (
            int(self._samples.mode[i]) != CarryingMode.POCKET
            or elapsed >= longest_s
            or height > _HIGH * self._recent_height
        ):
            return False
        stride_s = self._stride.before(len(self._samples.signal) - 1 - i)
        return np.isfinite(stride_s) and not far_enough(elapsed, 0.5 * p.pocket_interval_share * stride_s)

    def _min_interval_s(self) -> float:
        p = self._parameters
        return max(p.running_interval_s, min(p.min_interval_s, p.interval_share * self._rhythm.interval_s))


class _Rhythm:
    """The time between steps, which tells the step that a change of the mode hid.

    interval_s: mean of the recent ones with weights that fall off; infinite for who has just set off.
    """

    def __init__(self, memory: float, standstill_s: float) -> None:
        self._memory = memory
        self._standstill_s = standstill_s
        self._previous: StepEvent | None = None
        self.interval_s = np.inf

    def completed(self, event: StepEvent) -> list[StepEvent]:
        """The next step, and before it the hidden one if two intervals passed while the mode changed."""
        previous, self._previous = self._previous, event
        if previous is None:
            return [event]
        elapsed_s = event.time_s - previous.time_s
        if elapsed_s > self._standstill_s:
            self.interval_s = np.inf
            return [event]
        changed = event.mode is not previous.mode and CarryingMode.UNKNOWN not in (event.mode, previous.mode)
        if changed and 1.5 < elapsed_s / self.interval_s < 2.5:
            middle = previous.index + (event.index - previous.index) // 2
            return [replace(event, index=middle, time_s=event.time_s - 0.5 * elapsed_s, confidence=0.0), event]
        if self.interval_s == np.inf:
            self.interval_s = elapsed_s
        else:
            self.interval_s = self._memory * self.interval_s + (1.0 - self._memory) * elapsed_s
        return [event]


def horizontal_rate(block: LevelBlock) -> Array:
    """Rate of rotation about the horizontal, (n,) rad/s: what a limb's swing makes of it, without the turns."""
    rotation, turning = block.rotation_rate_radps, block.turn_rate_radps
    rate: Array = np.sqrt(np.maximum(dot(rotation, rotation) - turning * turning, 0.0))
    return rate
