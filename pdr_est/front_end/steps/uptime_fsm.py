"""Step detection of UPTIME: a state machine on the magnitude of the acceleration.

The magnitude enters unfiltered, gravity taken off. m stands for it, the thresholds are those of Table I.

    state                     goes on to                when
    S0 not walking            S1                        m > Thr
    S1 step perhaps begun     S2                        m > Pos_Peek_Thr
                              S4                        m <= Thr
    S4 noise after S1         S1                        m > Thr
                              S0                        m <= Thr
    S2 positive peak          S3                        m <= Neg_Peek_Thr
    S3 negative peak          S5                        m > Neg_Peek_Thr
    S5 noise after S3         S3                        m <= Neg_Peek_Thr
                              S6                        m > Neg_Thr
    S6 end of the step        S0                        always

A step's time is that of S6, where the paper ends it. The paper has no time limits and no confidence, so neither has
this stage.

Readings of the paper. (1) The thresholds have no unit; m/s^2, which its Android phones report, fits its Figure 2. (2)
Negative thresholds need a magnitude without gravity: the length of the specific force less standard gravity. (3)
"Going below Neg_Thr" at the end is about the size of m, which rises to zero through -0.6 there; taken by its sign it
would hold at once in S5. (4) The text names S4 and S5 and leaves open how they tolerate noise; the table takes the
usual reading of Figure 3, and in S5 the paper's text.

Deviation. The paper's machine makes one transition per sample and does not say how fast it samples. A transition here
takes `transition_s` instead, one sample at 50 Hz. It matters: with several transitions per sample, or faster samples,
the jolts of a pocket pass through all states and are counted. A recording sampled more slowly than that still makes
one transition per sample.

References
----------
UPTIME: Alzantot and Youssef, WCNC 2012, section III-A, Figure 3 and Table I.
"""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import ConfigError
from pdr_est.front_end.signal.vectors import excess_magnitude
from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.params import NonNegative, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import StepEvent


@params
class UptimeFsmParams:
    """Thresholds of UPTIME's state machine (Table I), and the duration of a transition."""

    threshold_mps2: float = 0.6
    """Thr, m/s^2 (Table I)."""
    positive_peak_mps2: float = 1.8
    """Pos_Peek_Thr, m/s^2 (Table I)."""
    negative_peak_mps2: float = -1.0
    """Neg_Peek_Thr, m/s^2 (Table I)."""
    negative_threshold_mps2: float = -0.6
    """Neg_Thr, m/s^2 (Table I)."""
    transition_s: NonNegative = 0.02
    """Least time in a state, s; ours, one sample at 50 Hz."""

    def rising(self) -> tuple[float, float, float, float]:
        """Return the thresholds in rising order.

        Raises
        ------
        ConfigError
            If the values are in another order.
        """
        order = (
            self.negative_peak_mps2,
            self.negative_threshold_mps2,
            self.threshold_mps2,
            self.positive_peak_mps2,
        )
        if not order[0] < order[1] < order[2] < order[3]:
            raise ConfigError(
                f"uptime-fsm thresholds {order}: negative_peak_mps2 < negative_threshold_mps2 < threshold_mps2 "
                "< positive_peak_mps2 is needed"
            )
        return order


class UptimeState(IntEnum):
    """States of UPTIME's Figure 3 by their numbers in the paper."""

    NOT_WALKING = 0
    POSSIBLE_STEP = 1
    POSITIVE_PEAK = 2
    NEGATIVE_PEAK = 3
    START_NOISE = 4
    END_NOISE = 5
    STEP_END = 6


class UptimeFsm:
    """Stage LevelBlock -> StepEvent by UPTIME's state machine.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    parameters : UptimeFsmParams
        Thresholds, and the duration of a transition.

    Raises
    ------
    ConfigError
        If the thresholds are not in order.
    """

    latency_s = 0.0

    def __init__(self, rate_hz: float, parameters: UptimeFsmParams) -> None:
        self._thresholds = np.array(parameters.rising())
        self._samples_per_transition = max(round(parameters.transition_s * rate_hz), 1)
        self._samples = SampleBuffer(rate_hz, delay_s=0.0)
        self._state = UptimeState.NOT_WALKING
        self._wait = 0  # samples until the state may change again

    @property
    def state(self) -> UptimeState:
        """Return the state after the latest sample."""
        return self._state

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        """Take level samples and return the steps that end in them."""
        if not len(item):
            return []
        if item.segment != self._samples.segment:
            self._samples.begin(item)
            self._state, self._wait = UptimeState.NOT_WALKING, 0
        magnitude = excess_magnitude(item.up, item.acceleration_mps2)
        self._samples.append(item, magnitude)
        exceeded = np.searchsorted(self._thresholds, magnitude, side="left")
        events = [self._samples.event(i) for i in self._step_ends(exceeded)]
        self._samples.drop(len(item))
        return events

    def flush(self) -> list[StepEvent]:
        """Return nothing: no event is held back."""
        return []

    def _step_ends(self, exceeded: NDArray[np.intp]) -> list[int]:
        """Run from transition to transition and return the positions of the samples that end a step.

        `exceeded` (n,) is the number of thresholds that each sample exceeds.
        """
        exits_of = [np.flatnonzero(_IS_EXIT[state][exceeded]) for state in UptimeState]
        ends: list[int] = []
        position = self._wait
        while True:
            exits = exits_of[self._state]
            nearest = int(np.searchsorted(exits, position))
            if nearest == len(exits):
                self._wait = max(position - len(exceeded), 0)
                return ends
            at = int(exits[nearest])
            self._state = next_state(self._state, int(exceeded[at]))
            if self._state is UptimeState.STEP_END:
                ends.append(at)
            position = at + self._samples_per_transition


def next_state(state: UptimeState, exceeded: int) -> UptimeState:
    """Make one transition of the table in the module's docstring.

    Parameters
    ----------
    state : UptimeState
        Present state.
    exceeded : int
        Number of the four thresholds, in rising order, that m exceeds.
    """
    match state:
        case UptimeState.NOT_WALKING:
            return UptimeState.POSSIBLE_STEP if exceeded >= 3 else state
        case UptimeState.POSSIBLE_STEP if exceeded < 3:
            return UptimeState.START_NOISE
        case UptimeState.POSSIBLE_STEP:
            return UptimeState.POSITIVE_PEAK if exceeded == 4 else state
        case UptimeState.START_NOISE:
            return UptimeState.POSSIBLE_STEP if exceeded >= 3 else UptimeState.NOT_WALKING
        case UptimeState.POSITIVE_PEAK:
            return UptimeState.NEGATIVE_PEAK if exceeded == 0 else state
        case UptimeState.NEGATIVE_PEAK:
            return UptimeState.END_NOISE if exceeded >= 1 else state
        case UptimeState.END_NOISE if exceeded == 0:
            return UptimeState.NEGATIVE_PEAK
        case UptimeState.END_NOISE:
            return UptimeState.STEP_END if exceeded >= 2 else state
        case UptimeState.STEP_END:
            return UptimeState.NOT_WALKING


# True where a sample that exceeds so many thresholds (column) leaves the state (row).
_IS_EXIT = np.array([[next_state(state, exceeded) is not state for exceeded in range(5)] for state in UptimeState])
