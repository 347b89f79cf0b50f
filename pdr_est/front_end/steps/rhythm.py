"""The rhythm of a walk: what the detector `auto` expects of the next step."""

from collections import deque
from dataclasses import replace

import numpy as np

from pdr_est.records import CarryingMode, StepEvent

_INTERVALS = 6  # among which two are whole ones, even if every other step is split
_LONGEST_USUAL_S = 1.2  # bounds how long a doubtful step waits


class Rhythm:
    """The time between steps, which tells the step that a change of the mode hid, and what a whole interval is.

    interval_s: mean of the recent ones with weights that fall off; infinite for who has just set off.
    """

    def __init__(self, memory: float, standstill_s: float) -> None:
        self._memory = memory
        self._standstill_s = standstill_s
        self._previous: StepEvent | None = None
        self.interval_s = np.inf
        self._split = False
        self._recent_s: deque[float] = deque(maxlen=_INTERVALS)

    @property
    def usual_s(self) -> float:
        """A whole interval: the second longest of the recent ones, for the longest may hide a step; 0 at first."""
        return min(sorted(self._recent_s)[-2], _LONGEST_USUAL_S) if len(self._recent_s) > 1 else 0.0

    def was_split(self) -> None:
        """The interval up to the next step had a hump in its middle that was taken for none. It counts as halves:
        if all are like that, the humps are steps."""
        self._split = True

    def completed(self, event: StepEvent) -> list[StepEvent]:
        """The next step, and before it the hidden one if two intervals passed while the mode changed."""
        previous, self._previous = self._previous, event
        if previous is None:
            return [event]
        elapsed_s = event.time_s - previous.time_s
        if elapsed_s > self._standstill_s:
            self.interval_s = np.inf
            self._recent_s.clear()
            return [event]
        self._recent_s.append(0.5 * elapsed_s if self._split else elapsed_s)
        self._split = False
        changed = event.mode is not previous.mode and CarryingMode.UNKNOWN not in (event.mode, previous.mode)
        if changed and 1.5 < elapsed_s / self.interval_s < 2.5:
            middle = previous.index + (event.index - previous.index) // 2
            return [replace(event, index=middle, time_s=event.time_s - 0.5 * elapsed_s, confidence=0.0), event]
        if self.interval_s == np.inf:
            self.interval_s = elapsed_s
        else:
            self.interval_s = self._memory * self.interval_s + (1.0 - self._memory) * elapsed_s
        return [event]
