"""Step detection of MMPDR (Tian et al. 2016), section III-C: peaks of the low-passed user acceleration.

HOLDING only so far: the vertical acceleration of eqs. 5 and 6, positive peaks, criteria 1 and 2.

Deviations from the paper. (1) Sample counts at 50 Hz are durations here. (2) The paper gives a threshold for POCKET
only (0.2 g); the HOLDING default was tuned on real walks. (3) Eqs. 5 and 6 hold for gravity and user acceleration
of any common sign; ours point up, Apple's down, so the paper's positive peak is our negative one. `peak_sign` says
which is taken. (4) The time of a step is put back by the low-pass filter's delay.
"""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.signal.filters import CausalLowPass
from pdr_est.front_end.signal.peaks import local_maxima, local_minima
from pdr_est.params import NonNegative, Positive, params
from pdr_est.records import CarryingMode, LevelBlock, StepEvent


@params
class MmpdrStepParams:
    """threshold_mps2: least height of a peak. cutoff_hz: low-pass. min_interval_s: criterion 1 (5 steps a second).
    false_peak_window_s: criterion 2, no opposite peak within this time after a valid one. peak_sign: +1 takes
    peaks of upward acceleration, -1 of downward."""

    threshold_mps2: NonNegative = 0.5
    cutoff_hz: Positive = 5.0
    min_interval_s: NonNegative = 0.2
    false_peak_window_s: NonNegative = 0.12
    peak_sign: int = 1


class MmpdrSteps:
    """Stage LevelBlock -> StepEvent."""

    def __init__(self, rate_hz: float, parameters: MmpdrStepParams) -> None:
        self._parameters = parameters
        self._window = round(parameters.false_peak_window_s * rate_hz)
        self._filter = CausalLowPass(parameters.cutoff_hz, rate_hz)
        self._rate_hz = rate_hz
        self._delay = round(self._filter.delay_s * rate_hz)
        self._segment: int | None = None
        self._last_step_s = -np.inf
        self._first_index = 0
        self._undecided = 1
        self._signal: Array = np.empty(0)
        self._time_s: Array = np.empty(0)
        self._mode: NDArray[np.int8] = np.empty(0, dtype=np.int8)

    @property
    def latency_s(self) -> float:
        return self._filter.delay_s + (self._window + 1) / self._rate_hz

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        events: list[StepEvent] = []
        if item.segment != self._segment:
            events += self.flush()
            self._segment = item.segment
            self._filter.reset()
            self._begin(item.first_index)
        vertical = self._parameters.peak_sign * holding_acceleration(item.up, item.acceleration_mps2)
        self._signal = np.concatenate([self._signal, self._filter.push(vertical)])
        self._time_s = np.concatenate([self._time_s, item.time_s])
        self._mode = np.concatenate([self._mode, item.mode])
        return events + self._decide(self._window + 1)

    def flush(self) -> list[StepEvent]:
        return self._decide(1)

    def _begin(self, first_index: int) -> None:
        self._first_index = first_index
        self._undecided = 1
        self._signal, self._time_s, self._mode = self._signal[:0], self._time_s[:0], self._mode[:0]

    def _decide(self, look_ahead: int) -> list[StepEvent]:
        """Judge all samples that have `look_ahead` successors; forget what no later decision needs."""
        ready = len(self._signal) - look_ahead
        if ready <= self._undecided:
            return []
        minima = np.flatnonzero(local_minima(self._signal))
        candidates = np.flatnonzero(local_maxima(self._signal) & (self._signal > self._parameters.threshold_mps2))
        events = []
        for i in candidates[(candidates >= self._undecided) & (candidates < ready)]:
            next_minimum = minima[np.searchsorted(minima, i) :][:1]
            if len(next_minimum) and next_minimum[0] - i <= self._window:
                continue  # criterion 2
            time = float(self._time_s[i]) - self._filter.delay_s
            if time - self._last_step_s < self._parameters.min_interval_s:
                continue  # criterion 1
            self._last_step_s = time
            events.append(self._event(int(i), time))
        drop = ready - 1
        self._first_index += drop
        self._signal, self._time_s, self._mode = self._signal[drop:], self._time_s[drop:], self._mode[drop:]
        self._undecided = 1
        return events

    def _event(self, i: int, time_s: float) -> StepEvent:
        return StepEvent(
            index=self._first_index + i - self._delay,
            time_s=time_s,
            segment=self._segment or 0,
            mode=CarryingMode(int(self._mode[i])),
        )


def holding_acceleration(up: Array, acceleration_mps2: Array) -> Array:
    """Vertical user acceleration of a phone held in front of the body (MMPDR eqs. 5 and 6), (n,).

    up: (n, 3) unit vector up, acceleration_mps2: (n, 3) without gravity, both in device axes.
    """
    phi = np.arctan2(np.abs(up[:, 2]), np.abs(up[:, 1]))  # eq. 5, defined for g_y = 0 as well
    vertical: Array = acceleration_mps2[:, 2] * np.sin(phi) + acceleration_mps2[:, 1] * np.cos(phi)  # eq. 6
    return vertical
