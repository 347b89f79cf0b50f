"""How a step goes on in the walk: cadence and intensity over the last three steps."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from pdr_est.records import Step

_STEPS = 3
_LEAST_RANGE_MPS2 = 0.05  # so that a step without any movement has a logarithm
_LEAST_INTERVAL_S = 0.1
_FEWEST, _MOST = 0.4, 2.2  # steps that one interval may stand for


@dataclass(frozen=True)
class Pace:
    """cadence_hz: reciprocal of the median interval of the last three steps. range_mps2: geometric mean over them of
    the range of the unsmoothed vertical acceleration within a step. steps: how many steps at that cadence the
    interval of this one holds, about 2 where the detector missed one and below 1 for a false one; 0.4 to 2.2."""

    cadence_hz: float
    range_mps2: float
    steps: float


class PaceMeter:
    """The pace at each step in turn; the first one after a standstill or a gap begins anew."""

    def __init__(self) -> None:
        self._interval_s: deque[float] = deque(maxlen=_STEPS)
        self._log_range: deque[float] = deque(maxlen=_STEPS)

    def at(self, step: Step) -> Pace:
        """The pace at the next step."""
        if step.frequency_hz == 0.0:
            self._interval_s.clear()
            self._log_range.clear()
        interval_s = max(step.event.time_s - step.start_s, _LEAST_INTERVAL_S)
        self._interval_s.append(interval_s)
        self._log_range.append(float(np.log(max(np.ptp(step.samples.vertical_mps2), _LEAST_RANGE_MPS2))))
        usual_s = float(np.median(self._interval_s))
        return Pace(
            cadence_hz=1.0 / usual_s,
            range_mps2=float(np.exp(np.mean(self._log_range))),
            steps=float(np.clip(interval_s / usual_s, _FEWEST, _MOST)),
        )
