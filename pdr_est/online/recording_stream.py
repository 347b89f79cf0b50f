"""Recordings as a stream: their samples in the order in which they were made, a tenth of a second at a time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.config import Config
from pdr_est.online.device_front_end import ExpectedDevice
from pdr_est.pipeline.front_end_chain import north_of
from pdr_est.preprocessing.quality.requirements import (
    prefers_recorded_attitude,
    require_plausible_samples,
    require_track_sensors,
)
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Recording
from pdr_est.types.sensors import SensorBlock

SLICE_S = 0.1
"""Duration of a slice, s."""


@dataclass(frozen=True)
class StreamSlice:
    """Samples and fixes since the previous slice.

    Attributes
    ----------
    time_s
        End of the slice.
    blocks
        Names of devices with their samples.
    fixes
        Position fixes.
    """

    time_s: float
    blocks: tuple[tuple[str, SensorBlock], ...]
    fixes: tuple[PositionFix, ...]


def expected_devices(recording: Recording, config: Config) -> list[ExpectedDevice]:
    """Describe the devices of a recording for a tracker.

    Parameters
    ----------
    recording
        The recording.
    config
        Configuration of the tracker.

    Raises
    ------
    RecordingError
        For a device that lacks a sensor without which there is no track, or whose samples have a wrong unit or an
        impossible clock.
    """
    for device in recording.devices:
        require_track_sensors(device, recording.place_of(device))
        require_plausible_samples(device, recording.place_of(device))
    auto = config.attitude.source == "auto"
    # Which of several devices will know north is not known in advance, and the others could not be placed beside it.
    alone = len(recording.devices) == 1
    return [
        ExpectedDevice(
            device.name,
            prefers_recorded_attitude(device) if auto else None,
            north_of(device, recording, config) if alone else None,
            device.restarts_s,
        )
        for device in recording.devices
    ]


def stream_slices(devices: Sequence[DeviceRecording], fixes: Sequence[PositionFix] = ()) -> Iterator[StreamSlice]:
    """Divide recordings into slices of a tenth of a second.

    A sample with a time before that of its predecessor comes with its predecessor.

    Parameters
    ----------
    devices
        Recorded devices.
    fixes
        Position fixes; each comes with the slice in which its time lies.
    """
    streams = [
        (device.name, block, np.maximum.accumulate(block.time_s)) for device in devices for block in device.blocks()
    ]
    begin_s = min(float(came_s[0]) for _, _, came_s in streams)
    end_s = max(float(came_s[-1]) for _, _, came_s in streams)
    done, waiting = [0] * len(streams), sorted(fixes, key=lambda fix: fix.time_s)
    now_s = begin_s
    while now_s < end_s:
        next_s = min(
            (float(came[k]) for (_, _, came), k in zip(streams, done, strict=True) if k < len(came)), default=end_s
        )
        now_s = max(now_s, next_s) + SLICE_S  # skips gaps
        blocks = []
        for i, (name, block, came_s) in enumerate(streams):
            stop = int(np.searchsorted(came_s, now_s, side="right"))
            if stop > done[i]:
                part = slice(done[i], stop)
                blocks.append((name, SensorBlock(block.channel, block.time_s[part], block.values[part])))
                done[i] = stop
        known = [fix for fix in waiting if fix.time_s <= now_s]
        waiting = waiting[len(known) :]
        yield StreamSlice(now_s, tuple(blocks), tuple(known))
    if waiting:
        yield StreamSlice(now_s, (), tuple(waiting))
