"""Detect steps by the peaks of the vertical acceleration in the band of walking cadences.

Not from a paper. A steep low-pass below the second harmonic of slow walking leaves one peak per step whatever the
shape of the raw signal, so that counting peaks needs no shape rules; a threshold relative to the recent peaks refuses
the small ones between steps and while standing. It serves every position of the phone but one.

A swinging hand rises at both ends of its arc, when a foot strikes and the trunk is lowest: the two cancel, in some
people altogether, and only strides are left in the vertical acceleration. While the phone swings, its rotation rate
takes the place of the acceleration. It is smallest at the ends of the arc, near the strikes, whatever the arm's
strength or the phone's orientation.

In a pocket, a slow leg adds a third peak to the two of a stride: its swing has the third and fourth harmonics of the
stride, which lie in the band of cadences of a slow walker. Peaks that follow too soon for a step of the strides that
the signal shows are refused, unless they are much higher, as a runner's.

Where the mode changes, arm and trunk may hide a step from each other. A pause of two steps between two steps in
different known modes is filled with the one in between, unless it is long enough for a standstill.
"""

from dataclasses import replace

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.signal.event_detection import has_elapsed, local_maxima
from pdr_est.front_end.signal.filters import CausalBandPass
from pdr_est.front_end.signal.vectors import dot
from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.front_end.steps.stride_period import StridePeriod, StridePeriodParams
from pdr_est.params import Fraction, NonNegative, Positive, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, StepEvent


@params
class AutoStepParams:
    """Parameters of the default step detector; all values are ours."""

    low_hz: Positive = 0.3
    """Lower cutoff of the band of cadences, Hz."""
    high_hz: Positive = 2.0
    """Upper cutoff of the band of cadences, Hz."""
    threshold_mps2: NonNegative = 0.3
    """Least height of a peak in the band, m/s^2."""
    relative_threshold: Fraction = 0.25
    """Least height of a peak as a share of the recent peaks' height."""
    relative_threshold_holding: Fraction = 0.45
    """The same for a phone held in front of the body, which feels both feet alike."""
    min_interval_s: NonNegative = 0.3
    """Least time between steps, s."""
    interval_share: Fraction = 0.55
    """Least time between steps as a share of the recent intervals, where that is less than min_interval_s, because a
    runner's steps come faster.
    """
    running_interval_s: NonNegative = 0.24
    """Least time between steps, s, however short the recent intervals."""
    memory: Fraction = 0.8
    """Weight of the past in the recent height and interval of the peaks."""
    standstill_s: Positive = 2.0
    """Time without a step, s, after which the walk is over."""
    first_interval_s: Positive = 1.3
    """Longest time, s, between the two peaks with which a walk begins, so that a single jolt is no step."""
    first_share: Fraction = 0.4
    """Least height of the first of them as a share of the second one's height, to be a step itself."""
    strike_lead_s: NonNegative = 0.08
    """Time, s, from the foot's strike on the ground to the peak of the trunk's acceleration; a step's time is that of
    the strike.
    """
    swing_gain_mps: Positive = 2.0
    """Acceleration, m/s^2, that counts as much as a rotation rate of 1 rad/s while the phone swings."""
    pocket_interval_share: Fraction = 0.6
    """Least time between steps of a phone in a pocket as a share of half a stride (see `StridePeriod`), unless the
    later peak is higher than twice the recent ones.
    """
    stride: StridePeriodParams = StridePeriodParams()
    """Parameters of the search for the period of the strides."""


_SWING = np.int8(CarryingMode.SWING)
_HIGH_RATIO = 2.0  # times the recent peaks' height: too high for a peak between two steps


class BandpassPeakDetector:
    """Stage LevelBlock -> StepEvent by peaks in the band of cadences.

    The confidence of a step grows from 0 for a peak as high as the threshold to 1 for one far above it. It is 0 for a
    step that a change of the mode hid.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    parameters : AutoStepParams
        Band, thresholds and intervals.
    """

    def __init__(self, rate_hz: float, parameters: AutoStepParams) -> None:
        self._parameters = parameters
        self._filter = CausalBandPass(parameters.low_hz, parameters.high_hz, rate_hz)
        delay_s = self._filter.delay_s + parameters.strike_lead_s
        self._samples = SampleBuffer(rate_hz, delay_s)
        self._stride = StridePeriod(rate_hz, parameters.stride)
        self._begin_walk()
        # The first step of a walk waits for the second one, a hidden step for the next one.
        self.latency_s = delay_s + max(parameters.first_interval_s, 0.5 * parameters.standstill_s) + 1.0 / rate_hz

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        """Take level samples and return the steps that are now certain."""
        if item.segment != self._samples.segment:
            self._samples.begin(item)
            self._filter.reset()
            self._stride.clear()
            self._begin_walk()
        step_signal = self._step_signal(item)
        self._samples.append(item, step_signal)
        self._stride.append(step_signal, len(self._samples.signal))
        return self._decide()

    def flush(self) -> list[StepEvent]:
        """Return nothing: a peak that waits for a second one is no step."""
        return []

    def _begin_walk(self) -> None:
        self._last_peak_s = -np.inf
        self._recent_height = 0.0  # of the present walk; 0 before its second step
        self._first: tuple[StepEvent, float] | None = None
        self._intervals = StepIntervals(self._parameters.memory, self._parameters.standstill_s)

    def _step_signal(self, block: LevelBlock) -> Array:
        """Compute the signal (n,) that has one peak per step."""
        columns = np.empty((len(block), 2))
        columns[:, 0] = block.vertical_mps2
        columns[:, 1] = horizontal_rotation_rate(block)
        vertical, rotation = self._filter.push(columns).T
        # The mode may be given as SWING for a device without gyroscope, whose rotation is NaN.
        is_swing = (block.mode == _SWING) & np.isfinite(rotation)
        step_signal: Array = np.where(is_swing, -self._parameters.swing_gain_mps * rotation, vertical)
        return step_signal

    def _decide(self) -> list[StepEvent]:
        """Decide about all samples that have both neighbours, then forget them."""
        signal = self._samples.signal
        if len(signal) < 3:
            return []
        peaks = np.flatnonzero(local_maxima(signal) & (signal > self._parameters.threshold_mps2))
        events = [
            step
            for i in peaks
            for event in self._accept_peak(int(i))
            for step in self._intervals.fill_hidden_step(event)
        ]
        self._samples.drop(len(signal) - 2)
        return events

    def _accept_peak(self, i: int) -> list[StepEvent]:
        """Return the steps that peak i makes certain: its own, and with the second peak of a walk also the first."""
        p, time_s, height = self._parameters, self._samples.time_s(i), float(self._samples.signal[i])
        elapsed = time_s - self._last_peak_s
        if not has_elapsed(elapsed, self._min_interval_s()):
            return []
        if elapsed > p.standstill_s:
            self._recent_height, self._first = 0.0, None
        is_held = int(self._samples.mode[i]) == CarryingMode.HOLDING
        relative_threshold = p.relative_threshold_holding if is_held else p.relative_threshold
        threshold = max(p.threshold_mps2, relative_threshold * self._recent_height)
        if height < threshold or self._is_intermediate_peak(i, elapsed, height):
            return []
        self._last_peak_s = time_s
        event = self._samples.event(i, confidence=1.0 - (threshold / height) ** 2)
        if self._recent_height > 0.0:
            self._recent_height = p.memory * self._recent_height + (1.0 - p.memory) * height
            return [event]
        first, self._first = self._first, (event, height)
        if first is None or time_s - first[0].time_s > p.first_interval_s:
            return []
        self._recent_height, self._first = 0.5 * (first[1] + height), None
        return [first[0], event] if first[1] >= p.first_share * height else [event]

    def _is_intermediate_peak(self, i: int, elapsed: float, height: float) -> bool:
        """Return True for a peak in a pocket that comes too soon to be a step of the strides before it."""
        p = self._parameters
        longest_s = 0.5 * p.pocket_interval_share * p.stride.longest_s
        if (
            int(self._samples.mode[i]) != CarryingMode.POCKET
            or elapsed >= longest_s
            or height > _HIGH_RATIO * self._recent_height
        ):
            return False
        stride_s = self._stride.ending_at(len(self._samples.signal) - 1 - i)
        return np.isfinite(stride_s) and not has_elapsed(elapsed, 0.5 * p.pocket_interval_share * stride_s)

    def _min_interval_s(self) -> float:
        p = self._parameters
        return max(p.running_interval_s, min(p.min_interval_s, p.interval_share * self._intervals.interval_s))


class StepIntervals:
    """Recent time between steps, by which a step hidden by a change of the mode is found.

    `interval_s` is a mean with weights that fall off into the past; it is infinite for a walker who has just set off.
    """

    def __init__(self, memory: float, standstill_s: float) -> None:
        self._memory = memory
        self._standstill_s = standstill_s
        self._previous: StepEvent | None = None
        self.interval_s = np.inf

    def fill_hidden_step(self, event: StepEvent) -> list[StepEvent]:
        """Return the next step, and before it the hidden one if two intervals passed while the mode changed."""
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


def horizontal_rotation_rate(block: LevelBlock) -> Array:
    """Compute the rotation rate about horizontal axes, (n,) rad/s: the swing of a limb without the walker's turns."""
    rotation, turning = block.rotation_rate_radps, block.turn_rate_radps
    rate: Array = np.sqrt(np.maximum(dot(rotation, rotation) - turning * turning, 0.0))
    return rate
