"""Fixes as the explanation of a walk says: wider, in a source of their own, or at another time."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.estimators.fix_checks.explanations import (
    BadStretch,
    Explained,
    Explanation,
    spread_m2,
)
from pdr_est.estimators.fix_checks.outlier_weights import outliers
from pdr_est.estimators.fix_checks.remaining_doubt import USUAL_STEPS, SourceDoubt, StepDoubt
from pdr_est.estimators.fix_checks.section import FixTable, Section
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix, StepOdometry


@dataclass(frozen=True)
class SectionResult:
    """All fixes of a section, n in number, under the explanation of those that were compared.

    Attributes
    ----------
    section
        The section.
    explained
        The explanation.
    outlier
        (n,) probability of each fix to be an outlier.
    more_m2
        (n,) variance that its error has more than the explanation says in each coordinate, m².
    left_out_m
        (n, 2) difference of each fix from its prediction by the compared ones, m.
    doubts
        What the explanation leaves open.
    spread_m
        Standard deviation that the fixes have more because nothing tells which of them is wrong, m.
    steps
        How probable worse steps are.
    misfit
        Sum of the squared normalised residuals if every error is as stated, and its degrees of freedom.
    """

    section: Section
    explained: Explained
    outlier: Array
    more_m2: Array
    left_out_m: Array
    doubts: tuple[SourceDoubt, ...] = ()
    spread_m: float | None = None
    steps: StepDoubt = USUAL_STEPS
    misfit: tuple[float, int] = (0.0, 0)

    @property
    def examined(self) -> bool:
        """Tell whether explanations were compared."""
        return self.spread_m is not None

    @property
    def start_more_m2(self) -> float:
        """Variance that the error of a given start position has more in each coordinate, m²."""
        return float(self.more_m2[self.section.table.index < 0].sum())

    @property
    def sigma_scale(self) -> float:
        """Standard deviation of the length scale that the smoother should take."""
        return max(self.section.sigma_scale, self.explained.weighed.regression.prior.sigma_scale)


def weigh_all(section: Section, explained: Explained) -> SectionResult:
    """Weigh also the fixes of a section that were not compared with each other."""
    weighed, count = explained.weighed, len(section.table)
    outlier, more_m2, left_out_m = np.zeros(count), np.zeros(count), np.zeros((count, 2))
    chosen = section.chosen
    outlier[chosen], more_m2[chosen] = weighed.outlier, weighed.more_m2
    left_out_m[chosen] = weighed.regression.left_out_m
    others = np.setdiff1d(np.arange(count), chosen)
    if len(others):
        fixes = explained.explanation.apply(section.table.rows(others))
        difference_m, spread = _predicted(section, explained, fixes)
        left_out_m[others] = difference_m
        outlier[others], more_m2[others] = outliers(fixes, difference_m, spread)
    return SectionResult(section, explained, outlier, more_m2, left_out_m)


def _predicted(section: Section, explained: Explained, fixes: FixTable) -> tuple[Array, Array]:
    """Predict fixes from those that were compared."""
    explanation, known = explained.explanation, explained.fixes
    points = section.path.at(fixes.time_s + explanation.shifts(fixes))
    begin = min(explained.points.first_pose, points.first_pose)
    worse = explanation.step_factor**2
    with_known = worse * section.path.covariance(points, explained.points, begin)
    own = worse * section.path.variance(points, begin) + _own_common_m2(explained, fixes)[:, None, None] * np.eye(2)
    return explained.weighed.regression.predict(
        fixes.position_m,
        points.position_m,
        with_known + spread_m2(explanation.common_m2(fixes, known)),
        own,
        explained.points.position_m,
    )


def _own_common_m2(explained: Explained, fixes: FixTable) -> Array:
    """Return the variance (n,) of the common error of each fix in a coordinate, m²."""
    variance = np.square(fixes.sigma_wander_m)
    for stretch in explained.explanation.stretches:
        variance = variance + stretch.has(fixes) * stretch.sigma_m**2
    return np.asarray(variance)


def adjusted(fixes: Sequence[PositionFix], results: Sequence[SectionResult]) -> tuple[PositionFix, ...]:
    """Return the fixes with the errors and times of the explanations."""
    changed = list(fixes)
    for result in results:
        explanation = result.explained.explanation
        table = _with_doubts(explanation, result)
        shifts_s = explanation.shifts(table)
        for row, index in enumerate(table.index):
            if index >= 0:
                fix = replace(
                    fixes[index],
                    time_s=fixes[index].time_s + float(shifts_s[row]),
                    covariance_m2=table.white_m2[row] + result.more_m2[row] * np.eye(2),
                    sigma_wander_m=float(table.sigma_wander_m[row]),
                )
                bad = [one for one in explanation.stretches if one.has(table.rows(np.array([row])))[0]]
                changed[index] = _in_stretches(fix, bad)
    return tuple(changed)


def adjusted_steps(steps: Sequence[StepOdometry], results: Sequence[SectionResult]) -> tuple[StepOdometry, ...]:
    """Return the steps with the covariances of the explanations; a step belongs to the section that ends after it."""
    ends_s = np.array([float(result.section.table.time_s[-1]) for result in results])
    factors = [result.explained.explanation.step_factor for result in results]
    if all(factor == 1.0 for factor in factors):
        return tuple(steps)
    own = np.minimum(np.searchsorted(ends_s, [step.time_s for step in steps]), len(results) - 1)
    return tuple(
        step if factors[i] == 1.0 else replace(step, covariance=factors[i] ** 2 * step.covariance)
        for i, step in zip(own.tolist(), steps, strict=True)
    )


def _with_doubts(explanation: Explanation, result: SectionResult) -> FixTable:
    """Return the fixes of a section with the errors of their sources, and with what is left open about these."""
    taken = dict(explanation.factor) | {one.source: one.factor for one in result.doubts}
    table = replace(explanation, factor=tuple(taken.items())).apply(result.section.table)
    sigma_wander_m = table.sigma_wander_m.copy()
    for one in result.doubts:
        own = table.source == one.source
        sigma_wander_m[own] = np.hypot(sigma_wander_m[own], one.sigma_m)
    return replace(table, sigma_wander_m=sigma_wander_m)


def _in_stretches(fix: PositionFix, stretches: Sequence[BadStretch]) -> PositionFix:
    """Return a fix with the common error of its stretches, which is not that of the rest of its source."""
    if not stretches:
        return fix
    sigma_m = float(np.sqrt(fix.sigma_wander_m**2 + sum(one.sigma_m**2 for one in stretches)))
    return replace(fix, source=f"{fix.source} from {stretches[0].begin_s:.1f} s", sigma_wander_m=sigma_m)
