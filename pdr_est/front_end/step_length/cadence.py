"""Measure the pace of a walk at a step: cadence and intensity over the last three steps."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from pdr_est.types.steps import Step, begins_walk

_WINDOW_STEPS = 3
_LEAST_RANGE_MPS2 = 0.05  # keeps the logarithm of a step without movement finite
_LEAST_INTERVAL_S = 0.1


@dataclass(frozen=True)
class Pace:
    """Cadence and intensity of the last steps.

    Attributes
    ----------
    cadence_hz : float
        Reciprocal of the median interval of the last three steps.
    range_mps2 : float
        Geometric mean over them of the range of the vertical acceleration within a step, unsmoothed.
    """

    cadence_hz: float
    range_mps2: float


class PaceMeter:
    """Pace at each step in turn; the first step after a standstill or a gap begins afresh.

    The duration of that first step is assumed and not measured, so its cadence is given but not remembered.
    """

    def __init__(self) -> None:
        self._previous: Step | None = None
        self._interval_s: deque[float] = deque(maxlen=_WINDOW_STEPS)
        self._log_range: deque[float] = deque(maxlen=_WINDOW_STEPS)

    def at(self, step: Step) -> Pace:
        """Take in the next step and return the pace at it."""
        interval_s = max(step.event.time_s - step.start_s, _LEAST_INTERVAL_S)
        begins = begins_walk(step, self._previous)
        self._previous = step
        if begins:
            self._interval_s.clear()
            self._log_range.clear()
        else:
            self._interval_s.append(interval_s)
        self._log_range.append(float(np.log(max(np.ptp(step.samples.vertical_mps2), _LEAST_RANGE_MPS2))))
        return Pace(
            cadence_hz=1.0 / (interval_s if begins else float(np.median(self._interval_s))),
            range_mps2=float(np.exp(np.mean(self._log_range))),
        )
