"""Metrics of recognised carrying modes against the true modes over time.

A label belongs to its sample: the delay of a recogniser that decides late matters online only and is not scored here.
While the hand moves the phone (true mode TRANS) there is no right label, and samples are not scored.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.label_runs import label_runs
from pdr_est.types.ground_truth import TrueModes
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, Step

TOLERANCE_S = 1.0
_MODES = len(CarryingMode)


@dataclass(frozen=True)
class Transitions:
    """Counted changes of the carrying mode.

    Attributes
    ----------
    real : int
        Number of true changes.
    missed : int
        Number of true changes without a detected one.
    false : int
        Number of detected changes without a true one.
    arrived : ndarray
        (modes, modes) how often, after a true change that was not missed, the true mode (row) got the label (column).
    """

    real: int
    missed: int
    false: int
    arrived: NDArray[np.int64]

    def __add__(self, other: "Transitions") -> "Transitions":
        """Add the counts of two walks."""
        return Transitions(
            self.real + other.real,
            self.missed + other.missed,
            self.false + other.false,
            self.arrived + other.arrived,
        )


def mode_confusion(
    truth: TrueModes, level: Sequence[LevelBlock], span_s: tuple[float, float] = (-np.inf, np.inf)
) -> NDArray[np.int64]:
    """Count the samples by true mode (row) and label (column).

    Samples whose true mode is TRANS or not known do not count; those labelled TRANS do, as a wrong label.

    Parameters
    ----------
    truth : TrueModes
        True modes over time.
    level : sequence of LevelBlock
        Labelled samples.
    span_s : (float, float)
        First and last time of the samples that count, s.

    Returns
    -------
    ndarray
        (modes, modes) numbers of samples.
    """
    time_s, label = _labels(level, span_s)
    true = truth.at(time_s)
    known = (true != CarryingMode.TRANS) & (true != CarryingMode.UNKNOWN)
    cells = true[known].astype(np.int64) * _MODES + label[known]
    return np.bincount(cells, minlength=_MODES**2).reshape(_MODES, _MODES)


def row_shares(counts: NDArray[np.int64]) -> Array:
    """Divide each row of a confusion matrix by its sum; rows without counts become NaN."""
    total = counts.sum(axis=1, keepdims=True)
    share: Array = np.where(total > 0, counts / np.maximum(total, 1), np.nan)
    return share


def count_transitions(
    truth: TrueModes,
    level: Sequence[LevelBlock],
    span_s: tuple[float, float] = (-np.inf, np.inf),
    tolerance_s: float = TOLERANCE_S,
) -> Transitions:
    """Pair true and detected changes of the mode one to one in the order of time, and count them.

    A true change is an interval of TRANS between two modes. A detected change is an unbroken run of TRANS labels,
    whatever follows it, or a label of one mode directly after one of another; labels of UNKNOWN are left out. The two
    are paired if they overlap after the true one was made longer by the tolerance at both ends. The label after a
    change is the one in the middle between its end and the beginning of the next one (after the last change, the end
    of the span).

    Parameters
    ----------
    truth : TrueModes
        True modes over time.
    level : sequence of LevelBlock
        Labelled samples.
    span_s : (float, float)
        First and last time of the samples that count, s.
    tolerance_s : float
        Tolerance of the pairing, s.
    """
    time_s, label = _labels(level, span_s)
    real, free = _true_changes(truth, span_s), _detected_changes(time_s, label)
    arrived = np.zeros((_MODES, _MODES), dtype=np.int64)
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
    """Return times and labels of the samples within the span."""
    time_s = np.concatenate([np.empty(0), *(block.time_s for block in level)])
    label = np.concatenate([np.empty(0, dtype=np.int8), *(block.mode for block in level)])
    inside = (time_s >= span_s[0]) & (time_s <= span_s[1])
    return time_s[inside], label[inside]


def _true_changes(truth: TrueModes, span_s: tuple[float, float]) -> list[tuple[float, float, int]]:
    """Return begin and end of each true change within the span, and the mode after it."""
    changes = []
    for number in range(len(truth.mode) - 1):
        begin_s, end_s = float(truth.start_s[number]), float(truth.start_s[number + 1])
        if truth.mode[number] == CarryingMode.TRANS and begin_s >= span_s[0] and end_s <= span_s[1]:
            changes.append((begin_s, end_s, int(truth.mode[number + 1])))
    return changes


def _detected_changes(time_s: Array, label: NDArray[np.int8]) -> list[tuple[float, float]]:
    """Return the first and last time of each change of the labels."""
    known = label != CarryingMode.UNKNOWN
    time_s, label = time_s[known], label[known]
    changes: list[tuple[float, float]] = []
    for start, stop in label_runs(label):
        if label[start] == CarryingMode.TRANS:
            changes.append((float(time_s[start]), float(time_s[stop - 1])))
        elif start > 0 and label[start - 1] != CarryingMode.TRANS:
            changes.append((float(time_s[start]), float(time_s[start])))
    return changes


def step_durations_s(steps: Sequence[Step]) -> Array:
    """Return the duration of each step, (n,) s."""
    return np.array([step.event.time_s - step.start_s for step in steps])


def mode_shares(steps: Sequence[Step]) -> dict[CarryingMode, float]:
    """Compute the share of the walking time, 0 to 1, of each mode of the steps.

    Returns
    -------
    dict
        Mode -> share, the longest first; NaN if the steps took no time.
    """
    time_s: dict[CarryingMode, float] = {}
    for step, duration_s in zip(steps, step_durations_s(steps).tolist(), strict=True):
        time_s[step.event.mode] = time_s.get(step.event.mode, 0.0) + duration_s
    total_s = sum(time_s.values())
    longest_first = sorted(time_s, key=lambda mode: (-time_s[mode], mode))
    return {mode: time_s[mode] / total_s if total_s > 0.0 else float("nan") for mode in longest_first}
