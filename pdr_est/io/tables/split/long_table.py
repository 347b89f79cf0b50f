"""Split long tables: one row a sample, and a column that names the sensor, such as `timestamp,sensor,x,y,z`.

The columns may stand in any order and have any titles (`v1`, `value_0`); without titles the values tell the clock.
"""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.headerless import guess_columns
from pdr_est.io.tables.mapping import QuantityColumns, TableMapping
from pdr_est.io.tables.quantities import AXES, MOTION, Quantity
from pdr_est.io.tables.signals import HEAD_BYTES, TableSignals, signals_of, with_titles_of
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.tables.words.folding import split_words
from pdr_est.io.tables.words.sensors import ANDROID_TYPES
from pdr_est.io.text.cells import Cell, kind_of_cell, split_line
from pdr_est.io.text.loose_table import LooseTable, read_loose_table
from pdr_est.io.text.table_layout import TableLayout

_ROWS_LOOKED_AT = 60
_FEWEST_ROWS = 10  # of a table without titles
_NAMING_SHARE = 0.2  # a log has other sensors, too, such as light and proximity
_SENSOR_TITLES = frozenset(
    {"sensor", "sensortype", "sensorname", "type", "name", "source", "stream", "topic", "kind", "typ", "quelle"}
)
_NUMBER_TITLES = frozenset({"sensortype", "sensorid", "type", "sensor"})
_NO_VALUES = frozenset({"accuracy", "genauigkeit", "precision", "status", "quality", "confidence", "id", "index"})
_NO_SENSORS = (None, Quantity.LATITUDE_LONGITUDE, Quantity.ACCURACY)
_SECOND_CHOICE = ("uncal", "raw", "game")
_NUMBERED = re.compile(r"^(.*?)[\s_.\[(-]*(\d)[\])]?$")


def sensor_column(layout: TableLayout, head: bytes) -> str | None:
    """Find the column of a long table that names the sensor; None when the table is not long.

    Parameters
    ----------
    layout
        How the table is written.
    head
        Beginning of the file in UTF-8.
    """
    if layout.has_header and _is_wide(layout):
        return None
    cells = _first_cells(layout, head)
    first = 0 if layout.has_header else 1  # rows that begin with a name are a tagged log
    if not layout.has_header and min(map(len, cells)) < _FEWEST_ROWS:
        return None
    for title, column in list(zip(layout.titles, cells, strict=True))[first:]:
        plain = "".join(split_words(title))
        filled = [cell for cell in column if cell]
        if not filled:
            continue
        texts = sum(kind_of_cell(cell) is Cell.TEXT for cell in filled)
        found = [sensor_by_name(cell) for cell in filled if kind_of_cell(cell) is Cell.TEXT]
        names = sum(quantity not in _NO_SENSORS for quantity in found)
        if not layout.has_header and not set(found) & set(MOTION):
            continue
        if texts == len(filled) and names >= max(1.0, _NAMING_SHARE * len(filled)):
            return title
        if layout.has_header and texts == len(filled) and plain in _SENSOR_TITLES and names:
            return title
        numbers = {_android(cell) for cell in filled}
        if layout.has_header and plain in _NUMBER_TITLES and texts == 0 and numbers & set(MOTION):
            return title
    return None


def read_long_table(text: bytes, place: str, layout: TableLayout, column: str) -> tuple[TableSignals, ...]:
    """Read a long table: the rows of each sensor become a table of their own.

    Parameters
    ----------
    text
        Content in UTF-8.
    place
        Name of the file, for messages.
    layout
        How the table is written.
    column
        Title of the column that names the sensor.

    Raises
    ------
    RecordingError
        When no row is of a sensor that is known, or the rows have no time.
    """
    titles = [title for title in layout.titles if title != column]
    units = [unit for title, unit in zip(layout.titles, layout.units, strict=False) if title != column]
    clocks = understand_titles(titles, units=units).clocks if layout.has_header else ()
    times = [title for clock in clocks for title in clock.titles]
    if layout.has_header and not times:
        raise RecordingError(
            f"{place}: the rows of the sensors in column {column!r} have no time among "
            f"{', '.join(map(repr, titles[:12]))}; name the column with --map"
        )
    others = times if layout.has_header else titles
    cells = dict(zip(layout.titles, _first_cells(layout, text), strict=True))
    numbers = [title for title in titles if title not in others and not _is_text(cells[title])]
    loose = read_loose_table(text, place, layout, numbers, [*others, column])
    names = loose.table.texts(column)
    found, skipped = [], []
    for name in dict.fromkeys(names.tolist()):
        quantity = _android(name) if name.isdigit() else sensor_by_name(name)
        rows = _selected(loose, names == name, f"{place}, rows {name}")
        mapping = None if quantity is None else _mapping_of(rows, layout, titles, units, quantity)
        signals = None if mapping is None else signals_of(rows, replace(mapping, rows=(column, name)))
        if signals is None or not signals.signals:
            skipped.append(name)
        else:
            found.append(signals)
    if not found:
        raise RecordingError(
            f"{place}: column {column!r} names no sensor that is known ({', '.join(skipped)}); "
            "say with --map which of these names is which sensor"
        )
    found.sort(key=lambda table: is_second_choice(table.place))
    note = f"column {column!r} names the sensor of each row" + (
        f"; not used: rows {', '.join(skipped)}" if skipped else ""
    )
    found[0] = replace(
        found[0], decisions=(note, *found[0].decisions), warnings=(*loose.warnings, *found[0].warnings)
    )
    return tuple(found)


def read_stated_rows(
    text: bytes, place: str, layout: TableLayout, parts: Sequence[TableMapping]
) -> tuple[TableSignals, ...]:
    """Read the sensors of a table as a person states them: all rows, or those that a column names.

    Parameters
    ----------
    text, place, layout
        As for `read_long_table`.
    parts
        Meaning of the columns for each sensor or group of sensors.

    Raises
    ------
    RecordingError
        For a column that the table does not have, a name that no row has, and rows without time.
    """
    found = []
    for part in parts:
        stated = with_titles_of(part, layout, place)
        numbers = [title for columns in stated.columns.values() for title in columns.titles]
        times = [title for clock in stated.clocks for title in clock.titles]
        if stated.rows is None:
            found.append(signals_of(read_loose_table(text, place, layout, numbers, times), stated))
            continue
        column, name = stated.rows
        loose = read_loose_table(text, place, layout, numbers, [*times, column])
        names = loose.table.texts(column)
        if name not in names:
            known = ", ".join(dict.fromkeys(names.tolist()))
            raise RecordingError(f"{place}: no row has {name!r} in column {column!r}, which has {known}; correct it")
        found.append(signals_of(_selected(loose, names == name, f"{place}, rows {name}"), stated))
    return tuple(found)


def is_second_choice(name: str) -> bool:
    """Tell whether a calibrated source of the same sensor is better than the one of this name."""
    return any(word in name.casefold() for word in _SECOND_CHOICE)


def _selected(loose: LooseTable, rows: NDArray[np.bool_], place: str) -> LooseTable:
    return replace(loose.only(rows, place), warnings=())


def _is_wide(layout: TableLayout) -> bool:
    """Tell whether the titles name the axes of two motion sensors, so that a name in a row is no sensor."""
    columns = understand_titles(layout.titles, units=layout.units).columns
    return sum(quantity in columns for quantity in MOTION) > 1


def _first_cells(layout: TableLayout, head: bytes) -> list[list[str]]:
    """List the cells of each column in the first rows."""
    lines = head[:HEAD_BYTES].decode("utf-8", "replace").split("\n")[layout.first_line :][:_ROWS_LOOKED_AT]
    rows = [split_line(line, layout.separator) for line in (lines[:-1] or lines)]
    whole = [row for row in rows if len(row) == len(layout.titles)] or [list(layout.sample)]
    return [[cell.strip().strip("\"'") for cell in column] for column in zip(*whole, strict=True)]


def _is_text(cells: Sequence[str]) -> bool:
    return any(kind_of_cell(cell) is Cell.TEXT for cell in cells)


def _mapping_of(
    rows: LooseTable, layout: TableLayout, titles: Sequence[str], units: Sequence[str], quantity: Quantity
) -> TableMapping | None:
    """Find the clock and the columns of the values of one sensor; None when there are too few."""
    if not layout.has_header:
        try:
            return guess_columns(rows, quantity)
        except RecordingError:
            return None
    mapping = understand_titles(titles, quantity, units)
    if quantity in mapping.columns:
        return replace(mapping, columns={quantity: mapping.columns[quantity]}, unused=(), incomplete=())
    if quantity is Quantity.ATTITUDE:
        return None
    times = {title for clock in mapping.clocks for title in clock.titles}
    values = [title for title in titles if title not in times and not _NO_VALUES & set(split_words(title))]
    needed = len(AXES[quantity])
    chosen = _numbered(values, needed) or _measured(rows, values)
    if len(chosen) < needed:
        return None
    columns = QuantityColumns(tuple(chosen[:needed]), (None,) * needed)
    return replace(mapping, columns={quantity: columns}, unused=(), incomplete=())


def _numbered(titles: Sequence[str], needed: int) -> list[str]:
    """Return titles that differ only in the number at their end, in its order: `v1`, `values[0]`, `data_2`."""
    stems: dict[str, dict[int, str]] = {}
    for title in titles:
        match = _NUMBERED.match(title.strip())
        if match is not None:
            stems.setdefault(match[1].casefold(), {})[int(match[2])] = title
    for numbered in stems.values():
        first = min(numbered)
        if all(first + i in numbered for i in range(needed)):
            return [numbered[first + i] for i in range(needed)]
    return []


def _measured(rows: LooseTable, titles: Sequence[str]) -> list[str]:
    """Return the columns with values that no flag has: with fractions, or with many different integers."""
    chosen = []
    for title in titles:
        values = rows.table.numbers(title) if title in rows.table else np.zeros(0)
        values = values[np.isfinite(values)]
        if len(values) and ((values != np.floor(values)).any() or len(np.unique(values)) > 5):
            chosen.append(title)
    return chosen


def _android(cell: str) -> Quantity | None:
    return ANDROID_TYPES.get(int(cell)) if cell.strip().isdigit() and len(cell) < 5 else None
