"""Split tagged logs: each row begins with the name of its kind, and rows of different kinds have different columns.

Examples are `IMU,0.02,-0.7,…` below a line that names the columns, and `UncalAccel,1663164669189,…`.
"""

import re
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

from pdr_est.errors import RecordingError
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import MOTION, is_unit
from pdr_est.io.tables.signals import HEAD_BYTES, TableSignals, layout_of, signals_of_text
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.cells import Cell, kind_of_cell, split_line

_TAG = re.compile(r"[$#%\s]*([A-Za-z][\w ]{0,40})\s*")
_MARKS = ("COL", "UNIT", "VAR")  # FlySight's lines that describe a kind of row
_SEPARATORS = (",", ";", "\t", " ")
_LINES_LOOKED_AT = 300
_TAGGED_SHARE = 0.8
_MOST_TAGS = 40


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


def read_tagged_log(text: bytes, place: str) -> tuple[TableSignals, ...]:
    """Read the kinds of rows that name a sensor or have titles that do; the others are reported."""
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
            f"{place}: none of the kinds of rows ({', '.join(skipped)}) has the samples of a sensor{reasons}; "
            "save the rows of each sensor as a file of its own, named by the sensor"
        )
    decisions = [f"not used: rows {', '.join(skipped)}"] if skipped else []
    found[0] = replace(found[0], decisions=(*found[0].decisions, *decisions), warnings=(*found[0].warnings, *lost))
    return tuple(found)
