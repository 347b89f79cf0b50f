"""Mean vertical velocity and height of each step.

The vertical acceleration, integrated over a walk, is the vertical velocity up to a constant and a slow drift. Its
mean over a step is free of the rise and fall of the body within it. On stairs this mean is 0.2 to 0.35 m/s, up or
down, for some steps; no movement of a phone in the hand can be that for longer than a second.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.front_end.signal.barometric_height import height_by_pressure
from pdr_est.front_end.signal.step_samples import StepSamples, of_equal_count, rows_from
from pdr_est.records import made
from pdr_est.types.steps import CarryingMode, Step, begins_walk

_LEAST_SAMPLES = 3
_LEAST_DURATION_S = 0.1
_HELD = (CarryingMode.HOLDING, CarryingMode.UNKNOWN)  # the vertical velocity is that of the body
_ELSEWHERE_STEPS = 8  # in a row with the phone not held, after which it is not where it was; fewer may be an error


@dataclass(frozen=True)
class VerticalMotion:
    """Vertical motion of one step.

    Attributes
    ----------
    begins : bool
        True for the first step of a stretch of contiguous samples, and where the phone has been put elsewhere; the
        velocity counts from there.
    velocity_mps : float
        Mean vertical velocity, up to the constant of the stretch; NaN for a step of hardly any samples, and for a
        phone that is not held: it moves against the body.
    step_s : float
        Duration of the step.
    pace_s : float
        Mean duration of this step and the one before, of the other foot.
    height_m : float
        Mean height by the air pressure, from an arbitrary level; NaN where there is none.
    """

    begins: bool
    velocity_mps: float
    step_s: float
    pace_s: float
    height_m: float


class VerticalMotionMeter:
    """Vertical motion of one step after the other."""

    def __init__(self) -> None:
        self._previous: Step | None = None
        self._previous_s = 0.0  # its duration
        self._elsewhere = 0  # latest steps with the phone not held
        self._velocity_mps = 0.0  # at the end of the previous step

    def motions(self, steps: Sequence[Step]) -> list[VerticalMotion]:
        """Take in the next steps, at least one, and return their vertical motion."""
        return [self._motion(step, *gains) for step, gains in zip(steps, _velocity_gains(steps), strict=True)]

    def _motion(self, step: Step, mean_mps: float, gain_mps: float) -> VerticalMotion:
        """Take in a step with its mean and final velocity less that at its start."""
        previous = self._previous
        is_held = step.event.mode in _HELD
        is_elsewhere = self._elsewhere >= _ELSEWHERE_STEPS
        self._elsewhere = 0 if is_held else self._elsewhere + 1
        is_moved = is_elsewhere if is_held else self._elsewhere == _ELSEWHERE_STEPS
        begins = is_moved or begins_walk(step, previous) or not _follows(step, previous)
        before_mps = 0.0 if begins else self._velocity_mps
        step_s = step_duration_s(step)
        pace_s = step_s if begins else 0.5 * (step_s + self._previous_s)
        self._previous, self._previous_s, self._velocity_mps = step, step_s, before_mps + gain_mps
        return made(
            VerticalMotion,
            begins=begins,
            velocity_mps=before_mps + mean_mps if is_held else math.nan,
            step_s=step_s,
            pace_s=pace_s,
            height_m=_height_m(step),
        )


def _velocity_gains(steps: Sequence[Step]) -> list[tuple[float, float]]:
    """Compute for each step the mean and the final vertical velocity, less that at its start.

    The mean is NaN for a step of hardly any samples.
    """
    samples = StepSamples(steps)
    vertical, time_s = samples.column("vertical_mps2"), samples.column("time_s")
    mean_mps, gain_mps = np.full(len(steps), np.nan), np.zeros(len(steps))
    for count, places in of_equal_count(samples.count):
        if not count:
            continue
        first = samples.start[places]
        rows = rows_from(vertical, first, count)
        if count == 1:
            period_s = np.array([step_duration_s(steps[place]) for place in places])
        else:
            period_s = (time_s[first + count - 1] - time_s[first]) / (count - 1)
        gain_mps[places] = period_s * rows.sum(axis=1)
        if count >= _LEAST_SAMPLES:  # the mean of the running sum, in which the first sample counts most
            weight = np.arange(count, 0.0, -1.0)
            mean_mps[places] = period_s * np.matmul(rows[:, None], weight[:, None])[:, 0, 0] / count
    return list(zip(mean_mps.tolist(), gain_mps.tolist(), strict=True))


def _follows(step: Step, previous: Step | None) -> bool:
    """Tell whether the samples of a step begin where those of the previous one ended."""
    return previous is not None and step.samples.first_index == previous.samples.first_index + len(previous.samples)


def step_duration_s(step: Step) -> float:
    """Return the duration of a step, s, at least a tenth of a second."""
    return max(step.event.time_s - step.start_s, _LEAST_DURATION_S)


def _height_m(step: Step) -> float:
    """Compute the mean height by the air pressure; NaN where it is not known."""
    pressure_pa = step.samples.pressure_pa
    if pressure_pa is None:
        return float("nan")
    known = pressure_pa[np.isfinite(pressure_pa) & (pressure_pa > 0.0)]
    return float(height_by_pressure(known).mean()) if len(known) else float("nan")
