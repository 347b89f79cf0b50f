"""Error metrics of a track against true positions.

All of them are 2-D and Euclidean, in metres, at the truth's own times. Arrays named track_m and truth_m are (n, 2),
row i of both at the same time; `association.associate` makes such pairs.
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
    """(n,) distance of each pair of points."""
    return np.asarray(np.linalg.norm(track_m - truth_m, axis=1))


def error_open(track_m: Array, truth_m: Array) -> float:
    """`error_open_m`: mean error over all truth points after the first, aligned at the start.

    The alignment matches the first truth point and the direction to the first one at least 20 m away (the farthest
    one if none is): see `alignment.start_alignment`. Needs at least two points.
    """
    return float(point_errors(_aligned_at_start(track_m, truth_m), truth_m)[1:].mean())


def final_drift(track_m: Array, truth_m: Array) -> float:
    """`final_drift`: error at the last truth point, aligned at the start, per length of the polyline of the truth."""
    length = polyline_length(truth_m)
    if length == 0.0:
        return float("nan")
    return float(point_errors(_aligned_at_start(track_m, truth_m), truth_m)[-1] / length)


def ate_rigid(track_m: Array, truth_m: Array) -> float:
    """`ate_rigid_m`: root of the mean squared Euclidean error after the best rotation and translation, no scale.

    The square is that of the distance, not of each coordinate: no factor root two is hidden.
    """
    aligned = best_alignment(track_m, truth_m).apply(track_m)
    return float(np.sqrt(np.square(point_errors(aligned, truth_m)).mean()))


def length_ratio(track: Track, truth_time_s: Array, truth_m: Array, least_leg_m: float = 0.0) -> float:
    """`length_ratio`: length of the track between the first and the last truth point / length of the truth.

    Both are lengths of polylines. The truth's goes through its points (n, 2), without those nearer than least_leg_m
    to the last one kept: with GPS (least_leg_m = 5) the noise would lengthen it. The track's goes through its own
    poses between the first and the last point kept, and its interpolated places at those two times.
    NaN when the truth has no length.
    """
    kept = thinned(truth_m, least_leg_m)
    length = polyline_length(truth_m[kept])
    if length == 0.0:
        return float("nan")
    return length_between(track, float(truth_time_s[kept[0]]), float(truth_time_s[kept[-1]])) / length


def polyline_length(points_m: Array) -> float:
    """Length of the polyline through points (n, 2)."""
    return float(np.linalg.norm(np.diff(points_m, axis=0), axis=1).sum())


def length_between(track: Track, start_s: float, end_s: float) -> float:
    """Length of the polyline of one device's track from start_s to end_s, the ends interpolated."""
    (first, last), _ = track.at(np.array([start_s, end_s]))
    between = track.position_m[(track.time_s > start_s) & (track.time_s < end_s)]
    return polyline_length(np.vstack([first, between, last]))


def distance_error(total_m: float, true_m: float) -> float:
    """`distance_error`: difference of the lengths of the way / true length, which is positive."""
    return abs(total_m - true_m) / true_m


def within_sigma(total_m: float, true_m: float, sigma_log: float) -> float:
    """`scale_coverage68` of one walk: 1 if the logarithm of its length is off by at most sigma_log, and else 0.

    Over many walks the mean is 0.68 when the stated sigma_log is right; more is as wrong as less. true_m is positive;
    a walk of no length is never within.
    """
    return float(total_m > 0.0 and abs(np.log(total_m / true_m)) <= sigma_log)


def thinned(points_m: Array, least_leg_m: float) -> NDArray[np.intp]:
    """Indices of the first of the points (n, 2) and of each next one at least least_leg_m from the last one kept."""
    if least_leg_m <= 0.0:
        return np.arange(len(points_m), dtype=np.intp)
    kept = [0]
    for i in range(1, len(points_m)):
        if np.linalg.norm(points_m[i] - points_m[kept[-1]]) >= least_leg_m:
            kept.append(i)
    return np.array(kept, dtype=np.intp)


def mode_accuracy(duration_s: Array, mode: Sequence[CarryingMode], true_mode: NDArray[np.int8]) -> float:
    """`mode_accuracy`: share of the walking time that is labelled with the true carrying mode.

    duration_s: (n,) how long each step took; mode, true_mode: (n,) its label and what is right. NaN when there is no
    step.
    """
    total = float(np.sum(duration_s))
    if total <= 0.0:
        return float("nan")
    right = np.asarray(mode, dtype=np.int8) == true_mode
    return float(np.sum(duration_s[right]) / total)


def _aligned_at_start(track_m: Array, truth_m: Array) -> Array:
    return start_alignment(track_m, truth_m).apply(track_m)


OPEN_METRICS = ("error_open_m", "final_drift", "ate_rigid_m", "length_ratio")
LEAST_POINTS = 2  # truth points, for a direction

_LEAST_LEG_M = {"gps": 5.0}  # between which points the truth's length is taken, by source of the truth


def open_metrics(track: Track, pairs: Association, source: str) -> dict[str, float]:
    """`OPEN_METRICS` of one device's track. pairs: at least `LEAST_POINTS`; source: of the truth, in words."""
    least_leg_m = _LEAST_LEG_M.get(source, 0.0)
    return {
        "error_open_m": error_open(pairs.track_m, pairs.truth_m),
        "final_drift": final_drift(pairs.track_m, pairs.truth_m),
        "ate_rigid_m": ate_rigid(pairs.track_m, pairs.truth_m),
        "length_ratio": length_ratio(track, pairs.time_s, pairs.truth_m, least_leg_m),
    }
