"""The top of the system: a recording becomes measurements, measurements become a track."""

import time
from collections.abc import Sequence
from dataclasses import replace

from pdr_est.clock_sync import align_device_clocks
from pdr_est.config import Config, check
from pdr_est.pipeline.front_end_chain import analyse_device
from pdr_est.pipeline.measurements import in_map, measured, refuse_without_heading, tethers, track_of, with_person
from pdr_est.pipeline.warnings import mismatches, warnings_of
from pdr_est.preprocessing.quality.requirements import require_track_sensors
from pdr_est.types.analysis import DeviceWalk, SmoothedWalk
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.track import Track

__all__ = ["DeviceWalk", "SmoothedWalk", "analyse", "estimate", "smooth"]


def smooth(recording: Recording, config: Config, fixes: Sequence[PositionFix] = ()) -> SmoothedWalk:
    """The track of a recorded walk, with everything a report needs.

    Raises ConfigError for values out of range, RecordingError if a device lacks a sensor that is needed.
    """
    check(config)
    for device in recording.devices:
        require_track_sensors(device, recording.place_of(device), one_of_several=len(recording.devices) > 1)
    started = time.process_time()
    devices = analyse(recording, config)
    analysed = time.process_time()
    track = estimate(devices, config, fixes)
    estimated = time.process_time()
    return SmoothedWalk(
        track=track,
        devices=devices,
        fixes=tuple(fixes),
        timings_s={"front_end": analysed - started, "estimator": estimated - analysed},
        warnings=(*warnings_of(recording, devices), *mismatches(devices, config, fixes)),
    )


def analyse(recording: Recording, config: Config) -> tuple[DeviceWalk, ...]:
    """The front end on every device of a recording; one without gyroscope has steps without heading.

    Raises RecordingError if a device has no accelerometer, or samples that cannot be used, and when the devices or
    their clocks do not belong together.
    """
    walks = []
    for device, clock in align_device_clocks(recording, config.devices.clock, config.devices.clocks):
        walk = analyse_device(device, recording.place_of(device), config)
        walks.append(replace(walk, clock=clock, warnings=device.warnings))
    return tuple(walks)


def estimate(walks: Sequence[DeviceWalk], config: Config, fixes: Sequence[PositionFix] = ()) -> Track:
    """The configured estimator on the measurements of every device, and of several devices the person's track.

    Raises EstimationError for a device without gyroscope, and what `estimate_walk` raises.
    """
    refuse_without_heading(walks)
    devices, node_tethers = [measured(walk, config, fixes) for walk in walks], tethers(walks, config)
    track = track_of(devices, node_tethers, config)
    direction_rad = config.heading.dominant.direction_rad
    if direction_rad is not None:
        devices = [in_map(one, walk, track, direction_rad) for one, walk in zip(devices, walks, strict=True)]
        track = track_of(devices, node_tethers, config)
    return with_person(track, config) if len(walks) > 1 else track
