"""Steps that are taken while the phone changes its place, counted by their rhythm (MMPDR section III-C, eq. 8)."""

from dataclasses import replace

import numpy as np

from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.types.steps import StepEvent


class StepFrequency:
    """How many steps a second the walker takes: the reciprocal of the time between the last two steps, 0 for one
    who has taken no step for standstill_s or only one since."""

    def __init__(self, standstill_s: float) -> None:
        self._standstill_s = standstill_s
        self._last_s = -np.inf
        self._frequency_hz = 0.0
        self._bridged = False

    def at(self, time_s: float) -> float:
        """The frequency, Hz, at a time after the latest step."""
        return self._frequency_hz if time_s - self._last_s <= self._standstill_s else 0.0

    def step(self, time_s: float) -> None:
        """Take in a detected step. The time since a compensated one says nothing."""
        if not (self._bridged and self.at(time_s)):
            elapsed_s = time_s - self._last_s
            self._frequency_hz = 1.0 / elapsed_s if elapsed_s <= self._standstill_s else 0.0
        self._last_s, self._bridged = time_s, False

    def bridge(self, time_s: float) -> None:
        """The walker went on in the same rhythm until this time."""
        self._last_s, self._bridged = time_s, True


class Transition:
    """Compensation of one transition after another. longest_s: a longer one is compensated in parts of this length,
    so that nobody has to wait for its end."""

    def __init__(self, rate_hz: float, longest_s: float, frequency: StepFrequency) -> None:
        self._rate_hz = rate_hz
        self._longest = max(round(longest_s * rate_hz), 1)
        self._frequency = frequency
        self._first: StepEvent | None = None
        self._count = 0

    def extend(self, samples: SampleBuffer, start: int, stop: int) -> list[StepEvent]:
        """Samples start to stop (exclusive) lie in the transition; return the steps of its complete parts."""
        events: list[StepEvent] = []
        while start < stop:
            if self._first is None:
                self._first = samples.event(start)
            taken = min(stop - start, self._longest - self._count)
            self._count += taken
            start += taken
            if self._count == self._longest:
                events += self.end()
        return events

    def end(self) -> list[StepEvent]:
        """The transition is over: its steps, none if there was no transition."""
        if self._first is None:
            return []
        events = compensated_steps(self._first, self._count, self._rate_hz, self._frequency.at(self._first.time_s))
        self._first, self._count = None, 0
        if events:
            self._frequency.bridge(events[-1].time_s)
        return events


def compensated_steps(first: StepEvent, count: int, rate_hz: float, frequency_hz: float) -> list[StepEvent]:
    """Eq. 8: round(duration * frequency) steps, evenly spread over a transition of `count` samples.

    first: a step at its first sample. The steps lie on samples, each in the middle of its share of the transition.
    """
    number = min(int(count / rate_hz * frequency_hz + 0.5), count)
    places = [(2 * k + 1) * count // (2 * number) for k in range(number)]
    return [
        replace(first, index=first.index + place, time_s=first.time_s + place / rate_hz, compensated=True)
        for place in places
    ]
