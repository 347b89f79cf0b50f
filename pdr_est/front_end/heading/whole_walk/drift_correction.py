"""What the whole walk tells of its headings: a stage that emits at the end."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np

from pdr_est.frames import wrap_angle
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams, dominant_directions
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections, straight_leg_sections
from pdr_est.types.analysis import DominantDirections
from pdr_est.types.steps import Step

_LEAST_FOLLOWING = 0.5  # probability that a piece follows a dominant direction


class WholeWalkHeading:
    """Stage Step -> Step that sets the heading right by the dominant directions of the building, if it has some.

    as_priors: whether steps along a dominant direction get it as path_heading_rad and keep their heading, or get the
    drift taken off their heading. `found`: what was found in the first segment with straight stretches.
    """

    latency_s = float("inf")  # the end of the recording

    def __init__(self, parameters: DominantParams, as_priors: bool) -> None:
        self._parameters = parameters
        self._as_priors = as_priors
        self._steps: list[Step] = []
        self.found: DominantDirections | None = None

    def push(self, item: Step, /) -> list[Step]:
        self._steps.append(item)
        return []

    def flush(self) -> list[Step]:
        steps, self._steps = self._steps, []
        segments = groupby(steps, key=lambda step: step.event.segment)
        return [step for _, segment in segments for step in self._set_right(list(segment))]

    def _set_right(self, steps: list[Step]) -> list[Step]:
        pieces = straight_leg_sections(steps, self._parameters.straight)
        directions = dominant_directions(pieces, self._parameters)
        if self.found is None:
            self.found = directions
        if directions is None or not directions.used:
            return steps
        if not self._as_priors:
            return _without_drift(steps, pieces, directions)
        return _with_drift_noise(_with_priors(steps, pieces, directions), directions.drift_per_sqrt_s)


def _with_priors(steps: Sequence[Step], pieces: LegSections, directions: DominantDirections) -> list[Step]:
    told = list(steps)
    for i in np.flatnonzero(directions.follows >= _LEAST_FOLLOWING):
        for k in range(pieces.first[i], pieces.last[i]):
            told[k] = replace(
                told[k],
                path_heading_rad=float(wrap_angle(directions.path_heading_rad[i])),
                sigma_path_heading_rad=float(directions.sigma_rad[i]),
            )
    return told


def _with_drift_noise(steps: Sequence[Step], per_sqrt_s: float) -> list[Step]:
    """The steps with what their headings drift by, as the walk shows it, among what is uncertain of their turns: so a
    phone that slips about in its pocket has less of a say than one in a steady hand."""
    times = [step.event.time_s for step in steps]
    elapsed_s = np.diff(times, prepend=times[0])
    return [
        replace(step, sigma_turn_rad=float(np.hypot(step.sigma_turn_rad, per_sqrt_s * np.sqrt(max(passed, 0.0)))))
        for step, passed in zip(steps, elapsed_s, strict=True)
    ]


def _without_drift(steps: Sequence[Step], pieces: LegSections, directions: DominantDirections) -> list[Step]:
    drift = np.interp([step.event.time_s for step in steps], pieces.time_s, directions.drift_rad)
    return [
        replace(step, heading_rad=float(wrap_angle(step.heading_rad - off)))
        for step, off in zip(steps, drift, strict=True)
    ]
