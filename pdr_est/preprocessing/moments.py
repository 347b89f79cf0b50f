"""Moments of a recording as people write them: seconds from its start, a time of day, or a date with a time."""

import re
from dataclasses import dataclass
from datetime import UTC, datetime, time, timedelta

from pdr_est.errors import ConfigError, RecordingError
from pdr_est.preprocessing.trim import trim_recording
from pdr_est.types.clock import utc_date
from pdr_est.types.recording import Recording

_SECONDS = re.compile(r"[0-9]+(\.[0-9]*)?|\.[0-9]+")
_TIME_OF_DAY = re.compile(r"[0-9]{1,2}:[0-9]{2}(:[0-9]{2}(\.[0-9]{1,6})?)?")
_DATE = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}[T ][0-9:.]+(Z|[+-][0-9]{2}:?[0-9]{2})?")
_LONGEST_S = 1e9


@dataclass(frozen=True)
class Moment:
    """Moment of a recording.

    Attributes
    ----------
    text
        As it was written.
    value
        Seconds from the first sample, a time of day, or a date with a time, with a zone if it was written.
    """

    text: str
    value: float | time | datetime

    def on_clock_of(self, recording: Recording) -> float:
        """Find the moment on the clock of a recording, s.

        A time without a zone is compared with the date, or the time of day, of a recording that states no zone
        either, else it is UTC.

        Raises
        ------
        RecordingError
            For a time of day or a date, if the recording does not tell its own.
        """
        start_s, end_s = _span_s(recording)
        if isinstance(self.value, float):
            return start_s + self.value
        epoch_s = self._epoch_s(recording)
        middle = None if epoch_s is None else utc_date(epoch_s + 0.5 * (start_s + end_s))
        if epoch_s is None or middle is None:
            zoned = isinstance(self.value, datetime) and self.value.tzinfo is not None
            missing = "time zone" if zoned and recording.tells_local_date else "date"
            raise RecordingError(
                f"{recording.name}: {self.text} is a clock time, but the recording does not tell its {missing}: give "
                "seconds from its start"
            )
        if isinstance(self.value, datetime):
            moment = self.value if self.value.tzinfo is not None else self.value.replace(tzinfo=UTC)
            return moment.timestamp() - epoch_s
        days = [middle.date() + timedelta(days=day) for day in (-1, 0, 1)]
        moments = [datetime.combine(day, self.value, tzinfo=UTC) for day in days]
        nearest = min(moments, key=lambda moment: abs(moment - middle))
        return nearest.timestamp() - epoch_s

    def _epoch_s(self, recording: Recording) -> float | None:
        """Return the time zero of a recording from which this kind of moment counts; None where it is not known."""
        if isinstance(self.value, datetime):
            zoned = self.value.tzinfo is not None
            return recording.local_epoch_s if recording.tells_local_date and not zoned else recording.epoch_s
        return recording.epoch_s if recording.local_epoch_s is None else recording.local_epoch_s


def parse_moment(text: str) -> Moment:
    """Parse seconds from the start of a recording (12.5), a time of day (14:03, 14:03:05.2) or a date with a time.

    A time without a zone is UTC, as `pdr-est inspect` prints it, or in the zone of a recording that states none.

    Raises
    ------
    ConfigError
        For anything else.
    """
    written = text.strip()
    try:
        if _SECONDS.fullmatch(written) and float(written) < _LONGEST_S:
            return Moment(text, float(written))
        if _TIME_OF_DAY.fullmatch(written):
            return Moment(text, time.fromisoformat(written.rjust(len(written) + (written[1] == ":"), "0")))
        if _DATE.fullmatch(written):
            return Moment(text, datetime.fromisoformat(written))
    except ValueError:
        pass  # such as 25:00
    raise ConfigError(
        f"{text!r} is no moment: give seconds from the start of the recording (12.5), a time of day in UTC "
        "(14:03:05), or a date with a time (2024-06-10T14:03:05Z)"
    )


def cut_recording(recording: Recording, begin: Moment | None, end: Moment | None) -> Recording:
    """Keep what was recorded between two moments, or from the first or to the last sample.

    Devices that have no sample in this time are left out, which a note says; time stamps stay as they are.

    Raises
    ------
    RecordingError
        If the end does not come after the beginning, if nothing is left, or for a clock time that cannot be found.
    """
    if begin is None and end is None:
        return recording
    start_s, end_s = _span_s(recording)
    from_s = start_s if begin is None else begin.on_clock_of(recording)
    to_s = end_s if end is None else end.on_clock_of(recording)
    if to_s <= from_s:
        raise RecordingError(
            f"{recording.name}: from {from_s - start_s:.3f} s to {to_s - start_s:.3f} s after its start there is "
            f"nothing: it lasts {end_s - start_s:.3f} s; let the end come after the beginning"
        )
    return trim_recording(recording, from_s, to_s)


def _span_s(recording: Recording) -> tuple[float, float]:
    """Return the times of the first and the last sample, s; raise RecordingError without any."""
    if recording.span_s is None:
        raise RecordingError(f"{recording.name}: no sample of accelerometer or gyroscope: nothing to cut")
    return recording.span_s
