"""Search for the clock of a source of fixes that is shifted against the recording."""

from dataclasses import replace

import numpy as np

from pdr_est.estimators.fix_checks.explanations import (
    SHIFT_STEP_S,
    Explained,
    Explanation,
    evidence_alone,
    weigh_under,
)
from pdr_est.estimators.fix_checks.outlier_weights import rough_heading
from pdr_est.estimators.fix_checks.section import Section
from pdr_est.frames import Array

_NEAR_S: Array = SHIFT_STEP_S * np.arange(-16.0, 17.0)
_COARSE_STEP_S, _FARTHEST_S = 1.5, 60.0  # of the search beyond; ours
_FINE_S = SHIFT_STEP_S * np.arange(-4, 5)
_MOST_TRIED = 3  # far corrections that are worth a closer look


def likely_shift(section: Section, now: Explained, source: int) -> Explanation:
    """Return the explanation with the most probable correction of the clock of a source by at most 8 s."""
    shifts_s, evidence = shift_evidence(section, now, source)
    best = int(np.argmax(np.where(shifts_s == 0.0, -np.inf, evidence)))
    return _shifted(now.explanation, source, float(shifts_s[best]))


def far_shifts(section: Section, now: Explained, source: int) -> list[Explanation]:
    """Return explanations with a correction of the clock of a source by at most a minute.

    The search goes from coarse to fine: rough distances of the fixes from the path first, for the weights of the
    fixes under a clock that is far off mean nothing; then the evidence about the best of them.
    """
    coarse_s = np.arange(_COARSE_STEP_S, _FARTHEST_S + 0.1, _COARSE_STEP_S)
    coarse_s = np.concatenate([-coarse_s[::-1], coarse_s])
    cost = np.array([_rough_cost(section, now, source, float(shift_s)) for shift_s in coarse_s])
    found = []
    for shift_s in coarse_s[np.argsort(cost, kind="stable")[:_MOST_TRIED]]:
        tried = weigh_under(section, _shifted(now.explanation, source, float(shift_s)))
        fine_s = shift_s + _FINE_S
        best = int(np.argmax(_evidence(section, tried, source, fine_s)))
        found.append(_shifted(now.explanation, source, float(fine_s[best])))
    return found


def _rough_cost(section: Section, now: Explained, source: int, shift_s: float) -> float:
    """Return how far the fixes are from the path with a clock correction, without a unit."""
    shifts_s = _shifted(now.explanation, source, shift_s).shifts(now.fixes)
    path_m = section.path.at(now.fixes.time_s + shifts_s).position_m
    return rough_heading(now.fixes, path_m, None if section.heading is None else section.heading[0])[2]


def shift_evidence(section: Section, now: Explained, source: int) -> tuple[Array, Array]:
    """Return clock corrections of a source (k,), s, and the logarithm (k,) of their probabilities.

    They lie around the one that is taken if it is far. The weights of the fixes are those of the present explanation;
    the logarithms have a constant in common.
    """
    taken_s = dict(now.explanation.shift_s).get(source, 0.0)
    shifts_s: Array = _NEAR_S if abs(taken_s) <= _NEAR_S[-1] else np.asarray(taken_s + _NEAR_S)
    return shifts_s, _evidence(section, now, source, shifts_s)


def _evidence(section: Section, now: Explained, source: int, shifts_s: Array) -> Array:
    """Return the logarithm (k,) of the probability of each clock correction (k,), s."""
    tried = [_shifted(now.explanation, source, float(shift_s)) for shift_s in shifts_s]
    rest = replace(now.explanation, shift_s=()).log_prior
    return np.array([evidence_alone(section, one, now) + one.log_prior - rest for one in tried])


def _shifted(known: Explanation, source: int, shift_s: float) -> Explanation:
    """Return an explanation with another clock correction of a source."""
    others = tuple(one for one in known.shift_s if one[0] != source)
    return replace(known, shift_s=(*others, (source, shift_s)))
