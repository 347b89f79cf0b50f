"""Scores of a track that knows where the walk starts, and the floor plan."""

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.evaluate.consistency import coverage95
from pdr_est.evaluate.held_out_fixes import LEAST_POINTS, WAYPOINT_SIGMA_M, fixes_at
from pdr_est.evaluate.position_errors import point_errors
from pdr_est.evaluate.time_association import associate
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.scoring.track_scores import MetricPart, missing_without_north
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.ground_truth import TruePositions

PLAN_METRICS = ("error_plan_m", "coverage95_plan", "outside_plan", "error_heldout_plan_m", "coverage95_heldout_plan")


def plan_part(walk: AnalysedWalk, name: str, truth: TruePositions) -> MetricPart:
    """Compute `PLAN_METRICS` of one device, or of the person.

    The first true position is the only fix, or every third one for the last two metrics, and nothing is aligned.
    Where no estimator is chosen, it is the one for walks on a floor plan. The metrics are missing where no plan lies
    beside the recording, where the estimator makes no use of one, and where nothing tells north.

    Parameters
    ----------
    walk : AnalysedWalk
        The walk.
    name : str
        The device, or "fused".
    truth : TruePositions
        True positions in the frame of the plan, at least two of them within the recording.
    """
    spec = walk.config.estimator.make(on_plan=True).spec
    if walk.plan is None:
        return MetricPart(missing=dict.fromkeys(PLAN_METRICS, walk.without_plan))
    if not (spec.uses_plan or spec.smooths):
        return MetricPart(missing=dict.fromkeys(PLAN_METRICS, f"{spec.name} makes no use of a floor plan"))
    if (missing := missing_without_north(walk, PLAN_METRICS)) is not None:
        return missing
    try:
        known, held = _with_start(walk, walk.plan, name, truth), _with_every_third(walk, name, truth)
    except EstimationError as error:  # which must not cost the metrics without plan
        return MetricPart(missing=dict.fromkeys(PLAN_METRICS, str(error)))
    return MetricPart({**known.values, **held.values}, missing={**known.missing, **held.missing})


def _with_start(walk: AnalysedWalk, plan: FloorPlan, name: str, truth: TruePositions) -> MetricPart:
    first = np.argsort(truth.time_s, kind="stable")[:1]
    track = walk.track_on_plan(fixes_at(truth.time_s[first], truth.position_m[first])).of_device(name)
    pairs = associate(track, truth.time_s, truth.position_m, walk.span_of(name))
    later = pairs.time_s > truth.time_s[first]
    error_m = (pairs.track_m - pairs.truth_m)[later]
    return MetricPart(
        {
            "error_plan_m": float(point_errors(pairs.track_m[later], pairs.truth_m[later]).mean()),
            "coverage95_plan": coverage95(error_m, pairs.covariance_m2[later], WAYPOINT_SIGMA_M),
            "outside_plan": float(np.mean(~plan.contains(track.position_m))),
        }
    )


def _with_every_third(walk: AnalysedWalk, name: str, truth: TruePositions) -> MetricPart:
    metrics, held_out = PLAN_METRICS[3:], walk.held_out
    pairs = associate(walk.track().of_device(name), truth.time_s, truth.position_m, walk.span_of(name))
    if held_out is None or len(held_out.waypoints(pairs)) < LEAST_POINTS or held_out.given(pairs).all():
        return MetricPart(missing=dict.fromkeys(metrics, f"no fixes, or fewer than {LEAST_POINTS} truth points"))
    given = held_out.given(pairs)
    track = walk.track_on_plan(held_out.fixes(pairs)).of_device(name)
    held = associate(track, pairs.time_s[~given], pairs.truth_m[~given], walk.span_of(name))
    covered = coverage95(held.track_m - held.truth_m, held.covariance_m2, held_out.truth_sigma_m)
    values = (float(point_errors(held.track_m, held.truth_m).mean()), covered)
    return MetricPart(dict(zip(metrics, values, strict=True)))
