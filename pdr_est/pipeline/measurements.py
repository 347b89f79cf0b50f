"""Measurements of each device for the estimator, and the track of the person from the tracks of the devices."""

from collections.abc import Sequence
from dataclasses import replace

from pdr_est.config import Config
from pdr_est.config.contradictions import unused_closure
from pdr_est.errors import ConfigError, EstimationError
from pdr_est.estimators import Estimator, EstimatorSpec
from pdr_est.estimators.common.fix_noise import fixes_with_noise
from pdr_est.estimators.common.late_start import extend_late_devices, without_extension
from pdr_est.estimators.common.map_directions import resolve_relative_priors
from pdr_est.estimators.common.tethers import tethers_between
from pdr_est.estimators.person.track import at_lever_arm, fuse
from pdr_est.evaluate.walk_findings import findings_of
from pdr_est.parts import ESTIMATOR, Parts, given_part
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.measurements import (
    LATE_START_S,
    DeviceMeasurements,
    DeviceTether,
    HeadingPrior,
    LoopClosure,
    Measurement,
    PositionFix,
)
from pdr_est.types.track import Track, concatenate


def refuse_without_heading(walks: Sequence[DeviceWalk]) -> None:
    """Raise EstimationError for a device without gyroscope."""
    for walk in walks:
        if not walk.has_heading:
            raise EstimationError(
                f"{walk.device}: no gyroscope, so its {len(walk.steps)} steps have no direction and make no track: "
                "leave this device out"
            )


def chosen_estimator(config: Config, parts: Parts) -> Estimator:
    """Make the estimator that was given in Python, else the configured one.

    Raises ConfigError for one that cannot be made, or that makes no use of a closed walk.
    """
    if parts.estimator is None:
        return config.estimator.make()
    estimator: Estimator = given_part(parts.estimator, ESTIMATOR, "Parts: estimator", {})
    words = unused_closure(estimator.spec) if config.start.closed else None
    if words is not None:
        raise ConfigError(words)
    return estimator


def measurements_of(
    walk: DeviceWalk, config: Config, fixes: Sequence[PositionFix], spec: EstimatorSpec
) -> DeviceMeasurements:
    """Collect the measurements of a device.

    A smoother gets the headings that are known only at the end of the walk, a filter those that were known at the
    step. The fixes get the noise of their source.
    """
    odometry = walk.whole_walk_odometry if spec.smooths else walk.odometry
    closure = [LoopClosure(walk.device, config.start.sigma_closed_m)] if config.start.closed else []
    return DeviceMeasurements(
        walk.device, walk.start_s, (*odometry, *closure, *fixes_with_noise(fixes, config.fixes))
    )


def without_partial_north(devices: Sequence[DeviceMeasurements]) -> list[DeviceMeasurements]:
    """Leave the headings in the map out of a walk in which only some of its devices have any.

    The others could not be placed beside them: how their headings differ is known only roughly.
    """
    if all(any(_in_map(m) for m in one.measurements) for one in devices):
        return list(devices)
    return [replace(one, measurements=tuple(m for m in one.measurements if not _in_map(m))) for one in devices]


def _in_map(measurement: Measurement) -> bool:
    return isinstance(measurement, HeadingPrior) and not measurement.relative


def tethers_of(walks: Sequence[DeviceWalk], config: Config, spec: EstimatorSpec) -> list[DeviceTether]:
    """Make the tethers between the devices, as configured; for a smoother also one at the end of the walk."""
    if not config.devices.tethered:
        return []
    spans_s = {walk.device: walk.walking_span_s for walk in walks}
    return tethers_between(spans_s, config.devices.tether, at_end=spec.smooths)


def run_estimator(
    devices: Sequence[DeviceMeasurements], tethers: Sequence[DeviceTether], estimator: Estimator, config: Config
) -> Track:
    """Estimate the track of every device.

    Another device leads one that began late from the start of the walk to its own start; an estimator that also works
    online places a late device by itself.

    Raises EstimationError for measurements that give no track, and for an estimator that returns no track of every
    device.
    """
    extended = devices if estimator.spec.online else extend_late_devices(devices, LATE_START_S)
    track = estimator.estimate(extended, tethers, config.start.pose(), config.odometry.sigma_length_scale)
    names = tuple(one.device for one in devices)
    if not isinstance(track, Track) or track.devices != names:
        found = track.devices if isinstance(track, Track) else type(track).__name__
        raise EstimationError(
            f"the estimator {estimator.spec.name} returned {found}: it must return a Track of the devices {names}"
        )
    return without_extension(track, devices, extended)


def with_map_directions(
    known: DeviceMeasurements, walk: DeviceWalk, track: Track, direction_rad: float
) -> DeviceMeasurements:
    """Tie the dominant directions that a walk shows to one that is known in the map.

    Parameters
    ----------
    known
        Measurements of the device.
    walk
        Its analysis, with the dominant directions.
    track
        Track from the same measurements without that knowledge.
    direction_rad
        One of the directions in the map, rad, counter-clockwise from east.
    """
    if walk.directions is None:
        return known
    own = track.of_device(walk.device)
    tied = resolve_relative_priors(known.measurements, own, direction_rad, walk.directions.spacing_rad)
    return replace(known, measurements=tuple(tied))


def with_findings(
    track: Track,
    walks: Sequence[DeviceWalk],
    devices: Sequence[DeviceMeasurements],
    tethers: Sequence[DeviceTether],
    estimator: Estimator,
    config: Config,
) -> Track:
    """Add what does not fit in the walk, and what the front ends have found, to what the estimator has found."""
    start, sigma = config.start.pose(), config.odometry.sigma_length_scale
    by_front_end = tuple(finding for walk in walks for finding in walk.findings)
    of_walk = findings_of(track, devices, tethers, start, sigma, estimator.spec)
    return replace(track, findings=(*track.findings, *by_front_end, *of_walk))


def with_person(track: Track, config: Config) -> Track:
    """Put the tracks of several devices where they sit on the body, and add the track of the person."""
    if len(track.devices) < 2:
        return track
    placed = [
        at_lever_arm(track.of_device(name), config.devices.mounting_of(name).offset_m) for name in track.devices
    ]
    return concatenate([*placed, fuse(track)])
