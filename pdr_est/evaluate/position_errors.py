"""Error metrics of a track against true positions.

All of them are 2-D and Euclidean, in metres, at the times of the true positions. Arrays named track_m and truth_m are
(n, 2), row i of both at the same time; `time_association.associate` makes such pairs.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.evaluate.rigid_alignment import best_alignment, start_alignment
from pdr_est.evaluate.time_association import Association
from pdr_est.frames import Array
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track


def point_errors(track_m: Array, truth_m: Array) -> Array:
    """Compute the distance (n,), m, of each pair of points."""
    return np.asarray(np.linalg.norm(track_m - truth_m, axis=1))


def error_open(track_m: Array, truth_m: Array) -> float:
    """Compute `error_open_m`: the mean error, m, over all true positions after the first, aligned at the start.

    The alignment (`rigid_alignment.start_alignment`) matches the first true position and the direction to the first
    one at least 20 m away (else the farthest one). It needs at least two points.
    """
    return float(point_errors(_aligned_at_start(track_m, truth_m), truth_m)[1:].mean())


def final_drift(track_m: Array, truth_m: Array) -> float:
    """Compute `final_drift`: the error at the last true position, aligned at the start, per length of the truth."""
    length = polyline_length(truth_m)
    if length == 0.0:
        return float("nan")
    return float(point_errors(_aligned_at_start(track_m, truth_m), truth_m)[-1] / length)


def ate_rigid(track_m: Array, truth_m: Array) -> float:
    """Compute `ate_rigid_m`: the RMS error, m, after the best rotation and translation, without scale.

    The square is that of the distance and not that of each coordinate, which would be smaller by a root of two.
    """
    aligned = best_alignment(track_m, truth_m).apply(track_m)
    return float(np.sqrt(np.square(point_errors(aligned, truth_m)).mean()))


def length_ratio(track: Track, truth_time_s: Array, truth_m: Array, least_leg_m: float = 0.0) -> float:
    """Compute `length_ratio`: the length of the track per length of the truth.

    Both are lengths of polylines. That of the track goes through its own poses between the first and the last true
    position that is kept, and its interpolated positions at those two times.

    Parameters
    ----------
    track : Track
        Track of one device.
    truth_time_s : ndarray
        Times (n,) of the true positions, s.
    truth_m : ndarray
        True positions (n, 2), m.
    least_leg_m : float
        True positions nearer than this to the last one that is kept are left out, m; the noise of GPS would lengthen
        the polyline.

    Returns
    -------
    float
        The ratio; NaN if the truth has no length.
    """
    kept = thinned(truth_m, least_leg_m)
    length = polyline_length(truth_m[kept])
    if length == 0.0:
        return float("nan")
    return length_between(track, float(truth_time_s[kept[0]]), float(truth_time_s[kept[-1]])) / length


def leg_metrics(track_m: Array, truth_m: Array) -> tuple[dict[str, float], dict[str, int]]:
    """Compute `LEG_METRICS`, the mean errors of the legs between successive true positions.

    A leg is the displacement from one true position to the next. Its length does not depend on headings. Its vector
    is compared after one rotation of all legs, the one that maximises the sum of their scalar products with the true
    ones. Its turn is its vector as seen from the leg before it: both legs are rotated so that the leg before, of the
    track and of the truth, points east. A leg after one shorter than 1 m, or 0.5 m of the track, has no turn.

    Parameters
    ----------
    track_m, truth_m : ndarray
        Paired positions (n, 2), m, in the order of time; n at least 2.

    Returns
    -------
    values : dict
        Mean error, m, by metric; a walk without any turn has no `leg_turn_mae_m`.
    counts : dict
        Number of legs and of turns, by which the means of several walks are pooled.
    """
    own, true = (_complex(np.diff(points_m, axis=0)) for points_m in (track_m, truth_m))
    agreement = np.vdot(own, true)
    rotation = agreement / abs(agreement) if agreement != 0.0 else 1.0
    values = {
        "leg_length_mae_m": float(np.mean(np.abs(np.abs(own) - np.abs(true)))),
        "leg_vector_mae_m": float(np.mean(np.abs(rotation * own - true))),
    }
    turns = (np.abs(true[:-1]) >= _LEAST_LEG_BEFORE_M) & (np.abs(own[:-1]) >= _LEAST_OWN_LEG_BEFORE_M)
    if turns.any():
        own_turn, true_turn = (legs[1:][turns] * np.exp(-1j * np.angle(legs[:-1][turns])) for legs in (own, true))
        values["leg_turn_mae_m"] = float(np.mean(np.abs(own_turn - true_turn)))
    return values, {"legs": len(true), "leg_turns": int(turns.sum())}


def polyline_length(points_m: Array) -> float:
    """Compute the length, m, of the polyline through points (n, 2)."""
    return float(np.linalg.norm(np.diff(points_m, axis=0), axis=1).sum())


def length_between(track: Track, start_s: float, end_s: float) -> float:
    """Compute the length, m, of the track of one device from start_s to end_s, with interpolated ends."""
    (first, last), _ = track.at(np.array([start_s, end_s]))
    between = track.position_m[(track.time_s > start_s) & (track.time_s < end_s)]
    return polyline_length(np.vstack([first, between, last]))


def distance_error(total_m: float, true_m: float) -> float:
    """Compute `distance_error`: the absolute error of a length per true length, which is positive."""
    return abs(total_m - true_m) / true_m


def within_sigma(total_m: float, true_m: float, sigma_log: float) -> float:
    """Compute `scale_coverage68` of one walk: 1 if the error of its logarithmic length is at most sigma_log, else 0.

    The ideal mean over many walks is 0.68; more is as wrong as less.

    Parameters
    ----------
    total_m : float
        Length, m; for a length of zero the result is 0.
    true_m : float
        True length, m, which is positive.
    sigma_log : float
        Stated standard deviation of the logarithm of the length.
    """
    return float(total_m > 0.0 and abs(np.log(total_m / true_m)) <= sigma_log)


def thinned(points_m: Array, least_leg_m: float) -> NDArray[np.intp]:
    """Return the indices of the first point, (n, 2), and of each next one least_leg_m from the last one kept."""
    if least_leg_m <= 0.0:
        return np.arange(len(points_m), dtype=np.intp)
    kept = [0]
    for i in range(1, len(points_m)):
        if np.linalg.norm(points_m[i] - points_m[kept[-1]]) >= least_leg_m:
            kept.append(i)
    return np.array(kept, dtype=np.intp)


def mode_accuracy(duration_s: Array, mode: Sequence[CarryingMode], true_mode: NDArray[np.int8]) -> float:
    """Compute `mode_accuracy`: the share of the walking time that is labelled with the true carrying mode.

    Parameters
    ----------
    duration_s : ndarray
        Duration (n,) of each step, s.
    mode : sequence of CarryingMode
        Label of each step.
    true_mode : ndarray
        True mode (n,) of each step.

    Returns
    -------
    float
        The share; NaN if there is no step.
    """
    total = float(np.sum(duration_s))
    if total <= 0.0:
        return float("nan")
    right = np.asarray(mode, dtype=np.int8) == true_mode
    return float(np.sum(duration_s[right]) / total)


def _complex(vectors_m: Array) -> NDArray[np.complex128]:
    """Write vectors (n, 2) as complex numbers (n,), with which rotations are products."""
    return np.asarray(vectors_m[:, 0] + 1j * vectors_m[:, 1])


def _aligned_at_start(track_m: Array, truth_m: Array) -> Array:
    return start_alignment(track_m, truth_m).apply(track_m)


OPEN_METRICS = ("error_open_m", "final_drift", "ate_rigid_m", "length_ratio")
LEG_METRICS = ("leg_length_mae_m", "leg_vector_mae_m", "leg_turn_mae_m")
LEAST_POINTS = 2  # true positions, for a direction

_LEAST_LEG_BEFORE_M, _LEAST_OWN_LEG_BEFORE_M = 1.0, 0.5  # true and estimated, for a direction
_LEAST_LEG_M = {"gps": 5.0}  # source of the truth -> least distance of the points that its length is taken from


def open_metrics(track: Track, pairs: Association, source: str) -> dict[str, float]:
    """Compute `OPEN_METRICS` of the track of one device.

    Parameters
    ----------
    track : Track
        The track.
    pairs : Association
        At least `LEAST_POINTS` true positions with those of the track.
    source : str
        Source of the true positions, such as "gps".
    """
    least_leg_m = _LEAST_LEG_M.get(source, 0.0)
    return {
        "error_open_m": error_open(pairs.track_m, pairs.truth_m),
        "final_drift": final_drift(pairs.track_m, pairs.truth_m),
        "ate_rigid_m": ate_rigid(pairs.track_m, pairs.truth_m),
        "length_ratio": length_ratio(track, pairs.time_s, pairs.truth_m, least_leg_m),
    }
