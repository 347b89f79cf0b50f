"""Step detection of UPTIME (Alzantot and Youssef 2012), section III-A: states of the acceleration's magnitude.

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

Readings of the paper. (1) The thresholds have no unit; m/s^2, which its Android phones report, fits its Figure 2.
(2) Negative thresholds need a magnitude without gravity: the length of the specific force less standard gravity.
(3) "Going below Neg_Thr" at the end is about the size of m, which rises to zero through -0.6 there; taken by its
sign it would hold at once in S5. (4) The text names S4 and S5 and leaves open how they tolerate noise; the table
takes the usual reading of Figure 3, and in S5 the paper's text.

Deviation. The paper's machine makes one transition a sample and does not say how fast it samples. A transition here
takes `transition_s` instead, one sample at 50 Hz. It matters: with several transitions a sample, or faster samples,
the jolts of a pocket pass through all states and are counted. A recording sampled more slowly than that still makes
one transition a sample.
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
    """Table I, in m/s^2: Thr, Pos_Peek_Thr, Neg_Peek_Thr and Neg_Thr. transition_s: least time in a state."""

    threshold_mps2: float = 0.6
    positive_peak_mps2: float = 1.8
    negative_peak_mps2: float = -1.0
    negative_threshold_mps2: float = -0.6
    transition_s: NonNegative = 0.02

    def rising(self) -> tuple[float, float, float, float]:
        """The thresholds in rising order. Raises ConfigError if the values are in another order."""
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


class State(IntEnum):
    """The states of Figure 3 by their numbers in the paper."""

    NOT_WALKING = 0
    POSSIBLE_STEP = 1
    POSITIVE_PEAK = 2
    NEGATIVE_PEAK = 3
    START_NOISE = 4
    END_NOISE = 5
    STEP_END = 6


class UptimeFsm:
    """Stage LevelBlock -> StepEvent. Raises ConfigError if the thresholds are not in order."""

    latency_s = 0.0

    def __init__(self, rate_hz: float, parameters: UptimeFsmParams) -> None:
        self._thresholds = np.array(parameters.rising())
        self._stay = max(round(parameters.transition_s * rate_hz), 1)
        self._samples = SampleBuffer(rate_hz, delay_s=0.0)
        self._state = State.NOT_WALKING
        self._wait = 0  # samples until the state may change again

    @property
    def state(self) -> State:
        """The state after the latest sample."""
        return self._state

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        if not len(item):
            return []
        if item.segment != self._samples.segment:
            self._samples.begin(item)
            self._state, self._wait = State.NOT_WALKING, 0
        magnitude = excess_magnitude(item.up, item.acceleration_mps2)
        self._samples.append(item, magnitude)
        exceeded = np.searchsorted(self._thresholds, magnitude, side="left")
        events = [self._samples.event(i) for i in self._step_ends(exceeded)]
        self._samples.drop(len(item))
        return events

    def flush(self) -> list[StepEvent]:
        return []

    def _step_ends(self, exceeded: NDArray[np.intp]) -> list[int]:
        """Run through the samples, from transition to transition; positions of those that end a step.

        exceeded: (n,) how many of the thresholds each sample exceeds.
        """
        leaving = [np.flatnonzero(_LEAVES[state][exceeded]) for state in State]
        ends: list[int] = []
        position = self._wait
        while True:
            exits = leaving[self._state]
            nearest = int(np.searchsorted(exits, position))
            if nearest == len(exits):
                self._wait = max(position - len(exceeded), 0)
                return ends
            at = int(exits[nearest])
            self._state = next_state(self._state, int(exceeded[at]))
            if self._state is State.STEP_END:
                ends.append(at)
            position = at + self._stay


def next_state(state: State, exceeded: int) -> State:
    """The table above, one transition. exceeded: how many of the four thresholds, in rising order, m exceeds."""
    match state:
        case State.NOT_WALKING:
            return State.POSSIBLE_STEP if exceeded >= 3 else state
        case State.POSSIBLE_STEP if exceeded < 3:
            return State.START_NOISE
        case State.POSSIBLE_STEP:
            return State.POSITIVE_PEAK if exceeded == 4 else state
        case State.START_NOISE:
            return State.POSSIBLE_STEP if exceeded >= 3 else State.NOT_WALKING
        case State.POSITIVE_PEAK:
            return State.NEGATIVE_PEAK if exceeded == 0 else state
        case State.NEGATIVE_PEAK:
            return State.END_NOISE if exceeded >= 1 else state
        case State.END_NOISE if exceeded == 0:
            return State.NEGATIVE_PEAK
        case State.END_NOISE:
            return State.STEP_END if exceeded >= 2 else state
        case State.STEP_END:
            return State.NOT_WALKING


# Whether a sample that exceeds so many thresholds (column) ends the stay in a state (row).
_LEAVES = np.array([[next_state(state, exceeded) is not state for exceeded in range(5)] for state in State])
