"""Explanations of a section's fixes: what may be otherwise than stated, and how probable that is beforehand.

The clocks of the sources are searched in `clock_shifts`, bad stretches in `bad_stretches`.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import log, log1p, pi

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.fix_checks.dead_reckoned_path import ReckonedPoints
from pdr_est.estimators.fix_checks.outlier_weights import WeighedFixes, weigh, widened
from pdr_est.estimators.fix_checks.position_regression import Regression, log_evidence, regress
from pdr_est.estimators.fix_checks.section import FixTable, Section
from pdr_est.frames import Array
from pdr_est.types.measurements import START_SOURCE

LEAST_FIXES = 4
"""Fewer fixes of a source tell nothing about it as a whole."""

_LOG_WRONG_HEADING, _LOG_UNUSUAL = log(0.02), log(0.01)  # of a given start heading, and of a length scale (ours)
SIGMA_UNUSUAL_SCALE = 0.2
"""Standard deviation of the length scale of a walk that shows an unusual one; ours."""
_LOG_SHIFTED = log(0.05)  # of the clock of a source (our choice), whose error is then a few seconds, seldom more
_SCALE_SHIFT_S = 3.0  # half of the clocks that are wrong; their errors have a Cauchy distribution
SHIFT_STEP_S = 0.5
"""Resolution of clock corrections, s."""

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
    log_prior
        Logarithm of its probability before the measurements.
    """

    source: int
    begin_s: float
    end_s: float
    sigma_m: float
    log_prior: float

    def has(self, fixes: FixTable) -> NDArray[np.bool_]:
        """Find the fixes (n,) in the stretch."""
        inside = (fixes.time_s >= self.begin_s) & (fixes.time_s <= self.end_s)
        return np.asarray(inside & (fixes.source == self.source))


@dataclass(frozen=True)
class Explanation:
    """Differences from what is stated; none by default.

    Attributes
    ----------
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

    heading_wrong: bool = False
    unusual_scale: bool = False
    shift_s: tuple[tuple[int, float], ...] = ()
    factor: tuple[tuple[int, float], ...] = ()
    stretches: tuple[BadStretch, ...] = ()
    step_factor: float = 1.0

    @property
    def log_prior(self) -> float:
        """Logarithm of its probability before the measurements."""
        logarithm = self.heading_wrong * _LOG_WRONG_HEADING + self.unusual_scale * _LOG_UNUSUAL
        logarithm += sum(_LOG_OTHER_ACCURACY + _log_factor(factor) for _, factor in self.factor)
        logarithm += sum(_log_shift(shift_s) for _, shift_s in self.shift_s)
        logarithm += sum(stretch.log_prior for stretch in self.stretches)
        if self.step_factor != 1.0:
            logarithm += _LOG_WORSE_STEPS + _log_factor(self.step_factor)
        return logarithm

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


def as_stated(section: Section, now: Explained) -> Regression:
    """Compare the fixes of a section with every error as an explanation states it, outliers or not."""
    fixes, points, common_m2, _, _ = _assumed(section, now.explanation)
    solved = now.weighed.regression
    return regress(fixes.position_m, points.position_m, common_m2, fixes.white_m2, solved.prior, solved.heading_rad)


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
    count, others = common_m2.shape
    both = np.zeros((count, 2, others, 2))
    both[:, 0, :, 0] = both[:, 1, :, 1] = common_m2
    return both.reshape(2 * count, 2 * others)


def _assumed(
    section: Section, explanation: Explanation
) -> tuple[FixTable, ReckonedPoints, Array, tuple[float, float] | None, float]:
    """Return fixes, points, their common covariance, heading and sigma of the scale under an explanation."""
    fixes = explanation.apply(section.compared)
    points, of_path = section.path_under(explanation.shifts(fixes))
    heading = None if explanation.heading_wrong else section.heading
    sigma_scale = max(section.sigma_scale, SIGMA_UNUSUAL_SCALE) if explanation.unusual_scale else section.sigma_scale
    common_m2 = explanation.step_factor**2 * of_path + spread_m2(explanation.common_m2(fixes, fixes))
    return fixes, points, common_m2, heading, sigma_scale


def checked_sources(now: Explained) -> list[int]:
    """List the sources that have enough fixes to be judged as a whole."""
    counts = [np.count_nonzero(now.fixes.source == number) for number in range(len(now.fixes.names))]
    return [i for i, name in enumerate(now.fixes.names) if name != START_SOURCE and counts[i] >= LEAST_FIXES]


def further_explanations(section: Section, now: Explained) -> Iterator[Explanation]:
    """Yield explanations with one more difference from what is stated, apart from clocks and stretches."""
    known = now.explanation
    if section.heading is not None and not known.heading_wrong:
        yield replace(known, heading_wrong=True)
    if not known.unusual_scale and 0.0 < section.sigma_scale < SIGMA_UNUSUAL_SCALE:
        yield replace(known, unusual_scale=True)
    if known.step_factor == 1.0:
        yield from worse_steps(known)
    for source in checked_sources(now):
        if source not in dict(known.factor):
            yield from other_accuracies(known, source)


def other_accuracies(known: Explanation, source: int) -> list[Explanation]:
    """Return the explanations by other accuracies of a source."""
    return [replace(known, factor=(*known.factor, (source, factor))) for factor in _FACTORS]


def worse_steps(known: Explanation) -> list[Explanation]:
    """Return the explanations by steps that are worse than usual."""
    return [replace(known, step_factor=factor) for factor in _FACTORS]


def evidence_alone(section: Section, explanation: Explanation, like: Explained) -> float:
    """Return the logarithm of the evidence of an explanation, with the weights of the fixes under another one.

    It is a fraction of the work of weighing the fixes again.
    """
    fixes, points, common_m2, _, _ = _assumed(section, explanation)
    solved, white_m2 = like.weighed.regression, widened(fixes.white_m2, like.weighed.more_m2)
    return log_evidence(fixes.position_m, points.position_m, common_m2, white_m2, solved.prior, solved.heading_rad)


def _log_factor(factor: float) -> float:
    """Return the logarithm of the probability of a factor on stated errors, among those that are not 1."""
    return -0.5 * (log(factor) / _SIGMA_LOG_FACTOR) ** 2


def _log_shift(shift_s: float) -> float:
    """Return the logarithm of the probability of a clock correction."""
    if shift_s == 0.0:
        return 0.0
    return _LOG_SHIFTED + log(SHIFT_STEP_S / (pi * _SCALE_SHIFT_S)) - log1p((shift_s / _SCALE_SHIFT_S) ** 2)


def _by_source(fixes: FixTable, values: tuple[tuple[int, float], ...], default: float) -> Array:
    of_source = np.full(len(fixes.names), default)
    for source, value in values:
        of_source[source] = value
    return np.asarray(of_source[fixes.source])
