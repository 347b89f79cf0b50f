"""From a scored walk to what is kept of it: numbers, the track in the frame of its truth, and its errors."""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.person.track import NAME as FUSED
from pdr_est.evaluate.carrying_modes import mode_shares
from pdr_est.evaluate.consistency import squared_mahalanobis
from pdr_est.evaluate.position_errors import LEAST_POINTS, point_errors
from pdr_est.evaluate.rigid_alignment import start_alignment
from pdr_est.evaluate.time_association import Association, associate
from pdr_est.experiment.runners.score_walk import Scored
from pdr_est.experiment.scoring.any_recording import HeldOutProtocol
from pdr_est.experiment.suite import AnalysedWalk, Scores
from pdr_est.frames import Array
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.outcome import TrackOutcome
from pdr_est.types.track import Track

_MOST_POINTS = 400  # of a truth, and of the errors along a walk: more than a plot can show
_NOTHING = np.empty(0)


def outcomes_of(
    scored: Scored, walk: str, labels: Mapping[str, str], metrics: Sequence[str], judge: HeldOutProtocol
) -> Iterator[TrackOutcome]:
    """Of each track of a scored walk. judge: which of its true positions were given to the estimator."""
    walked = scored.walk
    truth = walked.recording.truth
    for scores, (track, fixes) in zip(scored.scores, _shown(walked), strict=False):
        # The person's own track has no device; when it was recorded and how carried is told by the first one.
        own = str(track.device[0])
        device = next((one for one in walked.devices if one.device == own), walked.devices[0])
        position_m, along = _beside_truth(walked, own, track, judge if fixes else None)
        yield TrackOutcome(
            walk=walk,
            track=scores.track,
            variant=scored.variant.name,
            labels=labels,
            mode=scores.mode,
            metrics={name: _finite(scores, name) for name in metrics},
            steps=len(track) - 1,
            true_steps=truth.step_count if truth.steps is None else len(truth.steps.time_s),
            mode_shares={mode.name: share for mode, share in mode_shares(device.steps).items() if share == share},
            with_fixes=fixes,
            position_m=position_m,
            truth_m=np.empty((0, 2)) if truth.positions is None else _thinned(truth.positions.position_m),
            way_m=along[0],
            error_m=along[1],
            squared=along[2],
        )


def _finite(scores: Scores, name: str) -> float | None:
    value = scores.values.get(name, math.nan)
    return value if math.isfinite(value) else None


def _shown(walked: AnalysedWalk) -> list[tuple[Track, bool]]:
    """The track of each device, and then of the person if several are, as shown, and whether it was given fixes: each
    has fixes of its own."""
    opened = [track for fixes, track in walked.estimates if not fixes]
    tied = [track for fixes, track in walked.estimates if fixes]
    names = [device.device for device in walked.devices]
    names += [FUSED] if opened and FUSED in opened[0].devices else []
    fixed = len(tied) == len(names)
    chosen = tied if fixed else opened[:1] * len(names)
    return [(track.of_device(name), fixed) for track, name in zip(chosen, names, strict=True)]


def _beside_truth(
    walked: AnalysedWalk, name: str, track: Track, judge: HeldOutProtocol | None
) -> tuple[Array, tuple[Array, Array, Array]]:
    """The track in the frame of the truth, and way, error and squared error at the points that judge it.

    name: of the device. judge: None for a track without fixes, which is aligned at its start.
    """
    truth = walked.recording.truth.positions
    nothing = (_NOTHING, _NOTHING, _NOTHING)
    if truth is None:
        return track.position_m, nothing
    pairs = associate(track, truth.time_s, truth.position_m, walked.span_of(name))
    if len(pairs) < LEAST_POINTS:
        return track.position_m, nothing
    if judge is None:
        moved = start_alignment(pairs.track_m, pairs.truth_m)
        error_m = point_errors(moved.apply(pairs.track_m), pairs.truth_m)
        later = np.arange(len(pairs)) > 0  # the first point is matched by the alignment
        return moved.apply(track.position_m), _errors_along_way(pairs, error_m, _NOTHING, later)
    return track.position_m, _held_out_along(pairs, truth, judge)


def _held_out_along(pairs: Association, truth: TruePositions, judge: HeldOutProtocol) -> tuple[Array, Array, Array]:
    protocol = judge.held_out(truth)
    if protocol is None:
        return _NOTHING, _NOTHING, _NOTHING
    difference_m = pairs.track_m - pairs.truth_m
    squared = squared_mahalanobis(difference_m, pairs.covariance_m2, protocol.truth_sigma_m)
    return _errors_along_way(pairs, point_errors(pairs.track_m, pairs.truth_m), squared, ~protocol.given(pairs))


def _errors_along_way(
    pairs: Association, error_m: Array, squared: Array, chosen: NDArray[np.bool_]
) -> tuple[Array, Array, Array]:
    legs_m = np.linalg.norm(np.diff(pairs.truth_m, axis=0), axis=1)
    way_m = np.concatenate([[0.0], np.cumsum(legs_m)])
    kept = squared[chosen] if len(squared) else squared
    return _thinned(way_m[chosen]), _thinned(error_m[chosen]), _thinned(kept)


def _thinned(rows: Array) -> Array:
    """At most so many rows that a plot can show, evenly over all."""
    if len(rows) <= _MOST_POINTS:
        return rows
    chosen: Array = rows[np.linspace(0, len(rows) - 1, _MOST_POINTS).round().astype(int)]
    return chosen
