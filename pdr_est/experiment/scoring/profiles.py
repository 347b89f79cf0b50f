"""Metrics of a walk whose walker's step length was learnt from the other walks of the same person.

Each walk with true positions plays the walk of a user who had a few fixes: the true positions that `held_out` gives
tell its length scale (`calibration.scale_by_fixes`). The walk that is scored gets no fix, and its own true positions
tell nothing: its scale is that of a profile of all other walks of its group (`calibration.step_length_fit`).

A group is a person where the data set names one. Where it does not, it is the walks of a place or a folder; these are
of several people, so that a walk deviates from the group as much as people do from each other
(`SIGMA_OF_SEVERAL`), and the scale that they share is that of the place, the phones and the recorder.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from pdr_est.calibration.scale_by_fixes import observe_any_fixes
from pdr_est.calibration.step_length_fit import (
    SIGMA_LOG_SCALE,
    SIGMA_WALK,
    Calibration,
    CalibrationSteps,
    NotLearnt,
    ScaleObservation,
    fit_calibration,
    observe_scale,
)
from pdr_est.errors import PdrError
from pdr_est.evaluate.position_errors import ate_rigid, within_sigma
from pdr_est.evaluate.time_association import Association
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.held_out import HeldOut
from pdr_est.experiment.scoring.track_scores import MetricPart
from pdr_est.experiment.suite import CalibrationCase, ProfileGroup
from pdr_est.frames import Array
from pdr_est.types.outcome import TrackOutcome

PROFILE_METRICS = ("ate_rigid_profile_m", "length_ratio_profile", "scale_coverage68_profile")

SIGMA_OF_SEVERAL = math.hypot(SIGMA_LOG_SCALE, SIGMA_WALK)
"""Deviation of the walks of several people from their mean, in the logarithm of their length."""


@dataclass(frozen=True)
class PositionCase:
    """A walk with true positions as it takes part in learning.

    Attributes
    ----------
    observation : ScaleObservation or None
        Scale that its fixes tell.
    log_cadence : float
        Mean logarithm of the steps per second, weighted by step length.
    track_m, truth_m : Array
        Positions (n, 2), m, of the track from the sensors alone, and true ones at the same times.
    length_ratio : float
        Length of the track over that of the true way.
    """

    observation: ScaleObservation | None
    log_cadence: float
    track_m: Array
    truth_m: Array
    length_ratio: float

    def errors(self, calibration: Calibration) -> Mapping[str, float]:
        """Compute the metrics of the walk with the learnt scale, for the mean cadence of the walk."""
        away = self.log_cadence - math.log(calibration.reference_cadence_hz)
        scale = math.exp(float(calibration.mean[0] + calibration.mean[1] * away))
        ratio = scale * self.length_ratio
        values = (
            ate_rigid(scale * self.track_m, self.truth_m),
            ratio,
            within_sigma(ratio, 1.0, calibration.sigma_next),
        )
        return dict(zip(PROFILE_METRICS, values, strict=True))


def profile_part(
    walk: AnalysedWalk, name: str, pairs: Association, held_out: HeldOut, length_ratio: float
) -> MetricPart:
    """Make the part of a track that other walks can learn from, and that is scored after learning from them.

    It is empty for an estimator that makes no use of fixes, and so learns nothing, and for a walk without steps.

    Parameters
    ----------
    walk : AnalysedWalk
        The walk.
    name : str
        The device, or "fused".
    pairs : Association
        Poses of the track from the sensors alone, and true positions.
    held_out : HeldOut
        Which of the true positions are fixes.
    length_ratio : float
        Length of the track over that of the true way.
    """
    if not walk.config.estimator.make().spec.uses_fixes:
        return MetricPart()
    devices = [device for device in walk.devices if device.device == name] or list(walk.devices)
    steps = [CalibrationSteps.from_steps(device.steps) for device in devices]
    if not any(len(device.length_m) for device in steps):
        return MetricPart()
    try:
        told = observe_any_fixes(devices, walk.config, held_out.fixes(pairs), walk.recording.name)
        seen = None if isinstance(told, NotLearnt) else told
    except PdrError:  # the fixes do not fit: nothing for others to learn
        seen = None
    log_cadence = observe_scale(steps, 1.0).log_cadence
    case = PositionCase(seen, log_cadence, pairs.track_m, pairs.truth_m, length_ratio)
    return MetricPart(calibration=case)


def with_profiles(
    rows: Sequence[TrackOutcome],
    cases: Sequence[CalibrationCase | None],
    group_of: Callable[[TrackOutcome], ProfileGroup | None],
) -> tuple[tuple[TrackOutcome, ...], dict[str, str]]:
    """Add the metrics after learning from all other walks of the same group, track and variant to the rows.

    Parameters
    ----------
    rows : sequence of TrackOutcome
        Scored tracks of all walks.
    cases : sequence of CalibrationCase or None
        Case of each row; None where there is none.
    group_of : Callable
        Finds the group of a row; None for a walk that learns from no other.

    Returns
    -------
    rows : tuple of TrackOutcome
        The completed rows.
    missing : dict
        Walk -> reason why these metrics are missing.
    """
    completed, missing = list(rows), {}
    groups = [group_of(row) for row in rows]
    for i, (row, case, group) in enumerate(zip(rows, cases, groups, strict=True)):
        if case is None:
            continue
        seen = [
            other.observation
            for candidate, other, others_group in zip(rows, cases, groups, strict=True)
            if group is not None
            and others_group == group
            and candidate.walk != row.walk
            and (candidate.variant, candidate.track) == (row.variant, row.track)
            and other is not None
            and other.observation is not None
        ]
        if group is None or not seen:
            whom = "a person who is not known" if group is None else group.name
            missing[row.walk] = f"{', '.join(PROFILE_METRICS)}: no other walk of {whom} to learn from"
        else:
            errors = case.errors(fit_calibration(seen, group.sigma_walk))
            completed[i] = replace(row, metrics={**row.metrics, **errors})
    return tuple(completed), missing


def person_or_folder(row: TrackOutcome) -> ProfileGroup | None:
    """Group walks by the person within the uppermost folder; where nobody is named, by the folder alone."""
    place, person = row.walk.rpartition("/")[0].partition("/")[0], row.labels.get("person", "unknown")
    if person != "unknown":
        return ProfileGroup(f"{place}/{person}".lstrip("/"), SIGMA_WALK)
    return ProfileGroup(place, SIGMA_OF_SEVERAL) if place else None


def uppermost_folder(row: TrackOutcome) -> ProfileGroup | None:
    """Group the walks of unknown people by the uppermost folder, such as a building."""
    place = row.walk.partition("/")[0]
    return ProfileGroup(place, SIGMA_OF_SEVERAL) if place != row.walk else None
