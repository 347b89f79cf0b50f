"""Rhythm of the steps, and the steps that a change of the carrying mode hid.

Where the mode changes, arm and trunk may hide a step from each other. A pause of two steps between two steps in
different known modes is filled with the one in between, unless it is long enough for a standstill.
"""

from dataclasses import replace

import numpy as np

from pdr_est.types.steps import CarryingMode, StepEvent


class StepIntervals:
    """Recent time between steps, by which a step hidden by a change of the mode is found.

    `interval_s` is a mean with weights that fall off into the past; it is infinite for a walker who has just set off.
    """

    def __init__(self, memory: float, standstill_s: float) -> None:
        self._memory = memory
        self._standstill_s = standstill_s
        self._previous: StepEvent | None = None
        self.interval_s = np.inf

    def fill_hidden_step(self, event: StepEvent) -> list[StepEvent]:
        """Return the next step, and before it the hidden one if two intervals passed while the mode changed."""
        previous, self._previous = self._previous, event
        if previous is None:
            return [event]
        elapsed_s = event.time_s - previous.time_s
        if elapsed_s > self._standstill_s:
            self.interval_s = np.inf
            return [event]
        changed = event.mode is not previous.mode and CarryingMode.UNKNOWN not in (event.mode, previous.mode)
        if changed and 1.5 < elapsed_s / self.interval_s < 2.5:
            middle = previous.index + (event.index - previous.index) // 2
            return [replace(event, index=middle, time_s=event.time_s - 0.5 * elapsed_s, confidence=0.0), event]
        if self.interval_s == np.inf:
            self.interval_s = elapsed_s
        else:
            self.interval_s = self._memory * self.interval_s + (1.0 - self._memory) * elapsed_s
        return [event]
