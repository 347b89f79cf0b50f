"""Doubt that the best explanation of a section leaves: other accuracies and clocks explain it nearly as well."""

from dataclasses import dataclass, replace

import numpy as np

from pdr_est.estimators.fix_checks.explanations import (
    Explained,
    Explanation,
    checked_sources,
    other_accuracies,
    shift_evidence,
    weigh_under,
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


def remaining_doubt(section: Section, now: Explained) -> tuple[SourceDoubt, ...]:
    """Average accuracy and clock of each source over the values that it may have."""
    moved_m = np.diff(now.points.position_m, axis=0)
    elapsed_s = max(float(now.fixes.time_s[-1] - now.fixes.time_s[0]), 1.0)
    speed_mps = float(np.hypot(*moved_m.T).sum()) / elapsed_s
    return tuple(
        SourceDoubt(source, _factor(section, now, source), speed_mps * _sigma_shift_s(section, now, source))
        for source in checked_sources(now)
    )


def _factor(section: Section, now: Explained, source: int) -> float:
    """Return the root mean square of the factor on the errors of a source."""
    without = _without_factor(now.explanation, source)
    tried = [weigh_under(section, one) for one in (without, *other_accuracies(without, source))]
    weight = _weights(np.array([one.score for one in tried]))
    factors = np.array([dict(one.explanation.factor).get(source, 1.0) for one in tried])
    return float(np.sqrt(weight @ factors**2))


def _without_factor(known: Explanation, source: int) -> Explanation:
    chosen = dict(known.factor).get(source)
    if chosen is None:
        return known
    rest = replace(known, factor=tuple(one for one in known.factor if one[0] != source))
    cost = next(one.log_prior for one in other_accuracies(rest, source) if dict(one.factor)[source] == chosen)
    return replace(rest, log_prior=known.log_prior - (cost - rest.log_prior))


def _sigma_shift_s(section: Section, now: Explained, source: int) -> float:
    """Return the root mean square deviation of the clock of a source from the one that is taken, s."""
    shifts_s, evidence = shift_evidence(section, now, source)
    taken_s = dict(now.explanation.shift_s).get(source, 0.0)
    return float(np.sqrt(_weights(evidence) @ (shifts_s - taken_s) ** 2))


def _weights(logarithms: Array) -> Array:
    weights = np.exp(logarithms - logarithms.max())
    return np.asarray(weights / weights.sum())
