"""The clocks of a recording's devices from the messages that they exchanged."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.clock_sync.clock_model import from_messages
from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.types.clock import ClockEstimate
from pdr_est.types.recording import ClockMessages, DeviceRecording, Recording

_EPOCH_FROM_S = 1e9  # larger stamps are Unix times
_FAR_S = 86_400.0  # no clock is known a day before or after it was compared
_POOR_S = 0.1  # a tenth of a second is a fifth of a step
_FIRST_LINE = 2  # of the rows, behind the header


def clocks_by_messages(recording: Recording) -> list[ClockEstimate]:
    """The clocks of all devices but the first, against the first; each must have answered at least one message.

    Raises RecordingError for messages of devices that are not there, for a device without any, and for stamps that
    are not on the clock of the recording.
    """
    first, *others = recording.devices
    names = [device.name for device in others]
    if not recording.messages:
        raise RecordingError(
            f"{recording.name}: devices.clock = messages, but no clock messages are known: give them with --messages "
            "FILE.csv, or choose another --clock"
        )
    for messages in recording.messages:
        for line, name in enumerate(messages.device, start=_FIRST_LINE):
            if name not in names:
                raise RecordingError(f"{messages.place}, line {line}: device {name!r}: {_who_answers(first, names)}")
    return [_of_device(recording, first, other) for other in others]


def _who_answers(first: DeviceRecording, names: list[str]) -> str:
    if not names:
        return f"there is no device but {first.name!r}: give the other recording too, or leave the messages out"
    known = ", ".join(map(repr, names))
    return f"the devices that answer the first one, {first.name!r}, are {known}: name one of them"


def _of_device(recording: Recording, first: DeviceRecording, other: DeviceRecording) -> ClockEstimate:
    t1_s, t2_s, t3_s = (np.concatenate(parts) for parts in zip(*_stamps(recording, first, other), strict=True))
    if not len(t1_s):
        places = ", ".join(messages.place for messages in recording.messages)
        raise RecordingError(f"{places}: no message of device {other.name!r}: add one, or choose another --clock")
    clock = from_messages(t1_s, t2_s, t3_s)
    span_s = first.span_s
    if span_s is None:
        return clock
    worst_s = float(clock.sigma_at(np.array(span_s)).max())
    if clock.sigma_s < _POOR_S <= worst_s:
        doubt = f"known to {worst_s:.2f} s only where the recording is farthest from the messages"
        clock = replace(clock, doubts=(*clock.doubts, doubt))
    return clock


def _stamps(recording: Recording, first: DeviceRecording, other: DeviceRecording) -> list[tuple[Array, Array, Array]]:
    """T1, T2, T3 of a device's exchanges, a table each, on the times of the two recordings."""
    found = []
    for messages in recording.messages:
        its = np.flatnonzero(np.array(messages.device) == other.name)
        t1_s, t3_s = (_as_recorded(t, recording, first) for t in (messages.t1_s[its], messages.t3_s[its]))
        t2_s = _as_recorded(messages.t2_s[its], recording, other)
        for name, times_s, device in (("t1_s", t1_s, first), ("t2_s", t2_s, other), ("t3_s", t3_s, first)):
            _refuse_far(messages, name, its, times_s, device)
        found.append((t1_s, t2_s, t3_s))
    return found


def _as_recorded(stamps_s: Array, recording: Recording, device: DeviceRecording) -> Array:
    """Stamps in the recorder's seconds or in Unix time, on the times that the recording has for the device."""
    if recording.epoch_s is None:
        return stamps_s + device.clock_shift_s
    span_s = device.span_s
    unix = (stamps_s > _EPOCH_FROM_S) & (span_s is None or span_s[1] < _EPOCH_FROM_S)
    return np.where(unix, stamps_s - recording.epoch_s, stamps_s + device.clock_shift_s)


def _refuse_far(
    messages: ClockMessages, name: str, its: NDArray[np.int64], times_s: Array, device: DeviceRecording
) -> None:
    span_s = device.span_s
    if span_s is None:
        return
    far = np.flatnonzero((times_s < span_s[0] - _FAR_S) | (times_s > span_s[1] + _FAR_S))
    if len(far):
        row = int(its[far[0]])
        begin_s, end_s = (time_s - device.clock_shift_s for time_s in span_s)
        raise RecordingError(
            f"{messages.place}, line {row + _FIRST_LINE}: {name} = {getattr(messages, name)[row]:.6f} is far from "
            f"what {device.name} recorded ({begin_s:.3f} to {end_s:.3f} s): give it on that device's clock"
        )
