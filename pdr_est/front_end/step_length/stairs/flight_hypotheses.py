"""Probability of every step to lie on a flight of stairs, by a bank of Kalman filters over the vertical motion.

A hypothesis says for each step so far whether it went level, down or up. Its Kalman filter has four states: the error
of the vertical velocity, that of the acceleration, the difference of left and right steps, and the height by the air
pressure. The velocity of a step is that of its hypothesis, rise per duration, plus the first and the third state. It
may also be disturbed: for this step only, or by a change that stays.

Flights begin with a constant probability at each step. Their length is the sum of three exponential ones (an Erlang
distribution), since hardly any has one step or forty. After each step hypotheses that are in the same phase and
nearly agree on the velocity's error are merged, and only the most probable ones are kept. Each carries the
probabilities of its past steps along, so that the end of a flight tells of its steps, too: a jump up that is followed
by one down some steps later is a flight, and neither of them alone is.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.step_length.stairs import flight_tables as column
from pdr_est.front_end.step_length.stairs.flight_bank import (
    MOST_HYPOTHESES,
    Bank,
    Places,
    measure,
    merged_bank,
    most_probable,
)
from pdr_est.front_end.step_length.stairs.flight_tables import FlightTables
from pdr_est.front_end.step_length.stairs.stair_params import StairParams
from pdr_est.front_end.step_length.stairs.vertical_motion import VerticalMotion
from pdr_est.front_end.step_length.stairs.walk_noise import WalkNoise

_PHASES = 3  # of a flight
_LEVEL = 0  # the mode of level walking; those of the phases of flights down and up follow
_DIRECTION = np.array([0.0] + [-1.0] * _PHASES + [1.0] * _PHASES)  # of each mode
_ON_STAIRS = np.abs(_DIRECTION)
_SUCCESSORS = 3  # most modes that can follow a mode
_PARENT = np.repeat(np.arange(MOST_HYPOTHESES), _SUCCESSORS)  # of each child
_LAG_STEPS = 60  # no flight is longer, nor tells more about steps before it
UNSETTLED_STEPS = 3  # at the start of a walk, whose velocity tells nothing
_SIGMA_START_MPS = 1.0
_SIGMA_START_HEIGHT_M = 100.0
_SHARE_AT_START = 0.02  # of walks that begin on stairs; set and not fitted
_BIAS_AFTER_GAP = 0.3  # standard deviation of the change of the acceleration's error over a gap, over its own
_NEGLIGIBLE = 1e-9


class _Children(NamedTuple):
    """Hypotheses after a step by what it is: parent, mode and log weight (m,), and rows (m, WIDTH)."""

    parent: Places
    mode: Places
    log_weight: Array
    rows: Array


class FlightHypotheses:
    """Probability of each step to lie on stairs; it is known when the walk ends or many steps later.

    Parameters
    ----------
    parameters : StairParams
        Dimensions of stairs, and noise.

    Attributes
    ----------
    noise : WalkNoise
        What the walk shows of its own noise.
    """

    def __init__(self, parameters: StairParams) -> None:
        self._parameters = parameters
        self._successors, self._log_transitions = _successors(_transitions(parameters))
        self._tables = FlightTables(parameters, _DIRECTION)
        self._bias = (0.0, parameters.sigma_bias_mps2)  # mean and standard deviation
        self.noise = WalkNoise()
        shares = (1.0 - parameters.share_disturbed - parameters.share_of_jumps, parameters.share_disturbed)
        self._log_share = np.log(np.maximum([*shares, parameters.share_of_jumps], _NEGLIGIBLE))[:, None]
        self._steps = self._known = 0
        self._bank: Bank | None = None

    @property
    def probability(self) -> float:
        """Return the probability that the last step lies on stairs, by it and the steps before it."""
        bank = self._bank
        return 0.0 if bank is None else float(np.exp(bank.log_weight) @ (bank.mode != _LEVEL))

    def add(self, motion: VerticalMotion) -> list[float]:
        """Take in the next step; return the probabilities of the steps that have become final, in their order."""
        final: list[float] = []
        if motion.begins or self._bank is None:
            final = self.finish()
            self._bank, self._steps, self._known = self._start(), 0, 0
        self._steps += 1  # of the stretch, as far as they matter
        known = self._steps > UNSETTLED_STEPS and math.isfinite(motion.velocity_mps)
        self._known += known
        bank = self._after_step(self._bank, motion, known)
        if bank.past.shape[1] > _LAG_STEPS:
            final.append(float(np.exp(bank.log_weight) @ bank.past[:, 0]) if self._known else 0.0)
            bank = Bank(bank.mode, bank.log_weight, bank.filters, bank.past[:, 1:])
        self._bank = bank
        return final

    def begin_level(self, motions: Sequence[VerticalMotion]) -> None:
        """Begin in the middle of a stretch, after steps that were level; they tell the errors of the next ones."""
        start = self._start()
        filters = start.filters[:1]
        for motion in motions:
            move, of_mode, of_case = self._tables.at(motion.step_s, motion.pace_s, self.noise.variance)
            rows = filters @ move + of_mode[_LEVEL] + of_case[0]
            if math.isfinite(motion.velocity_mps):
                self._update(rows, motion)
            filters = rows[:, column.FILTER]
        self._bank = Bank(np.array([_LEVEL]), np.zeros(1), filters, np.empty((1, 0)))
        self._steps, self._known = 2 * UNSETTLED_STEPS, sum(math.isfinite(motion.velocity_mps) for motion in motions)

    def finish(self) -> list[float]:
        """Return the probabilities of the steps that are not final yet: nothing more can be learnt about them.

        They are 0 for steps of a walk whose vertical velocity is not known at all.
        """
        bank, self._bank = self._bank, None
        if bank is None:
            return []
        weight, bias = np.exp(bank.log_weight), bank.filters[:, column.ACCELERATION]
        mean = float(weight @ bias)
        variance = bank.filters[:, column.variance(column.ACCELERATION)]
        self._bias = (mean, math.sqrt(float(weight @ (variance + (bias - mean) ** 2))))
        return [float(p) * bool(self._known) for p in weight @ bank.past]

    def _start(self) -> Bank:
        """Make the hypotheses at the start of a walk; what is known of the acceleration's error is kept."""
        p = self._parameters
        mean, sigma = self._bias
        mode = np.array([_LEVEL, 1, 1 + _PHASES])
        variances = [
            _SIGMA_START_MPS**2,
            min(sigma**2 + (_BIAS_AFTER_GAP * p.sigma_bias_mps2) ** 2, p.sigma_bias_mps2**2),
            p.sigma_limp_mps**2,
            _SIGMA_START_HEIGHT_M**2,
        ]
        weight = np.array([1.0 - _SHARE_AT_START, _SHARE_AT_START / 2, _SHARE_AT_START / 2])
        one = np.concatenate([[0.0, mean, 0.0, 0.0], np.diag(variances).ravel()])
        return Bank(mode, np.log(weight), np.tile(one, (len(mode), 1)), np.empty((len(mode), 0)))

    def _after_step(self, bank: Bank, motion: VerticalMotion, known: bool) -> Bank:
        """Move on by a step; only the filters of the most probable children are updated."""
        move, of_mode, of_case = self._tables.at(motion.step_s, motion.pace_s, self.noise.variance)
        mode = self._successors.take(bank.mode, axis=0).ravel()
        parent = _PARENT[: len(mode)]
        rows = (bank.filters @ move).take(parent, axis=0)
        rows += of_mode.take(mode, axis=0)
        log_weight = bank.log_weight.take(parent) + self._log_transitions.take(bank.mode, axis=0).ravel()
        children = _Children(parent, mode, log_weight, rows)
        if known:
            log_weight = self._weighed(children, of_case[:, column.SPREAD, None], motion)
        chosen, weight = most_probable(log_weight.ravel())
        case, child = chosen // len(mode), chosen % len(mode)
        rows, mode = rows.take(child, axis=0), mode.take(child)
        if known:
            rows += of_case.take(case, axis=0)
            self._update(rows, motion)
        return merged_bank(mode, weight, rows[:, column.FILTER], _ON_STAIRS, bank.past, parent.take(child))

    def _weighed(self, children: _Children, disturbance: Array, motion: VerticalMotion) -> Array:
        """Weigh the children by the velocity, in each case of a disturbance, and by the height where it is known.

        Parameters
        ----------
        children : _Children
            The m children.
        disturbance : ndarray, shape (CASES, 1)
            What the cases add to the variance of the velocity.
        motion : VerticalMotion
            Vertical motion of the step.

        Returns
        -------
        ndarray, shape (CASES, m)
            Log weights, up to a constant.
        """
        rows = children.rows
        innovation = motion.velocity_mps - rows[:, column.EXPECTED]
        spread = rows[:, column.SPREAD] + disturbance
        squared = innovation * innovation / spread
        log_weight: Array = children.log_weight + self._log_share - 0.5 * (squared + np.log(spread))
        if self._steps > 2 * UNSETTLED_STEPS:
            self.noise.learn_of_hypotheses(squared[0], log_weight[0])
        if math.isfinite(motion.height_m):
            shared = rows[:, column.SHARED.start + column.HEIGHT]
            innovation = motion.height_m - rows[:, column.HEIGHT] - shared * innovation / spread
            variance = rows[:, column.variance(column.HEIGHT)] + self._parameters.sigma_height_m**2
            spread = variance - shared * shared / spread
            log_weight -= 0.5 * (innovation * innovation / spread + np.log(spread))
        return log_weight

    def _update(self, rows: Array, motion: VerticalMotion) -> None:
        """Update filters by the velocity, and by the height where it is known."""
        innovation = motion.velocity_mps - rows[:, column.EXPECTED]
        measure(rows, innovation, rows[:, column.SHARED], rows[:, column.SPREAD])
        if math.isfinite(motion.height_m):
            shared = rows[:, column.covariances(column.HEIGHT)].copy()
            spread = shared[:, column.HEIGHT] + self._parameters.sigma_height_m**2
            measure(rows, motion.height_m - rows[:, column.HEIGHT], shared, spread)


def _transitions(parameters: StairParams) -> Array:
    """Return the probability of each mode, column, after each mode, row."""
    begin = 1.0 / parameters.steps_between_flights
    advance = min(_PHASES / parameters.steps_of_flight, 1.0)
    matrix = np.zeros((len(_DIRECTION), len(_DIRECTION)))
    matrix[_LEVEL, _LEVEL] = 1.0 - begin
    for first in (1, 1 + _PHASES):
        matrix[_LEVEL, first] = begin / 2.0
        for phase in range(_PHASES):
            mode = first + phase
            matrix[mode, mode] = 1.0 - advance
            matrix[mode, mode + 1 if phase + 1 < _PHASES else _LEVEL] = advance
    return matrix


def _successors(transitions: Array) -> tuple[Places, Array]:
    """Return the modes (modes, _SUCCESSORS) that may follow each mode, and the logarithms of their probabilities.

    A mode that fewer can follow has impossible ones in their place.
    """
    follows = np.zeros((len(transitions), _SUCCESSORS), dtype=np.intp)
    logarithm = np.full(follows.shape, -np.inf)
    for mode, row in enumerate(transitions):
        possible = np.flatnonzero(row > _NEGLIGIBLE)
        follows[mode, : len(possible)] = possible
        logarithm[mode, : len(possible)] = np.log(row[possible])
    return follows, logarithm
