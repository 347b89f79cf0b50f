"""How well carrying modes are recognised, against their truth over time.

A label belongs to the sample that it stands on, so a recogniser that decides late is excused nothing here: its delay
shows online only, never in what it says about a time. What happens while the hand moves the phone (true mode TRANS)
has no right answer and is not scored.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.run_lengths import label_runs
from pdr_est.types.ground_truth import TrueModes
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, Step

TOLERANCE_S = 1.0
_MODES = len(CarryingMode)


@dataclass(frozen=True)
class Transitions:
    """Changes of the carrying mode, counted. real: true ones; missed: those of them that nothing was fired for;
    false: fired ones that belong to none. arrived: (modes, modes) how often a change that was not missed led
    from the true mode of its row's number to the label of its column's number afterwards."""

    real: int
    missed: int
    false: int
    arrived: NDArray[np.int64]

    def __add__(self, other: "Transitions") -> "Transitions":
        return Transitions(
            self.real + other.real,
            self.missed + other.missed,
            self.false + other.false,
            self.arrived + other.arrived,
        )


def confusion(
    truth: TrueModes, level: Sequence[LevelBlock], span_s: tuple[float, float] = (-np.inf, np.inf)
) -> NDArray[np.int64]:
    """(modes, modes) samples with the true mode of the row's number and the label of the column's number.

    span_s: from when to when samples count, both included: the time walked. Samples whose true mode is TRANS or
    not known do not count; those labelled TRANS do, as neither right nor any other mode.
    """
    time_s, label = _labels(level, span_s)
    true = truth.at(time_s)
    known = (true != CarryingMode.TRANS) & (true != CarryingMode.UNKNOWN)
    cells = true[known].astype(np.int64) * _MODES + label[known]
    return np.bincount(cells, minlength=_MODES**2).reshape(_MODES, _MODES)


def shares(counts: NDArray[np.int64]) -> Array:
    """Each row of a confusion matrix over its sum; NaN where nothing was counted."""
    total = counts.sum(axis=1, keepdims=True)
    share: Array = np.where(total > 0, counts / np.maximum(total, 1), np.nan)
    return share


def transitions(
    truth: TrueModes,
    level: Sequence[LevelBlock],
    span_s: tuple[float, float] = (-np.inf, np.inf),
    tolerance_s: float = TOLERANCE_S,
) -> Transitions:
    """True and fired changes of the mode, paired one to one in the order of time.

    A true change is a stretch of TRANS between two modes. A change is fired by an unbroken run of TRANS labels,
    whatever follows it, or where one mode's label follows another's directly; labels of UNKNOWN are left out. The two
    belong together if they overlap, the true one longer by tolerance_s at both ends. A change is judged by the label
    in the middle between its end and the beginning of the next one (the end of the span for the last one).
    """
    time_s, label = _labels(level, span_s)
    real, fired = _true_changes(truth, span_s), _fired_changes(time_s, label)
    arrived = np.zeros((_MODES, _MODES), dtype=np.int64)
    free = list(fired)
    missed = 0
    ends_s = [*(begin_s for begin_s, _, _ in real[1:]), float(time_s[-1]) if len(time_s) else np.inf]
    for (begin_s, end_s, mode), next_s in zip(real, ends_s, strict=True):
        near = [pair for pair in free if pair[0] <= end_s + tolerance_s and pair[1] >= begin_s - tolerance_s]
        if not near:
            missed += 1
            continue
        free.remove(near[0])
        middle = min(int(np.searchsorted(time_s, 0.5 * (end_s + next_s))), len(time_s) - 1)
        arrived[mode, label[middle]] += 1
    return Transitions(len(real), missed, len(free), arrived)


def _labels(level: Sequence[LevelBlock], span_s: tuple[float, float]) -> tuple[Array, NDArray[np.int8]]:
    """Times and labels of the samples within the span."""
    time_s = np.concatenate([np.empty(0), *(block.time_s for block in level)])
    label = np.concatenate([np.empty(0, dtype=np.int8), *(block.mode for block in level)])
    inside = (time_s >= span_s[0]) & (time_s <= span_s[1])
    return time_s[inside], label[inside]


def _true_changes(truth: TrueModes, span_s: tuple[float, float]) -> list[tuple[float, float, int]]:
    """Begin and end of each true change that ends in the span, and the mode after it."""
    changes = []
    for number in range(len(truth.mode) - 1):
        begin_s, end_s = float(truth.start_s[number]), float(truth.start_s[number + 1])
        if truth.mode[number] == CarryingMode.TRANS and begin_s >= span_s[0] and end_s <= span_s[1]:
            changes.append((begin_s, end_s, int(truth.mode[number + 1])))
    return changes


def _fired_changes(time_s: Array, label: NDArray[np.int8]) -> list[tuple[float, float]]:
    """First and last time of each change that the labels tell of."""
    known = label != CarryingMode.UNKNOWN
    time_s, label = time_s[known], label[known]
    changes: list[tuple[float, float]] = []
    for start, stop in label_runs(label):
        if label[start] == CarryingMode.TRANS:
            changes.append((float(time_s[start]), float(time_s[stop - 1])))
        elif start > 0 and label[start - 1] != CarryingMode.TRANS:
            changes.append((float(time_s[start]), float(time_s[start])))
    return changes


def durations_s(steps: Sequence[Step]) -> Array:
    """How long each step took, (n,)."""
    return np.array([step.event.time_s - step.start_s for step in steps])


def mode_shares(steps: Sequence[Step]) -> dict[CarryingMode, float]:
    """The share of the walking time that each mode of the steps has, 0 to 1, the longest first; NaN if the steps took
    no time."""
    time_s: dict[CarryingMode, float] = {}
    for step, duration_s in zip(steps, durations_s(steps).tolist(), strict=True):
        time_s[step.event.mode] = time_s.get(step.event.mode, 0.0) + duration_s
    total_s = sum(time_s.values())
    longest_first = sorted(time_s, key=lambda mode: (-time_s[mode], mode))
    return {mode: time_s[mode] / total_s if total_s > 0.0 else float("nan") for mode in longest_first}
