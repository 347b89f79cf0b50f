"""Result row of a scored track: its metrics, and the track and its errors in the frame of the ground truth."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from pdr_est.evaluate.carrying_modes import mode_shares
from pdr_est.evaluate.consistency import squared_mahalanobis
from pdr_est.evaluate.position_errors import LEAST_POINTS, point_errors
from pdr_est.evaluate.rigid_alignment import start_alignment
from pdr_est.evaluate.time_association import associate
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.runners.score_variants import ScoredVariant
from pdr_est.frames import Array
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.outcome import TrackOutcome
from pdr_est.types.track import Track

_MOST_POINTS = 400  # true positions and errors of a walk: more than a plot can show
_NONE = np.empty(0)

Lines = dict[str, Array]
"""Fields of `TrackOutcome` that are plotted."""


def track_outcomes(
    scored: ScoredVariant, walk: str, labels: Mapping[str, str], metrics: tuple[str, ...]
) -> Iterator[TrackOutcome]:
    """Make the result row of each track of a scored walk.

    Parameters
    ----------
    scored : ScoredVariant
        The walk after one variant.
    walk : str
        Name of the walk.
    labels : Mapping
        Keys of the walk to group by -> value.
    metrics : tuple of str
        Metrics of the row, in this order.
    """
    analysed = scored.walk
    truth = analysed.recording.truth
    open_track = analysed.tracks[0][1] if analysed.tracks else None
    on_plan = analysed.last_on_plan
    names = analysed.track_names
    with_fixes = analysed.fixed_tracks.keys() == set(names)
    for name, scores in zip(names, scored.scores, strict=False):
        # The person's own track has no device: its steps and modes are those of the first one. A file has none.
        own = [one for one in analysed.devices if one.device == name] or analysed.devices[:1]
        device = own[0] if own else None
        lines, steps, findings = _plotted(np.empty((0, 2))), len(device.steps) if device else None, 0
        if open_track is not None:
            track = analysed.fixed_tracks[name] if with_fixes else open_track.of_device(name)
            lines, steps = _lines(analysed, name, track, with_fixes), len(track) - 1 if device else None
            findings = sum(finding.doubtful for finding in track.findings)
        yield TrackOutcome(
            walk=walk,
            track=scores.track,
            variant=scored.variant.name,
            labels=labels,
            mode=scores.mode,
            metrics={metric: _finite(scores.values.get(metric)) for metric in metrics},
            steps=steps,
            true_steps=truth.step_count if truth.steps is None else len(truth.steps.time_s),
            mode_shares=_shares(device),
            with_fixes=with_fixes,
            truth_m=np.empty((0, 2)) if truth.positions is None else _thinned(truth.positions.position_m),
            counts=scores.counts,
            predicted=scores.predicted,
            findings=findings,
            on_plan_m=np.empty((0, 2)) if on_plan is None else on_plan.of_device(name).position_m,
            **lines,
        )


def _shares(device: DeviceWalk | None) -> dict[str, float]:
    found = {} if device is None else mode_shares(device.steps)
    return {mode.name: share for mode, share in found.items() if share == share}


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _lines(walk: AnalysedWalk, name: str, track: Track, with_fixes: bool) -> Lines:
    """Move a track into the frame of the truth, and compute its errors at the true positions that judge it.

    A track without fixes is aligned at its start.
    """
    truth, held_out = walk.recording.truth.positions, walk.held_out
    pairs = None if truth is None else associate(track, truth.time_s, truth.position_m, walk.span_of(name))
    if pairs is None or len(pairs) < LEAST_POINTS:
        return _plotted(track.position_m)
    legs_m = np.linalg.norm(np.diff(pairs.truth_m, axis=0), axis=1)
    way_m = np.concatenate([[0.0], np.cumsum(legs_m)])
    if held_out is None or not with_fixes:
        aligned = start_alignment(pairs.track_m, pairs.truth_m)
        error_m = point_errors(aligned.apply(pairs.track_m), pairs.truth_m)
        return _plotted(aligned.apply(track.position_m), way_m[1:], error_m[1:])  # the alignment matches the first
    held = ~held_out.given(pairs)
    error_m = point_errors(pairs.track_m, pairs.truth_m)
    if not np.isfinite(pairs.covariance_m2).all():  # of another program
        return _plotted(track.position_m, way_m[held], error_m[held])
    difference_m = pairs.track_m - pairs.truth_m
    squared = squared_mahalanobis(difference_m, pairs.covariance_m2, held_out.truth_sigma_m)
    return _plotted(track.position_m, way_m[held], error_m[held], squared[held])


def _plotted(position_m: Array, way_m: Array = _NONE, error_m: Array = _NONE, squared: Array = _NONE) -> Lines:
    errors = {"way_m": way_m, "error_m": error_m, "squared": squared}
    return {"position_m": position_m, **{name: _thinned(rows) for name, rows in errors.items()}}


def _thinned(rows: Array) -> Array:
    """Keep at most `_MOST_POINTS` rows, evenly over all of them."""
    if len(rows) <= _MOST_POINTS:
        return rows
    chosen: Array = rows[np.linspace(0, len(rows) - 1, _MOST_POINTS).round().astype(int)]
    return chosen
