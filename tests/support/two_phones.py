"""A walk with two phones, and ways to push it into a tracker."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from pdr_est import pipeline
from pdr_est.config import Config, DevicesParams, StartParams
from pdr_est.estimators.person.track import NAME as FUSED
from pdr_est.frames import Array
from pdr_est.online import ExpectedDevice, OnlineParams, Tracker, Update
from pdr_est.simulate import DeviceParams, PathParams, Pause, Scenario, SensorParams, WalkerGaitParams, simulate_walk
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Recording
from pdr_est.types.sensors import SensorBlock
from pdr_est.types.track import Track, concatenate

ONE_CLOCK = Config(devices=DevicesParams(clock="none")).with_estimator("ekf")
KNOWN_START = replace(ONE_CLOCK, start=StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0))


@cache
def recorded(devices: int = 2, gap: bool = False, short: bool = False) -> Recording:
    """Simulate forty seconds around two corners with a pause, or ten around one; the second phone has a gap."""
    names = ("left", "right", "back")[:devices]
    vertices_m = ((0.0, 0.0), (14.0, 0.0), (14.0, 9.0), (4.0, 9.0))
    pause = Pause(at_m=9.0, duration_s=6.0)
    if short:
        vertices_m, pause = ((0.0, 0.0), (5.0, 0.0), (5.0, 4.0)), Pause(at_m=3.0, duration_s=2.5)
    gap_s = (6.5, 7.8) if short else (20.0, 21.5)
    scenario = Scenario(
        path=PathParams(vertices_m=vertices_m),
        gait=WalkerGaitParams(lead_in_s=1.0, lead_out_s=1.0, pauses=(pause,)),
        devices=tuple(
            DeviceParams(name=name, sensors=SensorParams(gaps_s=(gap_s,) if gap and i == 1 else ()))
            for i, name in enumerate(names)
        ),
        seed=5,
    )
    return simulate_walk(scenario).recording


def offline(recording: Recording, config: Config, fixes: Sequence[PositionFix] = ()) -> Track:
    """The estimator on the whole recording, without the track of the person."""
    track = pipeline.smooth_recording(recording, config, fixes).track
    return concatenate([track.of_device(device.name) for device in recording.devices])


def tracker_of(recording: Recording, config: Config, **online: float) -> Tracker:
    return Tracker(config, [ExpectedDevice(device.name) for device in recording.devices], OnlineParams(**online))


def fix_at(time_s: float, x_m: float, y_m: float, sigma_m: float = 0.5) -> PositionFix:
    return PositionFix(time_s, np.array([x_m, y_m]), sigma_m**2 * np.eye(2))


def radio_off(items: Iterable[tuple[str, SensorBlock]]) -> Iterator[tuple[str, SensorBlock]]:
    """What the right phone records from 17 to 27 s comes before its first block that is later."""
    held: list[tuple[str, SensorBlock]] = []
    for name, block in items:
        if name == "right" and 17.0 < block.time_s[-1] < 27.0:
            held.append((name, block))
            continue
        if name == "right":
            yield from held
            held = []
        yield name, block


def slices(recording: Recording, cuts: Sequence[Array]) -> list[tuple[str, SensorBlock]]:
    """All samples in the order of time, each device cut at its own times."""
    pieces = [
        (float(end), number, device.name, part)
        for number, (device, borders) in enumerate(zip(recording.devices, cuts, strict=True))
        for begin, end in zip([-np.inf, *borders], [*borders, np.inf], strict=True)
        for part in _between(device, begin, end)
    ]
    return [(name, part) for _, _, name, part in sorted(pieces, key=lambda piece: piece[:2])]


def _between(device: DeviceRecording, begin_s: float, end_s: float) -> Iterable[SensorBlock]:
    for block in device.blocks():
        keep = (block.time_s > begin_s) & (block.time_s <= end_s)
        if keep.any():
            yield SensorBlock(block.channel, block.time_s[keep], block.values[keep])


def of_devices(updates: Iterable[Update]) -> list[Update]:
    """All but the person's."""
    return [update for update in updates if update.device != FUSED]


def push_all(tracker: Tracker, blocks: Iterable[tuple[str, SensorBlock]]) -> list[Update]:
    updates = [update for name, block in blocks for update in tracker.push(name, block)]
    return updates + tracker.flush()
