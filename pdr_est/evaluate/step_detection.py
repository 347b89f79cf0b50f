"""Metrics of detected steps against annotated ones.

The peak of the phone's signal and the contact of the foot are a fixed part of a step apart, which depends on the
position of the phone. This offset is removed before steps are compared.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array

STEP_METRICS = ("count_error", "step_precision", "step_recall")
SPAN_METRICS = ("count_error", "steps_missed", "steps_extra")
FALSE_STEPS_METRIC = "false_steps_per_min"
TOLERANCE_S = 0.3
ANNOTATION_PAUSE_S = 2.5
"""Time between two annotated steps, s, from which on nothing is annotated between them: the slowest climbers take
1.6 s for a step, and some annotations leave out where the walker stands or shuffles.
"""


@dataclass(frozen=True)
class StepScore:
    """Numbers of steps within the annotated time span.

    Attributes
    ----------
    true, detected : int
        Number of annotated and of detected steps.
    matched : int
        Largest number of pairs of a detected and a true step at most `TOLERANCE_S` apart after removal of the offset.
    offset_s : float
        Median of detected minus true time, s; NaN without a detected step.
    """

    true: int
    detected: int
    matched: int
    offset_s: float

    def values(self) -> dict[str, float]:
        """Compute `STEP_METRICS`; the precision is NaN if no step was detected."""
        return {
            "count_error": count_error(self.detected, self.true),
            "step_precision": self.matched / self.detected if self.detected else float("nan"),
            "step_recall": self.matched / self.true,
        }

    def span_values(self) -> dict[str, float]:
        """Compute `SPAN_METRICS`: missed and extra steps are shares of the true number."""
        return {
            "count_error": count_error(self.detected, self.true),
            "steps_missed": (self.true - self.matched) / self.true,
            "steps_extra": (self.detected - self.matched) / self.true,
        }


def count_error(detected: int, true: int) -> float:
    """Compute `count_error`: the absolute error of the number of steps per true number, which is at least 1."""
    return abs(detected - true) / true


def steps_per_minute(n_steps: int, span_s: tuple[float, float]) -> float:
    """Compute `false_steps_per_min` of a person who rests; NaN for a recording without duration."""
    minutes = (span_s[1] - span_s[0]) / 60.0
    return n_steps / minutes if minutes > 0.0 else float("nan")


def score_steps(detected_s: Array, true_s: Array) -> StepScore:
    """Count and match the steps between the first and the last true step, with the tolerance at both ends.

    Parameters
    ----------
    detected_s, true_s : ndarray
        Times (n,) and (m,), s, in rising order, m at least 1.
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


def score_annotated_spans(detected_s: Array, true_s: Array) -> StepScore:
    """Count and match the steps within the annotated spans, with the tolerance at the ends of each.

    A span is a sequence of true steps at most `ANNOTATION_PAUSE_S` apart.

    Parameters
    ----------
    detected_s, true_s : ndarray
        Times (n,) and (m,), s, in rising order, m at least 1.
    """
    offset_s = median_offset(detected_s, true_s)
    shifted = detected_s - offset_s
    pauses = np.flatnonzero(np.diff(true_s) > ANNOTATION_PAUSE_S)
    begin_s = true_s[np.concatenate([[0], pauses + 1])] - TOLERANCE_S
    end_s = true_s[np.concatenate([pauses, [len(true_s) - 1]])] + TOLERANCE_S
    span = np.searchsorted(begin_s, shifted, side="right") - 1
    inside = shifted[(span >= 0) & (shifted <= end_s[np.maximum(span, 0)])]
    matched = largest_matching(inside, true_s, TOLERANCE_S)
    return StepScore(true=len(true_s), detected=len(inside), matched=matched, offset_s=offset_s)


def median_offset(detected_s: Array, true_s: Array) -> float:
    """Compute the median over the true steps of the time of the nearest detected step minus the true time.

    Of two equally near steps the earlier one counts.

    Parameters
    ----------
    detected_s, true_s : ndarray
        Times (n,) and (m,), s, in rising order.

    Returns
    -------
    float
        Median, s; NaN without a detected step.
    """
    if not len(detected_s):
        return float("nan")
    after = np.clip(np.searchsorted(detected_s, true_s), 0, len(detected_s) - 1)
    before = np.maximum(after - 1, 0)
    to_after, to_before = detected_s[after] - true_s, detected_s[before] - true_s
    nearest = np.where(np.abs(to_before) <= np.abs(to_after), to_before, to_after)
    return float(np.median(nearest))


def largest_matching(a_s: Array, b_s: Array, tolerance_s: float) -> int:
    """Count the largest number of one-to-one pairs of times, (n,) and (m,) in rising order, within a tolerance.

    Pairing the earliest two times that are near enough is optimal: everything else that they could be paired with is
    later and stays free.
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
