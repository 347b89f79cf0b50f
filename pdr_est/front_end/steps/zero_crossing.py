"""Step detection by zero crossings, UPTIME's baseline (Alzantot and Youssef 2012, section II-B 2, reference [11]).

The magnitude of the acceleration is low-passed; each crossing of zero upwards is the boundary of a step.

The paper gives neither the filter nor numbers. Ours: (1) a Butterworth low-pass of second order. (2) Zero is the
mean of the low-passed magnitude over the last seconds, because an accelerometer's scale and bias move the magnitude
at rest away from standard gravity.

Deviations, without which the method counts the noise of a phone that lies still. (3) A crossing counts after the
signal was below a dead band only. (4) A crossing soon after a step is not a step. Both can be set to 0.
"""

from pdr_est.front_end.signal.filters import CausalLowPass
from pdr_est.front_end.signal.moving_average import MovingAverage
from pdr_est.front_end.signal.vectors import excess_magnitude
from pdr_est.front_end.steps.hysteresis_detector import TriggeredSteps
from pdr_est.params import NonNegative, Positive, Window, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import StepEvent


@params
class ZeroCrossingParams:
    """cutoff_hz: low-pass. mean_window_s: over which the mean is taken. dead_band_mps2: how far below the mean the
    signal must have been. min_interval_s: between steps."""

    cutoff_hz: Positive = 2.5
    mean_window_s: Window = 2.0
    dead_band_mps2: NonNegative = 0.4
    min_interval_s: NonNegative = 0.3


class ZeroCrossing:
    """Stage LevelBlock -> StepEvent."""

    def __init__(self, rate_hz: float, parameters: ZeroCrossingParams) -> None:
        self._low_pass = CausalLowPass(parameters.cutoff_hz, rate_hz)
        self._mean = MovingAverage(parameters.mean_window_s, rate_hz)
        self.latency_s = self._low_pass.delay_s
        self._crossings = TriggeredSteps(
            rate_hz,
            self.latency_s,
            above=parameters.dead_band_mps2,
            below=0.0,
            min_interval_s=parameters.min_interval_s,
        )

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        if not len(item):
            return []
        if self._crossings.begins(item):
            self._low_pass.reset()
            self._mean.reset()
        smooth = self._low_pass.push(excess_magnitude(item.up, item.acceleration_mps2))
        depth = self._mean.push(smooth) - smooth
        return self._crossings.push(item, depth)

    def flush(self) -> list[StepEvent]:
        return []
