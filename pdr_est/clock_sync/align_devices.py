"""Put all devices of a recording on the clock of the first device."""

from collections.abc import Sequence
from dataclasses import replace
from math import exp
from typing import Literal

from pdr_est.clock_sync.clock_model import apply_clock
from pdr_est.clock_sync.from_config import GivenClock, device_clocks_from_config
from pdr_est.clock_sync.from_messages import device_clocks_from_messages
from pdr_est.clock_sync.from_motion import estimate_clock_and_same_walk_odds
from pdr_est.clock_sync.overlap import coverage_warnings, require_overlap
from pdr_est.errors import RecordingError
from pdr_est.types.clock import ClockEstimate
from pdr_est.types.recording import DeviceRecording, Recording

_CERTAIN = 0.95  # probability of one walk above which there is no warning; ours

ClockMethod = Literal["walk", "messages", "given", "none"]


def align_device_clocks(
    recording: Recording, method: ClockMethod = "walk", given: Sequence[GivenClock] = ()
) -> list[tuple[DeviceRecording, ClockEstimate | None]]:
    """Convert the time stamps of every device to the clock of the first device.

    Parameters
    ----------
    recording
        Walk with one or more devices.
    method
        "walk" estimates the clocks from the recorded motion, "messages" from the clock messages of the recording,
        "given" takes those of `given`, "none" keeps the time stamps as they are.
    given
        Clocks from the configuration; used by the method "given" only.

    Returns
    -------
    list of (DeviceRecording, ClockEstimate or None)
        Every device on the reference clock, with its estimated clock. The clock is None for the first device, for
        the method "none", and for a device whose clock cannot be estimated from its motion. A poor estimate from
        motion is returned but not applied: the time stamps stay as recorded, and a warning of the device says so.

    Raises
    ------
    RecordingError
        For recordings that are not of one walk ("walk"), clock messages that cannot be used ("messages"), and for a
        device that recorded less than 5 s together with any other device.
    ConfigError
        For given clocks that cannot be used.
    """
    aligned = _aligned(recording, method, given)
    devices = [device for device, _ in aligned]
    require_overlap(devices)
    warnings = coverage_warnings(devices)
    return [(_with_warnings(device, *warnings.get(device.name, ())), clock) for device, clock in aligned]


def _aligned(
    recording: Recording, method: ClockMethod, given: Sequence[GivenClock]
) -> list[tuple[DeviceRecording, ClockEstimate | None]]:
    """Apply the clocks that the method gives."""
    first, *others = recording.devices
    if method == "none":
        return [(device, None) for device in recording.devices]
    if method == "walk":
        return [(first, None), *(_align_by_motion(first, other) for other in others)]
    if method == "messages":
        clocks = device_clocks_from_messages(recording)
    else:
        clocks = device_clocks_from_config([device.name for device in recording.devices], given)
    applied = [(apply_clock(other, clock), clock) for other, clock in zip(others, clocks, strict=True)]
    return [(first, None), *applied]


def _align_by_motion(
    reference: DeviceRecording, other: DeviceRecording
) -> tuple[DeviceRecording, ClockEstimate | None]:
    """Estimate the clock of one device from motion and apply it unless it is poor."""
    try:
        clock, log_odds = estimate_clock_and_same_walk_odds(reference, other)
    except RecordingError as error:
        return _with_warnings(other, f"clock taken as recorded: {error}"), None
    if log_odds is not None and log_odds < 0.0:
        raise RecordingError(
            f"{reference.name} and {other.name}: no shift of the clocks makes their steps coincide (probability of "
            f"one walk {_probability(log_odds):.2g}), so these are not recordings of one walk: smooth them one by "
            "one, or use --clock none (devices.clock) if you know that their clocks agree"
        )
    other = _with_warnings(other, *_same_walk_warnings(log_odds))
    if clock.poor:
        reasons = "; ".join(clock.doubts)
        return _with_warnings(other, f"clock taken as recorded: it cannot be found from the walk ({reasons})"), clock
    return apply_clock(other, clock), clock


def _probability(log_odds: float) -> float:
    return 1.0 / (1.0 + exp(-log_odds))


def _same_walk_warnings(log_odds: float | None) -> tuple[str, ...]:
    """Warn if it is not quite certain that the devices recorded one walk."""
    if log_odds is None or _probability(log_odds) >= _CERTAIN:
        return ()
    return (f"it is not certain that this is the same walk (probability {_probability(log_odds):.2g})",)


def _with_warnings(device: DeviceRecording, *warnings: str) -> DeviceRecording:
    return replace(device, warnings=(*device.warnings, *warnings))
