"""Recordings as a stream: their samples in the order in which they were made."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.config import Config
from pdr_est.online.device_front_end import ExpectedDevice
from pdr_est.preprocessing.quality.requirements import prefers_recorded_attitude, require_track_sensors
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording
from pdr_est.types.sensors import SensorBlock

EVERY_S = 0.1


@dataclass(frozen=True)
class StreamSlice:
    """What was made up to a time, since the moment before."""

    time_s: float
    blocks: tuple[tuple[str, SensorBlock], ...]
    fixes: tuple[PositionFix, ...]


def expected(devices: Sequence[DeviceRecording], place: str, config: Config) -> list[ExpectedDevice]:
    """What a tracker needs to know of recorded devices.

    Raises RecordingError for one that lacks a sensor without which there is no track. place: of the recording, for
    messages.
    """
    for device in devices:
        require_track_sensors(device, f"{place} ({device.name})")
    auto = config.attitude.source == "auto"
    return [ExpectedDevice(device.name, prefers_recorded_attitude(device) if auto else None) for device in devices]


def moments(devices: Sequence[DeviceRecording], fixes: Sequence[PositionFix] = ()) -> Iterator[StreamSlice]:
    """The samples of recorded devices ten times a second. A sample with a time before its predecessor's comes with
    that one."""
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
        now_s = max(now_s, next_s) + EVERY_S  # over a gap at once
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
