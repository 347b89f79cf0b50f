"""How brisk a walk is at a step: cadence and intensity over the last three steps."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from pdr_est.types.steps import Step, begins_walk

_STEPS = 3
_LEAST_RANGE_MPS2 = 0.05  # so that a step without any movement has a logarithm
_LEAST_INTERVAL_S = 0.1


@dataclass(frozen=True)
class Pace:
    """cadence_hz: reciprocal of the median interval of the last three steps. range_mps2: geometric mean over them of
    the range of the vertical acceleration within a step, unsmoothed."""

    cadence_hz: float
    range_mps2: float


class PaceMeter:
    """The pace at each step in turn; the first one after a standstill or a gap begins anew.

    How long that first step took is assumed and not measured, so its cadence is given but not remembered.
    """

    def __init__(self) -> None:
        self._previous: Step | None = None
        self._interval_s: deque[float] = deque(maxlen=_STEPS)
        self._log_range: deque[float] = deque(maxlen=_STEPS)

    def at(self, step: Step) -> Pace:
        """The pace at the next step."""
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
