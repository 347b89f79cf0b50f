"""Measure the pace of a walk at a step: cadence and intensity over the last three steps."""

from collections import deque
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from pdr_est.types.steps import Step, walks_begun

_WINDOW_STEPS = 3
_LEAST_RANGE_MPS2 = 0.05  # keeps the logarithm of a step without movement finite
_LEAST_INTERVAL_S = 0.1


class Pace(NamedTuple):
    """Cadence and intensity of the last steps.

    Attributes
    ----------
    cadence_hz : float
        Reciprocal of the median interval of the last three steps.
    last_steps : tuple of Step
        These steps.
    """

    cadence_hz: float
    last_steps: tuple[Step, ...]

    @property
    def range_mps2(self) -> float:
        """Geometric mean over the last steps of the range of the vertical acceleration within one, unsmoothed."""
        ranges = [max(np.ptp(step.samples.vertical_mps2), _LEAST_RANGE_MPS2) for step in self.last_steps]
        return float(np.exp(np.mean(np.log(ranges))))


class PaceMeter:
    """Pace at each step in turn; the first step after a standstill or a gap begins afresh.

    The duration of that first step is assumed and not measured, so its cadence is given but not remembered.
    """

    def __init__(self) -> None:
        self._interval_s: deque[float] = deque(maxlen=_WINDOW_STEPS)
        self._last: deque[Step] = deque(maxlen=_WINDOW_STEPS)

    def at(self, step: Step) -> Pace:
        """Take in the next step and return the pace at it."""
        return self.at_each([step])[0]

    def at_each(self, steps: Sequence[Step]) -> list[Pace]:
        """Take in the next steps and return the pace at each."""
        intervals_s, last, found = self._interval_s, self._last, []
        for step, begins in zip(steps, walks_begun(steps, last[-1] if last else None), strict=True):
            interval_s = max(step.event.time_s - step.start_s, _LEAST_INTERVAL_S)
            if begins:
                intervals_s.clear()
                last.clear()
            else:
                intervals_s.append(interval_s)
                interval_s = _median(intervals_s)
            last.append(step)
            found.append(Pace(1.0 / interval_s, tuple(last)))
        return found


def _median(values: Iterable[float]) -> float:
    """Compute the median of a few values."""
    ordered = sorted(values)
    half = len(ordered) // 2
    return ordered[half] if len(ordered) % 2 else 0.5 * (ordered[half - 1] + ordered[half])
