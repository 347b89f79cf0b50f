"""Read the folder `meta` of a phyphox export: when the experiment ran, and on which phone."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array
from pdr_est.io.text.container import Source
from pdr_est.io.text.number_table import read_table
from pdr_est.io.text.table_layout import detect_header

_EXPERIMENT_TIME, _SYSTEM_TIME = "experiment time", "system time"
_TABLE = "{}meta/{}.csv"
_SHEET = "{}Metadata {}.csv"  # of a workbook


@dataclass(frozen=True)
class ExperimentClock:
    """Clock of the experiment, which stands still in pauses.

    Attributes
    ----------
    epoch_s
        Unix time of the first start; None when unknown.
    resumed_s
        Experiment times at which a pause ended.
    pause_s
        Durations of these pauses, s.
    """

    epoch_s: float | None = None
    resumed_s: tuple[float, ...] = ()
    pause_s: tuple[float, ...] = ()

    def to_continuous_time(self, time_s: Array) -> Array:
        """Convert experiment times (n,) to a clock that runs through the pauses."""
        if not self.resumed_s:
            return time_s
        before = np.concatenate([[0.0], np.cumsum(self.pause_s)])
        shifted: Array = time_s + before[np.searchsorted(self.resumed_s, time_s, side="right")]
        return shifted

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warn of the pauses."""
        if not self.resumed_s:
            return ()
        total = f"{len(self.resumed_s)} times, for {sum(self.pause_s):.1f} s"
        return (f"the experiment was paused {total}; the pauses are gaps of the recording",)


def read_experiment_clock(source: Source, prefix: str) -> ExperimentClock:
    """Read the clock from the start and pause events of `meta/time.csv`; an unknown one without that file.

    Parameters
    ----------
    source
        The export.
    prefix
        Folder of the walk with a slash; empty for the top.
    """
    member = _member(source, prefix, "time")
    dialect = None if member is None else detect_header(source.head(member))
    if member is None or dialect is None:
        return ExperimentClock()
    table = read_table(
        source.read(member),
        source.place(member),
        separator=dialect.separator,
        decimal_comma=dialect.decimal_comma,
        columns=(_EXPERIMENT_TIME, _SYSTEM_TIME),
        text_columns=("event",),
    )
    starts = table.texts("event") == "START"
    if not starts.any():
        return ExperimentClock()
    experiment_s = table.numbers(_EXPERIMENT_TIME)[starts]
    offset_s = table.numbers(_SYSTEM_TIME)[starts] - experiment_s
    resumed_s = tuple(float(t) for t in experiment_s[1:])
    return ExperimentClock(float(offset_s[0]), resumed_s, tuple(float(pause) for pause in np.diff(offset_s)))


def read_device_properties(source: Source, prefix: str) -> Mapping[str, str]:
    """Read the properties of `meta/device.csv` below a folder; none without that file."""
    member = _member(source, prefix, "device")
    if member is None:
        return {}
    data = source.read(member)
    dialect = detect_header(data)
    if dialect is None:
        return {}
    rows = csv.reader(data.decode("utf-8-sig", "replace").splitlines(), delimiter=dialect.separator)
    return {row[0]: row[1] for row in rows if len(row) >= 2}


def _member(source: Source, prefix: str, table: str) -> str | None:
    """Find a table of metadata, which is a sheet of its own in a workbook."""
    names = (_TABLE.format(prefix, table), _SHEET.format(prefix, table.capitalize()))
    return next((name for name in names if name in source.members), None)
