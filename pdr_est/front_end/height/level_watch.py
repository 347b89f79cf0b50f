"""Modes of all seconds: hypotheses are compared only around changes of height, for most of a walk is level."""

from collections import deque

import numpy as np

from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.move_hypotheses import MoveHypotheses, PathOfModes
from pdr_est.front_end.height.seconds import Second
from pdr_est.front_end.height.vertical_filter import STEADY

_LOOK_BACK_S = 20  # a move that has changed the height noticeably began less than this before
_NOTICEABLE_SIGMAS = 4.0
_NOTICEABLE_M = 0.6
_SETTLED_S = 30  # level for so long, the hypotheses have nothing left to decide
_SETTLED_PROBABILITY = 0.999


class LevelWatch:
    """Modes of one second after the other.

    On the level a scalar Kalman filter follows the pressure. When the height is noticeably another than within the
    last twenty seconds, the hypotheses begin there, and go on until the walker is level again.

    Parameters
    ----------
    parameters
        Rates of moves and noise.
    sigma_m
        Standard deviation of the noise of the height in a second, m.
    """

    def __init__(self, parameters: HeightParams, sigma_m: float) -> None:
        self._parameters = parameters
        self._sigma_m = sigma_m
        self._recent: deque[tuple[Second, float, float]] = deque(maxlen=_LOOK_BACK_S)  # with the level after it
        self._level_m, self._variance_m2 = float("nan"), 1.0
        self._hypotheses: MoveHypotheses | None = None
        self._mode: list[int] = []
        self._case: list[int] = []

    def add(self, second: Second) -> None:
        """Take in the next second."""
        if self._hypotheses is not None:
            self._hypotheses.add(second)
            self._end_when_settled(self._hypotheses)
            return
        if self._is_noticeable(second.height_m):
            self._hypotheses = self._hypotheses_from_the_oldest()
            self._hypotheses.add(second)
            return
        self._follow(second.height_m)
        self._recent.append((second, self._level_m, self._variance_m2))
        self._mode.append(modes.LEVEL)
        self._case.append(STEADY)

    @property
    def path(self) -> PathOfModes:
        """Return the most probable modes of all seconds so far, and the cases of the pressure."""
        if self._hypotheses is None:
            return PathOfModes(np.array(self._mode, dtype=np.int64), np.array(self._case, dtype=np.int64))
        rest = self._hypotheses.best_path
        return PathOfModes(
            np.array([*self._mode, *rest.mode], dtype=np.int64), np.array([*self._case, *rest.case], dtype=np.int64)
        )

    def _follow(self, height_m: float) -> None:
        """Update the level, which wanders, by the height in a second."""
        if not np.isfinite(height_m):
            self._variance_m2 += self._parameters.drift_m_per_sqrt_s**2
        elif not np.isfinite(self._level_m):
            self._level_m, self._variance_m2 = height_m, self._sigma_m**2
        else:
            variance = self._variance_m2 + self._parameters.drift_m_per_sqrt_s**2
            gain = variance / (variance + self._sigma_m**2)
            self._level_m += gain * (height_m - self._level_m)
            self._variance_m2 = (1.0 - gain) * variance

    def _is_noticeable(self, height_m: float) -> bool:
        """Check whether a height is another than the levels of the last seconds."""
        if not self._recent or not np.isfinite(height_m) or not np.isfinite(self._level_m):
            return False
        limit_m = max(_NOTICEABLE_M, _NOTICEABLE_SIGMAS * self._sigma_m)
        return abs(height_m - self._recent[0][1]) > limit_m or abs(height_m - self._level_m) > limit_m

    def _hypotheses_from_the_oldest(self) -> MoveHypotheses:
        """Begin hypotheses at the oldest of the recent seconds, and give them those after it."""
        _, level_m, variance_m2 = self._recent[0]
        later = [second for second, _, _ in self._recent][1:]
        hypotheses = MoveHypotheses(self._parameters, self._sigma_m, level_m, variance_m2)
        del self._mode[len(self._mode) - len(later) :], self._case[len(self._case) - len(later) :]
        for second in later:
            hypotheses.add(second)
        self._recent.clear()
        return hypotheses

    def _end_when_settled(self, hypotheses: MoveHypotheses) -> None:
        """End the hypotheses when the walker has been level for long enough."""
        path = hypotheses.best_path
        latest = path.mode[-_SETTLED_S:]
        if len(latest) < _SETTLED_S or modes.is_moving(latest).any():
            return
        if hypotheses.level_probability < _SETTLED_PROBABILITY:
            return
        self._mode += path.mode.tolist()
        self._case += path.case.tolist()
        self._level_m, self._variance_m2 = hypotheses.level_error
        self._hypotheses = None
