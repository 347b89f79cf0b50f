"""The estimators of the package in one table: what each can do, and how it is called.

Each is imported when it is called, with filterpy or gtsam: who detects steps or reads the table needs none of them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.timeline import Timeline, timelines_of
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.robust_dr.params import MapFusionParams
from pdr_est.estimators.spec import EstimatorSpec, OnlineFilter
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether, StartPose
from pdr_est.types.track import Track, concatenate


@dataclass(frozen=True)
class EstimatorSettings:
    """Parameters of the estimators of the package.

    Attributes
    ----------
    map_fusion
        Parameters of map-closed-form and map-general.
    fixed_lag
        Parameters of fixed-lag.
    particle
        Parameters of particle.
    """

    map_fusion: MapFusionParams
    fixed_lag: FixedLagParams
    particle: ParticleParams


@dataclass(frozen=True)
class BuiltInEstimator:
    """An estimator of the package with its parameters; it fits the contract `pdr_est.estimators.spec.Estimator`.

    Attributes
    ----------
    spec
        Abilities of the estimator.
    settings
        Parameters of all estimators of the package, of which each takes its own.
    """

    spec: EstimatorSpec
    settings: EstimatorSettings

    def estimate(
        self,
        devices: Sequence[DeviceMeasurements],
        tethers: Sequence[DeviceTether],
        start: StartPose,
        sigma_length_scale: float,
    ) -> Track:
        """Estimate the track of every device, as the contract says.

        For an estimator that smooths, the fixes are compared with the steps first; then it smooths each alternative
        that the measurements leave open. A filter takes the fixes one by one as they are. The devices are taken in
        the order of their names, so that the order in which they are given makes no difference: where nothing tells
        the direction of the walk, it counts from that of the first device.
        """
        ordered = sorted(devices, key=lambda one: one.device)
        track = self._estimate_checked(ordered, _in_order(tethers), start, sigma_length_scale)
        names = [one.device for one in devices]
        if names == [one.device for one in ordered]:
            return track
        return concatenate([track.of_device(name) for name in names])

    @property
    def has_filter(self) -> bool:
        """Tell whether `begin` makes an online filter; the others that work online are part of the tracker."""
        return self.spec.name in _FILTERS

    def begin(self, devices: Sequence[str], start: StartPose, sigma_length_scale: float) -> OnlineFilter:
        """Make the filter of a walk, as the contract says.

        Raises
        ------
        EstimationError
            For an estimator without a filter of its own.
        """
        if not self.has_filter:
            raise EstimationError(f"the estimator {self.spec.name} has no filter of its own: use it by a Tracker")
        return _FILTERS[self.spec.name](devices, start, sigma_length_scale, self.settings)

    def _estimate_checked(
        self,
        devices: Sequence[DeviceMeasurements],
        tethers: Sequence[DeviceTether],
        start: StartPose,
        sigma_length_scale: float,
    ) -> Track:
        if not self.spec.smooths:
            return self._estimate(devices, tethers, start, sigma_length_scale)
        from pdr_est.estimators.common.length_scale_check import track_scale_finding
        from pdr_est.estimators.fix_checks import check_fixes

        checked = check_fixes(devices, start, sigma_length_scale)
        track = self._estimate(checked.devices, tethers, checked.start, checked.sigma_length_scale)
        scale = track_scale_finding(track, devices, start, sigma_length_scale)
        found = (*checked.findings, *track.findings, *([] if scale is None else [scale]))
        return replace(track, findings=tuple(dict.fromkeys(found)))

    def _estimate(
        self,
        devices: Sequence[DeviceMeasurements],
        tethers: Sequence[DeviceTether],
        start: StartPose,
        sigma_length_scale: float,
    ) -> Track:
        walk = _Walk(timelines_of(devices, tethers), tethers, start, sigma_length_scale, self.settings, devices)
        call = _CALLS[self.spec.name]
        if not self.spec.smooths or self.spec.weighs_alternatives:
            return call(walk)
        from pdr_est.estimators.alternatives import alternatives_of, estimate_alternatives

        alternatives = alternatives_of(walk.timelines, start, sigma_length_scale)
        return estimate_alternatives(
            alternatives,
            lambda one: call(replace(walk, timelines=one.timelines, start_headings_rad=one.start_headings_rad)),
        )


def _in_order(tethers: Sequence[DeviceTether]) -> list[DeviceTether]:
    """Return tethers in order of time and of the names of their devices, also of the two of each."""
    named = [
        replace(one, device_a=one.device_b, device_b=one.device_a) if one.device_b < one.device_a else one
        for one in tethers
    ]
    return sorted(named, key=lambda one: (one.time_s, one.device_a, one.device_b))


@dataclass(frozen=True)
class _Walk:
    """Inputs that the estimators of the package share."""

    timelines: Sequence[Timeline]
    tethers: Sequence[DeviceTether]
    start: StartPose
    sigma_length_scale: float
    settings: EstimatorSettings
    devices: Sequence[DeviceMeasurements]
    start_headings_rad: Sequence[float | None] = ()


def _dead_reckoning(walk: _Walk) -> Track:
    from pdr_est.estimators.dead_reckoning import estimate

    return concatenate([estimate(one, walk.start, walk.sigma_length_scale) for one in walk.timelines])


def _map_closed_form(walk: _Walk) -> Track:
    from pdr_est.estimators.robust_dr.fusion import estimate_closed_form

    return estimate_closed_form(
        walk.timelines, walk.tethers, walk.start, walk.sigma_length_scale, walk.settings.map_fusion
    )


def _map_general(walk: _Walk) -> Track:
    from pdr_est.estimators.robust_dr.fusion import estimate_general

    return estimate_general(
        walk.timelines, walk.tethers, walk.start, walk.sigma_length_scale, walk.settings.map_fusion
    )


def _ekf(walk: _Walk) -> Track:
    from pdr_est.estimators.kalman.ekf import estimate

    return estimate(walk.timelines, walk.tethers, walk.start, walk.sigma_length_scale)


def _factor_graph(walk: _Walk) -> Track:
    from pdr_est.estimators.heading_chain import chain_smoother

    if chain_smoother.positions_follow(walk.timelines, walk.tethers):
        return chain_smoother.estimate(walk.timelines, walk.start, walk.sigma_length_scale, walk.start_headings_rad)
    from pdr_est.estimators.factor_graph.smoother import estimate

    return estimate(walk.timelines, walk.tethers, walk.start, walk.sigma_length_scale, walk.start_headings_rad)


def _fixed_lag(walk: _Walk) -> Track:
    from pdr_est.estimators.fixed_lag.smoother import estimate

    return estimate(walk.timelines, walk.tethers, walk.start, walk.sigma_length_scale, walk.settings.fixed_lag)


def _particle(walk: _Walk) -> Track:
    from pdr_est.estimators.particle.plan.plans_in_time import floors_among
    from pdr_est.estimators.particle.smoother import estimate

    settings = walk.settings.particle
    floors = floors_among(walk.devices)
    return estimate(walk.timelines, walk.tethers, walk.start, walk.sigma_length_scale, floors, settings)


def _particle_filter(
    devices: Sequence[str], start: StartPose, sigma_length_scale: float, settings: EstimatorSettings
) -> OnlineFilter:
    from pdr_est.estimators.particle.online_filter import ParticleOnlineFilter

    return ParticleOnlineFilter(devices, start, sigma_length_scale, settings.particle)


_TABLE: tuple[tuple[EstimatorSpec, Callable[[_Walk], Track]], ...] = (
    (EstimatorSpec("dead-reckoning", uses_fixes=False), _dead_reckoning),
    (EstimatorSpec("map-closed-form", uses_fixes=False, uses_tethers=True), _map_closed_form),
    (EstimatorSpec("map-general", uses_fixes=False, uses_tethers=True), _map_general),
    (EstimatorSpec("ekf", online=True, uses_closure=True, uses_tethers=True), _ekf),
    (
        EstimatorSpec("factor-graph", smooths=True, uses_closure=True, uses_tethers=True, needs_gtsam=True),
        _factor_graph,
    ),
    (EstimatorSpec("fixed-lag", online=True, delayed=True, uses_tethers=True), _fixed_lag),
    (
        EstimatorSpec(
            "particle",
            smooths=True,
            online=True,
            uses_closure=True,
            uses_tethers=True,
            uses_plan=True,
            weighs_alternatives=True,
            sampled=True,
        ),
        _particle,
    ),
)

SPECS: Mapping[str, EstimatorSpec] = MappingProxyType({spec.name: spec for spec, _ in _TABLE})
"""Abilities of the estimators of the package, by name."""

_CALLS: Mapping[str, Callable[[_Walk], Track]] = MappingProxyType({spec.name: call for spec, call in _TABLE})

_FILTERS: Mapping[str, Callable[[Sequence[str], StartPose, float, EstimatorSettings], OnlineFilter]] = (
    MappingProxyType({"particle": _particle_filter})
)
