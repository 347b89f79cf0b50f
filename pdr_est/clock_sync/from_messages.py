"""Estimate the clocks of devices from time-stamped messages that they exchanged (Robust DR section V-B).

The first device sends a message at T1 of its clock, the other one receives it and answers at T2 of its own clock, and
the answer arrives at T3 of the first clock.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.clock_sync.robust_line import SIGMA_SKEW, fit_clock_line
from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.types.clock import ClockEstimate
from pdr_est.types.recording import ClockMessages, DeviceRecording, Recording

_LEAST_INLIER_SHARE = 0.75  # of the exchanges, on the line of a clock that does not jump; ours
_SLOW_S = 0.1  # half of a round trip from which on messages are called slow
_EPOCH_FROM_S = 1e9  # larger stamps are Unix times
_FAR_S = 86_400.0  # a day before or after the messages, their clock says nothing about the recording
_POOR_S = 0.1  # a tenth of a second is a fifth of a step
_FIRST_LINE = 2  # of the data in the table; line 1 is the header


def estimate_clock_from_messages(t1_s: Array, t2_s: Array, t3_s: Array) -> ClockEstimate:
    """Estimate the clock of a device that answered messages of the reference device.

    One exchange gives the offset T2 - (T1 + T3) / 2 if both ways take the same time; it is never wrong by more than
    half of the round trip. The paper uses one exchange and therefore has no skew; here a robust line through several
    gives one. Only exchanges of at most twice the shortest round trip count, because the others waited in a queue.

    Parameters
    ----------
    t1_s, t3_s
        (n,) times of sending and of the arrival of the answer, s on the reference clock.
    t2_s
        (n,) times of the answer, s on the clock of the other device.

    Raises
    ------
    RecordingError
        For stamps that differ in number, are not finite, or have T3 before T1.

    References
    ----------
    Robust DR, section V-B.
    """
    t1_s, t2_s, t3_s = (np.atleast_1d(np.asarray(t, dtype=np.float64)) for t in (t1_s, t2_s, t3_s))
    if not (t1_s.ndim == 1 and len(t1_s) and t1_s.shape == t2_s.shape == t3_s.shape):
        raise RecordingError(
            f"clock messages: {t1_s.size} T1, {t2_s.size} T2 and {t3_s.size} T3 stamps: give one of each per exchange"
        )
    if not (np.isfinite([t1_s, t2_s, t3_s]).all() and np.all(t3_s >= t1_s)):
        raise RecordingError(
            "clock messages: every stamp must be finite, and no answer (T3) before its question (T1)"
        )
    trip_s = t3_s - t1_s
    quick = trip_s <= 2.0 * trip_s.min() + 1e-9
    middle_s, half_s = 0.5 * (t1_s + t3_s)[quick], 0.5 * trip_s[quick]
    # The delay of one way is anywhere between none and the whole trip, and much the same in all exchanges.
    bound_s = float(np.median(half_s))
    line = fit_clock_line(middle_s, t2_s[quick] - middle_s, SIGMA_SKEW, max(bound_s / np.sqrt(3.0), 1e-4))
    asymmetry_s = bound_s / np.sqrt(3.0)
    share = float(np.mean(line.inlier))
    doubts = []
    if bound_s >= _SLOW_S:
        doubts.append(f"messages took {2.0 * bound_s:.3f} s there and back, so offsets are within half of that")
    if share < _LEAST_INLIER_SHARE:
        doubts.append(f"{line.inlier.sum()} of {len(line.inlier)} exchanges fit one line: the clock jumps")
    return ClockEstimate(
        offset_s=line.offset_s,
        skew=line.slope,
        sigma_s=max(asymmetry_s, float(np.sqrt(line.covariance[0, 0]))),
        sigma_skew=float(np.sqrt(line.covariance[1, 1])),
        at_s=line.at_s,
        quality=share,
        method="messages",
        doubts=tuple(doubts),
    )


def device_clocks_from_messages(recording: Recording) -> list[ClockEstimate]:
    """Estimate the clocks of all devices but the first, relative to the first device.

    Each of them must have answered at least one message.

    Raises
    ------
    RecordingError
        When the recording has no clock messages, or a device has none; for messages of unknown devices, and for
        stamps that are not on the clock of the recording.
    """
    first, *others = recording.devices
    names = [device.name for device in others]
    if not recording.messages:
        raise RecordingError(
            f"{recording.name}: devices.clock = messages, but the recording has no clock messages: give them with "
            "--messages FILE.csv, or choose another --clock"
        )
    for messages in recording.messages:
        for line, name in enumerate(messages.device, start=_FIRST_LINE):
            if name not in names:
                hint = _hint_for_unknown_device(first, names)
                raise RecordingError(f"{messages.place}, line {line}: device {name!r}: {hint}")
    return [_device_clock(recording, first, other) for other in others]


def _hint_for_unknown_device(first: DeviceRecording, names: list[str]) -> str:
    if not names:
        return (
            f"there is no other device than {first.name!r}: give the other recording too, or leave the messages out"
        )
    known = ", ".join(map(repr, names))
    return f"the devices that answer the first one, {first.name!r}, are {known}: name one of them"


def _device_clock(recording: Recording, first: DeviceRecording, other: DeviceRecording) -> ClockEstimate:
    """Estimate the clock of one device from all of its messages."""
    t1_s, t2_s, t3_s = (np.concatenate(parts) for parts in zip(*_stamps(recording, first, other), strict=True))
    if not len(t1_s):
        places = ", ".join(messages.place for messages in recording.messages)
        raise RecordingError(f"{places}: no message of device {other.name!r}: add one, or choose another --clock")
    clock = estimate_clock_from_messages(t1_s, t2_s, t3_s)
    span_s = first.span_s
    if span_s is None:
        return clock
    worst_s = float(clock.sigma_at(np.array(span_s)).max())
    if clock.sigma_s < _POOR_S <= worst_s:
        doubt = f"known to {worst_s:.2f} s only where the recording is farthest from the messages"
        clock = replace(clock, doubts=(*clock.doubts, doubt))
    return clock


def _stamps(recording: Recording, first: DeviceRecording, other: DeviceRecording) -> list[tuple[Array, Array, Array]]:
    """Return T1, T2, T3 of the exchanges of a device, one entry a table, on the times of the two recordings."""
    stamps = []
    for messages in recording.messages:
        rows = np.flatnonzero(np.array(messages.device) == other.name)
        t1_s, t3_s = (_to_recording_time(t, recording, first) for t in (messages.t1_s[rows], messages.t3_s[rows]))
        t2_s = _to_recording_time(messages.t2_s[rows], recording, other)
        for name, times_s, device in (("t1_s", t1_s, first), ("t2_s", t2_s, other), ("t3_s", t3_s, first)):
            _check_near_recording(messages, name, rows, times_s, device)
        stamps.append((t1_s, t2_s, t3_s))
    return stamps


def _to_recording_time(stamps_s: Array, recording: Recording, device: DeviceRecording) -> Array:
    """Convert stamps in the recorder's seconds or in Unix time to the times that the recording has for the device."""
    if recording.epoch_s is None:
        return stamps_s + device.clock_shift_s
    span_s = device.span_s
    unix = (stamps_s > _EPOCH_FROM_S) & (span_s is None or span_s[1] < _EPOCH_FROM_S)
    return np.where(unix, stamps_s - recording.epoch_s, stamps_s + device.clock_shift_s)


def _check_near_recording(
    messages: ClockMessages, name: str, rows: NDArray[np.int64], times_s: Array, device: DeviceRecording
) -> None:
    """Refuse stamps more than a day before or after what the device recorded."""
    span_s = device.span_s
    if span_s is None:
        return
    far = np.flatnonzero((times_s < span_s[0] - _FAR_S) | (times_s > span_s[1] + _FAR_S))
    if len(far):
        row = int(rows[far[0]])
        begin_s, end_s = (time_s - device.clock_shift_s for time_s in span_s)
        raise RecordingError(
            f"{messages.place}, line {row + _FIRST_LINE}: {name} = {getattr(messages, name)[row]:.6f} is far from "
            f"what {device.name} recorded ({begin_s:.3f} to {end_s:.3f} s): give it on the clock of that device"
        )
