"""Turn step events into steps: each event with the samples of its movement.

Compensated steps were not observed, so they and the first one after them keep the last frequency (MMPDR section
III-D).
"""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from pdr_est.frames import SIGMA_UNIFORM_RAD
from pdr_est.front_end.signal.blocks import join, part, parts
from pdr_est.front_end.steps.mode_transition import StepFrequency
from pdr_est.params import Positive, params
from pdr_est.records import made
from pdr_est.stage import Stage
from pdr_est.types.sensors import Hole, LevelBlock
from pdr_est.types.steps import LONGEST_STEP_S, Step, StepEvent

_FOUND = ("event", "start_s", "frequency_hz", "samples", "holes", "sigma_turn_rad", "recorded_share")
_NOT_YET_KNOWN = {field.name: field.default for field in fields(Step) if field.name not in _FOUND}


@params
class SegmentationParams:
    """Parameters of the cut of the samples into steps."""

    standstill_s: Positive = 2.0
    """Time without a step, s, after which the walker stands (MMPDR section III-C: 2 s)."""
    initial_step_s: Positive = 0.6
    """Duration, s, of the first step after a standstill, or of one that a segment begins in; ours."""
    hole_turn_radps: Positive = 0.36
    """Standard deviation of the heading change over a gap of the recording in which the walker goes on, over its
    duration, rad/s, up to that of any direction. Measured by cutting gaps of 0.6 to 4 s into recorded walks.
    """
    standing_hole_turn_radps: Positive = 0.1
    """The same for a walker who stands before and after the gap."""


class StepSegmentation:
    """Stage LevelBlock -> Step around a step detector.

    Detectors take the delay of their filters off the time of a step, so that the first one of a segment may have
    ended before its first sample. It is no step of the recording and is left out; where it ended, the next one began.

    Parameters
    ----------
    detector : Stage
        Stage LevelBlock -> StepEvent.
    parameters : SegmentationParams
        Standstill, and the duration of a first step.
    """

    def __init__(self, detector: Stage, parameters: SegmentationParams) -> None:
        self._detector = detector
        self._parameters = parameters
        self._samples: list[LevelBlock] = []  # of one segment, joined when a step needs them
        self._begin_s = np.inf  # time of the first sample of the segment
        self._previous_s = -np.inf  # time of the previous step of the segment
        self._frequency = StepFrequency(parameters.standstill_s)
        self._holes: tuple[Hole, ...] = ()  # since the last step
        self._last_s = -np.inf  # time of the last step, whatever its segment
        self._segment: int | None = None  # of the last step

    @property
    def latency_s(self) -> float:
        """Return the latency of the detector, s: a step is emitted with its event."""
        return self._detector.latency_s

    def push(self, item: LevelBlock, /) -> list[Step]:
        """Take level samples and return the steps that end in them."""
        if not len(item):
            return []
        events: list[StepEvent] = self._detector.push(item)
        # The detector closes the old segment when it sees the new one; those steps need the old samples.
        steps = self._steps([event for event in events if event.segment != item.segment])
        if self._samples and item.segment != self._samples[-1].segment:
            self._begin_segment()
        if item.hole is not None:
            self._holes += (item.hole,)
        if not self._samples:
            self._begin_s = float(item.time_s[0])
        self._samples.append(item)
        steps += self._steps([event for event in events if event.segment == item.segment])
        self._forget()
        return steps

    def flush(self) -> list[Step]:
        """Return the steps that the detector held back."""
        return self._steps(self._detector.flush())

    def _steps(self, events: Sequence[StepEvent]) -> list[Step]:
        if not events:
            return []
        if not self._samples:
            raise ValueError("a step event came before any sample")
        samples = join(self._samples)
        self._samples = [samples]
        begins_s = [self._begin_of(event) for event in events]
        stops = samples.time_s.searchsorted([event.time_s for event in events], side="right").tolist()
        firsts = samples.time_s.searchsorted(begins_s, side="right").tolist()
        spans = [(min(first, max(stop, 1) - 1), max(stop, 1)) for first, stop in zip(firsts, stops, strict=True)]
        first_s = float(samples.time_s[0])
        moved = zip(events, begins_s, parts(samples, spans), strict=True)
        steps = [self._step(event, begin_s, own, first_s) for event, begin_s, own in moved]
        return [step for step in steps if step.event.time_s > self._begin_s]

    def _begin_of(self, event: StepEvent) -> float:
        """Return the time at which the movement of the next step began, s."""
        begin_s, self._previous_s = self._previous_s, event.time_s
        if event.time_s - begin_s <= self._parameters.standstill_s:
            return begin_s
        return max(event.time_s - self._parameters.initial_step_s, begin_s)

    def _step(self, event: StepEvent, begin_s: float, samples: LevelBlock, first_s: float) -> Step:
        """Make the step of an event from its samples; it may have begun before the first sample of all."""
        start_s = min(max(begin_s, first_s), event.time_s)
        holes, before_s = self._holes, self._last_s
        same = event.segment == self._segment or self._segment is None
        if event.time_s > self._begin_s:
            self._holes, self._last_s, self._segment = (), event.time_s, event.segment
        return made(
            Step,
            **_NOT_YET_KNOWN,
            event=event,
            start_s=start_s,
            frequency_hz=self._frequency_at(event),
            samples=samples,
            holes=holes,
            sigma_turn_rad=self._turn_over(holes, before_s, start_s) if same or holes else SIGMA_UNIFORM_RAD,
            recorded_share=(event.time_s - start_s) / (event.time_s - begin_s) if begin_s < start_s else 1.0,
        )

    def _turn_over(self, holes: tuple[Hole, ...], before_s: float, start_s: float) -> float:
        """Compute the standard deviation of the heading change, rad, over gaps between two steps."""
        if not holes:
            return 0.0
        p = self._parameters
        stands = min(holes[0].start_s - before_s, start_s - holes[-1].end_s) > LONGEST_STEP_S
        per_s = p.standing_hole_turn_radps if stands else p.hole_turn_radps
        squares = [min(per_s * hole.duration_s, SIGMA_UNIFORM_RAD) ** 2 for hole in holes]
        return float(min(np.sqrt(sum(squares)), SIGMA_UNIFORM_RAD))

    def _frequency_at(self, event: StepEvent) -> float:
        """Return the step frequency, Hz, with this event; 0 for the first one after a standstill."""
        if event.compensated and self._frequency.at(event.time_s):
            self._frequency.bridge(event.time_s)
        else:
            self._frequency.step(event.time_s)
        return self._frequency.at(event.time_s)

    def _begin_segment(self) -> None:
        self._samples.clear()
        self._previous_s = -np.inf
        self._frequency = StepFrequency(self._parameters.standstill_s)

    def _forget(self) -> None:
        """Drop samples that no later step can reach."""
        if not self._samples:
            return
        horizon_s = self._parameters.standstill_s + self._parameters.initial_step_s + self._detector.latency_s
        earliest_s = float(self._samples[-1].time_s[-1]) - horizon_s
        while self._samples[0].time_s[-1] < earliest_s:
            self._samples.pop(0)
        oldest = self._samples[0]
        excess = int(np.searchsorted(oldest.time_s, earliest_s))
        if excess > len(oldest) // 2:
            self._samples[0] = part(oldest, excess, len(oldest))
