"""Between the front end and the estimators: the measurements of each device, and the person's track from theirs."""

from collections.abc import Sequence
from dataclasses import replace

from pdr_est.config import Config
from pdr_est.errors import EstimationError
from pdr_est.estimators import ONLINE, SMOOTHERS, estimate_walk
from pdr_est.estimators.common.late_start import extend_late_devices, without_extension
from pdr_est.estimators.common.map_directions import resolve_relative_priors
from pdr_est.estimators.common.tethers import tethers_between
from pdr_est.estimators.person.track import at_lever_arm, fuse
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.measurements import LATE_S, DeviceMeasurements, DeviceTether, LoopClosure, PositionFix
from pdr_est.types.track import Track, concatenate


def refuse_without_heading(walks: Sequence[DeviceWalk]) -> None:
    """Raise EstimationError for a device without gyroscope."""
    for walk in walks:
        if not walk.has_heading:
            raise EstimationError(
                f"{walk.device}: no gyroscope, so its {len(walk.steps)} steps have no direction and make no track: "
                "leave this device out"
            )


def measured(walk: DeviceWalk, config: Config, fixes: Sequence[PositionFix]) -> DeviceMeasurements:
    """What the configured estimator gets of a device: what the whole walk tells only if it smooths."""
    own = walk.whole_walk_odometry if config.estimator.name in SMOOTHERS else walk.odometry
    closure = [LoopClosure(walk.device, config.start.sigma_closed_m)] if config.start.closed else []
    return DeviceMeasurements(walk.device, walk.start_s, (*own, *closure, *fixes))


def tethers(walks: Sequence[DeviceWalk], config: Config) -> list[DeviceTether]:
    """What holds the devices together, as configured."""
    if not config.devices.tethered:
        return []
    spans_s = {walk.device: walk.stepping_s for walk in walks}
    return tethers_between(spans_s, config.devices.tether, at_end=config.estimator.name in SMOOTHERS)


def track_of(devices: Sequence[DeviceMeasurements], node_tethers: Sequence[DeviceTether], config: Config) -> Track:
    """The configured estimator on the measurements of every device. Raises what `estimate_walk` raises.

    A device that began late is led to its start by another one; those that work online, too, know of late ones.
    """
    chosen, start = config.estimator, config.start.pose()
    sigma_scale = config.odometry.sigma_length_scale
    extended = devices if chosen.name in ONLINE else extend_late_devices(devices, LATE_S)
    track = estimate_walk(
        chosen.name, extended, start, sigma_scale, node_tethers, chosen.map_fusion, chosen.fixed_lag
    )
    return without_extension(track, devices, extended)


def in_map(known: DeviceMeasurements, walk: DeviceWalk, track: Track, direction_rad: float) -> DeviceMeasurements:
    """The measurements with the walk's directions tied to one that is known in the map. track: without that."""
    if walk.directions is None:
        return known
    own = track.of_device(walk.device)
    tied = resolve_relative_priors(known.measurements, own, direction_rad, walk.directions.spacing_rad)
    return replace(known, measurements=tuple(tied))


def with_person(track: Track, config: Config) -> Track:
    """The tracks of the devices, each where it sits on the body, and that of the person."""
    placed = [
        at_lever_arm(track.of_device(name), config.devices.mounting_of(name).offset_m) for name in track.devices
    ]
    return concatenate([*placed, fuse(track)])
