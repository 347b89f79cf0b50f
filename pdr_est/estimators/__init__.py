"""Estimators: measurements ─► track. They know geometry and probability, and nothing of phones."""

from collections.abc import Callable, Iterable
from typing import Literal, get_args

from pdr_est.errors import EstimationError
from pdr_est.estimators import dead_reckoning, ekf
from pdr_est.estimators.timeline import Timeline, build_timeline
from pdr_est.records import Measurement, StartPose
from pdr_est.track import Track

EstimatorName = Literal["dead-reckoning", "ekf", "factor-graph"]
ESTIMATORS: tuple[EstimatorName, ...] = get_args(EstimatorName)
SMOOTHERS: tuple[EstimatorName, ...] = ("factor-graph",)  # each pose from the whole walk


def estimate_track(
    name: EstimatorName,
    device: str,
    start_s: float,
    measurements: Iterable[Measurement],
    start: StartPose,
    sigma_length_scale: float,
) -> Track:
    """Track of one device. start_s: time of the start pose; sigma_length_scale: of the walker's own step length.

    Raises EstimationError for an unknown name, odometry out of order, or a graph without a unique solution.
    """
    return _function(name)(build_timeline(device, start_s, measurements), start, sigma_length_scale)


def _function(name: EstimatorName) -> Callable[[Timeline, StartPose, float], Track]:
    match name:
        case "dead-reckoning":
            return dead_reckoning.estimate
        case "ekf":
            return ekf.estimate
        case "factor-graph":
            from pdr_est.estimators import factor_graph  # gtsam is slow to load: only when it is used

            return factor_graph.estimate
    raise EstimationError(f"unknown estimator {name!r}: choose one of {', '.join(ESTIMATORS)}")
