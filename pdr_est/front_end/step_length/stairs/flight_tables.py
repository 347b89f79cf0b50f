"""Tables by which all flight hypotheses move on by a step at once.

Each filter is a row: mean (4) and covariance (4 x 4, row by row) of its states, and six numbers that follow
from them, in which a measurement of the velocity is expressed: the velocity's error that is expected, its variance,
and its covariance with each state. What a step does to such a row is linear in it: a matrix, and sums that depend on
whether the step is level or on stairs and on what disturbs it. Matrix and sums are polynomials of the duration of the
step, which are put together beforehand.
"""

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.step_length.stairs.stair_params import StairParams

VELOCITY, ACCELERATION, LIMP, HEIGHT = range(4)  # states: errors of velocity and acceleration, limp, height
STATES = 4
MEAN, COVARIANCE = slice(0, 4), slice(4, 20)
EXPECTED, SPREAD, SHARED = 20, 21, slice(22, 26)  # of the measured velocity: mean, variance, covariance with states
FILTER, WIDTH = slice(0, 20), 26
CASES = 3  # a usual step, a disturbed one, and a lasting change

_OBSERVED = np.array([1.0, 0.0, 1.0, 0.0])  # states whose sum is the velocity's error
_LIMP_DRIFT_MPS = 0.001  # per step
_ONE, _DURATION, _DURATION_SQUARED, _PACE, _PACE_SQUARED, _SCALE = range(6)  # terms of the polynomials
_TERMS = 6


def covariances(state: int) -> slice:
    """Return the columns of the covariance of a state with each state."""
    begin = COVARIANCE.start + STATES * state
    return slice(begin, begin + STATES)


def variance(state: int) -> int:
    """Return the column of the variance of a state."""
    return covariances(state).start + state  # type: ignore[no-any-return]


class FlightTables:
    """Tables of a step of any duration.

    Parameters
    ----------
    parameters : StairParams
        Dimensions of stairs, and noise.
    direction : ndarray, shape (modes,)
        1 for a mode that goes up, -1 for one that goes down, 0 for one that is level.
    """

    def __init__(self, parameters: StairParams, direction: Array) -> None:
        self._modes = len(direction)
        tables = [_moves(), _sums_of_modes(parameters, direction), _sums_of_cases(parameters)]
        self._tables = np.concatenate(tables, axis=1).reshape(_TERMS, -1)

    def at(self, step_s: float, pace_s: float, scale: float) -> tuple[Array, Array, Array]:
        """Compute the tables of one step.

        Parameters
        ----------
        step_s, pace_s : float
            Duration of the step, and mean duration of it and the one before.
        scale : float
            Variance of this walk's velocities over that of the parameters.

        Returns
        -------
        move : (20, WIDTH)
            Matrix that turns mean and covariance before the step into the row after it.
        of_mode : (modes, WIDTH)
            What a step of each mode adds.
        of_case : (CASES, WIDTH)
            What the noise of the states, and a disturbance, add where the velocity is measured.
        """
        terms = np.array([1.0, step_s, step_s * step_s, 1.0 / pace_s, 1.0 / (pace_s * pace_s), scale])
        rows = (terms @ self._tables).reshape(-1, WIDTH)
        first = FILTER.stop
        return rows[:first], rows[first : first + self._modes], rows[first + self._modes :]


def _moves() -> Array:
    """Return the terms of the matrix of a step (_TERMS, 20, WIDTH)."""
    still, forwards, backwards = (_move(step_s) for step_s in (0.0, 1.0, -1.0))
    moves = np.zeros((_TERMS, FILTER.stop, WIDTH))
    moves[_ONE] = still
    moves[_DURATION] = 0.5 * (forwards - backwards)
    moves[_DURATION_SQUARED] = 0.5 * (forwards + backwards) - still
    return moves


def _move(step_s: float) -> Array:
    """Return the matrix of a step (20, WIDTH): left and right alternate, the acceleration changes the velocity."""
    move = np.diag([1.0, 1.0, -1.0, 1.0])
    move[VELOCITY, ACCELERATION] = step_s
    matrix = np.zeros((FILTER.stop, WIDTH))
    matrix[MEAN, MEAN] = move.T
    matrix[COVARIANCE, COVARIANCE] = np.kron(move, move).T
    matrix[:, EXPECTED] = matrix[:, MEAN] @ _OBSERVED
    covariance = matrix[:, COVARIANCE].reshape(-1, STATES, STATES)
    matrix[:, SHARED] = covariance @ _OBSERVED
    matrix[:, SPREAD] = matrix[:, SHARED] @ _OBSERVED
    return matrix


def _sums_of_modes(parameters: StairParams, direction: Array) -> Array:
    """Return the terms of what a step of each mode adds (_TERMS, modes, WIDTH)."""
    p, on_stairs = parameters, np.abs(direction)
    sums = np.zeros((_TERMS, len(direction), WIDTH))
    sums[_ONE, :, HEIGHT] = direction * p.rise_m
    sums[_ONE, :, variance(HEIGHT)] = on_stairs * p.sigma_rise_m**2
    sums[_DURATION, :, variance(HEIGHT)] = p.sigma_height_drift_m_per_sqrt_s**2
    sums[_PACE, :, EXPECTED] = direction * p.rise_m
    sums[_PACE_SQUARED, :, SPREAD] = on_stairs * p.sigma_rise_m**2
    sums[_SCALE, :, SPREAD] = p.sigma_velocity_mps**2
    return sums


def _sums_of_cases(parameters: StairParams) -> Array:
    """Return the terms of what a usual step, a disturbed one, and a lasting change add (_TERMS, CASES, WIDTH)."""
    p = parameters
    drift, bias_drift = p.sigma_drift_mps**2, p.sigma_bias_drift_mps2**2
    sums = np.zeros((_TERMS, CASES, WIDTH))
    _add_noise(sums[_SCALE], VELOCITY, [drift, drift, 0.0])
    _add_noise(sums[_ONE], VELOCITY, [0.0, 0.0, p.sigma_jump_mps**2])
    _add_noise(sums[_SCALE], ACCELERATION, [bias_drift, bias_drift, 0.0])
    _add_noise(sums[_ONE], ACCELERATION, [0.0, 0.0, p.sigma_bias_jump_mps2**2])
    _add_noise(sums[_SCALE], LIMP, [_LIMP_DRIFT_MPS**2] * CASES)
    sums[_ONE, 1, SPREAD] += p.sigma_disturbed_mps**2
    return sums


def _add_noise(sums: Array, state: int, variances: list[float]) -> None:
    """Add noise of a state with these variances in each case to rows (CASES, WIDTH)."""
    sums[:, variance(state)] += variances
    sums[:, SHARED.start + state] += _OBSERVED[state] * np.array(variances)
    sums[:, SPREAD] += _OBSERVED[state] * np.array(variances)
