"""Detect steps by zero crossings, a baseline of UPTIME.

The magnitude of the acceleration is low-passed; each crossing of zero upwards is the boundary of a step.

The paper gives neither the filter nor numbers. Ours: (1) a Butterworth low-pass of second order. (2) Zero is the mean
of the low-passed magnitude over the last seconds, because an accelerometer's scale and bias move the magnitude at
rest away from standard gravity.

Deviations, without which the method counts the noise of a phone that lies still. (3) A crossing counts only after the
signal was below a dead band. (4) A crossing soon after a step is not a step. Both can be set to 0.

References
----------
UPTIME: Alzantot and Youssef, WCNC 2012, section II-B 2, after its reference [11].
"""

from pdr_est.front_end.signal.filters import CausalLowPass
from pdr_est.front_end.signal.moving_average import MovingAverage
from pdr_est.front_end.signal.vectors import excess_magnitude
from pdr_est.front_end.steps.hysteresis_detector import HysteresisDetector
from pdr_est.params import NonNegative, Positive, Window, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import StepEvent


@params
class ZeroCrossingParams:
    """Parameters of the step detector "zero-crossing"; all values are ours."""

    cutoff_hz: Positive = 2.5
    """Cutoff of the low-pass, Hz."""
    mean_window_s: Window = 2.0
    """Window over which the mean is taken, s."""
    dead_band_mps2: NonNegative = 0.4
    """Depth below the mean, m/s^2, that the signal must have reached before a crossing."""
    min_interval_s: NonNegative = 0.3
    """Least time between two steps, s."""


class ZeroCrossing:
    """Stage LevelBlock -> StepEvent by zero crossings of the acceleration's magnitude.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    parameters : ZeroCrossingParams
        Filter, mean and dead band.
    """

    def __init__(self, rate_hz: float, parameters: ZeroCrossingParams) -> None:
        self._low_pass = CausalLowPass(parameters.cutoff_hz, rate_hz)
        self._mean = MovingAverage(parameters.mean_window_s, rate_hz)
        self.latency_s = self._low_pass.delay_s
        self._hysteresis = HysteresisDetector(
            rate_hz,
            self.latency_s,
            above=parameters.dead_band_mps2,
            below=0.0,
            min_interval_s=parameters.min_interval_s,
        )

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        """Take level samples and return the steps in them."""
        if not len(item):
            return []
        if self._hysteresis.begin_if_new_segment(item):
            self._low_pass.reset()
            self._mean.reset()
        smooth = self._low_pass.push(excess_magnitude(item.up, item.acceleration_mps2))
        depth = self._mean.push(smooth) - smooth
        return self._hysteresis.push(item, depth)

    def flush(self) -> list[StepEvent]:
        """Return nothing: no event is held back."""
        return []
