"""Curves of time that pass through given values at the steps of a walk, with continuous acceleration."""

import numpy as np
from scipy.interpolate import PPoly

from pdr_est.frames import Array
from pdr_est.simulate.motion.differentiable_signal import quintic_curve
from pdr_est.simulate.walker.step_schedule import SETTLE_S, StepSchedule


def cumulative_curve(steps: StepSchedule, per_step_m: Array) -> PPoly:
    """Add up over time what each step (n,) covers, m, evenly within a step, with standstills between the bouts."""
    nodes = CurveNodes()
    covered_m = 0.0
    for bout in steps.bouts:
        edge_s = _step_edges(steps, bout)
        arc_m = covered_m + np.concatenate([[0.0], np.cumsum(per_step_m[bout])])
        speed = np.diff(arc_m) / np.diff(edge_s)
        nodes.add(edge_s, arc_m, np.concatenate([[0.0], 0.5 * (speed[1:] + speed[:-1]), [0.0]]))
        covered_m = float(arc_m[-1])
    return nodes.curve(steps.end_s)


def step_count_curve(steps: StepSchedule) -> PPoly:
    """Count steps over time; a bout begins in the middle of a step, where the trunk is highest, as in standing.

    After a bout the count falls back while the walker stands, which no motion shows.
    """
    nodes = CurveNodes()
    for bout in steps.bouts:
        edge_s = _step_edges(steps, bout)
        count = np.arange(bout.start, bout.stop + 1, dtype=np.float64)
        count[0] += 0.5
        rate = 1.0 / np.diff(edge_s)
        at_edge = np.concatenate([[0.0], 0.5 * (rate[1:] + rate[:-1]), rate[-1:]])
        nodes.add(edge_s, count, at_edge)
        nodes.add(edge_s[-1:] + SETTLE_S, bout.stop + rate[-1:] * SETTLE_S, rate[-1:])
    return nodes.curve(steps.end_s)


def amplitude_curve(steps: StepSchedule, amplitude: Array, to_rest: bool = False) -> PPoly:
    """Compute an amplitude over time.

    It rises in the first step of a bout, then passes through that of each step at its heel strike, and fades out
    after the last one (`to_rest`: already with the last one).
    """
    nodes = CurveNodes()
    for bout in steps.bouts:
        level = np.concatenate([[0.0], amplitude[bout], [0.0]])
        if to_rest:
            level[-2] = 0.0
        edge_s = _step_edges(steps, bout)
        nodes.add(np.append(edge_s, edge_s[-1] + SETTLE_S), level, np.zeros(len(level)))
    return nodes.curve(steps.end_s)


def _step_edges(steps: StepSchedule, bout: slice) -> Array:
    """Return the beginning of a bout and the ends of its steps, (n + 1,)."""
    return np.append(steps.start_s[bout.start], steps.time_s[bout])


class CurveNodes:
    """Points that a curve of time passes through, standing still before and after them."""

    def __init__(self) -> None:
        self._columns: list[tuple[Array, Array, Array]] = []

    def add(self, time_s: Array, value: Array, rate: Array) -> None:
        """Add points: times (n,), s, values and their rates."""
        self._columns.append((time_s, value, rate))

    def curve(self, end_s: float) -> PPoly:
        """Compute the curve, at least up to the end of the recording, s."""
        time_s, value, rate = (np.concatenate(parts) for parts in zip(*self._columns, strict=True))
        before, after = min(0.0, time_s[0]) - 1.0, max(end_s, time_s[-1]) + 1.0
        return quintic_curve(
            np.concatenate([[before], time_s, [after]]),
            np.concatenate([value[:1], value, value[-1:]]),
            np.concatenate([[0.0], rate, [0.0]]),
        )
