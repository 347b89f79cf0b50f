"""Step detection of MMPDR: peaks of the low-passed user acceleration.

    mode     acceleration (Table III)    peaks             after the peak no opposite one for (section IV-A)
    HOLDING  vertical, eqs. 5 and 6      positive          6 samples at 50 Hz = 0.12 s
    SWING    y axis                      of both signs     6 samples          = 0.12 s
    POCKET   z axis                      positive          3 samples          = 0.06 s

A peak beyond the threshold of its mode is a step if it comes at least 0.2 s after the step before (criterion 1) and
no peak of the opposite sign follows at once (criterion 2, false peak rejection). Nothing is detected in TRANS; the
steps of a transition are compensated when it is over (eq. 8, `mode_transition`), from the frequency of the steps
before it, which is 0 after two seconds without a step.

Readings of the paper. (1) Any peak of the opposite sign within the window rejects, however small, as the small ones
are those to be rejected. (2) A peak belongs to the mode of its own sample and is looked for on that mode's axis, even
if its neighbours or its window lie in another mode. (3) Criterion 1 counts from the last detected step, in whatever
mode; compensated steps are not compared. (4) The paper does not say when the steps of a transition were: they are
spread evenly over it. They take part in the standstill rule, and the first step after them leaves the frequency as it
is, because the time since the last of them says nothing. (5) A transition that the recording or a gap cuts off is
compensated up to there.

Deviations. (1) Sample counts are durations here. (2) The paper gives a threshold for POCKET only (0.2 g, with Fig.
7); those of HOLDING and SWING were tuned on real and simulated walks. (3) The paper's accelerations have Apple's
sign, which points down: its positive peaks are negative ones here, and `peak_sign` says which are taken. (4) Eq. 5 is
written with atan2, for g_y = 0. (5) The time of a step is put back by the low-pass filter's delay. (6) The paper
knows three modes: in any other one the vertical acceleration of a phone in any orientation follows the rules of
HOLDING.

References
----------
MMPDR: Tian et al., IEEE Sensors Journal 2016, section III-C, Table III, eqs. 5, 6 and 8; section IV-A.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.front_end.signal.event_detection import RefractoryPeriod, local_maxima, local_minima
from pdr_est.front_end.signal.filters import CausalLowPass
from pdr_est.front_end.steps.mode_transition import StepFrequency, TransitionCompensation
from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.label_runs import label_runs
from pdr_est.params import NonNegative, Positive, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, StepEvent


@params
class MmpdrStepParams:
    """Parameters of MMPDR's step detection (sections III-C and IV-A)."""

    holding_threshold_mps2: NonNegative = 0.5
    """Least height of a peak in HOLDING, m/s^2; ours, tuned on real and simulated walks."""
    swing_threshold_mps2: NonNegative = 1.0
    """Least height of a peak in SWING, m/s^2; ours, tuned on real and simulated walks."""
    pocket_threshold_mps2: NonNegative = 0.2 * STANDARD_GRAVITY_MPS2
    """Least height of a peak in POCKET, m/s^2; 0.2 g in the paper (Fig. 7)."""
    cutoff_hz: Positive = 5.0
    """Cutoff of the low-pass, Hz."""
    min_interval_s: NonNegative = 0.2
    """Criterion 1: least time between two steps, s (5 steps per second)."""
    false_peak_window_s: NonNegative = 0.12
    """Criterion 2: time, s, after a valid peak in which there is no peak of the opposite sign (n_fpr = 6 samples at
    50 Hz).
    """
    pocket_false_peak_window_s: NonNegative = 0.06
    """The same time in POCKET, s (n_fpr = 3 samples at 50 Hz)."""
    peak_sign: Literal[-1, 1] = -1
    """Sign of the peaks that are taken: 1 takes peaks of acceleration upwards and along +z, -1 the opposite ones,
    which are the paper's positive ones.
    """
    standstill_s: Positive = 2.0
    """Time without a step, s, after which the step frequency is 0."""
    transition_s: Positive = 2.0
    """Longest transition that is compensated at once, s."""


@dataclass(frozen=True)
class _PeakRule:
    """Rule of a carrying mode: column of the signals, signs of the peaks, window of criterion 2 in samples."""

    column: int
    signs: tuple[int, ...]
    threshold_mps2: float
    window: int

    def peaks(self, signals: Array) -> NDArray[np.intp]:
        """Return the positions of the valid peaks in signals (n, columns), rising."""
        column = signals[:, self.column]
        peaks = [valid_maxima(sign * column, self.threshold_mps2, self.window) for sign in self.signs]
        return np.sort(np.concatenate(peaks))


class MmpdrSteps:
    """Stage LevelBlock -> StepEvent by MMPDR's rules; compensated steps have the mode TRANS.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    parameters : MmpdrStepParams
        Filter, thresholds and windows.
    """

    def __init__(self, rate_hz: float, parameters: MmpdrStepParams) -> None:
        self._rate_hz = rate_hz
        self._parameters = parameters
        self._rules = _rules(rate_hz, parameters)
        self._look_ahead = max(rule.window for rule in self._rules.values()) + 1
        self._low_pass = CausalLowPass(parameters.cutoff_hz, rate_hz)
        self._samples = SampleBuffer(rate_hz, self._low_pass.delay_s, columns=_COLUMNS)
        self._decided = 0  # samples at the front of the window that have been decided
        self.latency_s = self._low_pass.delay_s + parameters.transition_s + self._look_ahead / rate_hz
        self._begin_walk()

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        """Take level samples and return the steps that are now certain."""
        if not len(item):
            return []
        events: list[StepEvent] = []
        if item.segment != self._samples.segment:
            events += self.flush()
            self._begin(item)
        self._samples.append(item, self._low_pass.push(_accelerations(item)))
        return events + self._decide(self._look_ahead)

    def flush(self) -> list[StepEvent]:
        """Return the steps that wait for their window or the end of a transition."""
        return self._decide(look_ahead=0) + self._transition.end()

    def _begin(self, block: LevelBlock) -> None:
        self._samples.begin(block)
        self._decided = 0
        self._low_pass.reset()
        self._begin_walk()

    def _begin_walk(self) -> None:
        self._criterion_1 = RefractoryPeriod(self._parameters.min_interval_s)
        self._frequency = StepFrequency(self._parameters.standstill_s)
        self._transition = TransitionCompensation(self._rate_hz, self._parameters.transition_s, self._frequency)

    def _decide(self, look_ahead: int) -> list[StepEvent]:
        """Decide about all samples that have `look_ahead` successors, then forget them but for the last."""
        samples = self._samples
        stop = len(samples.mode) - look_ahead
        if stop <= self._decided:
            return []
        peaks = {mode: rule.peaks(samples.signal) for mode, rule in self._rules.items() if mode in samples.mode}
        events: list[StepEvent] = []
        for first, last in label_runs(samples.mode[self._decided : stop]):
            start, end = self._decided + first, self._decided + last
            mode = int(samples.mode[start])
            if mode == CarryingMode.TRANS:
                events += self._transition.extend(samples, start, end)
            else:
                inside = slice(*np.searchsorted(peaks[mode], [start, end]))
                events += self._transition.end()
                events += self._steps(peaks[mode][inside].tolist())
        samples.drop(stop - 1)
        self._decided = 1
        return events

    def _steps(self, peaks: list[int]) -> list[StepEvent]:
        """Return the peaks that are steps by criterion 1."""
        events = []
        for i in peaks:
            event = self._samples.event(i)
            if not self._criterion_1.accepts(event.time_s):
                continue
            self._frequency.step(event.time_s)
            events.append(event)
        return events


_COLUMNS = 4


def _accelerations(block: LevelBlock) -> Array:
    """Stack the accelerations (n, `_COLUMNS`), m/s^2, of HOLDING, SWING, POCKET and of the paper's missing modes."""
    y, z = block.acceleration_mps2[:, 1], block.acceleration_mps2[:, 2]
    return np.stack([holding_acceleration(block.up, block.acceleration_mps2), y, z, block.vertical_mps2], axis=1)


def _rules(rate_hz: float, p: MmpdrStepParams) -> dict[int, _PeakRule]:
    """Make the rules of every mode in which steps are detected."""
    window, pocket_window = (round(s * rate_hz) for s in (p.false_peak_window_s, p.pocket_false_peak_window_s))
    any_orientation = _PeakRule(3, (p.peak_sign,), p.holding_threshold_mps2, window)
    return {
        CarryingMode.HOLDING: _PeakRule(0, (p.peak_sign,), p.holding_threshold_mps2, window),
        CarryingMode.SWING: _PeakRule(1, (1, -1), p.swing_threshold_mps2, window),
        CarryingMode.POCKET: _PeakRule(2, (p.peak_sign,), p.pocket_threshold_mps2, pocket_window),
        CarryingMode.OTHER: any_orientation,
        CarryingMode.UNKNOWN: any_orientation,
    }


def valid_maxima(signal: Array, threshold: float, window: int) -> NDArray[np.intp]:
    """Return the positions of the maxima that criterion 2 accepts.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        Low-passed acceleration.
    threshold : float
        Height that a maximum exceeds.
    window : int
        Number of samples after a maximum in which there is no minimum.

    References
    ----------
    MMPDR, section III-C, criterion 2.
    """
    maxima = np.flatnonzero(local_maxima(signal) & (signal > threshold))
    minima = np.append(np.flatnonzero(local_minima(signal)), len(signal) + window)
    return maxima[minima[np.searchsorted(minima, maxima)] - maxima > window]


def holding_acceleration(up: Array, acceleration_mps2: Array) -> Array:
    """Compute the vertical user acceleration (n,) of a phone held in front of the body.

    Parameters
    ----------
    up : ndarray, shape (n, 3)
        Unit vector upwards in device axes.
    acceleration_mps2 : ndarray, shape (n, 3)
        Acceleration without gravity in device axes.

    References
    ----------
    MMPDR, eqs. 5 and 6.
    """
    phi = np.arctan2(np.abs(up[:, 2]), np.abs(up[:, 1]))  # eq. 5, defined for g_y = 0 as well
    vertical: Array = acceleration_mps2[:, 2] * np.sin(phi) + acceleration_mps2[:, 1] * np.cos(phi)  # eq. 6
    return vertical
