"""Level or moving, second by second: a bank of Kalman filters over the height by the air pressure.

A hypothesis says for each second so far whether the walker was level or moved on stairs, an escalator or a lift, down
or up, and whether the pressure was disturbed. Its Kalman filter has three states: the height of the walker, the error
of the height by the pressure, which wanders with weather and wind, and the vertical speed. The height changes in
moves alone: no drift of the pressure, however long, becomes a change of floor, and a move has to be as fast and as
high as moves are.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.normal_distribution import normal_cdf
from pdr_est.front_end.height.path_of_modes import PathOfModes
from pdr_est.front_end.height.seconds import Second
from pdr_est.front_end.height.vertical_filter import Numbers, jump_variances_m2, passage

_MOST_HYPOTHESES = 24
_CONSIDERED = 6 * _MOST_HYPOTHESES
_NEGLIGIBLE_LOG = -25.0  # log of the weight over that of the best one
_SAME_M, _SAME_MPS = 0.4, 0.25  # hypotheses of a mode are merged whose height and speed lie in the same interval
_SHARE_OF_SMALL = 1e-4  # of moves that are no more than a few steps
_H, _E, _S, _HH, _HE, _HS, _EE, _ES, _SS, _BEGIN = range(10)  # rows of filters: means, covariances, begin of the move
_CELLS = 4096  # more than there are intervals of heights or speeds


class _Changes(NamedTuple):
    """All pairs of modes (k,) that can follow one another, in order of the earlier one, and what they do."""

    first: Numbers  # (modes,) place of the first pair of each earlier mode
    pairs: Numbers  # (modes,) number of its pairs
    mode: Numbers
    begins: NDArray[np.bool_]
    ends: NDArray[np.bool_]
    numbers: Array  # (8, k) log probability; with a step, without; passage; additional variance of the height


class MoveHypotheses:
    """Bank of hypotheses about the seconds since it began.

    Parameters
    ----------
    parameters
        Rates of moves and noise.
    error_m, variance_m2
        Error of the height by the pressure before the first second, and its variance.
    """

    def __init__(self, parameters: HeightParams, error_m: float, variance_m2: float) -> None:
        self._parameters = parameters
        self._filters = np.zeros((10, 1))
        self._filters[_E], self._filters[_EE] = error_m, variance_m2
        self._mode = np.zeros(1, dtype=np.int64)
        self._log_weight = np.zeros(1)
        self._seconds: list[_SecondOfBank] = []

    def __len__(self) -> int:
        return len(self._seconds)

    @property
    def level_probability(self) -> float:
        """Return the probability that the last second was level."""
        weight = np.exp(self._log_weight)
        return float(weight[~modes.is_moving(self._mode)].sum() / weight.sum())

    @property
    def best_path(self) -> PathOfModes:
        """Return what the most probable hypothesis says, and the heights of its filter above the begin."""
        place, rows = 0, []
        for second in reversed(self._seconds):
            rows.append((second.mode[place], second.case[place], second.height_m[place], second.variance_m2[place]))
            place = second.parent[place]
        return PathOfModes.of_rows(rows[::-1])

    @property
    def level_error(self) -> tuple[float, float]:
        """Return height plus error of the most probable hypothesis, m, and its variance, m²."""
        best = self._filters[:, 0]
        return float(best[_H] + best[_E]), float(best[_HH] + 2.0 * best[_HE] + best[_EE])

    def still_s(self, most: int) -> int:
        """Return for how many of the latest seconds, up to a number, the most probable hypothesis is level."""
        place = 0
        for count, second in enumerate(reversed(self._seconds[-most:])):
            if second.mode[place] >= modes.STILL:
                return count
            place = second.parent[place]
        return min(most, len(self._seconds))

    def agreement(self, within_m: float) -> float:
        """Return the probability of the hypotheses whose height is that of the best one within an interval."""
        weight = np.exp(self._log_weight)
        near = np.abs(self._filters[_H] - self._filters[_H, 0]) < within_m
        return float(weight[near].sum() / weight.sum())

    def add(self, second: Second, sigma_m: float) -> None:
        """Take in the next second, whose height has a standard deviation of the noise, m."""
        p, changes = self._parameters, _changes(self._parameters)
        count = changes.pairs[self._mode]
        parent = np.arange(len(count)).repeat(count)
        ahead = changes.first[self._mode] - np.cumsum(count) + count
        change = ahead.repeat(count) + np.arange(len(parent))
        numbers = changes.numbers[:, change]
        moved = self._moved(parent, numbers, changes.begins[change])
        log_weight = self._log_weight[parent] + numbers[0]
        ends = np.flatnonzero(changes.ends[change])
        if len(ends):
            ended = self._filters[:, parent[ends]]
            rise_m = np.abs(ended[_H] - ended[_BEGIN])
            is_high = normal_cdf((rise_m - p.least_rise_m) / p.sigma_least_rise_m)
            log_weight[ends] += np.log(_SHARE_OF_SMALL + (1.0 - _SHARE_OF_SMALL) * is_high)
        if second.steps is not None:
            log_weight += numbers[1 if second.steps else 2]
        if second.height_m != second.height_m:
            self._keep(moved, changes.mode[change], log_weight, parent, np.zeros(len(parent), dtype=np.int64))
            return
        self._measure(second.height_m, sigma_m**2, moved, numbers[7], changes.mode[change], log_weight, parent)

    def weigh_steps(self, seconds_ago: int, stepped: bool) -> None:
        """Take in whether there was a step in a second that was added without knowing."""
        table = modes.LOG_STEPPING if stepped else modes.LOG_RESTING
        places = list(range(len(self._mode)))
        for second in reversed(self._seconds[len(self._seconds) - seconds_ago :]):
            places = [second.parent[place] for place in places]
        then = self._seconds[-1 - seconds_ago].mode
        self._log_weight += table[[then[place] for place in places]]
        best = int(self._log_weight.argmax())
        if best:
            order = np.arange(len(self._mode))
            order[[0, best]] = best, 0
            self._filters, self._mode = self._filters.take(order, axis=1), self._mode[order]
            self._log_weight = self._log_weight[order]
            self._seconds[-1] = self._seconds[-1].in_order(order.tolist())
        self._log_weight -= self._log_weight[0]

    def _moved(self, parent: Numbers, numbers: Array, begins: NDArray[np.bool_]) -> Array:
        """Move the filters on by a second, once for each mode that may follow."""
        by_speed, kept, speed, variance = numbers[3:7]
        old = self._filters.take(parent, axis=1)
        new = np.empty_like(old)
        new[_H] = old[_H] + by_speed * old[_S] + 0.5 * speed
        new[_E] = old[_E]
        new[_S] = kept * old[_S] + speed
        half = old[_HS] + by_speed * old[_SS]
        new[_HH] = old[_HH] + by_speed * (old[_HS] + half) + 0.25 * variance
        new[_HE] = old[_HE] + by_speed * old[_ES]
        new[_HS] = kept * half + 0.5 * variance
        new[_EE] = old[_EE] + self._parameters.drift_m_per_sqrt_s**2
        new[_ES] = kept * old[_ES]
        new[_SS] = kept * kept * old[_SS] + variance
        new[_BEGIN] = np.where(begins, old[_H], old[_BEGIN])
        return new

    def _measure(
        self,
        height_m: float,
        noise_m2: float,
        moved: Array,
        disturbed_m2: Array,
        mode: Numbers,
        log_weight: Array,
        parent: Numbers,
    ) -> None:
        """Update the filters by the height in a second, in each case of the pressure, and keep the best ones."""
        jump_m2, log_case = _cases(self._parameters)
        innovation = height_m - moved[_H] - moved[_E]
        base = moved[_HH] + 2.0 * moved[_HE] + moved[_EE] + disturbed_m2 + noise_m2
        spread = base + jump_m2[:, None]
        weight = log_weight + log_case[:, None] - 0.5 * (innovation * innovation / spread + np.log(spread))
        order = _best(weight.ravel())
        case, one = np.divmod(order, len(parent))
        found = moved.take(one, axis=1)
        found[_EE] += jump_m2[case]
        spread, off = spread.ravel()[order], innovation[one]
        by_height, by_error = found[_HH] + found[_HE], found[_HE] + found[_EE]
        by_speed = found[_HS] + found[_ES]
        gain_h, gain_e, gain_s = by_height / spread, by_error / spread, by_speed / spread
        found[_H] += gain_h * off
        found[_E] += gain_e * off
        found[_S] += gain_s * off
        found[_HH] -= gain_h * by_height
        found[_HE] -= gain_h * by_error
        found[_HS] -= gain_h * by_speed
        found[_EE] -= gain_e * by_error
        found[_ES] -= gain_e * by_speed
        found[_SS] -= gain_s * by_speed
        self._keep(found, mode[one], weight.ravel()[order], parent[one], case)

    def _keep(self, filters: Array, mode: Numbers, log_weight: Array, parent: Numbers, case: Numbers) -> None:
        """Keep the most probable hypotheses, the best one first, each mode, height and speed once."""
        order = _best(log_weight)
        cell = (mode[order] * _CELLS + np.rint(filters[_H, order] / _SAME_M)) * _CELLS
        cell += np.rint(filters[_S, order] / _SAME_MPS)
        _, first = np.unique(cell, return_index=True)
        first.sort()
        chosen = order[first[:_MOST_HYPOTHESES]]
        self._filters, self._mode = filters.take(chosen, axis=1), mode[chosen]
        self._log_weight = log_weight[chosen] - log_weight[chosen[0]]
        self._seconds.append(
            _SecondOfBank(
                parent[chosen].tolist(),
                self._mode.tolist(),
                case[chosen].tolist(),
                self._filters[_H].tolist(),
                self._filters[_HH].tolist(),
            )
        )


class _SecondOfBank(NamedTuple):
    """Hypotheses after a second: place of the parent, mode, case, height (m) and its variance (m²)."""

    parent: list[int]
    mode: list[int]
    case: list[int]
    height_m: list[float]
    variance_m2: list[float]

    def in_order(self, order: list[int]) -> "_SecondOfBank":
        """Return the same hypotheses in another order."""
        return _SecondOfBank(
            parent=[self.parent[place] for place in order],
            mode=[self.mode[place] for place in order],
            case=[self.case[place] for place in order],
            height_m=[self.height_m[place] for place in order],
            variance_m2=[self.variance_m2[place] for place in order],
        )


def _best(log_weight: Array) -> Numbers:
    """Return the places of the most probable ones, the best one first."""
    order = np.argsort(-log_weight, kind="stable")[:_CONSIDERED]
    return np.asarray(order[log_weight[order] > log_weight[order[0]] + _NEGLIGIBLE_LOG])


@lru_cache(maxsize=8)
def _changes(parameters: HeightParams) -> _Changes:
    """Tabulate the pairs of modes that can follow one another."""
    matrix = modes.transitions(parameters)
    before, mode = np.nonzero(matrix > 0.0)
    numbers = np.array(
        [
            np.log(matrix[before, mode]),
            modes.LOG_STEPPING[mode],
            modes.LOG_RESTING[mode],
            *np.array([passage(one, other) for one, other in zip(before.tolist(), mode.tolist(), strict=True)]).T,
            parameters.sigma_disturbed_m**2 * (mode == modes.DISTURBED),
        ]
    )
    count = np.bincount(before, minlength=modes.MODES)
    changed = before != mode
    return _Changes(
        first=np.cumsum(count) - count,
        pairs=count,
        mode=mode,
        begins=modes.is_moving(mode) & changed,
        ends=modes.is_moving(before) & changed,
        numbers=numbers,
    )


@lru_cache(maxsize=8)
def _cases(parameters: HeightParams) -> tuple[Array, Array]:
    """Return the variance of the jump in each case of the pressure, m², and the log of its share."""
    shares = (1.0 - parameters.jumps - parameters.great_jumps, parameters.jumps, parameters.great_jumps)
    return jump_variances_m2(parameters), np.log(np.maximum(shares, 1e-12))
