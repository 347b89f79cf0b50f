"""Make up the steps taken while the phone changes its carrying mode (MMPDR section III-C, eq. 8)."""

from dataclasses import replace

import numpy as np

from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.types.steps import StepEvent


class StepFrequency:
    """Step frequency of the walker: the reciprocal of the time between the last two steps.

    It is 0 for a walker who has taken no step for `standstill_s`, or only one since then.
    """

    def __init__(self, standstill_s: float) -> None:
        self._standstill_s = standstill_s
        self._last_s = -np.inf
        self._frequency_hz = 0.0
        self._bridged = False

    def at(self, time_s: float) -> float:
        """Return the frequency, Hz, at a time after the latest step."""
        return self._frequency_hz if time_s - self._last_s <= self._standstill_s else 0.0

    def step(self, time_s: float) -> None:
        """Take in the time of a detected step.

        The time since a compensated step says nothing, so the first step after one leaves the frequency as it is.
        """
        if not (self._bridged and self.at(time_s)):
            elapsed_s = time_s - self._last_s
            self._frequency_hz = 1.0 / elapsed_s if elapsed_s <= self._standstill_s else 0.0
        self._last_s, self._bridged = time_s, False

    def bridge(self, time_s: float) -> None:
        """Take it that the walker went on with the same frequency until this time."""
        self._last_s, self._bridged = time_s, True


class TransitionCompensation:
    """Compensation of the steps of one transition after another.

    Parameters
    ----------
    rate_hz : float
        Sampling rate.
    longest_s : float
        Longest transition that is compensated at once; a longer one is compensated in parts of this length, so that
        its steps need not wait for its end.
    frequency : StepFrequency
        Step frequency of the walker, shared with the detector.
    """

    def __init__(self, rate_hz: float, longest_s: float, frequency: StepFrequency) -> None:
        self._rate_hz = rate_hz
        self._longest = max(round(longest_s * rate_hz), 1)
        self._frequency = frequency
        self._first: StepEvent | None = None
        self._count = 0

    def extend(self, samples: SampleBuffer, start: int, stop: int) -> list[StepEvent]:
        """Add samples `start` to `stop` (exclusive) to the transition, and return the steps of its complete parts."""
        events: list[StepEvent] = []
        while start < stop:
            if self._first is None:
                self._first = samples.event(start)
            added = min(stop - start, self._longest - self._count)
            self._count += added
            start += added
            if self._count == self._longest:
                events += self.end()
        return events

    def end(self) -> list[StepEvent]:
        """End the transition and return its steps; none if there was no transition."""
        if self._first is None:
            return []
        events = compensated_steps(self._first, self._count, self._rate_hz, self._frequency.at(self._first.time_s))
        self._first, self._count = None, 0
        if events:
            self._frequency.bridge(events[-1].time_s)
        return events


def compensated_steps(first: StepEvent, count: int, rate_hz: float, frequency_hz: float) -> list[StepEvent]:
    """Spread round(duration * frequency) steps evenly over a transition.

    The steps lie on samples, each in the middle of its share of the transition.

    Parameters
    ----------
    first : StepEvent
        A step at the first sample of the transition, of which the others are copies.
    count : int
        Number of samples of the transition.
    rate_hz : float
        Sampling rate.
    frequency_hz : float
        Step frequency before the transition.

    References
    ----------
    MMPDR, eq. 8.
    """
    steps = min(int(count / rate_hz * frequency_hz + 0.5), count)
    offsets = [(2 * k + 1) * count // (2 * steps) for k in range(steps)]
    return [
        replace(first, index=first.index + offset, time_s=first.time_s + offset / rate_hz, compensated=True)
        for offset in offsets
    ]
