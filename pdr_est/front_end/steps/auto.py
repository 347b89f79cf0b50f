"""Step detection by the crests of the vertical acceleration in the band of walking cadences.

Not from a paper. A steep low-pass below the second harmonic of slow walking leaves one hump a step whatever the shape
of the raw signal, so that counting humps needs no shape rules; a threshold relative to the recent humps refuses the
small ones between steps and while standing. It serves every position of the phone.
"""

from dataclasses import replace

import numpy as np

from pdr_est.front_end.signal.filters import CausalBandPass
from pdr_est.front_end.signal.peaks import local_maxima
from pdr_est.front_end.steps.undecided import UndecidedSamples
from pdr_est.params import Fraction, NonNegative, Positive, params
from pdr_est.records import CarryingMode, LevelBlock, StepEvent


@params
class AutoStepParams:
    """low_hz, high_hz: band of cadences. threshold_mps2: least height of a hump in the band; relative_threshold:
    its least share of the recent humps' height, and relative_threshold_holding the same for a phone held in front of
    the body, which feels both feet alike. min_interval_s: between steps. memory: weight of the past in the
    recent height. standstill_s: after this long without a step the walk is over. A walk begins with two crests at
    most first_interval_s apart, so that a single jolt is no step; the first of them is a step if it has first_share
    of the second's height. strike_lead_s: the foot strikes the ground this long before the trunk's acceleration
    crests; a step's time is that of the strike."""

    low_hz: Positive = 0.3
    high_hz: Positive = 2.0
    threshold_mps2: NonNegative = 0.3
    relative_threshold: Fraction = 0.25
    relative_threshold_holding: Fraction = 0.45
    min_interval_s: NonNegative = 0.3
    memory: Fraction = 0.8
    standstill_s: Positive = 2.0
    first_interval_s: Positive = 1.3
    first_share: Fraction = 0.4
    strike_lead_s: NonNegative = 0.08


class AutoSteps:
    """Stage LevelBlock -> StepEvent.

    The confidence of a step grows from 0 for a hump as high as the threshold to 1 for one far above it.
    """

    def __init__(self, rate_hz: float, parameters: AutoStepParams) -> None:
        self._parameters = parameters
        self._filter = CausalBandPass(parameters.low_hz, parameters.high_hz, rate_hz)
        delay_s = self._filter.delay_s + parameters.strike_lead_s
        self._samples = UndecidedSamples(rate_hz, delay_s)
        self._last_crest_s = -np.inf
        self._recent_height = 0.0  # of the walk under way; 0 before its second step
        self._first: tuple[StepEvent, float] | None = None
        self.latency_s = delay_s + parameters.first_interval_s + 1.0 / rate_hz

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        if item.segment != self._samples.segment:
            self._samples.begin(item)
            self._filter.reset()
            self._last_crest_s, self._recent_height, self._first = -np.inf, 0.0, None
        self._samples.append(item, self._filter.push(item.vertical_mps2))
        return self._decide()

    def flush(self) -> list[StepEvent]:
        return []

    def _decide(self) -> list[StepEvent]:
        """Judge all samples that have both neighbours, then forget them."""
        signal = self._samples.signal
        if len(signal) < 3:
            return []
        crests = np.flatnonzero(local_maxima(signal) & (signal > self._parameters.threshold_mps2))
        events = [event for i in crests for event in self._judge(int(i))]
        self._samples.drop(len(signal) - 2)
        return events

    def _judge(self, i: int) -> list[StepEvent]:
        """The steps that crest i makes certain: its own, and with the second of a walk also the first."""
        p, time_s, height = self._parameters, self._samples.time_s(i), float(self._samples.signal[i])
        elapsed = time_s - self._last_crest_s
        if elapsed < p.min_interval_s:
            return []
        if elapsed > p.standstill_s:
            self._recent_height, self._first = 0.0, None
        event = self._samples.event(i)
        held = event.mode is CarryingMode.HOLDING
        share = p.relative_threshold_holding if held else p.relative_threshold
        threshold = max(p.threshold_mps2, share * self._recent_height)
        if height < threshold:
            return []
        self._last_crest_s = time_s
        event = replace(event, confidence=1.0 - (threshold / height) ** 2)
        if self._recent_height > 0.0:
            self._recent_height = p.memory * self._recent_height + (1.0 - p.memory) * height
            return [event]
        first, self._first = self._first, (event, height)
        if first is None or time_s - first[0].time_s > p.first_interval_s:
            return []
        self._recent_height, self._first = 0.5 * (first[1] + height), None
        return [first[0], event] if first[1] >= p.first_share * height else [event]
