"""Split files that hold several sensors in turn: a row for each sample with the sensor's name, or tagged rows.

In a long table one column names the sensor: `timestamp,sensor,x,y,z`. In a tagged log each row begins with the name
of its kind, and rows of different kinds have different columns: `IMU,0.02,-0.7,…` or `UncalAccel,1663164669189,…`.
"""

import re
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

from pdr_est.errors import RecordingError
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.mapping import QuantityColumns, TableMapping
from pdr_est.io.tables.quantities import AXES, MOTION, Quantity, is_unit
from pdr_est.io.tables.signals import HEAD_BYTES, TableSignals, layout_of, signals_of, signals_of_text, tables_of_text
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.tables.words.sensors import ANDROID_TYPES
from pdr_est.io.text.cells import Cell, kind_of_cell, split_line
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.text.loose_table import read_loose_table
from pdr_est.io.text.table_layout import TableLayout

_TAG = re.compile(r"[$#%\s]*([A-Za-z][\w ]{0,40})\s*")
_MARKS = ("COL", "UNIT", "VAR")  # FlySight's lines that describe a kind of row
_SEPARATORS = (",", ";", "\t", " ")
_LINES_LOOKED_AT = 300
_TAGGED_SHARE = 0.8
_MOST_TAGS = 40
_SENSOR_TITLES = frozenset(
    {"sensor", "sensortype", "type", "sensorname", "name", "source", "stream", "topic", "kind"}
)


@dataclass(frozen=True)
class TaggedTable:
    """Rows of one kind of a tagged log.

    Attributes
    ----------
    tag
        Name of the kind.
    text
        Its rows without the tag, below its titles and units where the log states them.
    """

    tag: str
    text: bytes


def read_tables(
    data: bytes, place: str, *, hint: Quantity | None = None, mapping: TableMapping | None = None
) -> tuple[TableSignals, ...]:
    """Read a file that holds one table, a long table, a tagged log, or a table with a clock for each sensor.

    Parameters
    ----------
    data, place, hint, mapping
        As for `read_table_signals`; a mapping is that of one table.

    Raises
    ------
    RecordingError
        When the content is no table, has no time, or is damaged.
    """
    text = as_utf8(data)
    if mapping is None:
        layout = layout_of(text)
        column = None if layout is None else sensor_column(layout)
        if layout is not None and column is not None:
            return _read_long(text, place, layout, column)
        if tagged_separator(text[:HEAD_BYTES]) is not None:
            return _read_tagged(text, place)
    return tables_of_text(text, place, hint=hint, mapping=mapping)


def sensor_column(layout: TableLayout) -> str | None:
    """Find the column of a long table that names the sensor; None when the table is not long."""
    if not layout.has_header:
        return None
    for title, cell in zip(layout.titles, layout.sample, strict=True):
        kind = kind_of_cell(cell)
        plain = re.sub(r"[\W_]", "", title.casefold())
        if kind is Cell.TEXT and sensor_by_name(cell) is not None:
            return title
        if kind is Cell.NUMBER and plain in ("sensortype", "sensorid") and _android(cell) is not None:
            return title
        if kind is Cell.TEXT and plain in _SENSOR_TITLES and any(t.strip().lower() == "x" for t in layout.titles):
            return title
    return None


def tagged_separator(head: bytes) -> str | None:
    """Return the separator of a tagged log, of which most rows begin with one of a few names; None for other text."""
    lines = [line for line in head.decode("utf-8", "replace").split("\n")[:_LINES_LOOKED_AT] if line.strip()][:-1]
    for separator in _SEPARATORS:
        rows = [line.split(separator) for line in lines if line.count(separator) >= 3]
        tags = [match.group(1).strip() for row in rows if (match := _TAG.fullmatch(row[0])) is not None]
        if (
            len(tags) < max(2.0, _TAGGED_SHARE * len(rows))
            or len(set(tags)) > _MOST_TAGS
            or 2 * len(rows) < len(lines)
        ):
            continue
        numeric = {
            match.group(1).strip()
            for row in rows
            if (match := _TAG.fullmatch(row[0])) is not None
            and sum(kind_of_cell(cell) is Cell.NUMBER for cell in row[1:]) >= 3
        }
        described = {tag for tag in numeric if tags.count(tag) > 1 and _has_titles(tag, lines, separator)}
        if described or any(sensor_by_name(tag) for tag in numeric):
            return separator
    return None


def tagged_tables(text: bytes) -> tuple[TaggedTable, ...]:
    """Split a tagged log into one table for each kind of row; empty for other text.

    Parameters
    ----------
    text
        Content in UTF-8 with LF at the ends of lines.
    """
    separator = tagged_separator(text[:HEAD_BYTES])
    if separator is None:
        return ()
    rows: dict[str, list[str]] = defaultdict(list)
    heads: dict[str, list[list[str]]] = defaultdict(list)
    for line in text.decode("utf-8", "replace").split("\n"):
        first, _, rest = line.partition(separator)
        match = _TAG.fullmatch(first)
        if match is None or not rest:
            continue
        tag = match.group(1).strip()
        if tag in _MARKS:
            tag, _, rest = rest.partition(separator)
            heads[tag.strip()].append(split_line(rest, separator))
        elif _is_description(cells := split_line(rest, separator)):
            heads[tag].append(cells)
        else:
            rows[tag].append(rest)
    return tuple(TaggedTable(tag, _with_titles(lines, heads.get(tag, []), separator)) for tag, lines in rows.items())


def _has_titles(tag: str, lines: Sequence[str], separator: str) -> bool:
    """Tell whether a line names the columns of a kind of row."""
    for line in lines:
        cells = [cell.strip(" $#%") for cell in line.split(separator)]
        if tag in cells[:2] and _is_description(cells[cells.index(tag) + 1 :]):
            return True
    return False


def _is_description(cells: Sequence[str]) -> bool:
    """Tell whether the cells behind a tag are titles or units, not values."""
    return len(cells) >= 3 and not any(kind_of_cell(cell) in (Cell.NUMBER, Cell.DATE) for cell in cells)


def _with_titles(rows: Sequence[str], heads: Sequence[Sequence[str]], separator: str) -> bytes:
    """Put titles with their units above the rows."""
    titles = next((list(cells) for cells in heads if not all(is_unit(cell) for cell in cells)), None)
    units = next((cells for cells in heads if all(is_unit(cell) for cell in cells)), None)
    if titles is None:
        return "\n".join(rows).encode()
    if units is not None and len(units) == len(titles):
        titles = [f"{title} [{unit}]" if unit.strip() else title for title, unit in zip(titles, units, strict=True)]
    return "\n".join([separator.join(title.strip() for title in titles), *rows]).encode()


def _read_tagged(text: bytes, place: str) -> tuple[TableSignals, ...]:
    """Read the kinds of rows that name a sensor or have titles that do; the others are told."""
    found, skipped, lost = [], [], []
    for table in tagged_tables(text):
        hint = sensor_by_name(table.tag)
        layout = layout_of(table.text)
        stated = understand_titles(layout.titles) if layout is not None and layout.has_header else TableMapping()
        motion = hint in MOTION or stated.has_motion
        if layout is None or (hint is None and not stated.columns):
            skipped.append(table.tag)
            lost += [f"rows {table.tag} are left out, because they are no table of numbers"] if motion else []
            continue
        try:
            found.append(signals_of_text(table.text, f"{place}, rows {table.tag}", hint=hint))
        except RecordingError as error:
            skipped.append(table.tag)
            lost += [f"rows {table.tag} are left out: {error}"] if motion else []
    if not found:
        reasons = f"; {'; '.join(lost)}" if lost else ""
        raise RecordingError(
            f"{place}: none of the kinds of rows ({', '.join(skipped)}) has the samples of a sensor{reasons}"
        )
    decisions = [f"not used: rows {', '.join(skipped)}"] if skipped else []
    found[0] = replace(found[0], decisions=(*found[0].decisions, *decisions), warnings=(*found[0].warnings, *lost))
    return tuple(found)


def _read_long(text: bytes, place: str, layout: TableLayout, column: str) -> tuple[TableSignals, ...]:
    """Read a long table: the rows of each sensor become a table of their own."""
    titles = [title for title in layout.titles if title != column]
    units = [unit for title, unit in zip(layout.titles, layout.units, strict=False) if title != column]
    clocks = understand_titles(titles, units=units).clocks
    times = [title for clock in clocks for title in clock.titles]
    numbers = [title for title in titles if title not in times]
    loose = read_loose_table(text, place, layout, numbers, [*times, column])
    names = loose.table.texts(column)
    found, skipped = [], []
    for name in dict.fromkeys(names.tolist()):
        quantity = _android(name) if name.isdigit() else sensor_by_name(name)
        mapping = None if quantity is None else _mapping_of(titles, units, quantity)
        if mapping is None:
            skipped.append(name)
            continue
        rows = loose.only(names == name, f"{place}, rows {name}")
        signals = signals_of(replace(rows, warnings=()), mapping)
        if signals.signals:
            found.append(signals)
    if not found:
        raise RecordingError(f"{place}: column {column!r} names no sensor that is known ({', '.join(skipped)})")
    note = f"column {column!r} names the sensor of each row" + (
        f"; not used: rows {', '.join(skipped)}" if skipped else ""
    )
    found[0] = replace(
        found[0], decisions=(note, *found[0].decisions), warnings=(*loose.warnings, *found[0].warnings)
    )
    return tuple(found)


def _mapping_of(titles: Sequence[str], units: Sequence[str], quantity: Quantity) -> TableMapping | None:
    """Find the columns of the values of one sensor; None when there are too few."""
    mapping = understand_titles(titles, quantity, units)
    if quantity in mapping.columns:
        return replace(mapping, columns={quantity: mapping.columns[quantity]}, unused=())
    times = {title for clock in mapping.clocks for title in clock.titles}
    values = [title for title in titles if title not in times]
    needed = len(AXES[quantity])
    if len(values) < needed or quantity is Quantity.ATTITUDE:
        return None
    columns = QuantityColumns(tuple(values[:needed]), (None,) * needed)
    return replace(mapping, columns={quantity: columns}, unused=())


def _android(cell: str) -> Quantity | None:
    return ANDROID_TYPES.get(int(cell)) if cell.strip().isdigit() else None
