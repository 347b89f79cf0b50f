"""Modes of all seconds: hypotheses are compared only around changes of height, for most of a walk is level."""

from collections import deque

from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.move_hypotheses import MoveHypotheses
from pdr_est.front_end.height.path_of_modes import PathOfModes
from pdr_est.front_end.height.seconds import Second
from pdr_est.front_end.height.vertical_filter import STEADY

LOOK_BACK_S = 20
"""A move that has changed the height noticeably began less than this before, s."""

_NOTICEABLE_SIGMAS = 4.0
_NOTICEABLE_M = 0.6
_SETTLED_S = 30  # level for so long, the hypotheses have nothing left to decide
_SETTLED_PROBABILITY = 0.99  # a move may begin in any second, for which 0.004 is the prior probability
_LONG_S, _LONGEST_S = 900, 1800  # hypotheses end at the next level second, and at once: memory stays bounded


class LevelWatch:
    """Modes of one second after the other.

    On the level a scalar Kalman filter follows the pressure. When the height is noticeably another than within the
    last twenty seconds, the hypotheses begin there, and go on until the walker is level again.

    Parameters
    ----------
    parameters
        Rates of moves and noise.
    """

    def __init__(self, parameters: HeightParams) -> None:
        self._parameters = parameters
        self._recent: deque[tuple[Second, float, float]] = deque(maxlen=LOOK_BACK_S)  # with the level after it
        self._level_m, self._variance_m2 = float("nan"), 1.0  # of the pressure
        self._height = 0.0, 0.0  # of the walker at the last decided second, m, and its variance, m²
        self._hypotheses: MoveHypotheses | None = None
        self._decided: list[tuple[int, int, float, float]] = []  # rows of a PathOfModes
        self._decided_last = 0  # rows that the last second decided

    def add(self, second: Second, sigma_m: float) -> None:
        """Take in the next second, whose height has a standard deviation of the noise, m."""
        self._decided_last = 0
        if self._hypotheses is not None:
            self._hypotheses.add(second, sigma_m)
            self._end_when_settled(self._hypotheses)
            return
        if self._is_noticeable(second.height_m, sigma_m):
            self._hypotheses = self._hypotheses_from_the_oldest(sigma_m)
            self._hypotheses.add(second, sigma_m)
            return
        self._follow(second.height_m, sigma_m)
        self._recent.append((second, self._level_m, self._variance_m2))
        self._decided.append((modes.LEVEL, STEADY, *self._height))
        self._decided_last = 1

    def add_steps(self, seconds_ago: int, stepped: bool) -> None:
        """Take in whether there was a step in one of the last seconds, which was added without knowing."""
        if self._hypotheses is not None:
            if seconds_ago < len(self._hypotheses):
                self._hypotheses.weigh_steps(seconds_ago, stepped)
        elif seconds_ago < len(self._recent):
            second, level_m, variance_m2 = self._recent[-1 - seconds_ago]
            self._recent[-1 - seconds_ago] = Second(second.height_m, int(stepped)), level_m, variance_m2

    @property
    def path(self) -> PathOfModes:
        """Return the most probable modes of all seconds so far."""
        return PathOfModes.of_rows([*self._decided, *self._open_rows])

    @property
    def is_open(self) -> bool:
        """Tell whether later seconds may change what the latest path says about its seconds."""
        return self._hypotheses is not None

    @property
    def latest(self) -> PathOfModes:
        """Return the path of the last second and of those about which it may have changed the mind.

        Where there is one, the level second before them comes first.
        """
        decided = self._decided[max(len(self._decided) - self._decided_last - 1, 0) :]
        return PathOfModes.of_rows([*decided, *self._open_rows])

    def agreement(self, within_m: float) -> float:
        """Return the probability that the walker is now within an interval about the height that is told."""
        return 1.0 if self._hypotheses is None else self._hypotheses.agreement(within_m)

    def forget(self) -> None:
        """Forget what is decided and will not be looked at again."""
        del self._decided[: max(len(self._decided) - LOOK_BACK_S, 0)]

    @property
    def _open_rows(self) -> list[tuple[int, int, float, float]]:
        return [] if self._hypotheses is None else self._rows_of(self._hypotheses)

    def _rows_of(self, hypotheses: MoveHypotheses) -> list[tuple[int, int, float, float]]:
        """Return the rows of the most probable hypothesis, whose heights are above the level before it."""
        path, (height_m, variance_m2) = hypotheses.best_path, self._height
        heights = (path.height_m + height_m).tolist(), (path.variance_m2 + variance_m2).tolist()
        return list(zip(path.mode.tolist(), path.case.tolist(), *heights, strict=True))

    def _follow(self, height_m: float, sigma_m: float) -> None:
        """Update the level, which wanders, by the height in a second."""
        if height_m != height_m:
            self._variance_m2 += self._parameters.drift_m_per_sqrt_s**2
        elif self._level_m != self._level_m:
            self._level_m, self._variance_m2 = height_m, sigma_m**2
        else:
            variance = self._variance_m2 + self._parameters.drift_m_per_sqrt_s**2
            gain = variance / (variance + sigma_m**2)
            self._level_m += gain * (height_m - self._level_m)
            self._variance_m2 = (1.0 - gain) * variance

    def _is_noticeable(self, height_m: float, sigma_m: float) -> bool:
        """Check whether a height is another than the levels of the last seconds."""
        if not self._recent:
            return False
        limit_m = max(_NOTICEABLE_M, _NOTICEABLE_SIGMAS * sigma_m)  # NaN is not beyond it
        return abs(height_m - self._recent[0][1]) > limit_m or abs(height_m - self._level_m) > limit_m

    def _hypotheses_from_the_oldest(self, sigma_m: float) -> MoveHypotheses:
        """Begin hypotheses at the oldest of the recent seconds, and give them those after it."""
        _, level_m, variance_m2 = self._recent[0]
        later = [second for second, _, _ in self._recent][1:]
        hypotheses = MoveHypotheses(self._parameters, level_m, variance_m2)
        del self._decided[len(self._decided) - len(later) :]
        for second in later:
            hypotheses.add(second, sigma_m)
        self._recent.clear()
        return hypotheses

    def _end_when_settled(self, hypotheses: MoveHypotheses) -> None:
        """End the hypotheses when the walker has been level for long enough."""
        still_s = hypotheses.still_s(_SETTLED_S)
        settled = still_s == _SETTLED_S and hypotheses.level_probability >= _SETTLED_PROBABILITY
        too_long = len(hypotheses) >= _LONGEST_S or (len(hypotheses) >= _LONG_S and still_s > 0)
        if not settled and not too_long:
            return
        rows = self._rows_of(hypotheses)
        self._decided += rows
        self._decided_last = len(rows)
        self._height = rows[-1][2:]
        self._level_m, self._variance_m2 = hypotheses.level_error
        self._hypotheses = None
