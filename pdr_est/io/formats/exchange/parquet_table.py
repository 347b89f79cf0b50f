"""The documented plain table as a Parquet file: the same columns, empty where a sensor has no sample."""

import io
from pathlib import Path

import numpy as np
import polars as pl
from polars.exceptions import PolarsError

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.formats.exchange.left_out import left_out
from pdr_est.io.formats.plain_csv.writer import PARTS_OF_TABLE, plain_table
from pdr_est.io.tables.quantities import CANONICAL, Quantity
from pdr_est.io.text.archives.inflating import refuse_large
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import finite_signal_or_none
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.output.atomic_output import staged_file
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.recording import DeviceRecording, Recording, Signal

NAME = "Parquet"

_MAGIC = b"PAR1"
_NUMBER_BYTES = 8


def write_parquet_recording(recording: Recording, path: str | Path) -> tuple[str, ...]:
    """Write the signals and true positions of a recording of one device.

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
    content = io.BytesIO()
    frame.write_parquet(content, statistics=False)
    with staged_file(Path(path), overwrite=True) as staging:  # polars does not say when a disk is full
        staging.write_bytes(content.getbuffer())
    return left_out(recording, PARTS_OF_TABLE)


def sniff(source: Source) -> bool:
    """Tell whether a member is a Parquet file."""
    return bool(find_members(source, _is_parquet))


def read_source(source: Source) -> Recording:
    """Read a table with the documented columns; others are named in the decisions.

    Raises
    ------
    RecordingError
        For several tables, a damaged one, and one without times or motion sensors.
    """
    member = require_single_walk(source, find_members(source, _is_parquet), NAME)
    place = source.place(member)
    try:
        content = source.read(member)
        lazy = pl.scan_parquet(io.BytesIO(content))
        numbers = lazy.select(pl.len()).collect().item() * len(lazy.collect_schema())  # by the directory of the file
        refuse_large(len(content), _NUMBER_BYTES * numbers, source.limit_bytes, place)
        frame = pl.read_parquet(io.BytesIO(content))
    except (OSError, PolarsError) as error:
        raise RecordingError(f"{place}: damaged Parquet file ({_first_line(error)}); write it again") from error
    found = {quantity: names for quantity, names in CANONICAL.items() if all(name in frame.columns for name in names)}
    if Quantity.TIME not in found or not found.keys() & {Quantity.FORCE, Quantity.RATE}:
        needed = ", ".join((*CANONICAL[Quantity.TIME], *CANONICAL[Quantity.FORCE]))
        raise RecordingError(
            f"{place}: a Parquet file without the documented columns {needed} (it has {', '.join(frame.columns)}); "
            "rename them, see docs/recorder-formats.md"
        )
    signals, warnings = _signals(frame, found, place)
    used = {name for names in found.values() for name in names}
    unused = [name for name in frame.columns if name not in used]
    decisions = ["units and signs are those of the documented columns"]
    decisions += [f"columns not used: {', '.join(unused)}"] if unused else []
    positions = signals.get(Quantity.TRUE_POSITION)
    return Recording(
        name=member_stem(member),
        format=NAME,
        devices=(
            DeviceRecording(
                specific_force=signals.get(Quantity.FORCE),
                rotation_rate=signals.get(Quantity.RATE),
                magnetic_field=signals.get(Quantity.FIELD),
                attitude=signals.get(Quantity.ATTITUDE),
                pressure=signals.get(Quantity.PRESSURE),
                decisions=tuple(decisions),
                warnings=warnings,
            ),
        ),
        truth=Truth()
        if positions is None
        else Truth(positions=TruePositions(positions.time_s, positions.values, 0.0, "poses")),
    )


def _is_parquet(head: bytes) -> bool:
    return head.startswith(_MAGIC)


def _signals(
    frame: pl.DataFrame, found: dict[Quantity, tuple[str, ...]], place: str
) -> tuple[dict[Quantity, Signal], tuple[str, ...]]:
    """Make the signals of the columns; rows in which a sensor has no cell are not its samples."""
    time_s = _numbers(frame, CANONICAL[Quantity.TIME], place)[:, 0]
    signals: dict[Quantity, Signal] = {}
    warnings: list[str] = []
    for quantity, names in found.items():
        if quantity is Quantity.TIME:
            continue
        present = ~np.all([frame[name].is_null().to_numpy() for name in names], axis=0)
        if not present.any():
            continue
        values = _numbers(frame, names, place)[present]
        signal, dropped = finite_signal_or_none(time_s[present], values, str(quantity), place)
        warnings += dropped
        if signal is not None:
            signals[quantity] = signal
    return signals, tuple(warnings)


def _numbers(frame: pl.DataFrame, names: tuple[str, ...], place: str) -> Array:
    """Return columns (n, k) as numbers; an empty cell is NaN."""
    for name in names:
        if not frame[name].dtype.is_numeric():
            raise RecordingError(f"{place}: the column {name} holds {frame[name].dtype}; write numbers")
    columns = [frame[name].cast(pl.Float64).fill_null(float("nan")).to_numpy() for name in names]
    return np.stack(columns, axis=1).astype(np.float64)


def _first_line(error: Exception) -> str:
    return str(error).strip().split("\n", 1)[0][:200]
