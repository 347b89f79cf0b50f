"""Scores of a track that knows where the walk starts, and its direction from the phone's own knowledge of north."""

import numpy as np

from pdr_est.evaluate.consistency import coverage95
from pdr_est.evaluate.held_out_fixes import WAYPOINT_SIGMA_M, fixes_at
from pdr_est.evaluate.position_errors import point_errors
from pdr_est.evaluate.rigid_alignment import best_alignment
from pdr_est.evaluate.time_association import associate
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.scoring.track_scores import MetricPart, missing_without_north
from pdr_est.frames import wrap_angle
from pdr_est.types.ground_truth import TruePositions

START_METRICS = ("error_start_m", "heading_start_error_deg", "coverage95_start")


def start_part(walk: AnalysedWalk, name: str, truth: TruePositions) -> MetricPart:
    """Compute `START_METRICS` of one device, or of the person.

    The first true position is the only fix, and nothing is aligned. The metrics are missing where nothing tells
    north.

    Parameters
    ----------
    walk : AnalysedWalk
        The walk.
    name : str
        The device, or "fused".
    truth : TruePositions
        True positions in the map frame, at least two of them within the recording.
    """
    if (missing := missing_without_north(walk, START_METRICS)) is not None:
        return missing
    span_s = walk.span_of(name)
    first = np.argsort(truth.time_s, kind="stable")[:1]
    track = walk.track(fixes_at(truth.time_s[first], truth.position_m[first])).of_device(name)
    pairs = associate(track, truth.time_s, truth.position_m, span_s)
    later = pairs.time_s > truth.time_s[first]
    error_m = (pairs.track_m - pairs.truth_m)[later]
    turned_rad = best_alignment(pairs.track_m, pairs.truth_m).rotation_rad
    return MetricPart(
        {
            "error_start_m": float(point_errors(pairs.track_m[later], pairs.truth_m[later]).mean()),
            "heading_start_error_deg": float(np.degrees(abs(wrap_angle(turned_rad)))),
            "coverage95_start": coverage95(error_m, pairs.covariance_m2[later], WAYPOINT_SIGMA_M),
        }
    )
