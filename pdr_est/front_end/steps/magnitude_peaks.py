"""Detect steps by the peaks of the acceleration's magnitude, as textbooks do.

The magnitude of the specific force less standard gravity is low-passed. A sample is a step if it is higher than a
threshold and the highest within a least interval on either side: what scipy's `find_peaks` gives with `height` and
`distance`, but decided from the neighbourhood alone, so that it can be decided while the walk is recorded. It takes
no notice of how the phone is carried. It serves as a yardstick: what the elaborate detectors gain must show against
it.
"""

import numpy as np

from pdr_est.front_end.signal.event_detection import local_maxima
from pdr_est.front_end.signal.filters import CausalLowPass
from pdr_est.front_end.signal.vectors import excess_magnitude
from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.params import NonNegative, Positive, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import StepEvent


@params
class MagnitudePeaksParams:
    """Parameters of the step detector "magnitude-peaks"; round numbers, not tuned on any recording."""

    cutoff_hz: Positive = 3.0
    """Cutoff of the low-pass, Hz, above the cadence of anybody who walks."""
    threshold_mps2: NonNegative = 0.5
    """Least height of a peak over standard gravity, m/s^2."""
    min_interval_s: NonNegative = 0.3
    """Least time between two steps, s; of nearer peaks the highest is taken."""


class MagnitudePeaks:
    """Stage LevelBlock -> StepEvent by the peaks of the acceleration's magnitude.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    parameters : MagnitudePeaksParams
        Filter, threshold and interval.
    """

    def __init__(self, rate_hz: float, parameters: MagnitudePeaksParams) -> None:
        self._threshold_mps2 = parameters.threshold_mps2
        self._reach = max(round(parameters.min_interval_s * rate_hz), 1)  # samples on either side of a peak
        self._low_pass = CausalLowPass(parameters.cutoff_hz, rate_hz)
        self._samples = SampleBuffer(rate_hz, self._low_pass.delay_s)
        self._decided = 0  # samples at the front of the window that have been decided
        self.latency_s = self._low_pass.delay_s + (self._reach + 1) / rate_hz

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        """Take level samples and return the steps that are now certain."""
        if not len(item):
            return []
        events: list[StepEvent] = []
        if item.segment != self._samples.segment:
            events += self.flush()
            self._samples.begin(item)
            self._low_pass.reset()
            self._decided = 0
        self._samples.append(item, self._low_pass.push(excess_magnitude(item.up, item.acceleration_mps2)))
        return events + self._decide(self._reach)

    def flush(self) -> list[StepEvent]:
        """Return the steps that wait for a higher peak."""
        return self._decide(look_ahead=1)

    def _decide(self, look_ahead: int) -> list[StepEvent]:
        """Decide about all samples that have `look_ahead` successors, then forget those that no peak can see."""
        signal = self._samples.signal
        stop = len(signal) - look_ahead
        if stop <= self._decided:
            return []
        peaks = np.flatnonzero(local_maxima(signal[: stop + 1]) & (signal[: stop + 1] > self._threshold_mps2))
        events = [self._samples.event(i) for i in peaks.tolist() if i >= self._decided and self._is_highest(i)]
        forgotten = max(stop - self._reach, 0)
        self._samples.drop(forgotten)
        self._decided = stop - forgotten
        return events

    def _is_highest(self, i: int) -> bool:
        """Return True for a sample that is higher than those before, and not lower than those after it, in reach."""
        signal = self._samples.signal
        before, after = signal[max(i - self._reach, 0) : i], signal[i + 1 : i + 1 + self._reach]
        return bool(signal[i] > before.max()) and bool(signal[i] >= after.max())
