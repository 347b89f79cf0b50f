"""Detected steps against annotated ones.

The phone's peak and the foot's contact are a fixed part of a step apart, different for every position of the phone.
This offset is taken out before steps are compared.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array

STEP_METRICS = ("count_error", "step_precision", "step_recall")
FALSE_STEPS_METRIC = "false_steps_per_min"
TOLERANCE_S = 0.3


@dataclass(frozen=True)
class StepScore:
    """Counts over the annotated time span. offset_s: median of detected less true time, NaN without a detected step.

    matched: the largest number of pairs of a detected and a true step at most `TOLERANCE_S` apart after the offset.
    """

    true: int
    detected: int
    matched: int
    offset_s: float

    def values(self) -> dict[str, float]:
        """`STEP_METRICS`; the precision is NaN when no step was detected."""
        return {
            "count_error": count_error(self.detected, self.true),
            "step_precision": self.matched / self.detected if self.detected else float("nan"),
            "step_recall": self.matched / self.true,
        }


def count_error(detected: int, true: int) -> float:
    """`count_error`: difference of the numbers of steps / true number, which is at least 1."""
    return abs(detected - true) / true


def steps_per_minute(n_steps: int, span_s: tuple[float, float]) -> float:
    """`false_steps_per_min` of somebody who rests; NaN for a recording without duration."""
    minutes = (span_s[1] - span_s[0]) / 60.0
    return n_steps / minutes if minutes > 0.0 else float("nan")


def score_steps(detected_s: Array, true_s: Array) -> StepScore:
    """Counts and matches between the first and the last true step, with the tolerance at both ends.

    detected_s: (n,), true_s: (m,) times in rising order, m at least 1.
    """
    offset_s = median_offset(detected_s, true_s)
    shifted = detected_s - offset_s
    inside = shifted[(shifted >= true_s[0] - TOLERANCE_S) & (shifted <= true_s[-1] + TOLERANCE_S)]
    return StepScore(
        true=len(true_s),
        detected=len(inside),
        matched=largest_matching(inside, true_s, TOLERANCE_S),
        offset_s=offset_s,
    )


def median_offset(detected_s: Array, true_s: Array) -> float:
    """Median over the true steps (m,) of the nearest detected step's time less theirs; NaN without a detected step.

    detected_s: (n,) in rising order. Of two equally near ones the earlier counts.
    """
    if not len(detected_s):
        return float("nan")
    after = np.clip(np.searchsorted(detected_s, true_s), 0, len(detected_s) - 1)
    before = np.maximum(after - 1, 0)
    to_after, to_before = detected_s[after] - true_s, detected_s[before] - true_s
    nearest = np.where(np.abs(to_before) <= np.abs(to_after), to_before, to_after)
    return float(np.median(nearest))


def largest_matching(a_s: Array, b_s: Array, tolerance_s: float) -> int:
    """The largest number of one-to-one pairs of times at most tolerance_s apart. a_s: (n,), b_s: (m,), both rising.

    On a line, pairing the earliest two that are near enough never costs a pair: whatever else they could be paired
    with lies later and stays free.
    """
    i = j = pairs = 0
    while i < len(a_s) and j < len(b_s):
        if abs(a_s[i] - b_s[j]) <= tolerance_s:
            pairs, i, j = pairs + 1, i + 1, j + 1
        elif a_s[i] < b_s[j]:
            i += 1
        else:
            j += 1
    return pairs
