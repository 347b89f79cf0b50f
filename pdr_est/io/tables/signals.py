"""Read one table: from bytes to the signals of its sensors, unconverted, on the clock of the recorder."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.raw_device import RawSignal
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.headerless import guess_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import MOTION, Quantity, is_unit
from pdr_est.io.tables.times.bursts import spread_bursts
from pdr_est.io.tables.times.clock import TableClock, read_clock, without_stale_rows
from pdr_est.io.tables.times.sensor_clocks import by_sensor_clock, rows_of_clocks
from pdr_est.io.tables.values.measurements import Notes, find_missing_rows, read_measurements
from pdr_est.io.tables.values.zero_filled import without_zero_fill
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.text.loose_table import LooseTable, read_loose_table
from pdr_est.io.text.number_table import NumberTable
from pdr_est.io.text.table_layout import TableLayout, detect_layout

HEAD_BYTES = 8192
"""Number of bytes from which the layout of a table is detected."""


@dataclass(frozen=True)
class TableSignals:
    """Signals of one table.

    Attributes
    ----------
    place
        The file, for messages.
    clock
        Where the times of the signals start.
    mapping
        Meaning of the columns.
    signals
        Quantity -> its finite samples, values as recorded unless `RawSignal.factor` tells their unit.
    decisions, warnings
        What was decided and left out, in words.
    """

    place: str
    clock: TableClock
    mapping: TableMapping
    signals: Mapping[Quantity, RawSignal]
    decisions: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def layout_of(head: bytes) -> TableLayout | None:
    """Detect the layout of a table from the beginning of a file; None when it is none."""
    return _layout_of(head[:HEAD_BYTES])


@lru_cache(maxsize=64)
def _layout_of(head: bytes) -> TableLayout | None:
    return detect_layout(head, is_unit)


def read_table_signals(
    data: bytes, place: str, *, hint: Quantity | None = None, mapping: TableMapping | None = None
) -> TableSignals:
    """Read the signals of one table.

    Parameters
    ----------
    data
        Content of the file, in any encoding.
    place
        Name of the file, for messages.
    hint
        Quantity of axes without a sensor's name, from the name of the file; None when it is not known.
    mapping
        Meaning of the columns where a person or an app's reader states it; None to find it from the titles.

    Raises
    ------
    RecordingError
        When the content is no table, has no time, or is damaged.
    """
    return signals_of_text(as_utf8(data), place, hint=hint, mapping=mapping)


def signals_of_text(
    text: bytes, place: str, *, hint: Quantity | None = None, mapping: TableMapping | None = None
) -> TableSignals:
    """Read the signals of a table that is in UTF-8 already; see `read_table_signals`."""
    return signals_of(*_understood(text, place, hint, mapping))


def tables_of_text(
    text: bytes, place: str, *, hint: Quantity | None = None, mapping: TableMapping | None = None
) -> tuple[TableSignals, ...]:
    """Read a table like `signals_of_text`; where sensors have clocks of their own, each clock makes a table."""
    loose, mapping = _understood(text, place, hint, mapping)
    parts = by_sensor_clock(mapping, loose.table.names)
    if len(parts) == 1:
        return (signals_of(loose, mapping),)
    clocks = ", ".join(f"{part.clocks[0].title} of {' and '.join(part.columns)}" for part in parts)
    found = [signals_of(rows_of_clocks(replace(loose, warnings=()), part), part) for part in parts]
    first = found[0]
    decisions = (f"sensors have clocks of their own: {clocks}", *first.decisions)
    found[0] = replace(first, decisions=decisions, warnings=(*loose.warnings, *first.warnings))
    return tuple(found)


def _understood(
    text: bytes, place: str, hint: Quantity | None, mapping: TableMapping | None
) -> tuple[LooseTable, TableMapping]:
    """Read the wanted columns of a table, and find out what they mean."""
    layout = layout_of(text)
    if layout is None:
        raise RecordingError(f"{place}: no rows of numbers in columns; export the recording as a table")
    if mapping is not None:
        mapping = with_titles_of(mapping, layout, place)
    else:
        mapping = understand_titles(layout.titles, hint, layout.units) if layout.has_header else TableMapping()
    if not layout.has_header and not mapping.columns:
        everything = read_loose_table(text, place, layout, (), layout.titles)
        mapping = replace(guess_columns(everything, hint), guessed=hint is None)
        loose = everything
    else:
        clocks = [title for clock in mapping.clocks for title in clock.titles]
        numbers = [title for columns in mapping.columns.values() for title in columns.titles]
        loose = read_loose_table(text, place, layout, numbers, clocks)
    if not mapping.has_time:
        raise RecordingError(
            f"{place}: the table has no time column among {', '.join(map(repr, layout.titles[:12]))}; name it, "
            "or give the sampling rate, with --map (rate_hz: 50)"
        )
    return loose, mapping


def with_titles_of(mapping: TableMapping, layout: TableLayout, place: str) -> TableMapping:
    """Return a stated mapping with the titles as the table writes them; a column may be given by its number.

    Raises
    ------
    RecordingError
        For a column that the table does not have.
    """
    known = {title.casefold(): title for title in layout.titles}
    known |= {f"column {number}": title for number, title in enumerate(layout.titles, start=1)}

    def find(title: str) -> str:
        if title and title.strip().casefold() not in known:
            raise RecordingError(
                f"{place}: the mapping names the column {title!r}, which is not among "
                f"{', '.join(map(repr, layout.titles))}; correct the mapping"
            )
        return known[title.strip().casefold()] if title else ""

    clocks = tuple(
        replace(c, title=find(c.title), fraction=find(c.fraction), parts={k: find(t) for k, t in c.parts.items()})
        for c in mapping.clocks
    )
    columns = {q: replace(one, titles=tuple(map(find, one.titles))) for q, one in mapping.columns.items()}
    used = {title for one in columns.values() for title in one.titles}
    used |= {title for clock in clocks for title in clock.titles}
    rows = None if mapping.rows is None else (find(mapping.rows[0]), mapping.rows[1])
    unused = tuple(title for title in layout.titles if title not in used)
    return replace(mapping, clocks=clocks, columns=columns, unused=unused if rows is None else (), rows=rows)


def signals_of(loose: LooseTable, mapping: TableMapping) -> TableSignals:
    """Make the signals of a table that has been read, with its stale rows left out and its bursts spread.

    Parameters
    ----------
    loose
        Table with the columns of the mapping.
    mapping
        Meaning of the columns.

    Raises
    ------
    RecordingError
        When no row has a time.
    """
    clock = read_clock(loose, mapping)
    loose = without_zero_fill(loose, mapping)
    decisions, warnings = list(clock.decisions), [*loose.warnings, *clock.warnings, *mapping.incomplete]
    if clock.left_out is not None:
        loose = loose.only(~clock.left_out)
        clock = replace(clock, time_s=clock.time_s[~clock.left_out], left_out=None)
    documented = any(column.canonical for column in mapping.clocks)
    loose, clock, told = (loose, clock, ()) if documented else without_stale_rows(loose, clock)
    warnings += told
    if not documented and not (np.diff(clock.time_s) > 0.0).all():  # a clock that always advances has no bursts
        time_s, warning = spread_bursts(clock.time_s, _motion_values(loose.table, mapping))
        clock = replace(clock, time_s=time_s)
        warnings += [warning] if warning else []
    signals = {}
    notes = Notes(decisions, warnings)
    missing = find_missing_rows(loose.table, mapping.columns, notes)
    for quantity, columns in mapping.columns.items():
        signal = read_measurements(loose.table, clock.time_s, quantity, columns, missing.get(quantity), notes)
        if signal is not None:
            signals[quantity] = signal
    if mapping.guessed:
        guessed = "; ".join(f"{', '.join(one.titles)} as {quantity}" for quantity, one in mapping.columns.items())
        warnings.append(
            f"the table has no header: {mapping.clocks[0].title} is taken as time, {guessed}, because of their "
            "values: name the columns with --map to be sure"
        )
    unused = [title for title in mapping.unused if title]
    if unused:
        decisions.append(f"not used: {', '.join(unused)}")
    return TableSignals(loose.table.place, clock, mapping, signals, tuple(decisions), tuple(warnings))


def _motion_values(table: NumberTable, mapping: TableMapping) -> Array:
    """Return the columns that change with every sample, (n, k)."""
    titles = [
        title
        for quantity in (*MOTION, Quantity.GRAVITY)
        if quantity in mapping.columns
        for title in mapping.columns[quantity].titles
    ]
    titles = [title for title in titles if title in table]
    return table.stack(titles) if titles else np.zeros((len(table), 0))
