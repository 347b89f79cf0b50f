"""Comparison of the fixes of a walk with its steps before the walk is smoothed: `check_fixes`.

Fixes that agree with the steps and with each other stay as they are. Otherwise explanations are compared by their
evidence: single outliers, bad stretches, a wrong accuracy or clock of a source, a wrong start heading, an unusual
length scale. The fixes, and what else is given, are then changed as the best explanation says, and findings tell it.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.estimators.blas_threads import one_blas_thread
from pdr_est.estimators.common.length_scale_check import UNUSUAL_SIGMAS
from pdr_est.estimators.common.measurement_checks import GivenFixes, given_at, is_repeated, with_given
from pdr_est.estimators.fix_checks.adjusted_fixes import SectionResult, adjusted, adjusted_steps, weigh_all
from pdr_est.estimators.fix_checks.bad_stretches import likely_stretches
from pdr_est.estimators.fix_checks.clock_shifts import far_shifts, likely_shift
from pdr_est.estimators.fix_checks.dead_reckoned_path import DeadReckonedPath
from pdr_est.estimators.fix_checks.explanations import (
    Explained,
    Explanation,
    as_stated,
    checked_sources,
    degrees_of_freedom,
    further_explanations,
    weigh_under,
    with_rest_spread,
    with_worse_steps,
)
from pdr_est.estimators.fix_checks.fix_findings import repeated_finding, section_findings
from pdr_est.estimators.fix_checks.position_regression import Regression
from pdr_est.estimators.fix_checks.remaining_doubt import remaining_doubt, step_doubt
from pdr_est.estimators.fix_checks.section import Section, sections_of, table_of
from pdr_est.frames import Array
from pdr_est.types.findings import Finding
from pdr_est.types.measurements import DeviceMeasurements, PositionFix, StartPose, StepOdometry

_MOST_ROUNDS = 5  # differences from what is stated, one after another
_MISFIT = 2.0  # standard deviations of the sum of squared residuals from which on explanations are compared; ours
_GROSS = 1e-3  # probability of a larger one below which a clock may be wrong by more than a few seconds; ours
_WENT_ON_M = 0.5  # from which on the walker has gone on while a source repeated itself; ours
_LIKELY = 0.2  # probability of an outlier from which on they are compared, too; ours


@dataclass(frozen=True)
class CheckedWalk:
    """Measurements of a walk after the comparison.

    Attributes
    ----------
    devices
        Measurements of each device; the same objects where nothing was changed.
    start
        Start pose, of which a heading that contradicts the fixes is taken away.
    sigma_length_scale
        Standard deviation of the length scale, which is larger where the walk shows an unusual one.
    findings
        What does not fit.
    """

    devices: tuple[DeviceMeasurements, ...]
    start: StartPose
    sigma_length_scale: float
    findings: tuple[Finding, ...] = ()


def check_fixes(devices: Sequence[DeviceMeasurements], start: StartPose, sigma_length_scale: float) -> CheckedWalk:
    """Compare the fixes of a walk with the steps of the device that has most of them.

    Parameters
    ----------
    devices
        Measurements of each device; the fixes of the walk stand among those of every device.
    start
        Start pose as far as it is known.
    sigma_length_scale
        Standard deviation of the length scale around 1.
    """
    unchanged = CheckedWalk(tuple(devices), start, sigma_length_scale)
    given = [m for m in devices[0].measurements if isinstance(m, PositionFix)] if devices else []
    if not devices or len(given) + (start.position_m is not None) < 2:
        return unchanged
    steps_of = {one.device: _steps(one) for one in devices}
    main = max(devices, key=lambda one: len(steps_of[one.device]))
    if not steps_of[main.device]:
        return unchanged
    with one_blas_thread():
        path = DeadReckonedPath(main.start_s, steps_of[main.device])
        fixes, findings = _without_repeats(given, path)
        heading = None if start.heading_rad is None else (start.heading_rad, max(start.sigma_heading_rad, 1e-3))
        table = table_of(fixes, start, float(path.time_s[0]))
        results = [_examined(one) for one in sections_of(path, table, heading, sigma_length_scale)]
    findings = [*findings, *section_findings(results)]
    if not findings and len(fixes) == len(given) and not any(one.examined for one in results):
        return unchanged
    return CheckedWalk(
        tuple(_changed_device(one, adjusted(fixes, results), results) for one in devices),
        _changed(start, results[0]),
        max(result.sigma_scale for result in results),
        tuple(findings),
    )


def _examined(section: Section) -> SectionResult:
    """Find the best explanation of a section; a section that fits costs one comparison."""
    from scipy.special import chdtrc  # slow to load, and not needed for a walk without fixes

    now = weigh_under(section, Explanation())
    result, stated, freedom = weigh_all(section, now), as_stated(section, now), degrees_of_freedom(section, now)
    if _fits(section, stated, freedom, result):
        return result
    gross = bool(chdtrc(freedom, stated.squared) < _GROSS)
    for number in range(_MOST_ROUNDS):
        tried = [weigh_under(section, one) for one in _one_more(section, now, far=gross and number == 0)]
        better = max(tried, key=lambda one: one.score, default=now)
        if better.score <= now.score:
            break
        now = better
    steps = step_doubt(section, now)
    now = with_worse_steps(section, now)
    doubts = remaining_doubt(section, now)
    now, spread_m = with_rest_spread(section, now)
    misfit = (stated.squared, freedom)
    return replace(weigh_all(section, now), doubts=doubts, spread_m=spread_m, steps=steps, misfit=misfit)


def _one_more(section: Section, now: Explained, far: bool) -> list[Explanation]:
    """Return explanations with one more difference from what is stated. far: search the clocks up to a minute."""
    clocks = []
    for source in checked_sources(now):
        if source not in dict(now.explanation.shift_s) and source not in now.fixes.known_clocks:
            clocks.append(likely_shift(section, now, source))
            clocks += far_shifts(section, now, source) if far else []
    return [*further_explanations(section, now), *clocks, *likely_stretches(now)]


def _fits(section: Section, stated: Regression, freedom: int, result: SectionResult) -> bool:
    """Tell whether nothing about a section needs an explanation."""
    if freedom <= 0:
        return True
    if stated.squared > freedom + _MISFIT * np.sqrt(2.0 * freedom) or np.any(result.outlier > _LIKELY):
        return False
    if abs(stated.log_scale) > UNUSUAL_SIGMAS * section.sigma_scale > 0.0:
        return False
    if section.heading is None:
        return True
    off_rad = np.angle(np.exp(1j * (stated.heading_rad - section.heading[0])))
    return bool(abs(off_rad) < UNUSUAL_SIGMAS * section.heading[1])


def _without_repeats(given: Sequence[PositionFix], path: DeadReckonedPath) -> tuple[list[PositionFix], list[Finding]]:
    """Leave out fixes that repeat an earlier one of their source; those of a walker who stands are not told."""
    ordered = sorted(given, key=lambda one: one.time_s)
    walked_m = path.at(np.array([fix.time_s for fix in ordered])).position_m
    kept: list[PositionFix] = []
    earlier: defaultdict[str, GivenFixes] = defaultdict(tuple)
    last: dict[tuple[str, float, float], tuple[float, Array]] = {}
    stale = 0
    for fix, place_m in zip(ordered, walked_m, strict=True):
        key = (fix.source, *given_at(fix)[1:])
        before_s, there_m = last.get(key, (-np.inf, place_m))
        last[key] = fix.time_s, place_m
        if is_repeated(earlier[fix.source], fix):
            stale += fix.time_s == before_s or np.hypot(*(place_m - there_m)) > _WENT_ON_M
        else:
            kept.append(fix)
        earlier[fix.source] = with_given(earlier[fix.source], fix)
    return kept, [repeated_finding(stale, len(given))] if stale else []


def _changed(start: StartPose, first: SectionResult) -> StartPose:
    """Return the start pose without a heading that is wrong, and with a wider position where that is wrong."""
    if first.explained.explanation.heading_wrong:
        start = replace(start, heading_rad=None, sigma_heading_rad=0.0)
    sigma_m = np.sqrt(start.sigma_position_m**2 + first.start_more_m2)
    return start if start.position_m is None else replace(start, sigma_position_m=float(sigma_m))


def _changed_device(
    one: DeviceMeasurements, fixes: Sequence[PositionFix], results: Sequence[SectionResult]
) -> DeviceMeasurements:
    """Put other fixes and steps in place of those of a device."""
    others = tuple(m for m in one.measurements if not isinstance(m, PositionFix | StepOdometry))
    return replace(one, measurements=(*adjusted_steps(_steps(one), results), *others, *fixes))


def _steps(one: DeviceMeasurements) -> list[StepOdometry]:
    return [m for m in one.measurements if isinstance(m, StepOdometry) and m.device == one.device]
