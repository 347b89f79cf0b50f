"""Detect steps by local variance, a baseline of UPTIME.

The magnitude of the acceleration is filtered and its variance over a sliding window is compared with a threshold. The
method comes from sensors on the foot ([10]). We do not have the text of [10]; public programs of the method take the
standard deviation in a window of 15 samples to either side, above 2 m/s^2 for the swing of the foot and below 1 m/s^2
for its stance, and count swings with a stance soon after.

UPTIME names neither filter nor window nor thresholds. Ours: (1) A Butterworth low-pass of second order. (2) The
window ends at the current sample, and its delay is taken off the time of a step. (3) The variance is about the
window's own mean. (4) The step is where the stance begins. (5) The defaults are tuned on phones; with thresholds for
the foot the method misses most of their steps. (6) A stance soon after a step is not a step: the variance of the
smooth wave that a phone away from the foot feels has two peaks per step.

References
----------
UPTIME: Alzantot and Youssef, WCNC 2012, section II-B 1. [10] there is Jimenez et al. 2009.
"""

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.front_end.signal.filters import CausalLowPass
from pdr_est.front_end.signal.moving_average import MovingAverage
from pdr_est.front_end.signal.vectors import excess_magnitude
from pdr_est.front_end.steps.hysteresis_detector import HysteresisDetector
from pdr_est.params import NonNegative, Positive, Window, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import StepEvent


@params
class LocalVarianceParams:
    """Parameters of the step detector "local-variance"; all values are ours, tuned on phones."""

    cutoff_hz: Positive = 3.0
    """Cutoff of the low-pass, Hz."""
    window_s: Window = 0.12
    """Length of the window of the variance, s."""
    swing_mps2: NonNegative = 0.6
    """Standard deviation above which the foot swings, m/s^2."""
    stance_mps2: NonNegative = 0.6
    """Standard deviation below which the foot stands, m/s^2; at most as large as swing_mps2."""
    min_interval_s: NonNegative = 0.35
    """Least time between two steps, s."""


class LocalVariance:
    """Stage LevelBlock -> StepEvent by the local variance of the acceleration's magnitude.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    parameters : LocalVarianceParams
        Filter, window and thresholds.

    Raises
    ------
    ConfigError
        If the threshold of the stance is above that of the swing.
    """

    def __init__(self, rate_hz: float, parameters: LocalVarianceParams) -> None:
        if parameters.stance_mps2 > parameters.swing_mps2:
            raise ConfigError(
                f"stance_mps2 {parameters.stance_mps2} is above swing_mps2 {parameters.swing_mps2}: "
                "give it the same value or a smaller one"
            )
        self._low_pass = CausalLowPass(parameters.cutoff_hz, rate_hz)
        self._averages = MovingAverage(parameters.window_s, rate_hz)
        self.latency_s = self._low_pass.delay_s + self._averages.delay_s
        self._hysteresis = HysteresisDetector(
            rate_hz,
            self.latency_s,
            above=parameters.swing_mps2**2,
            below=parameters.stance_mps2**2,
            min_interval_s=parameters.min_interval_s,
        )

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        """Take level samples and return the steps in them."""
        if not len(item):
            return []
        if self._hysteresis.begin_if_new_segment(item):
            self._low_pass.reset()
            self._averages.reset()
        smooth = self._low_pass.push(excess_magnitude(item.up, item.acceleration_mps2))
        return self._hysteresis.push(item, self._variance(smooth))

    def flush(self) -> list[StepEvent]:
        """Return nothing: no event is held back."""
        return []

    def _variance(self, samples: Array) -> Array:
        """Compute the variance (n,) of the window that ends at each of the samples (n,)."""
        mean, mean_square = self._averages.push(np.stack([samples, samples * samples], axis=1)).T
        variance: Array = mean_square - mean * mean
        return variance
