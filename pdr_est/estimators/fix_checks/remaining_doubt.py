"""Doubt that the best explanation of a section leaves: others explain it nearly as well."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.estimators.fix_checks.clock_shifts import shift_evidence
from pdr_est.estimators.fix_checks.explanations import (
    Explained,
    Explanation,
    checked_sources,
    other_accuracies,
    weigh_under,
    worse_steps,
)
from pdr_est.estimators.fix_checks.section import Section
from pdr_est.frames import Array


@dataclass(frozen=True)
class SourceDoubt:
    """Doubt about a source of fixes under an explanation, averaged over all values by their probability.

    Attributes
    ----------
    source
        Number of the source.
    factor
        Root mean square of the factor on its stated errors.
    sigma_m
        Standard deviation of the error in each coordinate that its unknown clock causes, m.
    """

    source: int
    factor: float
    sigma_m: float


@dataclass(frozen=True)
class StepDoubt:
    """Doubt about the steps under an explanation.

    Attributes
    ----------
    probability
        Probability that the steps are worse than usual, against what is stated and against worse fixes.
    factor
        Root mean square of the factor on their standard deviations, if they are.
    """

    probability: float
    factor: float


USUAL_STEPS = StepDoubt(0.0, 1.0)
"""Steps as they are stated."""


def remaining_doubt(section: Section, now: Explained) -> tuple[SourceDoubt, ...]:
    """Average accuracy and clock of each source over the values that it may have."""
    moved_m = np.diff(now.points.position_m, axis=0)
    elapsed_s = max(float(now.fixes.time_s[-1] - now.fixes.time_s[0]), 1.0)
    speed_mps = float(np.hypot(*moved_m.T).sum()) / elapsed_s
    return tuple(
        SourceDoubt(source, _factor(section, now, source), speed_mps * _sigma_shift_s(section, now, source))
        for source in checked_sources(now)
    )


def step_doubt(section: Section, now: Explained) -> StepDoubt:
    """Compare worse steps with steps and fixes as stated, and with each source of fixes that is worse."""
    if now.explanation.step_factor == 1.0:
        return USUAL_STEPS
    plain = replace(now.explanation, step_factor=1.0, factor=())
    steps = worse_steps(plain)
    rivals = [plain, *(one for source in checked_sources(now) for one in other_accuracies(plain, source))]
    weight = _weights(_scores(section, [*steps, *rivals]))[: len(steps)]
    probability = float(weight.sum())
    factors = np.array([one.step_factor for one in steps])
    return StepDoubt(probability, float(np.sqrt(weight @ factors**2 / max(probability, 1e-300))))


def _factor(section: Section, now: Explained, source: int) -> float:
    """Return the root mean square of the factor on the errors of a source."""
    others = tuple(one for one in now.explanation.factor if one[0] != source)
    without = replace(now.explanation, factor=others)
    tried = [without, *other_accuracies(without, source)]
    factors = np.array([dict(one.factor).get(source, 1.0) for one in tried])
    return float(np.sqrt(_weights(_scores(section, tried)) @ factors**2))


def _sigma_shift_s(section: Section, now: Explained, source: int) -> float:
    """Return the root mean square deviation of the clock of a source from the one that is taken, s."""
    if source in now.fixes.known_clocks:
        return 0.0
    shifts_s, evidence = shift_evidence(section, now, source)
    taken_s = dict(now.explanation.shift_s).get(source, 0.0)
    return float(np.sqrt(_weights(evidence) @ (shifts_s - taken_s) ** 2))


def _scores(section: Section, explanations: Sequence[Explanation]) -> Array:
    return np.array([weigh_under(section, one).score for one in explanations])


def _weights(logarithms: Array) -> Array:
    weights = np.exp(logarithms - logarithms.max())
    return np.asarray(weights / weights.sum())
