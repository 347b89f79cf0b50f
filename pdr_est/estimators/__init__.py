"""Estimators: measurements ─► track. They know geometry and probability, and nothing of phones."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Literal, get_args

from pdr_est.errors import EstimationError
from pdr_est.estimators import dead_reckoning
from pdr_est.estimators.common.timeline import Timeline, build_timeline
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.estimators.kalman import ekf
from pdr_est.estimators.robust_dr.fusion import MapFusionParams, estimate_closed_form, estimate_general
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether, Measurement, PositionFix, StartPose
from pdr_est.types.track import Track, concatenate

EstimatorName = Literal["dead-reckoning", "map-closed-form", "map-general", "ekf", "factor-graph", "fixed-lag"]
ESTIMATORS: tuple[EstimatorName, ...] = get_args(EstimatorName)
SMOOTHERS: tuple[EstimatorName, ...] = ("factor-graph",)  # each pose from the whole walk
ONLINE: tuple[EstimatorName, ...] = ("ekf", "fixed-lag")  # the same while the devices record
# These find a start that is not given from the fixes, and use them for nothing else.
RECKONERS: tuple[EstimatorName, ...] = ("dead-reckoning", "map-closed-form", "map-general")

_MAP_FUSION, _FIXED_LAG = MapFusionParams(), FixedLagParams()


def estimate_walk(
    name: EstimatorName,
    devices: Sequence[DeviceMeasurements],
    start: StartPose,
    sigma_length_scale: float,
    tethers: Sequence[DeviceTether] = (),
    map_fusion: MapFusionParams = _MAP_FUSION,
    fixed_lag: FixedLagParams = _FIXED_LAG,
) -> Track:
    """Tracks of all devices of one walk. sigma_length_scale: of the walker's own step length.

    A position fix among the measurements of several devices is one piece of knowledge about one walker: each device
    gets its share of the information.

    Raises EstimationError for odometry out of order, a tether to an unknown device, or a graph without a unique
    solution.
    """
    split_times_s = sorted({tether.time_s for tether in tethers})
    timelines = [
        build_timeline(one.device, one.start_s, _shared(one.measurements, len(devices)), split_times_s)
        for one in devices
    ]
    match name:
        case "dead-reckoning":
            return concatenate([dead_reckoning.estimate(one, start, sigma_length_scale) for one in timelines])
        case "map-closed-form":
            return estimate_closed_form(timelines, tethers, start, sigma_length_scale, map_fusion)
        case "map-general":
            return estimate_general(timelines, tethers, start, sigma_length_scale, map_fusion)
        case "ekf":
            return ekf.estimate(timelines, tethers, start, sigma_length_scale)
        case "factor-graph":
            from pdr_est.estimators.factor_graph import smoother as factor_graph

            return factor_graph.estimate(timelines, tethers, start, sigma_length_scale)
        case "fixed-lag":
            from pdr_est.estimators.fixed_lag import smoother as lagged  # likewise

            return lagged.estimate(timelines, tethers, start, sigma_length_scale, fixed_lag)
    raise EstimationError(f"unknown estimator {name!r}: choose one of {', '.join(ESTIMATORS)}")


def estimate_track(
    name: EstimatorName,
    device: str,
    start_s: float,
    measurements: Iterable[Measurement],
    start: StartPose,
    sigma_length_scale: float,
) -> Track:
    """`estimate_walk` for one device."""
    return estimate_walk(name, [DeviceMeasurements(device, start_s, tuple(measurements))], start, sigma_length_scale)


def _shared(measurements: Sequence[Measurement], devices: int) -> list[Measurement]:
    return [
        replace(m, covariance_m2=m.covariance_m2 * devices) if isinstance(m, PositionFix) else m for m in measurements
    ]


__all__ = [
    "ESTIMATORS",
    "ONLINE",
    "RECKONERS",
    "SMOOTHERS",
    "DeviceMeasurements",
    "EstimatorName",
    "Timeline",
    "estimate_track",
    "estimate_walk",
]
