"""Hint of `pdr-est inspect` where in a recording the walking begins and ends."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.errors import PdrError
from pdr_est.types.recording import Recording
from pdr_est.types.steps import Step

_LEAST_STEPS = 4  # in a row, of a walk; fewer are the phone being handled (ours)
_APART_S = 2.0  # between two steps in a row: the step segmentation takes a longer time for a standstill
_MARGIN_S = 1.0  # before the first and after the last step, as whoever cuts a recording should leave


@dataclass(frozen=True)
class WalkingHint:
    """Time in which somebody walks.

    Attributes
    ----------
    begin_s, end_s
        Begin of the first and end of the last step in a row with others, s after the first sample.
    steps
        Number of steps between.
    duration_s
        Length of the recording, s.
    """

    begin_s: float
    end_s: float
    steps: int
    duration_s: float

    @property
    def words(self) -> str:
        """The hint in one line, with the options that cut off what comes before and after."""
        line = f"walking: {self.begin_s:.1f} s to {self.end_s:.1f} s after the start, {self.steps} steps"
        from_s, to_s = max(self.begin_s - _MARGIN_S, 0.0), min(self.end_s + _MARGIN_S, self.duration_s)
        options = [f"--from {from_s:.1f}"] if from_s > 0.0 else []
        options += [f"--to {to_s:.1f}"] if to_s < self.duration_s else []
        return f"{line}; the walk alone: {' '.join(options)}" if options else line

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers for JSON."""
        return {"begin_s": round(self.begin_s, 3), "end_s": round(self.end_s, 3), "steps": self.steps}


def walking_hint(recording: Recording) -> WalkingHint | None:
    """Find where in a recording somebody walks; None without steps, or if they cannot be sought."""
    if recording.span_s is None:
        return None
    try:
        walks = pipeline.analyse_recording(recording, Config(), at_the_end=False)
    except PdrError:
        return None
    start_s, end_s = recording.span_s
    in_a_row = [_in_a_row(walk.steps) for walk in walks]
    found = [steps for steps in in_a_row if steps]
    if not found:
        return None
    return WalkingHint(
        min(steps[0].start_s for steps in found) - start_s,
        max(steps[-1].event.time_s for steps in found) - start_s,
        max(len(steps) for steps in found),
        end_s - start_s,
    )


def _in_a_row(steps: Sequence[Step]) -> list[Step]:
    """Keep the steps that come several in a row."""
    if not steps:
        return []
    breaks = np.flatnonzero(np.diff([step.event.time_s for step in steps]) > _APART_S) + 1
    rows = np.split(np.arange(len(steps)), breaks)
    return [steps[i] for row in rows if len(row) >= _LEAST_STEPS for i in row]
