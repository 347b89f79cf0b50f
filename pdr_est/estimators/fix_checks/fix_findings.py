"""Findings of the comparison of fixes and steps, in words."""

from collections.abc import Sequence
from math import degrees, sqrt

import numpy as np

from pdr_est.estimators.fix_checks.adjusted_fixes import SectionResult
from pdr_est.estimators.fix_checks.explanations import BadStretch
from pdr_est.frames import wrap_angle
from pdr_est.types.findings import Finding, FindingKind

_WRONG = 0.5  # probability from which a fix is told to be an outlier
_MUCH_WORSE = 1.4  # factor on the stated errors from which it is told
_SURE = 0.95  # probability of worse steps from which it is told that it is the steps
_ROUND_M = 3.0  # from which metres are told without decimals
# Probability of a larger chi-squared below which a misfit is told: two standard deviations, one side.
_IMPROBABLE = 0.0228
_MANY = 0.1  # share of repeated fixes from which it is worth a look


def section_findings(results: Sequence[SectionResult]) -> list[Finding]:
    """Say what does not fit in the sections of a walk."""
    found = [finding for result in results for finding in _of_section(result)]
    return [*found, *_outliers(results)]


def repeated_finding(repeats: int, count: int) -> Finding:
    """Say that a source repeats its fixes."""
    message = f"{repeats} of {count} position fixes repeat the one before: each counts once"
    return Finding(FindingKind.FIXES, message, value=float(repeats), doubtful=repeats > _MANY * count)


def _of_section(result: SectionResult) -> list[Finding]:
    explanation, table = result.explained.explanation, result.section.table
    begin_s, end_s = float(table.time_s[0]), float(table.time_s[-1])
    found = [_stretch(result, one) for one in explanation.stretches]
    for source, shift_s in explanation.shift_s:
        late = "late" if shift_s < 0.0 else "early"
        message = f"the clock of the fixes ({table.names[source]}) is {abs(shift_s):.1f} s {late}: corrected"
        found.append(Finding(FindingKind.FIX_CLOCK, message, "", begin_s, end_s, shift_s, 0.5))
    factors = dict(explanation.factor) | {one.source: one.factor for one in result.doubts}
    for source, factor in factors.items():
        if factor > _MUCH_WORSE:
            message = f"the fixes ({table.names[source]}) err {factor:.1f} times as much as stated: weighed down"
            found.append(Finding(FindingKind.FIX_ACCURACY, message, "", begin_s, end_s, factor))
    if explanation.heading_wrong and result.section.heading is not None:
        found.append(_start_heading(result, *result.section.heading))
    found += _start_position(result)
    told = bool(found) or np.any(result.outlier > _WRONG)
    return [*found, *_misfit(result, begin_s, end_s, bool(told))]


def _start_position(result: SectionResult) -> list[Finding]:
    """Say that a given start position disagrees with the fixes."""
    wrong = np.flatnonzero((result.section.table.index < 0) & (result.outlier > _WRONG))
    if not len(wrong):
        return []
    distance_m = float(np.hypot(*result.left_out_m[wrong[0]]))
    message = f"the start position disagrees with the steps and the fixes by {distance_m:.0f} m: weighed down"
    return [Finding(FindingKind.FIXES, message, value=distance_m)]


def _misfit(result: SectionResult, begin_s: float, end_s: float, told: bool) -> list[Finding]:
    """Say in one statement that fixes and steps do not fit, and which of them are wrong if anything tells it."""
    spread_m, table, (squared, freedom) = result.spread_m, result.section.table, result.misfit
    if spread_m is None:
        return []
    span = f"between {begin_s:.0f} s and {end_s:.0f} s"
    steps_too = "; the steps count less, too" if result.explained.explanation.step_factor > 1.0 else ""
    if spread_m > np.median(table.sigma_m):
        message = (
            f"position fixes {span} contradict each other or the steps, and nothing tells which is wrong: "
            f"{spread_m:.{0 if spread_m > _ROUND_M else 1}f} m are added to the error of each{steps_too}"
        )
        return [Finding(FindingKind.FIXES, message, "", begin_s, end_s, spread_m)]
    if result.steps.probability > _SURE and result.steps.factor > _MUCH_WORSE:
        message = (
            f"the steps {span} disagree with the fixes {result.steps.factor:.1f} times as much as usual: they count "
            "less"
        )
        return [Finding(FindingKind.STEPS, message, "", begin_s, end_s, result.steps.factor)]
    from scipy.special import chdtrc  # slow to load, and not needed for a walk without fixes

    if told or chdtrc(freedom, squared) > _IMPROBABLE:
        return []
    message = (
        f"position fixes {span} and the steps fit badly (chi-squared {squared:.0f} for {freedom} degrees of "
        f"freedom), and nothing tells which are wrong: {'the steps count less' if steps_too else 'all stay as given'}"
    )
    return [Finding(FindingKind.FIXES, message, "", begin_s, end_s, squared)]


def _start_heading(result: SectionResult, given_rad: float, sigma_rad: float) -> Finding:
    solved = result.explained.weighed.regression
    off_rad = float(wrap_angle(solved.heading_rad - given_rad))
    message = (
        f"start heading {degrees(given_rad):.0f}° ± {degrees(sigma_rad):.0f}° contradicts the fixes by "
        f"{degrees(abs(off_rad)):.0f}°: the heading is taken from the fixes"
    )
    return Finding(FindingKind.START_HEADING, message, value=off_rad, sigma=sigma_rad)


def _stretch(result: SectionResult, stretch: BadStretch) -> Finding:
    """Say where fixes of a source have a common error, and how far they are from the steps."""
    table = result.section.table
    inside = stretch.has(table)
    distance_m = _distance_without(result, stretch)
    begin_s, end_s = float(table.time_s[inside][0]), float(table.time_s[inside][-1])
    name = "GPS" if table.names[stretch.source] == "gps" else f"fixes ({table.names[stretch.source]})"
    span = f"between {begin_s:.0f} s and {end_s:.0f} s"
    message = f"{name} {span} disagrees with the steps by {distance_m:.0f} m: weighed down"
    return Finding(FindingKind.FIXES, message, "", begin_s, end_s, distance_m, stretch.sigma_m)


def _distance_without(result: SectionResult, stretch: BadStretch) -> float:
    """Return the root mean square distance of the compared fixes of a stretch from what all others predict, m."""
    solved = result.explained.weighed.regression
    block = np.flatnonzero(stretch.has(result.explained.fixes))
    rows = np.stack([2 * block, 2 * block + 1], axis=1).ravel()
    residual = np.linalg.solve(solved.information[np.ix_(rows, rows)], solved.pulled[rows])
    return sqrt(float(np.square(residual).sum()) / len(block))


def _outliers(results: Sequence[SectionResult]) -> list[Finding]:
    """Say which single fixes are wrong."""
    rows = [(result, row) for result in results for row in np.flatnonzero(result.outlier > _WRONG)]
    rows = [(result, row) for result, row in rows if result.section.table.index[row] >= 0]
    if not rows:
        return []
    count = sum(int(np.count_nonzero(result.section.table.index >= 0)) for result in results)
    times_s = [float(result.section.table.time_s[row]) for result, row in rows]
    distance_m = sqrt(float(np.mean([np.square(result.left_out_m[row]).sum() for result, row in rows])))
    where = f"at {times_s[0]:.1f} s" if len(rows) == 1 else f"between {min(times_s):.0f} s and {max(times_s):.0f} s"
    message = (
        f"{len(rows)} of {count} position fixes, {where}, disagree with the steps and the other fixes by "
        f"{distance_m:.0f} m: weighed down"
    )
    return [Finding(FindingKind.FIXES, message, "", min(times_s), max(times_s), distance_m)]
