"""Detect steps by the peaks of a signal in the band of walking cadences.

Not from a paper. A steep low-pass below the second harmonic of slow walking leaves one peak per step whatever the
shape of the raw signal (`StepSignal`), so that counting peaks needs no shape rules. Three probabilities decide:

1. Is the peak a step, if somebody walks? A high peak is one, and so is a low one that comes when the rhythm of the
   steps before it lets one expect it (`peak_log_odds`).
2. Does somebody walk? The movement of the phone since a little before, the rhythm of the peaks and the likeness of
   the strides tell it (`WalkingBelief`). Until it is more probable than not, steps wait; those that have waited for
   too long are none.
3. Did a step not show? A pause of two intervals within a walk is filled if the phone went on moving
   (`StepIntervals`): phones that are sampled at 10 to 15 Hz miss the short shock of a foot in a pocket.

In a pocket, a slow leg adds a third peak to the two of a stride: its swing has the third and fourth harmonics of the
stride, which lie in the band of cadences of a slow walker. Peaks that follow too soon for a step of the strides that
the signal shows are refused, unless they are much higher, as a runner's.
"""

import math

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.signal.event_detection import has_elapsed, local_maxima
from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.front_end.steps.step_evidence.movement import MOVEMENT_COLUMNS, MovementSums, strength_between
from pdr_est.front_end.steps.step_evidence.peak_measurements import MeasuredPeak, PeakMeasurements
from pdr_est.front_end.steps.step_evidence.step_intervals import StepIntervals
from pdr_est.front_end.steps.step_evidence.step_probability import PeakShape, peak_log_odds, probability
from pdr_est.front_end.steps.step_evidence.step_signal import StepSignal
from pdr_est.front_end.steps.step_evidence.stride_likeness import StrideLikeness
from pdr_est.front_end.steps.step_evidence.walking_belief import (
    STRONG_MPS2,
    PeakRhythm,
    WalkingBelief,
    walking_evidence,
)
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
    """Least height in the band, m/s^2, of the peaks with which a walk begins."""
    least_height_mps2: NonNegative = 0.05
    """Least height in the band, m/s^2, of a later peak."""
    min_interval_s: NonNegative = 0.3
    """Least time between steps, s."""
    interval_share: Fraction = 0.55
    """Least time between steps as a share of the recent intervals, where that is less than min_interval_s, because a
    runner's steps come faster.
    """
    running_interval_s: NonNegative = 0.24
    """Least time between steps, s, however short the recent intervals."""
    memory: Fraction = 0.8
    """Weight of the past in the recent rise and interval of the peaks."""
    standstill_s: Positive = 2.0
    """Time without a step, s, after which the walk is over."""
    first_interval_s: Positive = 1.3
    """Longest time, s, between the two peaks with which a walk begins, so that a single jolt is no step."""
    first_share: Fraction = 0.4
    """Least height of the first of them as a share of the second one's height, to be a step itself."""
    walking_window_s: Positive = 2.0
    """Length of the movement before a peak, s, that tells whether somebody walks."""
    patience_s: NonNegative = 2.0
    """Longest time, s, that a step waits until it is certain enough that somebody walks."""
    weak_patience_s: NonNegative = 3.5
    """The same, s, where the phone moves so weakly that its carrier may ride, or where he surely rode before; at
    least patience_s.
    """
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


_SIGNAL, _SUMS = 0, slice(1, 1 + MOVEMENT_COLUMNS)  # columns of the buffered samples
_ON_TIME = 0.9  # times the recent interval: too late for a peak between two steps
_NO_RHYTHM = PeakRhythm(math.inf, math.inf, math.inf, 0.0)
_HIGH_RATIO = 2.0  # times the recent peaks' height: too high for a peak between two steps


class BandpassPeakDetector:
    """Stage LevelBlock -> StepEvent by peaks in the band of cadences.

    The confidence of a step is the probability that its peak is a step, if somebody walks, or that a pause hides it.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    parameters : AutoStepParams
        Band, thresholds and intervals.
    """

    def __init__(self, rate_hz: float, parameters: AutoStepParams) -> None:
        p = self._parameters = parameters
        self._signal = StepSignal(p.low_hz, p.high_hz, p.swing_gain_mps, rate_hz)
        self._sums = MovementSums(rate_hz)
        delay_s = self._signal.delay_s + p.strike_lead_s
        self._samples = SampleBuffer(rate_hz, delay_s, columns=1 + MOVEMENT_COLUMNS)
        self._stride = StridePeriod(rate_hz, p.stride)
        self._rate_hz = rate_hz
        self._measurements = PeakMeasurements(rate_hz, p.walking_window_s)
        self._kept = max(self._measurements.samples, math.ceil(p.standstill_s * rate_hz)) + 1
        self._walking = WalkingBelief()
        self._likeness = StrideLikeness()
        self._begin_segment()
        # The first step of a walk waits for the second one, a hidden step for the next one.
        held_s = max(p.first_interval_s, 0.5 * p.standstill_s, p.patience_s, p.weak_patience_s)
        self.latency_s = delay_s + held_s + 1.0 / rate_hz

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        """Take level samples and return the steps that are now certain."""
        if item.segment != self._samples.segment:
            self._samples.begin(item)
            self._begin_segment()
        rows = np.empty((1 + MOVEMENT_COLUMNS, len(item))).T  # each column lies in one piece, as it is computed
        rows[:, _SIGNAL] = self._signal.push(item)
        rows[:, _SUMS] = self._sums.push(item)
        self._samples.append(item, rows)
        self._stride.append(rows[:, _SIGNAL], len(self._samples.signal) - self._decided)
        return self._decide()

    def flush(self) -> list[StepEvent]:
        """Return nothing: a peak that waits for a second one is no step."""
        return []

    def _begin_segment(self) -> None:
        self._signal.reset()
        self._sums.reset()
        self._stride.clear()
        self._walking.reset()
        self._likeness.clear()
        self._alike: float | None = None
        self._rhythm = _NO_RHYTHM
        self._decided = 0  # position of the first buffered sample that is not decided about
        self._last_peak_s = -np.inf
        self._usual: PeakShape | None = None  # of the present walk; None before its second step
        self._first: tuple[StepEvent, PeakShape] | None = None
        self._waiting: list[StepEvent] = []
        self._intervals = StepIntervals(self._parameters.memory, self._parameters.standstill_s)

    def _decide(self) -> list[StepEvent]:
        """Decide about all samples that have both neighbours, then forget those that nothing needs any more."""
        start = max(self._decided - 1, 0)
        recent = self._samples.signal[start:, _SIGNAL]
        if len(recent) < 3:
            return []
        peaks = start + np.flatnonzero(local_maxima(recent) & (recent > self._parameters.least_height_mps2))
        events = self._steps_at(peaks) if len(peaks) else []
        excess = max(len(self._samples.signal) - 1 - self._kept, 0)
        self._decided = len(self._samples.signal) - 1 - excess
        self._samples.drop(excess)
        return events

    def _steps_at(self, places: NDArray[np.intp]) -> list[StepEvent]:
        """Return the steps that the peaks at positions (n,) make certain."""
        buffered = self._samples.signal
        signal: list[float] = buffered[:, _SIGNAL].tolist()
        measured = zip(
            self._measurements.measure(buffered[:, _SUMS], places), self._samples.times_s(places), strict=True
        )
        return [event for peak, time_s in measured for event in self._confirmed(peak, time_s, signal)]

    def _confirmed(self, peak: MeasuredPeak, time_s: float, signal: list[float]) -> list[StepEvent]:
        """Return the steps that a peak makes certain."""
        accepted = self._accept_peak(peak, time_s, signal)
        if not accepted:
            return []
        self._walking.add(walking_evidence(peak.movement, self._rhythm, self._alike))
        waiting = self._waiting + [step for event in accepted for step in self._with_hidden_step(event, peak.place)]
        may_ride = self._walking.rode or peak.movement.acceleration_mps2 < STRONG_MPS2
        patience_s = self._parameters.weak_patience_s if may_ride else self._parameters.patience_s
        latest_s = accepted[-1].time_s
        waiting = [event for event in waiting if has_elapsed(patience_s, latest_s - event.time_s)]
        is_walk = self._walking.log_odds > 0.0
        self._waiting = [] if is_walk else waiting
        return waiting if is_walk else []

    def _accept_peak(self, found: MeasuredPeak, time_s: float, signal: list[float]) -> list[StepEvent]:
        """Return the steps if somebody walks: that of the peak, and with the second peak of a walk also the first."""
        p, i, height = self._parameters, found.place, signal[found.place]
        elapsed = time_s - self._last_peak_s
        if not has_elapsed(elapsed, self._min_interval_s()):
            return []
        if elapsed > p.standstill_s:
            self._stand()
        usual = self._usual
        if usual is None and height < p.threshold_mps2:
            return []
        # The rise is that since the last step, or in the time of a standstill.
        count = int(min(elapsed, p.standstill_s) * self._rate_hz)
        peak = PeakShape(height, height - min(signal[max(i - count, 0) : i + 1]), found.strength_mps2)
        log_odds = peak_log_odds(peak, usual or peak, self._interval_ratio(elapsed) if usual else 1.0)
        if log_odds < 0.0 or self._is_intermediate_peak(i, elapsed, height):
            return []
        self._last_peak_s = time_s
        self._rhythm = self._rhythm.followed_by(elapsed if elapsed <= p.standstill_s else math.inf, peak.rise)
        self._alike = self._likeness.add(found.pattern)
        event = self._samples.event(i, confidence=probability(log_odds))
        if usual is None:
            return self._begin_walk(event, peak)
        self._usual = usual.blended(peak, p.memory)
        return [event]

    def _stand(self) -> None:
        """Forget the walk before a standstill."""
        if self._usual is not None or self._first is not None:
            self._walking.stand()
        self._usual = self._first = None
        self._waiting = []
        self._likeness.clear()

    def _begin_walk(self, event: StepEvent, peak: PeakShape) -> list[StepEvent]:
        """Return the steps of the first two peaks of a walk at the second one."""
        p = self._parameters
        first, self._first = self._first, (event, peak)
        if first is None or event.time_s - first[0].time_s > p.first_interval_s:
            return []
        self._usual, self._first = first[1].blended(peak, 0.5), None
        return [first[0], event] if first[1].height >= p.first_share * peak.height else [event]

    def _interval_ratio(self, elapsed: float) -> float:
        interval_s = self._intervals.interval_s
        return elapsed / interval_s if interval_s < np.inf else 1.0

    def _with_hidden_step(self, event: StepEvent, i: int) -> list[StepEvent]:
        """Return a step, and before it the one that did not show; i is the position of the latest peak."""
        if self._usual is None or not self._intervals.is_pause(event.time_s):
            return self._intervals.fill_hidden_step(event, 1.0)
        # The middle half of the pause; the steps at its ends shake the phone in any case.
        quarter = min(round(0.25 * self._rhythm.interval_s * self._rate_hz), i // 3)
        sums: Array = self._samples.signal[:, _SUMS]
        strength = strength_between(sums[i - 3 * quarter], sums[i - quarter], max(2 * quarter, 1))
        return self._intervals.fill_hidden_step(event, strength / self._usual.strength)

    def _is_intermediate_peak(self, i: int, elapsed: float, height: float) -> bool:
        """Return True for a peak in a pocket that comes too soon to be a step of the strides before it."""
        p = self._parameters
        longest_s = 0.5 * p.pocket_interval_share * p.stride.longest_s
        if (
            int(self._samples.mode[i]) != CarryingMode.POCKET
            or elapsed >= min(longest_s, _ON_TIME * self._intervals.interval_s)
            or height > _HIGH_RATIO * (self._usual.height if self._usual else 0.0)
        ):
            return False
        stride_s = self._stride.ending_at(len(self._samples.signal) - 1 - i)
        return np.isfinite(stride_s) and not has_elapsed(elapsed, 0.5 * p.pocket_interval_share * stride_s)

    def _min_interval_s(self) -> float:
        p = self._parameters
        return max(p.running_interval_s, min(p.min_interval_s, p.interval_share * self._intervals.interval_s))
