"""Step detection of Robust DR: alternating extremes of the vertical acceleration.

The accelerometer's reading is averaged over 200 ms in device axes, projected upwards with the latest attitude, and
averaged over 200 ms again. A local maximum is valid if it comes at least 150 ms after the latest valid local minimum
and exceeds it by a threshold; a local minimum is valid by the mirrored rule. A step is a valid maximum followed by a
valid minimum.

Readings of the paper. (1) Both averages are running means over the latest 200 ms; the paper gives the width of its
low-pass windows and not their shape. (2) "The most recent local minimum" whose value is compared is the most recent
valid one; otherwise a ripple of any size would reset the comparison. (3) A valid maximum takes the place of an
earlier one without a valid minimum between; so do minima. (4) At the beginning of a segment its first sample is the
most recent extreme of both kinds, long ago. (5) The time is that of the minimum, less the delay of both averages. (6)
The paper leaves the threshold to calibration; the default was tuned on real phones in many positions, and the
averaging takes about half of a walk's acceleration away before the comparison.

Deviation. The attitude tells the direction of gravity only; the paper's also tells north, which steps do not need.

References
----------
Robust DR: Jin et al., WCNC 2011, sections III-A to III-C.
"""

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.front_end.signal.event_detection import has_elapsed, local_maxima, local_minima
from pdr_est.front_end.signal.moving_average import MovingAverage
from pdr_est.front_end.signal.vectors import dot, specific_force
from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.params import NonNegative, Window, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import StepEvent


@params
class RelativeThresholdParams:
    """Parameters of Robust DR's step detection."""

    pre_window_s: Window = 0.2
    """Window of the average before the projection, s (the paper's 200 ms)."""
    post_window_s: Window = 0.2
    """Window of the average after the projection, s (the paper's 200 ms)."""
    threshold_mps2: NonNegative = 0.6
    """Least difference, m/s^2, between extremes that follow each other; ours, tuned on real phones in many positions.
    """
    min_interval_s: NonNegative = 0.15
    """Least time between extremes that follow each other, s (the paper's 150 ms)."""


class RelativeThreshold:
    """Stage LevelBlock -> StepEvent by relative thresholds.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    parameters : RelativeThresholdParams
        Windows, threshold and interval.
    """

    def __init__(self, rate_hz: float, parameters: RelativeThresholdParams) -> None:
        self._parameters = parameters
        self._pre_average = MovingAverage(parameters.pre_window_s, rate_hz)
        self._post_average = MovingAverage(parameters.post_window_s, rate_hz)
        delay_s = self._pre_average.delay_s + self._post_average.delay_s
        self._samples = SampleBuffer(rate_hz, delay_s)
        self._maximum = self._minimum = (-np.inf, 0.0)  # time_s and value of the most recent valid extremes
        self._last_is_maximum = False  # whether the most recent valid extreme is a maximum
        self.latency_s = delay_s + 1.0 / rate_hz

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        """Take level samples and return the steps that are now certain."""
        if not len(item):
            return []
        begins = item.segment != self._samples.segment
        if begins:
            self._samples.begin(item)
            self._pre_average.reset()
            self._post_average.reset()
        signal = self._vertical(item)
        if begins:
            self._maximum = self._minimum = (-np.inf, float(signal[0]))
            self._last_is_maximum = False
        self._samples.append(item, signal)
        return self._decide()

    def flush(self) -> list[StepEvent]:
        """Return nothing: no event is held back."""
        return []

    def _vertical(self, item: LevelBlock) -> Array:
        """Compute the projected and filtered vertical acceleration (n,)."""
        force = self._pre_average.push(specific_force(item.up, item.acceleration_mps2))
        return self._post_average.push(dot(force, item.up) - STANDARD_GRAVITY_MPS2)

    def _decide(self) -> list[StepEvent]:
        """Decide about all samples that have both neighbours, then forget them."""
        signal = self._samples.signal
        if len(signal) < 3:
            return []
        maxima = local_maxima(signal)
        events = []
        for i in np.flatnonzero(maxima | local_minima(signal)).tolist():
            if maxima[i]:
                self._check_maximum(i)
            elif self._is_step_at_minimum(i):
                events.append(self._samples.event(i))
        self._samples.drop(len(signal) - 2)
        return events

    def _check_maximum(self, i: int) -> None:
        """Remember the local maximum at i if it is valid."""
        time_s, value = self._samples.time_s(i), float(self._samples.signal[i])
        if (
            self._interval_elapsed(time_s, self._minimum[0])
            and value - self._minimum[1] >= self._parameters.threshold_mps2
        ):
            self._maximum, self._last_is_maximum = (time_s, value), True

    def _is_step_at_minimum(self, i: int) -> bool:
        """Remember a valid local minimum at i, and return True if it is the first one after a valid maximum."""
        time_s, value = self._samples.time_s(i), float(self._samples.signal[i])
        if not self._interval_elapsed(time_s, self._maximum[0]):
            return False
        if self._maximum[1] - value < self._parameters.threshold_mps2:
            return False
        ends, self._last_is_maximum = self._last_is_maximum, False
        self._minimum = (time_s, value)
        return ends

    def _interval_elapsed(self, time_s: float, before_s: float) -> bool:
        return has_elapsed(time_s - before_s, self._parameters.min_interval_s)
