"""Mend the time stamps of a recording: single stray ones are left out, and a clock that restarted goes on.

Samples stand in the order in which they were recorded. A few stamps that lie elsewhere, while those after them go on
where those before them ended, are therefore wrong. A clock that goes back and stays there has restarted: how long the
recorder stood still in between is unknown, and all sensors of the device are moved by the same time.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.recording import DeviceRecording, Recording, Signal

# All ours. The samples of a sensor are at most half a second apart, else there is a gap.
_RESTART_S = 0.5
_PAUSE_S = 1.0  # between the samples before and after a restart, longer than any gap that is interpolated
_MOST_STRAY = 5  # stamps in a row
_LEAST_JUMP_S = 0.1
_JUMP_PERIODS = 5.0
_FAR_S = 10.0  # a few samples at an end of the recording are stray if they are this far from the others
_FEWEST = 20
_NAMED = 3

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class _Restarts:
    """Restarts of the clock of a device.

    Attributes
    ----------
    first_s, last_s
        (k + 1,) earliest and latest stamp before the first, between two and after the last restart, as recorded.
    offset_s
        (k + 1,) time to be added to them.
    start_s
        (k,) earliest time after each restart, as moved.
    """

    first_s: Array
    last_s: Array
    offset_s: Array
    start_s: Array


def mend_clocks(recording: Recording) -> Recording:
    """Leave out the stray time stamps of each device, and let a clock that restarted go on, for all sensors alike.

    Warnings of the device say what was done. A recording with nothing to mend is returned as it is. Fixes and
    reference data keep their times.
    """
    mended = [_mended(device) for device in recording.devices]
    if all(one is device for one, device in zip(mended, recording.devices, strict=True)):
        return recording
    return replace(recording, devices=tuple(mended))


def stray_stamps(time_s: Array) -> Mask:
    """Find the time stamps (n,), s, of which a few in a row contradict those before and after them.

    Times that only increase contradict nothing, except for at most five samples at the beginning or the end that are
    more than 10 s away from the others.
    """
    stray = np.zeros(len(time_s), dtype=np.bool_)
    if len(time_s) < _FEWEST:
        return stray
    steps = np.diff(time_s)
    rises = steps[steps > 0.0]
    period_s = float(np.median(rises)) if len(rises) else 0.0
    jump_s = max(_LEAST_JUMP_S, _JUMP_PERIODS * period_s)
    borders = np.flatnonzero((steps > jump_s) | (steps < -jump_s)) + 1
    if not len(borders):
        return stray
    runs = list(zip([0, *borders.tolist()], [*borders.tolist(), len(time_s)], strict=True))
    if (steps < -jump_s).any():
        _mark_inner(stray, time_s, runs, period_s, jump_s)
    _mark_ends(stray, time_s, jump_s)
    return stray


def _mark_inner(stray: Mask, time_s: Array, runs: Sequence[tuple[int, int]], period_s: float, jump_s: float) -> None:
    """Mark short runs after which the clock goes on where it was before them."""
    trusted = 0  # end of the last run that counts
    doubtful: list[tuple[int, int]] = []
    for begin, end in runs:
        count = sum(b - a for a, b in doubtful)
        since_s = float(time_s[begin] - time_s[trusted - 1]) if trusted else np.inf
        if doubtful and 0.0 <= since_s <= jump_s + (count + 1) * period_s:
            for a, b in doubtful:
                stray[a:b] = True
        elif trusted and count + end - begin <= _MOST_STRAY:
            doubtful.append((begin, end))
            continue
        doubtful, trusted = [], end


def _mark_ends(stray: Mask, time_s: Array, jump_s: float) -> None:
    """Mark a few samples at either end that are far from the others."""
    kept = np.flatnonzero(~stray)
    if len(kept) < _FEWEST:
        return
    steps = np.diff(time_s[kept])
    far = (steps > _FAR_S) | (steps < -jump_s)
    first = np.flatnonzero(far[:_MOST_STRAY])
    if len(first) and not far[first[-1] + 1 : _FEWEST - 1].any():
        stray[kept[: first[-1] + 1]] = True
    last = np.flatnonzero(far[-_MOST_STRAY:])
    if len(last) and not far[1 - _FEWEST : len(far) - _MOST_STRAY + last[0]].any():
        stray[kept[len(kept) - _MOST_STRAY + last[0] :]] = True


def _mended(device: DeviceRecording) -> DeviceRecording:
    signals = device.signals()
    warnings = []
    changed: dict[str, Any] = {}
    for name, signal in signals.items():
        stray = stray_stamps(signal.time_s)
        if stray.any():
            named = ", ".join(f"{time_s:.6g} s" for time_s in signal.time_s[stray][:_NAMED])
            warnings.append(
                f"{name}: {int(stray.sum())} of {len(signal)} samples are left out because their time stamps "
                f"contradict those before and after them ({named})"
            )
            changed[name] = Signal(signal.time_s[~stray], signal.values[~stray])
    signals |= changed
    restarts = _find_restarts([signal.time_s for signal in signals.values()])
    if restarts is None:
        return replace(device, **changed, warnings=(*device.warnings, *warnings)) if changed else device
    back_s = ", ".join(f"at {at_s:.6g} s" for at_s in restarts.last_s[:-1][:_NAMED])
    warnings.append(
        f"the clock restarted {_count(len(restarts.start_s))} ({back_s}): what follows is put {_PAUSE_S:g} s later, "
        "for all sensors alike; how long it stood still is not known"
    )
    moved: dict[str, Any] = {
        name: Signal(_moved(signal.time_s, restarts), signal.values) for name, signal in signals.items()
    }
    return replace(
        device,
        **moved,
        warnings=(*device.warnings, *warnings),
        restarts_s=(*device.restarts_s, *restarts.start_s.tolist()),
    )


def _restart_rows(time_s: Array) -> NDArray[np.intp]:
    """Find the first samples (k,) after each restart."""
    return np.flatnonzero(np.diff(time_s) < -_RESTART_S) + 1


def _find_restarts(times: Sequence[Array]) -> _Restarts | None:
    """Find the restarts that the sensor with the most of them shows, and how far to move what follows."""
    rows = [_restart_rows(time_s) for time_s in times]
    most = max((len(one) for one in rows), default=0)
    if not most:
        return None
    # Sensors that missed a restart do not tell how the parts of the others lie.
    parts = [np.split(time_s, one) for time_s, one in zip(times, rows, strict=True) if len(one) == most]
    first_s = np.array([[part.min() for part in sensor] for sensor in parts]).min(axis=0)
    last_s = np.array([[part.max() for part in sensor] for sensor in parts]).max(axis=0)
    offset_s = np.concatenate([[0.0], np.cumsum(last_s[:-1] - first_s[1:] + _PAUSE_S)])
    return _Restarts(first_s, last_s, offset_s, first_s[1:] + offset_s[1:])


def _moved(time_s: Array, restarts: _Restarts) -> Array:
    """Move the samples after each restart; a sensor that missed one is where its stamps fit best."""
    edges = np.concatenate([[0], _restart_rows(time_s), [len(time_s)]]).astype(np.intp)
    parts = list(range(len(restarts.offset_s)))
    if len(edges) - 1 != len(parts):
        parts = _fitting_parts([time_s[a:b] for a, b in pairwise(edges)], restarts)
    return time_s + np.repeat(restarts.offset_s[parts], np.diff(edges))


def _fitting_parts(stretches: Sequence[Array], restarts: _Restarts) -> list[int]:
    """Find for each stretch between two restarts of a sensor the part of the recording that contains its stamps."""
    found: list[int] = []
    for stretch in stretches:
        if not len(stretch):
            return [0]
        next_part = min(found[-1] + 1, len(restarts.first_s) - 1) if found else 0
        outside_s = np.maximum(restarts.first_s - stretch.min(), 0.0) + np.maximum(
            stretch.max() - restarts.last_s, 0.0
        )
        # Sensors begin and end a little apart; of parts that fit alike the first counts.
        found.append(next_part + int(np.argmin(np.maximum(outside_s[next_part:], _PAUSE_S))))
    return found


def _count(number: int) -> str:
    return "once" if number == 1 else f"{number} times"
