"""Findings that follow from a track and its measurements alone: what does not fit.

* `fix_residuals`: fixes far from the track that the other measurements give.
* `prior_checks`: a direction that nothing tells.
* `closure_check`: a walk that does not end where it is said to.
* `contradictions`: fixes of one moment that contradict each other.
* `north_check`: headings against north that contradict the track.
* `tether_slack`: devices that are farther apart than their tether allows.
* `so_far`: fixes, and an unusual length scale, while a walk goes on.
"""

from collections.abc import Sequence
from dataclasses import replace

from pdr_est.estimators.common.length_scale_check import track_scale_finding
from pdr_est.estimators.spec import EstimatorSpec
from pdr_est.evaluate.walk_findings.closure_check import closure_findings
from pdr_est.evaluate.walk_findings.contradictions import contradictions
from pdr_est.evaluate.walk_findings.fix_residuals import fix_findings
from pdr_est.evaluate.walk_findings.north_check import north_findings
from pdr_est.evaluate.walk_findings.prior_checks import unknown_direction_finding
from pdr_est.evaluate.walk_findings.so_far import FindingsSoFar
from pdr_est.evaluate.walk_findings.tether_slack import tether_findings
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether, PositionFix, StartPose
from pdr_est.types.track import Track

__all__ = ["FindingsSoFar", "findings_of"]

_COMPARED = {FindingKind.FIXES, FindingKind.FIX_ACCURACY, FindingKind.FIX_CLOCK, FindingKind.STEPS}


def findings_of(
    track: Track,
    devices: Sequence[DeviceMeasurements],
    tethers: Sequence[DeviceTether],
    start: StartPose,
    sigma_length_scale: float,
    spec: EstimatorSpec,
) -> tuple[Finding, ...]:
    """Find what does not fit in a walk, apart from what the estimator has found itself.

    Parameters
    ----------
    track
        Track of all devices at the centre of the body, with the findings of the estimator.
    devices, tethers, start, sigma_length_scale
        What the estimator was given.
    spec
        Abilities of the estimator.

    Returns
    -------
    tuple of Finding
        Further findings. Where the estimator has compared fixes and steps itself, or has a finding about the length
        scale or the start heading, there is no second one: it may have used the fixes otherwise than they were given.
    """
    found: list[Finding | None] = []
    known = {finding.kind for finding in track.findings}
    if FindingKind.START_HEADING not in known and not track.on_plan:
        found.append(unknown_direction_finding(devices, start))
    if FindingKind.LENGTH_SCALE not in known:
        found.append(track_scale_finding(track, devices, start, sigma_length_scale))
    if not known & _COMPARED:
        fixes = _fixes_of(devices)
        told = contradictions(fixes)
        found += told
        found += fix_findings(replace(track, findings=(*track.findings, *told)), fixes, spec.uses_fixes)
    found += north_findings(track, devices)
    if spec.uses_closure:
        found += closure_findings(devices, sigma_length_scale)
    if spec.uses_tethers:
        found += tether_findings(track, tethers)
    return tuple(finding for finding in found if finding is not None)


def _fixes_of(devices: Sequence[DeviceMeasurements]) -> list[PositionFix]:
    """List the fixes of the walk in order of time; they all stand among the measurements of each device."""
    fixes = [one for one in devices[0].measurements if isinstance(one, PositionFix)] if devices else []
    return sorted(fixes, key=lambda fix: fix.time_s)
