"""Step detection of MMPDR (Tian et al. 2016), section III-C: peaks of the low-passed user acceleration.

HOLDING only so far: the vertical acceleration of eqs. 5 and 6, positive peaks, criteria 1 and 2. In SWING and POCKET
the same acceleration is used instead of Table III's y and z axes. No step is detected in TRANS, and the compensation
of eq. 8 for those steps is not there yet.

Deviations from the paper. (1) Sample counts at 50 Hz are durations here. (2) The paper gives a threshold for POCKET
only (0.2 g); the HOLDING default was tuned on real walks. (3) The paper's accelerations have Apple's sign, which
points down, so its positive peaks are negative ones here; `peak_sign` says which are taken. (4) The time of a step
is put back by the low-pass filter's delay.
"""

from typing import Literal

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.signal.filters import CausalLowPass
from pdr_est.front_end.signal.peaks import local_maxima, local_minima
from pdr_est.front_end.steps.undecided import UndecidedSamples
from pdr_est.params import NonNegative, Positive, params
from pdr_est.records import CarryingMode, LevelBlock, StepEvent


@params
class MmpdrStepParams:
    """threshold_mps2: least height of a peak. cutoff_hz: low-pass. min_interval_s: criterion 1 (5 steps a second).
    false_peak_window_s: criterion 2, no opposite peak within this time after a valid one. peak_sign: 1 takes
    peaks of upward acceleration, -1 of downward."""

    threshold_mps2: NonNegative = 1.0
    cutoff_hz: Positive = 5.0
    min_interval_s: NonNegative = 0.2
    false_peak_window_s: NonNegative = 0.12
    peak_sign: Literal[-1, 1] = -1


class MmpdrSteps:
    """Stage LevelBlock -> StepEvent."""

    def __init__(self, rate_hz: float, parameters: MmpdrStepParams) -> None:
        self._parameters = parameters
        self._window = round(parameters.false_peak_window_s * rate_hz)
        self._filter = CausalLowPass(parameters.cutoff_hz, rate_hz)
        self._samples = UndecidedSamples(rate_hz, self._filter.delay_s)
        self._last_step_s = -np.inf
        self.latency_s = self._filter.delay_s + (self._window + 1) / rate_hz

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        events: list[StepEvent] = []
        if item.segment != self._samples.segment:
            events += self.flush()
            self._samples.begin(item)
            self._filter.reset()
        acceleration = self._parameters.peak_sign * holding_acceleration(item.up, item.acceleration_mps2)
        self._samples.append(item, self._filter.push(acceleration))
        return events + self._decide(self._window + 1)

    def flush(self) -> list[StepEvent]:
        return self._decide(1)

    def _decide(self, look_ahead: int) -> list[StepEvent]:
        """Judge all samples that have a predecessor and `look_ahead` successors, then forget them."""
        signal = self._samples.signal
        ready = len(signal) - look_ahead
        if ready <= 1:
            return []
        minima = np.flatnonzero(local_minima(signal))
        candidates = np.flatnonzero(local_maxima(signal) & (signal > self._parameters.threshold_mps2))
        events = []
        for i in candidates[candidates < ready]:
            next_minimum = minima[np.searchsorted(minima, i) :][:1]
            if len(next_minimum) and next_minimum[0] - i <= self._window:
                continue  # criterion 2
            time_s = self._samples.time_s(int(i))
            if time_s - self._last_step_s < self._parameters.min_interval_s:
                continue  # criterion 1
            event = self._samples.event(int(i))
            if event.mode is CarryingMode.TRANS:
                continue
            self._last_step_s = time_s
            events.append(event)
        self._samples.drop(ready - 1)
        return events


def holding_acceleration(up: Array, acceleration_mps2: Array) -> Array:
    """Vertical user acceleration of a phone held in front of the body (MMPDR eqs. 5 and 6), (n,).

    up: (n, 3) unit vector up, acceleration_mps2: (n, 3) without gravity, both in device axes.
    """
    phi = np.arctan2(np.abs(up[:, 2]), np.abs(up[:, 1]))  # eq. 5, defined for g_y = 0 as well
    vertical: Array = acceleration_mps2[:, 2] * np.sin(phi) + acceleration_mps2[:, 1] * np.cos(phi)  # eq. 6
    return vertical
