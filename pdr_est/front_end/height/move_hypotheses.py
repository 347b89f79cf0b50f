"""Level or moving, second by second: a bank of Kalman filters over the height by the air pressure.

A hypothesis says for each second so far whether the walker was level or moved on stairs, an escalator or a lift, down
or up, and whether the pressure was disturbed. Its Kalman filter has three states: the height of the walker, the error
of the height by the pressure, which wanders with weather and wind, and the vertical speed. The height changes in
moves alone: no drift of the pressure, however long, becomes a change of floor, and a move has to be as fast and as
high as moves are.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from pdr_est.frames import Array
from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.seconds import Second
from pdr_est.front_end.height.vertical_filter import (
    ERROR,
    HEIGHT,
    SPEED,
    Numbers,
    jump_variances_m2,
    measure_height,
    move_on,
)

_MOST_HYPOTHESES = 24
_CONSIDERED = 6 * _MOST_HYPOTHESES
_NEGLIGIBLE_LOG = -25.0  # log of the weight over that of the best one
_SAME_M, _SAME_MPS = 0.4, 0.25  # hypotheses of a mode are merged whose height and speed lie in the same interval
_SHARE_OF_SMALL = 1e-4  # of moves that are no more than a few steps


class PathOfModes(NamedTuple):
    """Mode (n,) and case of the pressure (n,) of each second, by the most probable hypothesis."""

    mode: Numbers
    case: Numbers


@dataclass(frozen=True)
class _Bank:
    """Hypotheses (n,): filters, height at the begin of the present move, mode, log weight, and pasts (n, seconds)."""

    mean: Array
    covariance: Array
    begin_m: Array
    mode: Numbers
    log_weight: Array
    modes: NDArray[np.int8]
    cases: NDArray[np.int8]


class MoveHypotheses:
    """Bank of hypotheses about the seconds since it began.

    Parameters
    ----------
    parameters
        Rates of moves and noise.
    sigma_m
        Standard deviation of the noise of the height in a second, m.
    error_m, variance_m2
        Error of the height by the pressure before the first second, and its variance.
    """

    def __init__(self, parameters: HeightParams, sigma_m: float, error_m: float, variance_m2: float) -> None:
        self._parameters = parameters
        self._variance_m2 = sigma_m**2
        matrix = modes.transitions(parameters)
        self._successors = [np.flatnonzero(row) for row in matrix]
        self._log_transitions = [np.log(row[row > 0.0]) for row in matrix]
        shares = (1.0 - parameters.jumps - parameters.great_jumps, parameters.jumps, parameters.great_jumps)
        self._log_case = np.log(np.maximum(shares, 1e-12))
        self._bank = _Bank(
            mean=np.array([[0.0, error_m, 0.0]]),
            covariance=np.diag([0.0, variance_m2, 0.0])[None],
            begin_m=np.zeros(1),
            mode=np.zeros(1, dtype=np.int64),
            log_weight=np.zeros(1),
            modes=np.zeros((1, 0), dtype=np.int8),
            cases=np.zeros((1, 0), dtype=np.int8),
        )

    @property
    def level_probability(self) -> float:
        """Return the probability that the last second was level."""
        weight = np.exp(self._bank.log_weight)
        return float(weight[~modes.is_moving(self._bank.mode)].sum() / weight.sum())

    @property
    def best_path(self) -> PathOfModes:
        """Return what the most probable hypothesis says."""
        return PathOfModes(self._bank.modes[0].astype(np.int64), self._bank.cases[0].astype(np.int64))

    @property
    def level_error(self) -> tuple[float, float]:
        """Return height plus error of the most probable hypothesis, m, and its variance, m²."""
        mean, covariance = self._bank.mean[0], self._bank.covariance[0]
        return float(mean[HEIGHT] + mean[ERROR]), float(covariance[:2, :2].sum())

    def add(self, second: Second) -> None:
        """Take in the next second."""
        children = self._children(second)
        chosen = _distinct(children)
        bank = self._bank
        parent, case = children.parent[chosen], children.case[chosen]
        log_weight = children.log_weight[chosen]
        self._bank = _Bank(
            mean=children.mean[chosen],
            covariance=children.covariance[chosen],
            begin_m=children.begin_m[chosen],
            mode=children.mode[chosen],
            log_weight=log_weight - log_weight[0],
            modes=np.column_stack([bank.modes[parent], children.mode[chosen].astype(np.int8)]),
            cases=np.column_stack([bank.cases[parent], case.astype(np.int8)]),
        )

    def _children(self, second: Second) -> "_Children":
        """Return every mode and every case of a disturbance that may follow, moved on and weighed."""
        bank, p = self._bank, self._parameters
        parent = np.repeat(np.arange(len(bank.mode)), [len(self._successors[mode]) for mode in bank.mode])
        mode = np.concatenate([self._successors[one] for one in bank.mode])
        log_weight = bank.log_weight[parent] + np.concatenate([self._log_transitions[one] for one in bank.mode])
        mean, covariance, begin_m = bank.mean[parent], bank.covariance[parent], bank.begin_m[parent].copy()
        before = bank.mode[parent]
        begins, ends = modes.is_moving(mode) & (before != mode), modes.is_moving(before) & (before != mode)
        begin_m[begins] = mean[begins, HEIGHT]
        rise_m = np.abs(mean[ends, HEIGHT] - begin_m[ends])
        is_high = ndtr((rise_m - p.least_rise_m) / p.sigma_least_rise_m)
        log_weight[ends] += np.log(_SHARE_OF_SMALL + (1.0 - _SHARE_OF_SMALL) * is_high)
        move_on(mean, covariance, before, mode, p.drift_m_per_sqrt_s)
        if second.steps is not None:
            log_weight += (modes.LOG_STEPPING if second.steps else modes.LOG_RESTING)[mode]
        cases = len(self._log_case) if np.isfinite(second.height_m) else 1
        case = np.tile(np.arange(cases), len(mode))
        each = np.repeat(np.arange(len(mode)), cases)
        mean, covariance = mean[each], covariance[each]
        log_weight = log_weight[each] + self._log_case[case]
        covariance[:, ERROR, ERROR] += jump_variances_m2(p)[case]
        if cases > 1:
            noise = self._variance_m2 + p.sigma_disturbed_m**2 * (mode[each] == modes.DISTURBED)
            log_weight += measure_height(mean, covariance, second.height_m, noise)
        return _Children(parent[each], mode[each], case, mean, covariance, begin_m[each], log_weight)


class _Children(NamedTuple):
    """Hypotheses after a second (m,): parent, mode, case of the disturbance, filters, begin of the move, weight."""

    parent: Numbers
    mode: Numbers
    case: Numbers
    mean: Array
    covariance: Array
    begin_m: Array
    log_weight: Array


def _distinct(children: _Children) -> Numbers:
    """Return the places of the most probable children, the best one first, each mode, height and speed once."""
    order = np.argsort(-children.log_weight, kind="stable")[:_CONSIDERED]
    order = order[children.log_weight[order] > children.log_weight[order[0]] + _NEGLIGIBLE_LOG]
    cells = zip(
        children.mode[order].tolist(),
        np.round(children.mean[order, HEIGHT] / _SAME_M).tolist(),
        np.round(children.mean[order, SPEED] / _SAME_MPS).tolist(),
        strict=True,
    )
    first: dict[tuple[int, float, float], int] = {}
    for place, cell in zip(order.tolist(), cells, strict=True):
        if cell not in first:
            first[cell] = place
            if len(first) == _MOST_HYPOTHESES:
                break
    return np.array(list(first.values()), dtype=np.int64)
