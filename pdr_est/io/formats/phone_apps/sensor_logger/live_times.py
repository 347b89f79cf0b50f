"""Leave readings with a stray time stamp out of the messages of one phone; a clock that was set anew is followed.

A reading a long way off all others of its message is stray. A whole message a long way off waits for the next one:
if that continues it, there was a gap or the clock was set, else it was stray.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.io.formats.phone_apps.sensor_logger.live_messages import LiveMessage, Readings

_APART_NS = 60_000_000_000  # ours: longer than an app collects readings, shorter than errors of a clock that matter
_FEW = 0.1  # ours: share of the readings of a message that may be stray


class LiveTimes:
    """Times of the messages of one phone."""

    def __init__(self) -> None:
        self._newest_ns: int | None = None
        self._held: LiveMessage | None = None

    def newest_ns(self) -> int | None:
        """Return the time of the newest reading that was passed on; None before any."""
        return self._newest_ns

    def push(self, message: LiveMessage) -> tuple[list[LiveMessage], list[str]]:
        """Take the next message; return those that can be read now, and notes for the user."""
        message, notes = _without_strays(message)
        span = _span_ns(message)
        if span is None:
            return [], notes
        if self._held is not None and _near(span, _span_ns(self._held)):
            held, self._held = self._held, None
            return self._passed([held, message]), notes
        if self._newest_ns is None or _near(span, (self._newest_ns, self._newest_ns)):
            return self._passed([message]), [*notes, *self._drop_held()]
        notes += self._drop_held()
        self._held = message
        return [], notes

    def flush(self) -> tuple[list[LiveMessage], list[str]]:
        """End the walk: a message that still waits is stray."""
        return [], self._drop_held()

    def _passed(self, messages: list[LiveMessage]) -> list[LiveMessage]:
        span = _span_ns(messages[-1])
        self._newest_ns = self._newest_ns if span is None else span[1]
        return messages

    def _drop_held(self) -> list[str]:
        held, self._held = self._held, None
        span = None if held is None else _span_ns(held)
        if span is None or self._newest_ns is None:
            return []
        return [f"a message {_words(span[0] - self._newest_ns)} the one before has a stray time and is left out"]


def _without_strays(message: LiveMessage) -> tuple[LiveMessage, list[str]]:
    """Leave out the few readings that lie a long way off all others of a message."""
    times = np.array([time_ns for rows in message.rows.values() for time_ns, _ in rows], dtype=np.int64)
    if len(times) < 2 or int(times.max()) - int(times.min()) <= _APART_NS:
        return message, []
    ordered = np.sort(times)
    groups = np.split(ordered, np.flatnonzero(np.diff(ordered) > _APART_NS) + 1)
    kept = [group for group in groups if len(group) > _FEW * len(times)]
    if not kept or len(kept) == len(groups):
        return message, []
    stray = len(times) - sum(map(len, kept))
    spans = [(int(group[0]), int(group[-1])) for group in kept]
    rows = {sensor: _within(rows, spans) for sensor, rows in message.rows.items()}
    note = f"readings with a stray time, a minute or more off the others of their message, are left out: {stray}"
    return replace(message, rows={sensor: of_sensor for sensor, of_sensor in rows.items() if of_sensor}), [note]


def _within(rows: Readings, spans: Sequence[tuple[int, int]]) -> Readings:
    return [row for row in rows if any(begin <= row[0] <= end for begin, end in spans)]


def _span_ns(message: LiveMessage) -> tuple[int, int] | None:
    times = [time_ns for rows in message.rows.values() for time_ns, _ in rows]
    return (min(times), max(times)) if times else None


def _near(span: tuple[int, int], other: tuple[int, int] | None) -> bool:
    return other is not None and span[0] <= other[1] + _APART_NS and span[1] >= other[0] - _APART_NS


def _words(later_ns: int) -> str:
    return f"{abs(later_ns) / 1e9:.0f} s {'after' if later_ns > 0 else 'before'}"
