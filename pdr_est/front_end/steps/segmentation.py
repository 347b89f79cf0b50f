"""From step events to steps: each event with the samples of its movement."""

import numpy as np

from pdr_est.front_end.signal.blocks import join, part
from pdr_est.params import Positive, params
from pdr_est.records import CarryingMode, LevelBlock, Step, StepEvent
from pdr_est.stage import Stage


@params
class SegmentationParams:
    """standstill_s: without a step for this long the walker stands (MMPDR section III-C: 2 s).
    initial_step_s: how long the first step after a standstill takes."""

    standstill_s: Positive = 2.0
    initial_step_s: Positive = 0.6


class StepSegmentation:
    """Stage LevelBlock -> Step around a step detector, a stage LevelBlock -> StepEvent."""

    def __init__(self, detector: Stage, parameters: SegmentationParams) -> None:
        self._detector = detector
        self._parameters = parameters
        self._samples: LevelBlock | None = None
        self._previous: StepEvent | None = None
        self._frequency_hz = 0.0  # of the previous step

    @property
    def latency_s(self) -> float:
        return self._detector.latency_s

    def push(self, item: LevelBlock, /) -> list[Step]:
        if not len(item):
            return []
        events: list[StepEvent] = self._detector.push(item)
        # The detector closes the old segment when it sees the new one; those steps need the old samples.
        steps = [self._step(event) for event in events if event.segment != item.segment]
        if self._samples is None or item.segment != self._samples.segment:
            self._samples = item
            self._previous = None
        else:
            self._samples = join([self._samples, item])
        steps += [self._step(event) for event in events if event.segment == item.segment]
        self._forget()
        return steps

    def flush(self) -> list[Step]:
        return [self._step(event) for event in self._detector.flush()]

    def _step(self, event: StepEvent) -> Step:
        samples = self._samples
        if samples is None:
            raise ValueError("a step event came before any sample")
        start, frequency = event.time_s - self._parameters.initial_step_s, 0.0
        if self._previous is not None:
            interval = event.time_s - self._previous.time_s
            if interval <= self._parameters.standstill_s:
                start, frequency = self._previous.time_s, 1.0 / interval
                if self._frequency_hz and CarryingMode.TRANS in (event.mode, self._previous.mode):
                    # MMPDR section III-D: nobody saw when a transition's steps were; they keep the last frequency.
                    frequency = self._frequency_hz
            else:
                start = max(start, self._previous.time_s)
        self._previous, self._frequency_hz = event, frequency
        stop = max(int(np.searchsorted(samples.time_s, event.time_s, side="right")), 1)
        first = min(int(np.searchsorted(samples.time_s, start, side="right")), stop - 1)
        return Step(
            event=event,
            start_s=min(max(start, float(samples.time_s[0])), event.time_s),
            frequency_hz=frequency,
            samples=part(samples, first, stop),
        )

    def _forget(self) -> None:
        """Drop samples that no later step can reach."""
        if self._samples is None:
            return
        horizon_s = self._parameters.standstill_s + self._parameters.initial_step_s + self._detector.latency_s
        excess = int(np.searchsorted(self._samples.time_s, self._samples.time_s[-1] - horizon_s))
        if excess > len(self._samples) // 2:
            self._samples = part(self._samples, excess, len(self._samples))
