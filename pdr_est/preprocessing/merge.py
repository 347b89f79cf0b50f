"""Merge the recordings that several devices made of one walk."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.types.recording import DeviceRecording, Recording, Signal

_DAY_S = 86400.0


def merge_recordings(recordings: Sequence[Recording]) -> Recording:
    """Merge several recordings of one walk into one recording with all of their devices.

    Everything but devices, clock messages and name is taken from the first recording. Where two recorders tell the
    date, both with a time zone or both without, the times of the other recording are moved to the time zero of the
    first; remaining clock differences are found later, by `pdr_est.clock_sync`. A recording that is given twice, such
    as a data set in which the table of either phone brings the other phone along, counts once, and a note says so. If
    two devices have one name, all devices get the names of their recordings instead.

    Raises
    ------
    RecordingError
        For different recordings whose devices cannot be told apart by name.
    """
    given, recordings = recordings, _without_repetitions(recordings)
    first, *others = recordings
    if len(recordings) < len(given):
        first = replace(first, notes=(*first.notes, _repetition_note(given)))
    if not others:
        return first
    devices = [device for recording in recordings for device in _with_time_zero_of(first, recording)]
    names = [device.name for device in devices]
    if len(set(names)) < len(names):
        names = [
            recording.name if len(recording.devices) == 1 else f"{recording.name}/{device.name}"
            for recording in recordings
            for device in recording.devices
        ]
    if len(set(names)) < len(names):
        repeated = next(name for name in names if names.count(name) > 1)
        raise RecordingError(
            f"{repeated}: two different recordings share the name of recording and device: rename one of the files"
        )
    named = tuple(replace(device, name=name) for device, name in zip(devices, names, strict=True))
    messages = tuple(one for recording in recordings for one in recording.messages)
    name = " + ".join(recording.name for recording in recordings)
    notes = (*first.notes, *_date_notes(recordings))
    return replace(first, name=name, devices=named, messages=messages, notes=notes)


def _without_repetitions(recordings: Sequence[Recording]) -> list[Recording]:
    kept: list[Recording] = []
    for recording in recordings:
        if not any(_same_samples(recording, other) for other in kept):
            kept.append(recording)
    return kept


def _repetition_note(recordings: Sequence[Recording]) -> str:
    names = [recording.name for recording in recordings]
    repeated = dict.fromkeys(name for name in names if names.count(name) > 1)
    return f"{', '.join(repeated)}: given more than once with the same samples, and used once"


def _same_samples(a: Recording, b: Recording) -> bool:
    """Tell whether two recordings have the same devices with the same accelerometer samples."""
    if (a.name, [one.name for one in a.devices]) != (b.name, [one.name for one in b.devices]):
        return False
    signals = [(_acceleration(one), _acceleration(other)) for one, other in zip(a.devices, b.devices, strict=True)]
    return all(
        one is not None
        and other is not None
        and np.array_equal(one.time_s, other.time_s)
        and np.array_equal(one.values, other.values, equal_nan=True)
        for one, other in signals
    )


def _acceleration(device: DeviceRecording) -> Signal | None:
    return device.specific_force or device.linear_acceleration


def _with_time_zero_of(first: Recording, recording: Recording) -> tuple[DeviceRecording, ...]:
    """Shift the times of a recording to the time zero of the first one, if both know their dates."""
    later_s = _later_s(first, recording)
    if later_s is None:
        return recording.devices
    moved = (device.with_times(lambda time_s: time_s + later_s) for device in recording.devices)
    return tuple(replace(device, clock_shift_s=later_s) for device in moved)


def _later_s(first: Recording, recording: Recording) -> float | None:
    """Compute how much later the time zero of a recording is, s; None where the recorders do not tell.

    Dates without a time zone are taken to be of one zone, and times of day without a date of one day.
    """
    if first.epoch_s is not None and recording.epoch_s is not None:
        return recording.epoch_s - first.epoch_s
    if first.local_epoch_s is None or recording.local_epoch_s is None:
        return None
    later_s = recording.local_epoch_s - first.local_epoch_s
    if first.tells_local_date and recording.tells_local_date:
        return later_s
    return (later_s + 0.5 * _DAY_S) % _DAY_S - 0.5 * _DAY_S


def _date_notes(recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Say how dates without a time zone were compared, or why they were not."""
    first, *others = recordings
    local = [one for one in recordings if one.epoch_s is None and one.local_epoch_s is not None]
    if not local:
        return ()
    apart = [one.name for one in others if _later_s(first, one) is None]
    if not apart:
        return ("the dates of the recordings state no time zone and are taken to be of the same one",)
    return (
        f"the clock of {first.name} is not compared with that of {', '.join(apart)}, because not all of their dates "
        "are known with a time zone",
    )
