"""The devices of a walk on the clock of the first one."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from pdr_est.clock_sync.clock_model import apply_clock
from pdr_est.clock_sync.from_config import GivenClock, clocks_given
from pdr_est.clock_sync.from_messages import clocks_by_messages
from pdr_est.clock_sync.from_motion import clock_and_steps
from pdr_est.clock_sync.overlap import outside_others, refuse_apart
from pdr_est.clock_sync.same_walk import LEAST_AGREEMENT
from pdr_est.errors import RecordingError
from pdr_est.types.clock import ClockEstimate
from pdr_est.types.recording import DeviceRecording, Recording

ClockMethod = Literal["walk", "messages", "given", "none"]


def on_one_clock(
    recording: Recording, method: ClockMethod = "walk", given: Sequence[GivenClock] = ()
) -> list[tuple[DeviceRecording, ClockEstimate | None]]:
    """Each device, with its times on the clock of the first one, and its own clock; None for the first device and for
    one whose clock is not known.

    method: "walk" finds the clocks from what was recorded, "messages" from the recording's messages, "given" takes
    those of `given`, "none" leaves the times as they are. A poor estimate from the walk changes nothing: the clock
    stays as the recording has it, and a warning says so. Raises RecordingError for recordings that are not of one
    walk ("walk"), for messages that cannot be used, and for a device that hardly recorded together with another;
    ConfigError for given clocks that cannot be used.
    """
    aligned = _aligned(recording, method, given)
    devices = [device for device, _ in aligned]
    refuse_apart(devices)
    outside = outside_others(devices)
    return [(_doubted(device, *outside.get(device.name, ())), clock) for device, clock in aligned]


def _aligned(
    recording: Recording, method: ClockMethod, given: Sequence[GivenClock]
) -> list[tuple[DeviceRecording, ClockEstimate | None]]:
    first, *others = recording.devices
    if method == "none":
        return [(device, None) for device in recording.devices]
    if method == "walk":
        return [(first, None), *(_by_walk(first, other) for other in others)]
    if method == "messages":
        clocks = clocks_by_messages(recording)
    else:
        clocks = clocks_given([device.name for device in recording.devices], given)
    applied = [(apply_clock(other, clock), clock) for other, clock in zip(others, clocks, strict=True)]
    return [(first, None), *applied]


def _by_walk(reference: DeviceRecording, other: DeviceRecording) -> tuple[DeviceRecording, ClockEstimate | None]:
    try:
        clock, agreement = clock_and_steps(reference, other)
    except RecordingError as error:
        return _doubted(other, f"clock taken as recorded: {error}"), None
    if agreement is not None and agreement < LEAST_AGREEMENT:
        raise RecordingError(
            f"{reference.name} and {other.name}: their steps fall together at no shift of the clocks (agreement "
            f"{agreement:.2f}, at least {LEAST_AGREEMENT:g} in one walk): these are not recordings of one walk: "
            "smooth them one by one, or force it with --clock none (devices.clock) if their clocks agree"
        )
    if clock.poor:
        reasons = "; ".join(clock.doubts)
        return _doubted(other, f"clock taken as recorded: the walk does not tell it ({reasons})"), clock
    return apply_clock(other, clock), clock


def _doubted(device: DeviceRecording, *warnings: str) -> DeviceRecording:
    return replace(device, warnings=(*device.warnings, *warnings))
