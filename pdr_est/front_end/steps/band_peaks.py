"""Step detection by the peaks of the vertical acceleration in the band of walking cadences.

Not from a paper. A steep low-pass below the second harmonic of slow walking leaves one hump a step whatever the shape
of the raw signal, so that counting humps needs no shape rules; a threshold relative to the recent humps refuses the
small ones between steps and while standing.
"""

import numpy as np

from pdr_est.front_end.signal.filters import CausalBandPass
from pdr_est.front_end.signal.peaks import local_maxima
from pdr_est.front_end.steps.undecided import UndecidedSamples
from pdr_est.params import Fraction, NonNegative, Positive, params
from pdr_est.records import LevelBlock, StepEvent


@params
class BandPeaksParams:
    """low_hz, high_hz: band of cadences. threshold_mps2: least height of a hump in the band; relative_threshold:
    its least share of the recent humps' height. min_interval_s: between steps. memory: weight of the past in the
    recent height. standstill_s: after this long without a step the recent height is forgotten. strike_lead_s: the
    foot strikes the ground this long before the trunk's acceleration crests; a step's time is that of the strike."""

    low_hz: Positive = 0.3
    high_hz: Positive = 2.0
    threshold_mps2: NonNegative = 0.3
    relative_threshold: Fraction = 0.45
    min_interval_s: NonNegative = 0.3
    memory: Fraction = 0.8
    standstill_s: Positive = 2.0
    strike_lead_s: NonNegative = 0.08


class BandPeaks:
    """Stage LevelBlock -> StepEvent."""

    def __init__(self, rate_hz: float, parameters: BandPeaksParams) -> None:
        self._parameters = parameters
        self._filter = CausalBandPass(parameters.low_hz, parameters.high_hz, rate_hz)
        self._samples = UndecidedSamples(rate_hz, self._filter.delay_s + parameters.strike_lead_s)
        self._last_step_s = -np.inf
        self._recent_height = 0.0
        self.latency_s = self._filter.delay_s + parameters.strike_lead_s + 1.0 / rate_hz

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        if item.segment != self._samples.segment:
            self._samples.begin(item)
            self._filter.reset()
        self._samples.append(item, self._filter.push(item.vertical_mps2))
        return self._decide()

    def flush(self) -> list[StepEvent]:
        return []

    def _decide(self) -> list[StepEvent]:
        """Judge all samples that have both neighbours, then forget them."""
        signal = self._samples.signal
        if len(signal) < 3:
            return []
        peaks = np.flatnonzero(local_maxima(signal) & (signal > self._parameters.threshold_mps2))
        events = [self._samples.event(int(i)) for i in peaks if self._is_step(int(i))]
        self._samples.drop(len(signal) - 2)
        return events

    def _is_step(self, i: int) -> bool:
        p, time_s, height = self._parameters, self._samples.time_s(i), float(self._samples.signal[i])
        elapsed = time_s - self._last_step_s
        if elapsed < p.min_interval_s:
            return False
        if elapsed > p.standstill_s:
            self._recent_height = height
        if height < p.relative_threshold * self._recent_height:
            return False
        self._recent_height = p.memory * self._recent_height + (1.0 - p.memory) * height
        self._last_step_s = time_s
        return True
