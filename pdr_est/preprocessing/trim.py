"""Cut a time span out of a recording."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from pdr_est.errors import RecordingError
from pdr_est.types.ground_truth import TruePositions, TrueSteps, TrueStrides, TrueTurns, Truth
from pdr_est.types.recording import DeviceRecording, Recording, Signal


def trim_recording(recording: Recording, start_s: float, end_s: float = math.inf) -> Recording:
    """Keep what was recorded from start_s to end_s, both inclusive.

    Signals, annotated truth and fixes outside are removed; the time stamps stay as they are. Step count and distance
    of the whole walk do not hold for a part of it and become None. Devices without a sample inside are left out, and
    a note says so.

    Parameters
    ----------
    recording
        Recording to cut; it is not changed.
    start_s, end_s
        Time span, s on the clock of the recording.

    Raises
    ------
    RecordingError
        When no device has a sample inside.
    """
    trimmed = [_trim_device(device, start_s, end_s) for device in recording.devices]
    devices = tuple(device for device in trimmed if device.span_s is not None)
    if not devices:
        raise RecordingError(
            f"{recording.name}: no sample between {start_s:.3f} and {end_s:.3f} s: choose a span inside the recording"
        )
    return replace(
        recording,
        devices=devices,
        truth=_trim_truth(recording.truth, start_s, end_s),
        fixes=tuple(fix for fix in recording.fixes if start_s <= fix.time_s <= end_s),
        waypoints=tuple(fix for fix in recording.waypoints if start_s <= fix.time_s <= end_s),
        notes=(*recording.notes, f"cut to {start_s:.3f} to {end_s:.3f} s", *_absent(trimmed, devices)),
    )


def _absent(trimmed: Sequence[DeviceRecording], kept: Sequence[DeviceRecording]) -> Iterator[str]:
    """Say which devices have no sample inside."""
    for device in trimmed:
        if not any(device is other for other in kept):
            yield f"{device.name}: no sample in this time, left out"


def _trim_device(device: DeviceRecording, start_s: float, end_s: float) -> DeviceRecording:
    return replace(
        device,
        specific_force=_trim_signal(device.specific_force, start_s, end_s),
        linear_acceleration=_trim_signal(device.linear_acceleration, start_s, end_s),
        rotation_rate=_trim_signal(device.rotation_rate, start_s, end_s),
        magnetic_field=_trim_signal(device.magnetic_field, start_s, end_s),
        attitude=_trim_signal(device.attitude, start_s, end_s),
        pressure=_trim_signal(device.pressure, start_s, end_s),
    )


def _trim_signal(signal: Signal | None, start_s: float, end_s: float) -> Signal | None:
    if signal is None:
        return None
    # A mask and not a slice: the clock of a recording may jump back.
    inside = (signal.time_s >= start_s) & (signal.time_s <= end_s)
    return Signal(signal.time_s[inside], signal.values[inside])


def _trim_truth(truth: Truth, start_s: float, end_s: float) -> Truth:
    return Truth(
        positions=_trim_positions(truth.positions, start_s, end_s),
        steps=_trim_steps(truth.steps, start_s, end_s),
        turns=_trim_turns(truth.turns, start_s, end_s),
        activity=truth.activity,
        modes=truth.modes,
        strides=_trim_strides(truth.strides, start_s, end_s),
        speed_mps=truth.speed_mps,
    )


def _trim_positions(positions: TruePositions | None, start_s: float, end_s: float) -> TruePositions | None:
    if positions is None:
        return None
    inside = (positions.time_s >= start_s) & (positions.time_s <= end_s)
    return replace(positions, time_s=positions.time_s[inside], position_m=positions.position_m[inside])


def _trim_steps(steps: TrueSteps | None, start_s: float, end_s: float) -> TrueSteps | None:
    if steps is None:
        return None
    inside = (steps.time_s >= start_s) & (steps.time_s <= end_s)
    return TrueSteps(steps.time_s[inside], steps.foot[inside])


def _trim_turns(turns: TrueTurns | None, start_s: float, end_s: float) -> TrueTurns | None:
    if turns is None:
        return None
    inside = (turns.time_s >= start_s) & (turns.time_s <= end_s)
    return TrueTurns(turns.time_s[inside], turns.angle_rad[inside])


def _trim_strides(strides: TrueStrides | None, start_s: float, end_s: float) -> TrueStrides | None:
    if strides is None:
        return None
    inside = (strides.start_s >= start_s) & (strides.end_s <= end_s)
    return TrueStrides(strides.start_s[inside], strides.end_s[inside], strides.length_m[inside])
