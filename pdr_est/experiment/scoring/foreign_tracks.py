"""Scores of tracks that another program made of the walks of an experiment."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.estimators.person.track import NAME as FUSED
from pdr_est.evaluate.position_errors import LEG_METRICS
from pdr_est.evaluate.rigid_alignment import best_alignment
from pdr_est.evaluate.trajectories.on_recording import track_on_recording
from pdr_est.evaluate.trajectories.person import person_in
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.held_out import HeldOutProtocol
from pdr_est.experiment.scoring.positions import leg_part, position_parts, true_positions
from pdr_est.experiment.scoring.track_scores import MetricPart, track_scores
from pdr_est.experiment.suite import Suite, TrackScores
from pdr_est.io.trajectories import read_trajectory
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track


class ForeignWalk(AnalysedWalk):
    """A walk whose track was read from a file, in place of an estimator's.

    The track takes no measurement from fixes: it is moved and turned, as a whole, to fit them best, and then has no
    covariance. Before its first and after its last position the walker counts as standing, so that all variants are
    scored at the same true positions.

    Parameters
    ----------
    recording : Recording
        The recording with its ground truth.
    track : Track
        The track on the clock of the recording.
    protocol : HeldOutProtocol
        Rule that selects the true positions which the track is aligned with.
    """

    def __init__(self, recording: Recording, track: Track, protocol: HeldOutProtocol) -> None:
        super().__init__(recording, (), Config(), protocol=protocol)
        self._track = track

    @property
    def track_names(self) -> tuple[str, ...]:
        """Names of the devices of the track."""
        return self._track.devices

    def span_of(self, name: str) -> tuple[float, float]:
        """Return the times, s, of the first and the last sample of the recording, or of the track without samples."""
        own = self._track.of_device(name).time_s
        return self.recording.span_s or (float(own[0]), float(own[-1]))

    def track(self, fixes: Sequence[PositionFix] = ()) -> Track:
        """Return the track as it is, or moved and turned to fit fixes best."""
        moved = self._track if not fixes else _fitted(self._track, fixes)
        self.tracks.append((tuple(fixes), moved))
        return moved


def foreign_walk(path: Path, recording: Recording, protocol: HeldOutProtocol) -> ForeignWalk:
    """Read the track of a walk.

    Raises
    ------
    RecordingError
        If the file is missing or damaged, or its times, positions or devices do not belong to the recording.
    """
    trajectory = read_trajectory(path)
    devices = [device.name for device in recording.devices]
    if len(devices) == 1:
        person = person_in(trajectory)
        trajectory = replace(person, device=np.full(len(person), devices[0]))
    elif len(trajectory.devices) == 1 and trajectory.devices[0] not in devices:
        trajectory = replace(trajectory, device=np.full(len(trajectory), FUSED))
    unknown = sorted(set(trajectory.devices) - {*devices, FUSED})
    if unknown:
        raise RecordingError(
            f"{trajectory.place}: the recording {recording.name} has no device {unknown[0]!r}: name one of "
            f"{', '.join(devices)}, {FUSED}"
        )
    return ForeignWalk(recording, track_on_recording(trajectory, recording), protocol)


def score_foreign(walk: ForeignWalk, suite: Suite) -> list[TrackScores]:
    """Score each device of a track from a file with those metrics of a suite that compare positions.

    Others need the steps, modes or fixes of the chain that a file does not have, and do not apply.

    Raises
    ------
    RecordingError
        If the recording has no true positions, or fewer than two within its time.
    """
    truth, track = true_positions(walk.recording), walk.track()
    scores = []
    for name in walk.track_names:
        parts = position_parts(walk, name, track, truth)
        if any(metric in suite.metrics for metric in LEG_METRICS):
            parts.append(leg_part(walk, name, track, truth))
        own_s = track.of_device(name).time_s
        beyond = (truth.time_s < own_s[0]) | (truth.time_s > own_s[-1])
        parts.append(MetricPart(counts={"truth_points_beyond_track": int(beyond.sum())}))
        alone = len(walk.recording.devices) == 1
        scores.append(track_scores("device" if alone else name, CarryingMode.UNKNOWN.name, *parts))
    return scores


def _fitted(track: Track, fixes: Sequence[PositionFix]) -> Track:
    """Move and turn the track of each device to fit the fixes best; its covariances do not hold afterwards."""
    given_m = np.array([fix.position_m for fix in fixes])
    given_s = np.array([fix.time_s for fix in fixes])
    position_m = np.empty_like(track.position_m)
    for name in track.devices:
        own = track.of_device(name)
        fit = best_alignment(own.at(given_s)[0], given_m)
        position_m[track.device == name] = fit.apply(own.position_m)
    return replace(track, position_m=position_m, covariance_m2=np.full_like(track.covariance_m2, np.nan))
