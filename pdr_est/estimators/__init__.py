"""Estimators: from the measurements of a walk to its track with covariance.

They know geometry and probability, and nothing of phones. `spec` holds the contract that each of them fits, also one
from outside the package; `built_in` the table of those of the package and what each can do. What a smoother gets has
been through `fix_checks`, which compares fixes and steps, and `alternatives`, which lists what is open.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, get_args

from pdr_est.errors import EstimationError
from pdr_est.estimators.built_in import SPECS, BuiltInEstimator, EstimatorSettings
from pdr_est.estimators.common.timeline import Timeline, timelines_of
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.robust_dr.params import MapFusionParams
from pdr_est.estimators.spec import Estimator, EstimatorSpec, OnlineEstimator, OnlineFilter, OnlinePose
from pdr_est.parts import ESTIMATOR, is_external, named_part
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether, Measurement, StartPose
from pdr_est.types.track import Track

__all__ = [
    "AUTO",
    "ESTIMATORS",
    "SPECS",
    "BuiltInEstimator",
    "DeviceMeasurements",
    "Estimator",
    "EstimatorName",
    "EstimatorSettings",
    "EstimatorSpec",
    "OnlineEstimator",
    "OnlineFilter",
    "OnlinePose",
    "Timeline",
    "automatic_name",
    "estimate_track",
    "estimate_walk",
    "estimator_named",
    "timelines_of",
]

EstimatorName = Literal[
    "dead-reckoning", "map-closed-form", "map-general", "ekf", "factor-graph", "fixed-lag", "particle"
]
ESTIMATORS: tuple[EstimatorName, ...] = get_args(EstimatorName)
"""Names of the estimators of the package, which are the keys of `SPECS`."""

AUTO = "auto"
"""Name of the choice that depends on what is known of the walk, see `automatic_name`."""

_NO_PARAMETERS: Mapping[str, Any] = {}
_MAP_FUSION, _FIXED_LAG, _PARTICLE = MapFusionParams(), FixedLagParams(), ParticleParams()


def automatic_name(on_plan: bool) -> EstimatorName:
    """Return the name of the estimator where none is chosen: the one that keeps to the floor plan if there is one."""
    return "particle" if on_plan else "factor-graph"


def estimator_named(
    name: str,
    parameters: Mapping[str, Any] = _NO_PARAMETERS,
    map_fusion: MapFusionParams = _MAP_FUSION,
    fixed_lag: FixedLagParams = _FIXED_LAG,
    particle: ParticleParams = _PARTICLE,
    on_plan: bool = False,
) -> Estimator:
    """Make an estimator.

    Parameters
    ----------
    name
        One of `ESTIMATORS`, "auto", or the dotted name, `module:attribute`, of one from outside the package.
    parameters
        Arguments of the class or function that a dotted name stands for.
    map_fusion, fixed_lag, particle
        Parameters of the estimators of the package.
    on_plan
        True if the walk has a floor plan, which decides for "auto".

    Raises
    ------
    EstimationError
        For an unknown name.
    PartError
        For an estimator from outside the package that cannot be made.
    """
    if is_external(name):
        own: Estimator = named_part(name, parameters, ESTIMATOR, "estimator.name", {})
        return own
    if name == AUTO:
        name = automatic_name(on_plan)
    if name not in SPECS:
        raise EstimationError(f"unknown estimator {name!r}: choose one of {', '.join((AUTO, *ESTIMATORS))}")
    return BuiltInEstimator(SPECS[name], EstimatorSettings(map_fusion, fixed_lag, particle))


def estimate_walk(
    name: str,
    devices: Sequence[DeviceMeasurements],
    start: StartPose,
    sigma_length_scale: float,
    tethers: Sequence[DeviceTether] = (),
    map_fusion: MapFusionParams = _MAP_FUSION,
    fixed_lag: FixedLagParams = _FIXED_LAG,
    particle: ParticleParams = _PARTICLE,
) -> Track:
    """Estimate the tracks of all devices of one walk by an estimator of the package.

    Parameters
    ----------
    name
        One of `ESTIMATORS`.
    devices
        Measurements of each device. A position fix of the walk stands among those of every device, and each gets its
        share of the information.
    start
        Start pose, as far as it is known.
    sigma_length_scale
        Standard deviation of the walker's length scale.
    tethers
        Tethers between the devices.
    map_fusion, fixed_lag, particle
        Parameters of map-closed-form and map-general, of fixed-lag, and of particle.

    Raises
    ------
    EstimationError
        For odometry out of order, a tether to an unknown device, or a graph without a unique solution.
    """
    estimator = estimator_named(name, map_fusion=map_fusion, fixed_lag=fixed_lag, particle=particle)
    return estimator.estimate(devices, tethers, start, sigma_length_scale)


def estimate_track(
    name: str,
    device: str,
    start_s: float,
    measurements: Iterable[Measurement],
    start: StartPose,
    sigma_length_scale: float,
) -> Track:
    """Estimate the track of a single device; `estimate_walk` explains the arguments. start_s: time of its start."""
    return estimate_walk(name, [DeviceMeasurements(device, start_s, tuple(measurements))], start, sigma_length_scale)
