"""Recordings that several devices made of one walk, as one recording."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.types.recording import DeviceRecording, Recording


def together(recordings: Sequence[Recording]) -> Recording:
    """One recording with the devices of all; everything else is that of the first.

    Devices of one name get that of their recording. The times of the others are put on the time zero of the
    first as far as the recorders tell the date; what is still wrong with the clocks is found later, from the walk.
    A recording that is given twice, such as a set whose every table brings the other phone's along, counts once, and
    a note says so.
    Raises RecordingError for devices that cannot be told apart.
    """
    given, recordings = recordings, _once(recordings)
    first, *others = recordings
    if len(recordings) < len(given):
        first = replace(first, notes=(*first.notes, _repeated(given)))
    if not others:
        return first
    devices = [device for recording in recordings for device in _on_zero_of(first, recording)]
    names = [device.name for device in devices]
    if len(set(names)) < len(names):
        names = [
            recording.name if len(recording.devices) == 1 else f"{recording.name}/{device.name}"
            for recording in recordings
            for device in recording.devices
        ]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise RecordingError(
            f"{twice}: two of the recordings are alike in name and device, and differ: rename one of the files"
        )
    named = tuple(replace(device, name=name) for device, name in zip(devices, names, strict=True))
    messages = tuple(one for recording in recordings for one in recording.messages)
    name = " + ".join(recording.name for recording in recordings)
    return replace(first, name=name, devices=named, messages=messages)


def _once(recordings: Sequence[Recording]) -> list[Recording]:
    kept: list[Recording] = []
    for recording in recordings:
        if not any(_same(recording, other) for other in kept):
            kept.append(recording)
    return kept


def _repeated(recordings: Sequence[Recording]) -> str:
    names = [recording.name for recording in recordings]
    repeated = dict.fromkeys(name for name in names if names.count(name) > 1)
    return f"{', '.join(repeated)}: given more than once with the same samples, and counted once"


def _same(a: Recording, b: Recording) -> bool:
    """Whether two recordings hold the same devices with the same samples."""
    if (a.name, [one.name for one in a.devices]) != (b.name, [one.name for one in b.devices]):
        return False
    signals = [(one.specific_force, other.specific_force) for one, other in zip(a.devices, b.devices, strict=True)]
    return all(
        one is not None
        and other is not None
        and np.array_equal(one.time_s, other.time_s)
        and np.array_equal(one.values, other.values, equal_nan=True)
        for one, other in signals
    )


def _on_zero_of(first: Recording, recording: Recording) -> tuple[DeviceRecording, ...]:
    if first.epoch_s is None or recording.epoch_s is None:
        return recording.devices
    later_s = recording.epoch_s - first.epoch_s
    moved = (device.with_times(lambda time_s: time_s + later_s) for device in recording.devices)
    return tuple(replace(device, clock_shift_s=later_s) for device in moved)
