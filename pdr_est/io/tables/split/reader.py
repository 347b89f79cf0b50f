"""Read a file that holds one table, or several in any of the ways that recorders write them."""

from collections.abc import Sequence
from dataclasses import dataclass

from pdr_est.errors import RecordingError
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.signals import HEAD_BYTES, TableSignals, layout_of, tables_of_text, with_titles_of
from pdr_est.io.tables.split.long_table import read_long_table, read_stated_rows, sensor_column
from pdr_est.io.tables.split.owners import split_by_owner
from pdr_est.io.tables.split.respelt import respelt
from pdr_est.io.tables.split.sections import read_sections, table_sections
from pdr_est.io.tables.split.tagged_log import read_tagged_log, tagged_separator
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.text.table_layout import TableLayout


@dataclass(frozen=True)
class DeviceTables:
    """Tables of one device in a file.

    Attributes
    ----------
    name
        Name of the device; "" where the file names none.
    tables
        Its tables.
    decisions, warnings
        How its rows were found, in words.
    """

    name: str
    tables: tuple[TableSignals, ...]
    decisions: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def read_tables(
    data: bytes,
    place: str,
    *,
    hint: Quantity | None = None,
    mapping: TableMapping | None = None,
    chosen: Sequence[str] = (),
) -> tuple[DeviceTables, ...]:
    """Read a file that holds one table, several tables, a long table or a tagged log, of one device or several.

    Parameters
    ----------
    data, place, hint, mapping
        As for `read_table_signals`; a mapping may have parts for rows of several sensors.
    chosen
        Names of the devices, persons or sessions whose rows are wanted; all without names.

    Raises
    ------
    SeveralWalksError
        When the rows are of several walks, of which none or more than one is chosen.
    RecordingError
        When the content is no table, has no time, or is damaged.
    """
    text = respelt(as_utf8(data))
    sections = table_sections(text) if mapping is None else ()
    if sections:
        return (DeviceTables("", read_sections(sections, place, hint)),)
    layout = layout_of(text)
    if layout is None:
        return (DeviceTables("", _tables_of_device(text, place, hint, mapping)),)
    if mapping is None:
        sensor = sensor_column(layout, text[:HEAD_BYTES])
        known = understand_titles(layout.titles, hint, layout.units)
    else:
        sensor, known = _stated(mapping, layout, place)
    found = []
    for rows in split_by_owner(text, place, layout, known, sensor, chosen):
        own_place = f"{place}, rows of {rows.name}" if rows.name else place
        tables = _tables_of_device(rows.text, own_place, hint, mapping)
        found.append(DeviceTables(rows.name, tables, rows.decisions, rows.warnings))
    return tuple(found)


def _stated(mapping: TableMapping, layout: TableLayout, place: str) -> tuple[str | None, TableMapping]:
    """Return the column that names the sensor, and all columns that a stated mapping uses."""
    parts = [with_titles_of(part, layout, place) for part in mapping.parts or (mapping,)]
    sensor = next((part.rows[0] for part in parts if part.rows is not None), None)
    columns = {(number, q): one for number, part in enumerate(parts) for q, one in part.columns.items()}
    used = {quantity: one for (_, quantity), one in columns.items()}
    return sensor, TableMapping(clocks=parts[0].clocks, columns=used)


def _tables_of_device(
    text: bytes, place: str, hint: Quantity | None, mapping: TableMapping | None
) -> tuple[TableSignals, ...]:
    """Read the rows of one device."""
    if mapping is None:
        layout = layout_of(text)
        column = None if layout is None else sensor_column(layout, text[:HEAD_BYTES])
        if layout is not None and column is not None:
            return read_long_table(text, place, layout, column)
        if tagged_separator(text[:HEAD_BYTES]) is not None:
            return read_tagged_log(text, place)
    elif mapping.parts:
        layout = layout_of(text)
        if layout is None:
            raise RecordingError(f"{place}: no rows of numbers in columns; export the recording as a table")
        return read_stated_rows(text, place, layout, mapping.parts)
    return tables_of_text(text, place, hint=hint, mapping=mapping)
