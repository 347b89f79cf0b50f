"""Tell from the beginning of a file whether it is a table with motion, and describe what was seen if it is not."""

from enum import IntEnum

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.gravity_content import has_gravity
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.headerless import guess_columns
from pdr_est.io.tables.quantities import MOTION, Quantity
from pdr_est.io.tables.signals import HEAD_BYTES, layout_of
from pdr_est.io.tables.split.long_table import sensor_column
from pdr_est.io.tables.split.respelt import respelt
from pdr_est.io.tables.split.tagged_log import tagged_tables
from pdr_est.io.tables.titles import sensor_by_name, understand_title
from pdr_est.io.tables.values.impossible_values import without_impossible_rows
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.text.loose_table import read_loose_table
from pdr_est.io.text.table_layout import TableLayout, has_split_decimals

_TITLES_SHOWN = 12
_CELLS_SHOWN = 8


class Evidence(IntEnum):
    """Evidence that a file is a table with motion."""

    NONE = 0
    """It is none."""

    VALUES = 1
    """Only its values look like it: axes without a sensor's name, or no titles at all."""

    TITLES = 2
    """Titles, or the names of sensors in it, say so."""


def motion_evidence(head: bytes, stem: str) -> Evidence:
    """Judge whether a file holds a clock and the axes of an accelerometer or gyroscope.

    Parameters
    ----------
    head
        Beginning of the file.
    stem
        Name of the file without its extension, which may name the sensor.
    """
    written = _whole_lines(head)
    text = respelt(written)
    layout = layout_of(text)
    if layout is not None and sensor_column(layout, text) is not None:
        return Evidence.TITLES
    if layout is not None and text is not written and any(map(_is_motion_axis, layout.titles)):
        return Evidence.TITLES  # the other axes may come behind the head
    if any(_is_motion(table.tag, table.text) for table in tagged_tables(text)):
        return Evidence.TITLES
    if layout is None:
        return Evidence.NONE
    hint = sensor_by_name(stem)
    if not layout.has_header:
        return _evidence_of_values(text, layout, hint)
    mapping = understand_titles(layout.titles, hint, layout.units)
    if not (mapping.has_time and mapping.has_motion):
        return Evidence.NONE
    force = mapping.columns.get(Quantity.FORCE)
    rate = mapping.columns.get(Quantity.RATE)
    named = hint is not None or (rate is not None and not rate.nameless) or Quantity.LINEAR in mapping.columns
    if named or force is None or not _is_bare(force.titles):
        return Evidence.TITLES
    bare = [one.titles for one in (force, rate) if one is not None]
    return Evidence.VALUES if any(_head_has_gravity(text, layout, one) for one in bare) else Evidence.NONE


def describe_content(head: bytes, stem: str) -> str:
    """Say in words what a file that is not read holds, and what is missing."""
    text = respelt(_whole_lines(head))
    layout = layout_of(text)
    if (layout is None or not layout.has_header) and has_split_decimals(text):
        return (
            "commas separate the cells and the decimals, so that neither can be told apart; export it with points, "
            "with quotes around the numbers, or with semicolons between the cells"
        )
    if layout is None:
        return "no rows of numbers were found in it"
    row = ", ".join(cell[:30] for cell in layout.sample[:_CELLS_SHOWN])
    if not layout.has_header:
        return f"it has no header line; its first row is {row}"
    mapping = understand_titles(layout.titles, sensor_by_name(stem), layout.units)
    titles = ", ".join(map(repr, layout.titles[:_TITLES_SHOWN]))
    titles += ", …" if len(layout.titles) > _TITLES_SHOWN else ""
    if mapping.has_motion and not mapping.has_time:
        missing = "the table has no time column (a mapping can give the rate, time: {rate_hz: 50})"
    elif mapping.has_motion:
        missing = "its three axes without a sensor's name do not look like an accelerometer"
    else:
        missing = "no accelerometer or gyroscope"
        missing += "" if mapping.has_time else " and no time"
    return f"{missing} among the columns {titles}; the first row is {row}"


def _whole_lines(head: bytes) -> bytes:
    """Cut off a line that the head ends in."""
    text = as_utf8(head[:HEAD_BYTES])
    return text[: text.rfind(b"\n") + 1] if len(head) >= HEAD_BYTES and b"\n" in text else text


def _is_motion(tag: str, text: bytes) -> bool:
    if sensor_by_name(tag) in MOTION:
        return True
    layout = layout_of(text)
    return layout is not None and layout.has_header and understand_titles(layout.titles).has_motion


def _is_motion_axis(title: str) -> bool:
    meaning = understand_title(title)
    return meaning is not None and meaning.word is not None and meaning.word.quantity in MOTION


def _is_bare(titles: tuple[str, ...]) -> bool:
    return understand_titles(titles).columns[Quantity.FORCE].ambiguous and sensor_by_name(titles[0]) is None


def _evidence_of_values(text: bytes, layout: TableLayout, hint: Quantity | None) -> Evidence:
    try:
        mapping = guess_columns(read_loose_table(text, "", layout, (), layout.titles), hint)
    except RecordingError:
        return Evidence.NONE
    return Evidence.VALUES if mapping.has_motion else Evidence.NONE


def _head_has_gravity(text: bytes, layout: TableLayout, titles: tuple[str, ...]) -> bool:
    try:
        values = read_loose_table(text, "", layout, titles).table.stack(titles)
    except RecordingError:
        return False
    measured = without_impossible_rows(values)
    return len(measured) > 0 and has_gravity(measured)
