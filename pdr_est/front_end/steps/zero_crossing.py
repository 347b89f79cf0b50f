"""Step detection by zero crossings, UPTIME's baseline (Alzantot and Youssef 2012, section II-B 2, reference [11]).

The magnitude of the acceleration is low-passed; each crossing of zero upwards is the boundary of a step.

The paper gives neither the filter nor numbers. Ours: (1) a Butterworth low-pass of second order. (2) Zero is the
mean of the low-passed magnitude over the last seconds, because an accelerometer's scale and bias move the magnitude
at rest away from standard gravity.

Deviations, without which the method counts the noise of a phone that lies still. (3) A crossing counts after the
signal was below a dead band only. (4) A crossing soon after a step is not a step. Both can be set to 0.
"""

from pdr_est.front_end.signal.filters import CausalLowPass
from pdr_est.front_end.signal.magnitude import excess_magnitude
from pdr_est.front_end.signal.moving_average import MovingAverage
from pdr_est.front_end.signal.trigger import Refractory, Trigger
from pdr_est.front_end.steps.undecided import UndecidedSamples
from pdr_est.params import NonNegative, Positive, params
from pdr_est.records import LevelBlock, StepEvent


@params
class ZeroCrossingParams:
    """cutoff_hz: low-pass. mean_window_s: over which the mean is taken. dead_band_mps2: how far below the mean the
    signal must have been. min_interval_s: between steps."""

    cutoff_hz: Positive = 2.5
    mean_window_s: Positive = 2.0
    dead_band_mps2: NonNegative = 0.4
    min_interval_s: NonNegative = 0.3


class ZeroCrossing:
    """Stage LevelBlock -> StepEvent."""

    def __init__(self, rate_hz: float, parameters: ZeroCrossingParams) -> None:
        self._parameters = parameters
        self._low_pass = CausalLowPass(parameters.cutoff_hz, rate_hz)
        self._mean = MovingAverage(parameters.mean_window_s, rate_hz)
        self._trigger = Trigger()
        self._samples = UndecidedSamples(rate_hz, self._low_pass.delay_s)
        self._refractory = Refractory(parameters.min_interval_s)
        self.latency_s = self._low_pass.delay_s

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        if not len(item):
            return []
        if item.segment != self._samples.segment:
            self._begin(item)
        smooth = self._low_pass.push(excess_magnitude(item.up, item.acceleration_mps2))
        signal = smooth - self._mean.push(smooth)
        self._samples.append(item, signal)
        crossings = self._trigger.push(signal < -self._parameters.dead_band_mps2, signal > 0.0)
        events = [
            event for event in map(self._samples.event, crossings.tolist()) if self._refractory.accepts(event.time_s)
        ]
        self._samples.drop(len(item))
        return events

    def flush(self) -> list[StepEvent]:
        return []

    def _begin(self, item: LevelBlock) -> None:
        self._samples.begin(item)
        self._low_pass.reset()
        self._mean.reset()
        self._trigger.reset()
