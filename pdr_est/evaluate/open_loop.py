"""The metrics of a track that got nothing but the sensors, against true positions."""

from pdr_est.evaluate.association import Association
from pdr_est.evaluate.metrics import ate_rigid, error_open, final_drift, length_ratio
from pdr_est.track import Track

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
