"""The estimator of a walk: its choice, its run, and what is added to the tracks of the devices that it returns.

What is needed for tracks alone is imported at use: it is slow to load, and steps are found without it.
"""

from collections.abc import Sequence
from dataclasses import replace

from pdr_est.config import Config
from pdr_est.config.contradictions import unused_closure
from pdr_est.errors import ConfigError, EstimationError
from pdr_est.estimators import Estimator
from pdr_est.parts import ESTIMATOR, Parts, given_part
from pdr_est.pipeline.garbage_collection import collection_paused
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.measurements import LATE_START_S, DeviceMeasurements, DeviceTether
from pdr_est.types.track import Track, concatenate


def chosen_estimator(config: Config, parts: Parts, on_plan: bool = False) -> Estimator:
    """Make the estimator that was given in Python, else the configured one of a walk with a floor plan or without.

    Raises ConfigError for one that cannot be made, or that makes no use of a closed walk.
    """
    if parts.estimator is None:
        return config.estimator.make(on_plan)
    estimator: Estimator = given_part(parts.estimator, ESTIMATOR, "Parts: estimator", {})
    words = unused_closure(estimator.spec) if config.start.closed else None
    if words is not None:
        raise ConfigError(words)
    return estimator


@collection_paused()
def run_estimator(
    devices: Sequence[DeviceMeasurements], tethers: Sequence[DeviceTether], estimator: Estimator, config: Config
) -> Track:
    """Estimate the track of every device.

    Another device leads one that began late from the start of the walk to its own start; an estimator that also works
    online places a late device by itself.

    Raises EstimationError for measurements that give no track, and for an estimator that returns no track of every
    device.
    """
    from pdr_est.estimators.common.late_start import extend_late_devices, without_extension

    extended = devices if estimator.spec.online else extend_late_devices(devices, LATE_START_S)
    track = estimator.estimate(extended, tethers, config.start.pose(), config.odometry.sigma_length_scale)
    names = tuple(one.device for one in devices)
    if not isinstance(track, Track) or track.devices != names:
        found = track.devices if isinstance(track, Track) else type(track).__name__
        raise EstimationError(
            f"the estimator {estimator.spec.name} returned {found}: it must return a Track of the devices {names}"
        )
    return without_extension(track, devices, extended)


def with_findings(
    track: Track,
    walks: Sequence[DeviceWalk],
    devices: Sequence[DeviceMeasurements],
    tethers: Sequence[DeviceTether],
    estimator: Estimator,
    config: Config,
) -> Track:
    """Add what does not fit in the walk, and what the front ends have found, to what the estimator has found."""
    from pdr_est.evaluate.walk_findings import findings_of

    start, sigma = config.start.pose(), config.odometry.sigma_length_scale
    by_front_end = tuple(finding for walk in walks for finding in walk.findings)
    of_walk = findings_of(track, devices, tethers, start, sigma, estimator.spec)
    return replace(track, findings=(*track.findings, *by_front_end, *of_walk))


def with_height(track: Track, walks: Sequence[DeviceWalk]) -> Track:
    """Add height and floor of the walker, by the first device that recorded the air pressure."""
    return replace(track, height=next((walk.height for walk in walks if walk.height is not None), None))


def with_person(track: Track, config: Config) -> Track:
    """Put the tracks of several devices where they sit on the body, and add the track of the person."""
    if len(track.devices) < 2:
        return track
    from pdr_est.estimators.person.track import at_lever_arm, fuse

    placed = [
        at_lever_arm(track.of_device(name), config.devices.mounting_of(name).offset_m) for name in track.devices
    ]
    return concatenate([*placed, fuse(track)])
