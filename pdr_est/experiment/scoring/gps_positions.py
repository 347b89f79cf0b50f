"""Scores of a track whose only fixes are the GPS positions in the recording, against surveyed points."""

from collections.abc import Sequence

import numpy as np

from pdr_est.evaluate.consistency import coverage95
from pdr_est.evaluate.position_errors import point_errors
from pdr_est.evaluate.time_association import associate
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.scoring.track_scores import MetricPart
from pdr_est.frames import Array
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.measurements import PositionFix

GPS_METRICS = ("error_gps_m", "coverage95_gps", "scale_gps", "error_gps_raw_m")

SURVEYED_SIGMA_M = 0.2
"""Standard deviation of a surveyed point per axis, m: how exactly a walker steps on a mark (our choice)."""


def gps_part(walk: AnalysedWalk, name: str, truth: TruePositions) -> MetricPart:
    """Compute `GPS_METRICS` of one device, or of the person; they are missing if the recording has no GPS position.

    Parameters
    ----------
    walk : AnalysedWalk
        The walk.
    name : str
        The device, or "fused".
    truth : TruePositions
        Surveyed points in the map frame, at least one of them within the recording.
    """
    fixes = walk.recording.fixes
    if not fixes:
        return MetricPart(missing=dict.fromkeys(GPS_METRICS, "no GPS position in the recording"))
    track = walk.track(fixes).of_device(name)
    pairs = associate(track, truth.time_s, truth.position_m, walk.span_of(name))
    error_m = pairs.track_m - pairs.truth_m
    raw_m = interpolated_fixes(fixes, pairs.time_s)
    return MetricPart(
        {
            "error_gps_m": float(point_errors(pairs.track_m, pairs.truth_m).mean()),
            "coverage95_gps": coverage95(error_m, pairs.covariance_m2, SURVEYED_SIGMA_M),
            "scale_gps": track.length_scale,
            "error_gps_raw_m": float(point_errors(raw_m, pairs.truth_m).mean()),
        },
        {"gps_positions": len(fixes)},
    )


def interpolated_fixes(fixes: Sequence[PositionFix], time_s: Array) -> Array:
    """Interpolate the positions of fixes linearly in time.

    Parameters
    ----------
    fixes : sequence of PositionFix
        At least one fix, in any order.
    time_s : ndarray
        Times (n,), s; those outside the fixes take the first or the last one.

    Returns
    -------
    ndarray
        Positions (n, 2), m.
    """
    ordered = sorted(fixes, key=lambda fix: fix.time_s)
    fix_time_s = np.array([fix.time_s for fix in ordered])
    position_m = np.array([fix.position_m for fix in ordered])
    return np.column_stack([np.interp(time_s, fix_time_s, axis_m) for axis_m in position_m.T])
