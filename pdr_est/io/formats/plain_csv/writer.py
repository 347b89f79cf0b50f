"""Write a recording in the project's own plain format; the reader returns the same arrays, bit by bit."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import polars as pl

from pdr_est.errors import OutputError
from pdr_est.frames import Array
from pdr_est.io.formats.exchange.left_out import left_out, only_device
from pdr_est.io.tables.quantities import CANONICAL, Quantity
from pdr_est.output.atomic_output import staged_file
from pdr_est.types.recording import Recording, Signal

PARTS_OF_TABLE = ("positions", "pressure")
"""Parts of a recording that the table has columns for, as `left_out` names them."""


def write_plain_csv(recording: Recording, path: str | Path) -> tuple[str, ...]:
    """Write the signals and true positions of a recording of one device, with the titles of `CANONICAL`.

    There is one row for each time stamp of any sensor, with empty cells where a sensor has no sample then. Repeated
    and backward time stamps stay in each sensor's own order. Fixes, notes and the Unix time have no columns.

    Returns
    -------
    tuple of str
        What of the recording is not in the table, in words.

    Raises
    ------
    OutputError
        For several devices, for a recording without samples, and when the file cannot be written.
    """
    frame = plain_table(recording, path)
    with staged_file(Path(path), overwrite=True) as staging:
        frame.write_csv(staging)
    return left_out(recording, PARTS_OF_TABLE)


def plain_table(recording: Recording, place: str | Path = "table") -> pl.DataFrame:
    """Make the table of a recording of one device, as `write_plain_csv` writes it.

    Raises
    ------
    OutputError
        For several devices, and for a recording without samples; `place` names the table in the message.
    """
    only_device(recording)
    signals = _signals(recording)
    if not signals:
        raise OutputError(f"{place}: the recording has no samples to write")
    merged = _merge([signal.time_s for _, signal in signals])
    columns = {CANONICAL[Quantity.TIME][0]: pl.Series(merged.time_s)}
    for (quantity, signal), rows in zip(signals, merged.rows, strict=True):
        for title, values in zip(CANONICAL[quantity], signal.values.T, strict=True):
            columns[title] = _spread(values, rows, len(merged.time_s))
    return pl.DataFrame(columns)


def _signals(recording: Recording) -> list[tuple[Quantity, Signal]]:
    """List the signals of the recording, in the order of the columns."""
    device = recording.devices[0]
    positions = recording.truth.positions
    candidates = (
        (Quantity.FORCE, device.specific_force),
        (Quantity.RATE, device.rotation_rate),
        (Quantity.FIELD, device.magnetic_field),
        (Quantity.ATTITUDE, device.attitude),
        (Quantity.PRESSURE, device.pressure),
        (Quantity.TRUE_POSITION, None if positions is None else Signal(positions.time_s, positions.position_m)),
    )
    return [(quantity, signal) for quantity, signal in candidates if signal is not None and len(signal)]


@dataclass(frozen=True)
class _MergedRows:
    """Times (n,) of the rows, and for each input the row of each of its samples."""

    time_s: Array
    rows: Sequence[np.ndarray[tuple[int], np.dtype[np.intp]]]


def _merge(times: Sequence[Array]) -> _MergedRows:
    """Make rows for the time stamps of several clocks: equal stamps share a row, each clock keeps its own order.

    The rows are sorted by the latest time so far, so that a backward step stays behind what came before it; the count
    of stamps at that latest time keeps repeated and backward stamps in order.
    """
    keys = []
    for time_s in times:
        latest = np.maximum.accumulate(time_s)
        count = np.arange(len(latest)) - np.searchsorted(latest, latest, side="left")
        keys.append(np.column_stack([latest, count, time_s]))
    unique, inverse = np.unique(np.concatenate(keys), axis=0, return_inverse=True)
    ends = np.cumsum([len(time_s) for time_s in times])
    return _MergedRows(unique[:, 2], np.split(inverse.reshape(-1), ends[:-1]))


def _spread(values: Array, rows: np.ndarray[tuple[int], np.dtype[np.intp]], n_rows: int) -> pl.Series:
    """Make a column with empty cells where a sensor has no sample."""
    filled = np.zeros(n_rows)
    filled[rows] = values
    empty = np.ones(n_rows, dtype=np.bool_)
    empty[rows] = False
    return pl.select(pl.when(pl.lit(pl.Series(empty))).then(None).otherwise(pl.lit(pl.Series(filled)))).to_series()
