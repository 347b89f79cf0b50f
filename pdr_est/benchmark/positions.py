"""Metrics of a device whose true positions are known."""

from pdr_est.benchmark.devices import Part, device_scores, mode_part
from pdr_est.benchmark.suite import Scores, Walked
from pdr_est.errors import RecordingError
from pdr_est.evaluate import metrics, open_loop
from pdr_est.evaluate.association import Association, associate
from pdr_est.evaluate.consistency import coverage95, nees_mean
from pdr_est.evaluate.heldout import LEAST_POINTS, WAYPOINT_SIGMA_M, fixes_at, given_points
from pdr_est.evaluate.open_loop import open_metrics
from pdr_est.io.recording import TruePositions
from pdr_est.pipeline import DeviceWalk
from pdr_est.track import Track

HELDOUT_METRICS = ("error_heldout_m", "coverage95", "nees_mean")


def score_open(walk: Walked) -> list[Scores]:
    """`OPEN_METRICS`, from nothing but the sensors, and `mode_accuracy` of each device.

    Raises RecordingError when fewer than two truth points lie within the recording.
    """
    truth, track = _truth(walk), walk.track()
    scores = []
    for device in walk.devices:
        own = track.of_device(device.device)
        pairs = _pairs(walk, device, own, truth)
        scores.append(device_scores(walk, device, _open_part(own, pairs, truth), mode_part(walk, device)))
    return scores


def score_waypoints(walk: Walked) -> list[Scores]:
    """`OPEN_METRICS`, `HELDOUT_METRICS` and `mode_accuracy` of each device.

    With fewer than five truth points the held-out ones are missing. Raises RecordingError when fewer than two truth
    points lie within the recording.
    """
    truth, track = _truth(walk), walk.track()
    scores = []
    for device in walk.devices:
        own = track.of_device(device.device)
        pairs = _pairs(walk, device, own, truth)
        parts = (_open_part(own, pairs, truth), _heldout_part(walk, device, pairs), mode_part(walk, device))
        scores.append(device_scores(walk, device, *parts))
    return scores


def _open_part(track: Track, pairs: Association, truth: TruePositions) -> Part:
    counts = {"truth_points": len(pairs), "truth_points_not_scored": pairs.not_scored}
    return Part(open_metrics(track, pairs, truth.source), counts)


def _heldout_part(walk: Walked, device: DeviceWalk, pairs: Association) -> Part:
    """Metrics at the held-out points of a track that was given the others as fixes."""
    if len(pairs) < LEAST_POINTS:
        return Part(missing=dict.fromkeys(HELDOUT_METRICS, f"fewer than {LEAST_POINTS} truth points"))
    given = given_points(len(pairs))
    track = walk.track(fixes_at(pairs.time_s[given], pairs.truth_m[given])).of_device(device.device)
    held = associate(track, pairs.time_s[~given], pairs.truth_m[~given], device.span_s)
    error_m = held.track_m - held.truth_m
    return Part(
        {
            "error_heldout_m": float(metrics.point_errors(held.track_m, held.truth_m).mean()),
            "coverage95": coverage95(error_m, held.covariance_m2, WAYPOINT_SIGMA_M),
            "nees_mean": nees_mean(error_m, held.covariance_m2, WAYPOINT_SIGMA_M),
        }
    )


def _truth(walk: Walked) -> TruePositions:
    positions = walk.recording.truth.positions
    if positions is None or not len(positions.time_s):
        raise RecordingError(f"{walk.recording.name}: no true positions: nothing to score the track against")
    return positions


def _pairs(walk: Walked, device: DeviceWalk, track: Track, truth: TruePositions) -> Association:
    pairs = associate(track, truth.time_s, truth.position_m, device.span_s)
    if len(pairs) < open_loop.LEAST_POINTS:
        raise RecordingError(
            f"{walk.recording.name}: {len(pairs)} of {len(truth.time_s)} truth points within the recording of "
            f"{device.device}: at least {open_loop.LEAST_POINTS} are needed"
        )
    return pairs
