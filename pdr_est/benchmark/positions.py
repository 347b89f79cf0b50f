"""Scores of walks whose truth is positions: the metrics of the suites ilc20, oxiod and ipin2023."""

import numpy as np

from pdr_est.benchmark.suite import Scores, Walked
from pdr_est.errors import RecordingError
from pdr_est.evaluate import metrics, open_loop
from pdr_est.evaluate.association import Association, associate
from pdr_est.evaluate.consistency import coverage95, nees_mean
from pdr_est.evaluate.heldout import LEAST_POINTS, WAYPOINT_SIGMA_M, fixes_at, given_points
from pdr_est.evaluate.open_loop import open_metrics
from pdr_est.frames import Array
from pdr_est.io.recording import TruePositions
from pdr_est.pipeline import DeviceWalk
from pdr_est.records import CarryingMode
from pdr_est.track import Track

HELDOUT_METRICS = ("error_heldout_m", "coverage95", "nees_mean")


def score_open(walk: Walked) -> list[Scores]:
    """`OPEN_METRICS` of each device, from nothing but the sensors.

    Raises RecordingError when fewer than two truth points lie within the recording.
    """
    truth, track = _truth(walk), walk.track()
    scores = []
    for device in walk.devices:
        own = track.of_device(device.device)
        pairs = _pairs(walk, device, own, truth)
        scores.append(_scores(walk, device, pairs, open_metrics(own, pairs, truth.source)))
    return scores


def score_waypoints(walk: Walked, true_mode: CarryingMode) -> list[Scores]:
    """`OPEN_METRICS`, `HELDOUT_METRICS` and `mode_accuracy` of each device.

    With fewer than five truth points the held-out ones are missing. Raises RecordingError when fewer than two truth
    points lie within the recording.
    """
    truth, track = _truth(walk), walk.track()
    scores = []
    for device in walk.devices:
        own = track.of_device(device.device)
        pairs = _pairs(walk, device, own, truth)
        values = open_metrics(own, pairs, truth.source)
        values["mode_accuracy"] = metrics.mode_accuracy(*_walking(device), true_mode)
        missing = {} if device.steps else {"mode_accuracy": "no step found"}
        if len(pairs) >= LEAST_POINTS:
            values |= _heldout_values(walk, device, pairs)
        else:
            missing |= dict.fromkeys(HELDOUT_METRICS, f"fewer than {LEAST_POINTS} truth points")
        scores.append(_scores(walk, device, pairs, values, missing))
    return scores


def _heldout_values(walk: Walked, device: DeviceWalk, pairs: Association) -> dict[str, float]:
    """Metrics at the held-out points of a track that was given the others as fixes."""
    given = given_points(len(pairs))
    track = walk.track(fixes_at(pairs.time_s[given], pairs.truth_m[given])).of_device(device.device)
    held = associate(track, pairs.time_s[~given], pairs.truth_m[~given], device.span_s)
    error_m = held.track_m - held.truth_m
    return {
        "error_heldout_m": float(metrics.point_errors(held.track_m, held.truth_m).mean()),
        "coverage95": coverage95(error_m, held.covariance_m2, WAYPOINT_SIGMA_M),
        "nees_mean": nees_mean(error_m, held.covariance_m2, WAYPOINT_SIGMA_M),
    }


def _scores(
    walk: Walked,
    device: DeviceWalk,
    pairs: Association,
    values: dict[str, float],
    missing: dict[str, str] | None = None,
) -> Scores:
    return Scores(
        track=device.device if len(walk.devices) > 1 else "device",
        mode=metrics.main_mode(*_walking(device)).name,
        values=values,
        counts={"truth_points": len(pairs), "truth_points_not_scored": pairs.not_scored},
        missing=missing or {},
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


def _walking(device: DeviceWalk) -> tuple[Array, list[CarryingMode]]:
    """How long each step took, (n,) s, and the mode it was labelled with."""
    durations = np.array([step.event.time_s - step.start_s for step in device.steps])
    return durations, [step.event.mode for step in device.steps]
