"""The devices of a walk on the clock of the first one."""

from collections.abc import Sequence
from dataclasses import replace

from pdr_est.errors import RecordingError
from pdr_est.io.recording import DeviceRecording
from pdr_est.synchronise.clock import ClockEstimate, apply_clock
from pdr_est.synchronise.walk import estimate_clock


def on_one_clock(devices: Sequence[DeviceRecording]) -> list[tuple[DeviceRecording, ClockEstimate | None]]:
    """Each device, with its times on the clock of the first one, and its own clock as the walk tells it; None for the
    first device and for one whose clock cannot be told.

    A poor estimate changes nothing: the clock stays as the recording has it, and a warning says so.
    """
    reference, *others = devices
    return [(reference, None), *(_on_clock_of(reference, other) for other in others)]


def _on_clock_of(reference: DeviceRecording, other: DeviceRecording) -> tuple[DeviceRecording, ClockEstimate | None]:
    try:
        clock = estimate_clock(reference, other)
    except RecordingError as error:
        return _doubted(other, f"clock taken as recorded: {error}"), None
    if clock.poor:
        reasons = "; ".join(clock.doubts)
        return _doubted(other, f"clock taken as recorded: the walk does not tell it ({reasons})"), clock
    return apply_clock(other, clock), clock


def _doubted(device: DeviceRecording, warning: str) -> DeviceRecording:
    return replace(device, warnings=(*device.warnings, warning))
