"""Metrics of a track whose true positions are known."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.estimators.person.track import NAME as FUSED
from pdr_est.evaluate import position_errors as metrics
from pdr_est.evaluate import position_errors as open_loop
from pdr_est.evaluate.consistency import coverage95, nees_mean
from pdr_est.evaluate.held_out_fixes import EVERY, LEAST_POINTS, WAYPOINT_SIGMA_M, fixes_at, given_points
from pdr_est.evaluate.position_errors import open_metrics
from pdr_est.evaluate.time_association import Association, associate
from pdr_est.experiment.scoring.track_scores import MetricPart, device_scores, mode_part, person_scores
from pdr_est.experiment.suite import AnalysedWalk, Scores
from pdr_est.frames import Array
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.measurements import PositionFix
from pdr_est.types.track import Track

HELDOUT_METRICS = ("error_heldout_m", "coverage95", "nees_mean")


@dataclass(frozen=True)
class HeldOut:
    """Which truth points are given as fixes, and how sure they are; the others judge the track.

    every: each so-manyth and the last. sigma_m: of a fix, per axis. truth_sigma_m: of the points that judge. noise:
    from their number n, what is added to the points that are given, (n, 2) in m; for a truth that has no errors.
    """

    every: int = EVERY
    sigma_m: float = WAYPOINT_SIGMA_M
    truth_sigma_m: float = WAYPOINT_SIGMA_M
    noise: Callable[[int], Array] | None = None

    def given(self, pairs: Association) -> NDArray[np.bool_]:
        """(n,) which of the pairs are given."""
        return given_points(len(pairs), self.every)

    def fixes(self, pairs: Association) -> tuple[PositionFix, ...]:
        """Those that are given, as fixes."""
        given = self.given(pairs)
        position_m = pairs.truth_m[given]
        if self.noise is not None:
            position_m = position_m + self.noise(len(position_m))
        return fixes_at(pairs.time_s[given], position_m, self.sigma_m)


def score_open(walk: AnalysedWalk) -> list[Scores]:
    """`OPEN_METRICS`, from nothing but the sensors, and `mode_accuracy` of each device.

    Raises RecordingError when fewer than two truth points lie within the recording.
    """
    return score_positions(walk, None)


def score_waypoints(walk: AnalysedWalk) -> list[Scores]:
    """`OPEN_METRICS`, `HELDOUT_METRICS` and `mode_accuracy` of each device.

    With fewer than five truth points the held-out ones are missing. Raises RecordingError when fewer than two truth
    points lie within the recording.
    """
    return score_positions(walk, HeldOut())


def score_positions(walk: AnalysedWalk, held_out: HeldOut | None) -> list[Scores]:
    """`OPEN_METRICS` and `mode_accuracy` of each device, and `HELDOUT_METRICS` if points are held out; the same
    without `mode_accuracy` of the person who carries several devices."""
    truth, track = _truth(walk), walk.track()
    scores = [
        device_scores(
            walk, device, *position_parts(walk, device.device, track, truth, held_out), mode_part(walk, device)
        )
        for device in walk.devices
    ]
    if FUSED in track.devices:
        scores.append(person_scores(walk, *position_parts(walk, FUSED, track, truth, held_out)))
    return scores


def position_parts(
    walk: AnalysedWalk, name: str, track: Track, truth: TruePositions, held_out: HeldOut | None
) -> tuple[MetricPart, ...]:
    """The metrics of the true positions for one device, or for the person. track: of all of them, from nothing but
    the sensors.

    Raises RecordingError when fewer than two truth points lie within the recording.
    """
    own = track.of_device(name)
    pairs = _pairs(walk, name, own, truth)
    opened = _open_part(own, pairs, truth)
    return (opened,) if held_out is None else (opened, _heldout_part(walk, name, pairs, held_out))


def _open_part(track: Track, pairs: Association, truth: TruePositions) -> MetricPart:
    counts = {"truth_points": len(pairs), "truth_points_not_scored": pairs.not_scored}
    return MetricPart(open_metrics(track, pairs, truth.source), counts)


def _heldout_part(walk: AnalysedWalk, name: str, pairs: Association, held_out: HeldOut) -> MetricPart:
    """Metrics at the held-out points of a track that was given the others as fixes."""
    given = held_out.given(pairs)
    if len(pairs) < LEAST_POINTS or given.all():
        return MetricPart(missing=dict.fromkeys(HELDOUT_METRICS, f"fewer than {LEAST_POINTS} truth points"))
    track = walk.track(held_out.fixes(pairs)).of_device(name)
    held = associate(track, pairs.time_s[~given], pairs.truth_m[~given], walk.span_of(name))
    error_m = held.track_m - held.truth_m
    return MetricPart(
        {
            "error_heldout_m": float(metrics.point_errors(held.track_m, held.truth_m).mean()),
            "coverage95": coverage95(error_m, held.covariance_m2, held_out.truth_sigma_m),
            "nees_mean": nees_mean(error_m, held.covariance_m2, held_out.truth_sigma_m),
        }
    )


def _truth(walk: AnalysedWalk) -> TruePositions:
    positions = walk.recording.truth.positions
    if positions is None or not len(positions.time_s):
        raise RecordingError(f"{walk.recording.name}: no true positions: nothing to score the track against")
    return positions


def _pairs(walk: AnalysedWalk, name: str, track: Track, truth: TruePositions) -> Association:
    pairs = associate(track, truth.time_s, truth.position_m, walk.span_of(name))
    if len(pairs) < open_loop.LEAST_POINTS:
        raise RecordingError(
            f"{walk.recording.name}: {len(pairs)} of {len(truth.time_s)} truth points within the recording of "
            f"{name}: at least {open_loop.LEAST_POINTS} are needed"
        )
    return pairs
