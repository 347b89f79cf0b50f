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

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.step_length.stairs.stair_params import StairParams
from pdr_est.front_end.step_length.stairs.vertical_motion import VerticalMotion

_PHASES = 3  # of a flight
_LEVEL = 0  # the mode of level walking; those of the phases of flights down and up follow
_DIRECTION = np.array([0.0] + [-1.0] * _PHASES + [1.0] * _PHASES)  # of each mode
_MOST = 12  # hypotheses that are kept
_SAME_MPS = 0.08  # hypotheses are merged whose velocity errors lie in the same interval of this width
_LAG_STEPS = 60  # no flight is longer, nor tells more about steps before it
UNSETTLED_STEPS = 3  # at the start of a walk, whose velocity tells nothing
_SIGMA_START_MPS = 1.0
_SIGMA_START_HEIGHT_M = 100.0
_SHARE_AT_START = 0.02  # of walks that begin on stairs; set and not fitted
_BIAS_AFTER_GAP = 0.3  # standard deviation of the change of the acceleration's error over a gap, over its own
_LIMP_DRIFT_MPS = 0.001  # per step
_OBSERVED = np.array([1.0, 0.0, 1.0, 0.0])  # states whose sum is the velocity's error
_HEIGHT = 3  # state
_OF_HEIGHT = np.array([0.0, 0.0, 0.0, 1.0])
_DIAGONAL = np.arange(4)
_NEGLIGIBLE = 1e-9


@dataclass(frozen=True)
class _Bank:
    """Hypotheses: mode (n,), mean (n, 4), covariance (n, 4, 4), log weight (n,) and past (n, k).

    The past is the probability of each of the last k steps to have been on stairs, under the hypothesis.
    """

    mode: NDArray[np.intp]
    mean: Array
    covariance: Array
    log_weight: Array
    past: Array

    def take(self, chosen: NDArray[np.intp]) -> "_Bank":
        return _Bank(
            self.mode[chosen],
            self.mean[chosen],
            self.covariance[chosen],
            self.log_weight[chosen],
            self.past[chosen],
        )


class FlightHypotheses:
    """Probability of each step to lie on stairs; it is known when the walk ends or many steps later.

    Parameters
    ----------
    parameters : StairParams
        Dimensions of stairs, and noise.
    """

    def __init__(self, parameters: StairParams) -> None:
        self._parameters = parameters
        self._transitions = _transitions(parameters)
        self._bias = (0.0, parameters.sigma_bias_mps2)  # mean and standard deviation
        self._noise = _NoiseScale()
        shares = (1.0 - parameters.share_disturbed - parameters.share_of_jumps, parameters.share_disturbed)
        self._log_share = np.log(np.maximum([*shares, parameters.share_of_jumps], _NEGLIGIBLE))
        self._steps = self._known = 0
        self._bank: _Bank | None = None

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
        self._steps += 1
        known = self._steps > UNSETTLED_STEPS and bool(np.isfinite(motion.velocity_mps))
        self._known += known
        bank = self._predict(self._bank, motion)
        bank = _merged(self._updated(bank, motion) if known else bank)
        weight = np.exp(bank.log_weight)
        if bank.past.shape[1] > _LAG_STEPS:
            final.append(float(weight @ bank.past[:, 0]) if self._known else 0.0)
            bank = replace(bank, past=bank.past[:, 1:])
        self._bank = bank
        mean = float(weight @ bank.mean[:, 1])
        variance = float(weight @ (bank.covariance[:, 1, 1] + (bank.mean[:, 1] - mean) ** 2))
        self._bias = (mean, float(np.sqrt(variance)))
        return final

    def finish(self) -> list[float]:
        """Return the probabilities of the steps that are not final yet: nothing more can be learnt about them.

        They are 0 for steps of a walk whose vertical velocity is not known at all.
        """
        bank, self._bank = self._bank, None
        return [] if bank is None else [float(p) * bool(self._known) for p in np.exp(bank.log_weight) @ bank.past]

    def _start(self) -> _Bank:
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
        means = np.tile([0.0, mean, 0.0, 0.0], (len(mode), 1))
        return _Bank(mode, means, np.tile(np.diag(variances), (3, 1, 1)), np.log(weight), np.empty((3, 0)))

    def _predict(self, bank: _Bank, motion: VerticalMotion) -> _Bank:
        """Move on by a step: each hypothesis splits by what this step is."""
        p = self._parameters
        which, mode = np.nonzero(self._transitions[bank.mode] > _NEGLIGIBLE)
        move = np.diag([1.0, 1.0, -1.0, 1.0])  # left and right alternate
        move[0, 1] = motion.step_s
        mean = (bank.mean @ move.T)[which]
        covariance = (move @ bank.covariance @ move.T)[which]
        mean[:, _HEIGHT] += _DIRECTION[mode] * p.rise_m
        covariance[:, _HEIGHT, _HEIGHT] += np.abs(_DIRECTION[mode]) * p.sigma_rise_m**2
        covariance[:, _HEIGHT, _HEIGHT] += p.sigma_height_drift_m_per_sqrt_s**2 * motion.step_s
        on_stairs = np.abs(_DIRECTION[mode])[:, None]
        log_weight = bank.log_weight[which] + np.log(self._transitions[bank.mode[which], mode])
        return _Bank(mode, mean, covariance, log_weight, np.hstack([bank.past[which], on_stairs]))

    def _updated(self, bank: _Bank, motion: VerticalMotion) -> _Bank:
        """Take in the velocity, and the height where it is known; each hypothesis splits by its disturbance."""
        p, scale, count = self._parameters, self._noise.variance, len(bank.mode)
        added, disturbance_mps2 = self._cases(scale)
        every = np.tile(np.arange(count), len(added))
        case = np.repeat(np.arange(len(added)), count)
        split = bank.take(every)
        split.covariance[:, _DIAGONAL, _DIAGONAL] += added[case]
        direction = _DIRECTION[split.mode]
        expected_mps = direction * p.rise_m / motion.pace_s
        noise = scale * p.sigma_velocity_mps**2 + np.abs(direction) * (p.sigma_rise_m / motion.pace_s) ** 2
        innovation = motion.velocity_mps - expected_mps - split.mean @ _OBSERVED
        joined, squared = _measured(split, innovation, _OBSERVED, noise + disturbance_mps2[case])
        joined.log_weight[:] += self._log_share[case]
        if self._steps > 2 * UNSETTLED_STEPS:
            self._noise.learn(squared[:count], joined.log_weight[:count])
        if np.isfinite(motion.height_m):
            innovation = motion.height_m - joined.mean[:, _HEIGHT]
            joined, _ = _measured(joined, innovation, _OF_HEIGHT, np.full(len(innovation), p.sigma_height_m**2))
        return joined

    def _cases(self, scale: float) -> tuple[Array, Array]:
        """Return what a usual step, a disturbed one, and a lasting change add to the variances.

        Parameters
        ----------
        scale : float
            Variance of this walk's velocities over that of the parameters.

        Returns
        -------
        added : (3, 4)
            Of the states.
        disturbance : (3,)
            Of the measured velocity.
        """
        p = self._parameters
        drift, bias = p.sigma_drift_mps**2 * scale, p.sigma_bias_drift_mps2**2 * scale
        limp = _LIMP_DRIFT_MPS**2 * scale
        usual = (drift, bias, limp, 0.0)
        added = np.array([usual, usual, (p.sigma_jump_mps**2, p.sigma_bias_jump_mps2**2, limp, 0.0)])
        return added, np.array([0.0, p.sigma_disturbed_mps**2, 0.0])


class _NoiseScale:
    """Variance of this walk's velocities over that of the parameters, from the innovations of the last steps."""

    _PRIOR_STEPS, _KEPT, _MOST, _LEAST = 10.0, 0.97, 9.0, 0.25

    def __init__(self) -> None:
        self._squares = self._weight = 0.0

    @property
    def variance(self) -> float:
        return max((self._PRIOR_STEPS + self._squares) / (self._PRIOR_STEPS + self._weight), self._LEAST)

    def learn(self, squared: Array, log_weight: Array) -> None:
        """Take in the squared normalised innovations (n,) of hypotheses with these weights (n,)."""
        weight = np.exp(log_weight - log_weight.max())
        square = float(np.minimum(squared, self._MOST) @ weight / weight.sum()) * self.variance
        self._squares = self._KEPT * self._squares + square
        self._weight = self._KEPT * self._weight + 1.0


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


def _measured(bank: _Bank, innovation: Array, row: Array, variance: Array) -> tuple[_Bank, Array]:
    """Update all filters by a measurement of one sum of states; return the squared normalised innovations as well."""
    gain_part = bank.covariance @ row
    spread = gain_part @ row + variance
    gain = gain_part / spread[:, None]
    squared = innovation**2 / spread
    mean = bank.mean + gain * innovation[:, None]
    covariance = bank.covariance - gain[:, :, None] * gain_part[:, None, :]
    log_weight = bank.log_weight - 0.5 * (squared + np.log(2.0 * np.pi * spread))
    return _Bank(bank.mode, mean, covariance, log_weight, bank.past), squared


def _merged(bank: _Bank) -> _Bank:
    """Merge hypotheses that nearly agree, by their moments, and keep the most probable ones."""
    bank = bank.take(np.argsort(-bank.log_weight, kind="stable")[: 4 * _MOST])
    weight = np.exp(bank.log_weight - bank.log_weight[0])
    cell = np.round(bank.mean[:, 0] / _SAME_MPS).astype(np.int64)
    _, group = np.unique(cell * len(_DIRECTION) + bank.mode, return_inverse=True)
    total = np.bincount(group, weight)
    share = np.zeros((len(total), len(weight)))
    share[group, np.arange(len(weight))] = weight / total[group]
    mean = share @ bank.mean
    difference = bank.mean - mean[group]
    spread = bank.covariance + difference[:, :, None] * difference[:, None, :]
    covariance = np.einsum("gk,kij->gij", share, spread)
    mode = np.zeros(len(total), dtype=np.intp)
    mode[group] = bank.mode
    kept = np.argsort(-total, kind="stable")[:_MOST]
    log_weight = np.log(total / total[kept].sum())
    return _Bank(mode, mean, covariance, log_weight, share @ bank.past).take(kept)
