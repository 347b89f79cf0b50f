"""Explanations of a section's fixes: what may be otherwise than stated, and how probable that is beforehand."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import log

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.fix_checks.dead_reckoned_path import ReckonedPoints
from pdr_est.estimators.fix_checks.outlier_weights import WeighedFixes, weigh, widened
from pdr_est.estimators.fix_checks.position_regression import regress
from pdr_est.estimators.fix_checks.section import FixTable, Section
from pdr_est.frames import Array
from pdr_est.types.measurements import START_SOURCE

LEAST_FIXES = 4
"""Fewer fixes of a source tell nothing about it as a whole."""

_LOG_WRONG_HEADING, _LOG_UNUSUAL = log(0.02), log(0.01)  # of a given start heading, and of a length scale (ours)
SIGMA_UNUSUAL_SCALE = 0.2
"""Standard deviation of the length scale of a walk that shows an unusual one; ours."""
_LOG_SHIFTED = log(0.05)  # of the clock of a source (our choice), whose error is then a few seconds
_SIGMA_SHIFT_S, _SHIFT_STEP_S = 3.0, 0.5
_SHIFTS_S = tuple(_SHIFT_STEP_S * k for k in range(-16, 17))
_GROWTH, _MOST_SPREAD_M = 1.25, 1e4  # of the added standard deviation
_FACTORS = (1.5, 2.2, 3.3, 5.0, 8.0)
_LOG_OTHER_ACCURACY, _SIGMA_LOG_FACTOR = log(0.1), 0.8  # also phones that state a wrong accuracy state one
_LOG_WORSE_STEPS = log(0.3)  # of a walk, on stairs or with a phone that is moved (our choice)
_MOST_STEP_FACTOR = 4.0  # ours


@dataclass(frozen=True)
class BadStretch:
    """Stretch of time in which the fixes of a source have a common error on top of that which they state.

    Attributes
    ----------
    source
        Number of the source.
    begin_s, end_s
        Stretch, s.
    sigma_m
        Standard deviation of the error in each coordinate, m.
    """

    source: int
    begin_s: float
    end_s: float
    sigma_m: float

    def has(self, fixes: FixTable) -> NDArray[np.bool_]:
        """Find the fixes (n,) in the stretch."""
        inside = (fixes.time_s >= self.begin_s) & (fixes.time_s <= self.end_s)
        return np.asarray(inside & (fixes.source == self.source))


@dataclass(frozen=True)
class Explanation:
    """Differences from what is stated; none by default.

    Attributes
    ----------
    log_prior
        Logarithm of its probability before the measurements.
    heading_wrong
        True if the given start heading is wrong.
    unusual_scale
        True if the length scale lies outside of the usual range.
    shift_s
        Correction of the clock of a source, s, by its number.
    factor
        Factor on the stated errors of a source, by its number.
    stretches
        Bad stretches.
    step_factor
        Factor on the standard deviations of the steps.
    """

    log_prior: float = 0.0
    heading_wrong: bool = False
    unusual_scale: bool = False
    shift_s: tuple[tuple[int, float], ...] = ()
    factor: tuple[tuple[int, float], ...] = ()
    stretches: tuple[BadStretch, ...] = ()
    step_factor: float = 1.0

    def shifts(self, fixes: FixTable) -> Array:
        """Return the clock correction (n,) of each fix, s."""
        return _by_source(fixes, self.shift_s, 0.0)

    def apply(self, fixes: FixTable) -> FixTable:
        """Return the fixes with the errors that their sources then have."""
        factor = _by_source(fixes, self.factor, 1.0)
        return replace(
            fixes,
            white_m2=fixes.white_m2 * (factor**2)[:, None, None],
            sigma_wander_m=fixes.sigma_wander_m * factor,
        )

    def common_m2(self, some: FixTable, others: FixTable) -> Array:
        """Return the covariance (n, k) of the common errors of fixes and others in each coordinate, m²."""
        covariance = some.wander_m2(others)
        for stretch in self.stretches:
            apart_s = np.abs(some.time_s[:, None] - others.time_s) / some.wander_time_s[:, None]
            inside = np.outer(stretch.has(some), stretch.has(others))
            covariance = covariance + inside * stretch.sigma_m**2 * np.exp(-apart_s)
        return covariance


@dataclass(frozen=True)
class Explained:
    """An explanation with the fixes that were compared under it.

    Attributes
    ----------
    explanation
        The explanation.
    fixes
        Fixes that were compared, with the errors under the explanation.
    points
        Points of the path at their times.
    weighed
        What came out.
    """

    explanation: Explanation
    fixes: FixTable
    points: ReckonedPoints
    weighed: WeighedFixes

    @property
    def score(self) -> float:
        """Logarithm of evidence and prior probability together."""
        return self.weighed.score + self.explanation.log_prior


def weigh_under(section: Section, explanation: Explanation) -> Explained:
    """Weigh the fixes of a section under an explanation."""
    fixes, points, common_m2, heading, sigma_scale = _assumed(section, explanation)
    weighed = weigh(fixes, points.position_m, common_m2, heading, sigma_scale)
    return Explained(explanation, fixes, points, weighed)


def degrees_of_freedom(section: Section, now: Explained) -> int:
    """Return the number of coordinates less what is found from them: the place, and a heading that is unknown."""
    unknown = section.heading is None or now.explanation.heading_wrong
    return 2 * len(now.fixes) - (3 if unknown else 2)


def with_rest_spread(section: Section, now: Explained) -> tuple[Explained, float]:
    """Spread what an explanation leaves unexplained over all fixes, so that the residuals are as large as expected.

    Nothing tells then which of the fixes is wrong. It is the ratio of R. T. Birge, Phys. Rev. 40 (1932), by an added
    variance.

    Returns
    -------
    Explained
        The explanation with the added variances.
    float
        Standard deviation that was added in each coordinate, m.
    """
    fixes, points, common_m2, _, _ = _assumed(section, now.explanation)
    solved, expected = now.weighed.regression, degrees_of_freedom(section, now)
    given = np.array([fixes.names[source] != START_SOURCE for source in fixes.source])
    added_m = 0.0
    more_m2 = now.weighed.more_m2
    while solved.squared > expected > 0 and added_m < _MOST_SPREAD_M:
        added_m = max(_GROWTH * added_m, 0.3 * float(np.median(fixes.sigma_m)))
        more_m2 = now.weighed.more_m2 + given * added_m**2
        solved = regress(
            fixes.position_m,
            points.position_m,
            common_m2,
            widened(fixes.white_m2, more_m2),
            solved.prior,
            solved.heading_rad,
        )
    return replace(now, weighed=replace(now.weighed, more_m2=more_m2, regression=solved)), added_m


def with_worse_steps(section: Section, now: Explained) -> Explained:
    """Widen the steps until the residuals are as large as expected, as far as steps can be that wrong.

    Steps are wrong more often than surveyed points, on stairs or where the walker moves sideways; a misfit of a few
    metres is theirs first.
    """
    freedom = degrees_of_freedom(section, now)
    while now.weighed.regression.squared > freedom > 0 and now.explanation.step_factor < _MOST_STEP_FACTOR:
        wider = replace(now.explanation, step_factor=_GROWTH * now.explanation.step_factor)
        now = weigh_under(section, wider)
    return now


def spread_m2(common_m2: Array) -> Array:
    """Return the covariance (2 n, 2 k) of two coordinates, each of which has the covariance (n, k)."""
    return np.asarray(np.kron(common_m2, np.eye(2)))


def first_pose(points: ReckonedPoints) -> int:
    """Return the number of the pose from which the errors of a section's path count."""
    return int(points.pose.min())


def _assumed(
    section: Section, explanation: Explanation
) -> tuple[FixTable, ReckonedPoints, Array, tuple[float, float] | None, float]:
    """Return fixes, points, their common covariance, heading and sigma of the scale under an explanation."""
    fixes = explanation.apply(section.table.rows(section.chosen))
    points = section.path.at(fixes.time_s + explanation.shifts(fixes))
    of_path = explanation.step_factor**2 * section.path.covariance(points, points, first_pose(points))
    heading = None if explanation.heading_wrong else section.heading
    sigma_scale = max(section.sigma_scale, SIGMA_UNUSUAL_SCALE) if explanation.unusual_scale else section.sigma_scale
    return fixes, points, of_path + spread_m2(explanation.common_m2(fixes, fixes)), heading, sigma_scale


def checked_sources(now: Explained) -> list[int]:
    """List the sources that have enough fixes to be judged as a whole."""
    counts = [np.count_nonzero(now.fixes.source == number) for number in range(len(now.fixes.names))]
    return [i for i, name in enumerate(now.fixes.names) if name != START_SOURCE and counts[i] >= LEAST_FIXES]


def further_explanations(section: Section, now: Explained) -> Iterator[Explanation]:
    """Yield explanations with one more difference from what is stated."""
    known = now.explanation
    if section.heading is not None and not known.heading_wrong:
        yield replace(known, heading_wrong=True, log_prior=known.log_prior + _LOG_WRONG_HEADING)
    if not known.unusual_scale and 0.0 < section.sigma_scale < SIGMA_UNUSUAL_SCALE:
        yield replace(known, unusual_scale=True, log_prior=known.log_prior + _LOG_UNUSUAL)
    if known.step_factor == 1.0:
        yield from _worse_steps(known)
    for source in checked_sources(now):
        if source not in dict(known.factor):
            yield from other_accuracies(known, source)
        if source not in dict(known.shift_s):
            shifts_s, evidence = shift_evidence(section, now, source)
            yield _shifted(known, source, float(shifts_s[np.argmax(np.where(shifts_s == 0.0, -np.inf, evidence))]))


def other_accuracies(known: Explanation, source: int) -> list[Explanation]:
    """Return the explanations by other accuracies of a source."""
    costs = [(one, _LOG_OTHER_ACCURACY - 0.5 * (log(one) / _SIGMA_LOG_FACTOR) ** 2) for one in _FACTORS]
    return [
        replace(known, factor=(*known.factor, (source, factor)), log_prior=known.log_prior + cost)
        for factor, cost in costs
    ]


def _worse_steps(known: Explanation) -> list[Explanation]:
    """Return the explanations by steps that are worse than usual."""
    costs = [(one, _LOG_WORSE_STEPS - 0.5 * (log(one) / _SIGMA_LOG_FACTOR) ** 2) for one in _FACTORS]
    return [replace(known, step_factor=factor, log_prior=known.log_prior + cost) for factor, cost in costs]


def shift_evidence(section: Section, now: Explained, source: int) -> tuple[Array, Array]:
    """Return clock corrections of a source (k,), s, and the logarithm (k,) of their probabilities.

    The weights of the fixes are those of the present explanation; the logarithms have a constant in common.
    """
    found = [_log_shift(section, now, source, shift_s) for shift_s in _SHIFTS_S]
    return np.array(_SHIFTS_S), np.array(found)


def _log_shift(section: Section, now: Explained, source: int, shift_s: float) -> float:
    weighed, rest = now.weighed, tuple(one for one in now.explanation.shift_s if one[0] != source)
    tried = _shifted(replace(now.explanation, shift_s=rest, log_prior=0.0), source, shift_s)
    fixes, points, common_m2, _, _ = _assumed(section, tried)
    white_m2 = widened(fixes.white_m2, weighed.more_m2)
    solved = weighed.regression
    evidence = regress(
        fixes.position_m, points.position_m, common_m2, white_m2, solved.prior, solved.heading_rad
    ).log_evidence
    return evidence + tried.log_prior


def _shifted(known: Explanation, source: int, shift_s: float) -> Explanation:
    """Return an explanation with one more clock correction."""
    cost = 0.0
    if shift_s != 0.0:
        density = -0.5 * (shift_s / _SIGMA_SHIFT_S) ** 2 - log(_SIGMA_SHIFT_S * np.sqrt(2.0 * np.pi))
        cost = _LOG_SHIFTED + log(_SHIFT_STEP_S) + density
    return replace(known, shift_s=(*known.shift_s, (source, shift_s)), log_prior=known.log_prior + cost)


def _by_source(fixes: FixTable, values: tuple[tuple[int, float], ...], default: float) -> Array:
    of_source = np.full(len(fixes.names), default)
    for source, value in values:
        of_source[source] = value
    return np.asarray(of_source[fixes.source])
