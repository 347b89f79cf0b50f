"""Split files with tables one below the other, each with a header of its own, such as one for each sensor.

A line above a header, such as `# Gyroscope` or `Gyroscope:`, is the name of its table.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.quantities import MOTION, Quantity
from pdr_est.io.tables.signals import HEAD_BYTES, TableSignals, layout_of, signals_of_text
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.cells import Cell, kind_of_cell, split_line
from pdr_est.io.text.table_layout import TableLayout

_IS_WORD = np.array([chr(code).isalpha() or chr(code) in "#%/[(=*" or code >= 128 for code in range(256)])
_MOST_LINES = 160  # that are no rows of numbers
_FEWEST_ROWS = 3
_LINES_ABOVE = 4  # between the name of a table and its header


@dataclass(frozen=True)
class TableSection:
    """One of several tables in a file.

    Attributes
    ----------
    name
        What the line above its header says; "" without one.
    line
        Number of the line with its header, from 1.
    text
        Its header and rows in UTF-8.
    """

    name: str
    line: int
    text: bytes


def table_sections(text: bytes) -> tuple[TableSection, ...]:
    """Find the tables of a file that has several; empty for a file with one.

    A header that is written again, in the middle of a table, begins no new one unless another sensor's name stands
    above it.

    Parameters
    ----------
    text
        Content in UTF-8 with LF at the ends of lines.
    """
    heads = _headers(text)
    if len(heads) < 2:
        return ()
    borders = [start for _, start in heads]
    found: list[TableSection] = []
    for (name, start), end in zip(heads, [*borders[1:], len(text)], strict=True):
        content = _without_next_name(text[start:end])
        line = text.count(b"\n", 0, start) + 1
        first = content.split(b"\n", 1)[0].strip()
        repeated = found and first == found[-1].text.split(b"\n", 1)[0].strip()
        if repeated and (not name or name == found[-1].name):
            found[-1] = replace(found[-1], text=found[-1].text.rstrip(b"\n") + b"\n" + content)
            continue
        found.append(TableSection(name, line, content))
    return tuple(found) if len(found) > 1 else ()


def read_sections(
    sections: Sequence[TableSection], place: str, hint: Quantity | None = None
) -> tuple[TableSignals, ...]:
    """Read the tables of a file that has several; those that are not understood are reported.

    Parameters
    ----------
    sections
        The tables.
    place
        Name of the file, for messages.
    hint
        Quantity that the name of the file tells; None when it tells none.

    Raises
    ------
    RecordingError
        When none of them has the samples of a sensor.
    """
    found: list[TableSignals] = []
    left = []
    for section in sections:
        label = section.name or f"the table that begins in line {section.line}"
        try:
            table = signals_of_text(section.text, f"{place}, {label}", hint=sensor_by_name(section.name) or hint)
        except RecordingError as error:
            left.append(f"{label} is left out: {error}")
            continue
        if table.signals:
            found.append(table)
        else:
            left.append(f"{label} has no sensor that is known and is left out")
    if not any(quantity in table.signals for table in found for quantity in MOTION):
        raise RecordingError(
            f"{place}: {len(sections)} tables one below the other, and none has an accelerometer or gyroscope"
            + (f" ({'; '.join(left)})" if left else "")
            + "; write the sensor's name above its titles, or save each table as a file of its own"
        )
    note = f"the file has {len(sections)} tables one below the other"
    found[0] = replace(found[0], decisions=(note, *found[0].decisions), warnings=(*found[0].warnings, *left))
    return tuple(found)


def _headers(text: bytes) -> list[tuple[str, int]]:
    """Find the headers of tables: the name above each, and where it begins."""
    starts = _starts_of_words(text)
    if not 2 <= len(starts) <= _MOST_LINES:
        return []
    heads: list[tuple[str, int]] = []
    above: list[bytes] = []
    begun = -1  # end of the last header
    for start in starts:
        end = text.find(b"\n", start)
        line = text[start : len(text) if end < 0 else end]
        if begun >= 0 and not text[begun:start].strip():
            continue  # a row of units below its titles
        if not _is_header(line, text[start + len(line) + 1 :][: HEAD_BYTES // 4]):
            above.append(line)
            continue
        names = [name for one in above[-_LINES_ABOVE:] if sensor_by_name(name := _plain(one)) is not None]
        heads.append((names[-1] if names else "", start))
        begun = start + len(line)
        above = []
    return heads


def _starts_of_words(text: bytes) -> list[int]:
    """Find where lines begin that are no rows of numbers: with a letter or the mark of a comment, maybe quoted."""
    codes = np.frombuffer(text, dtype=np.uint8)
    starts = np.concatenate([[0], np.flatnonzero(codes == ord("\n")) + 1])
    starts = starts[starts < len(codes)]
    quoted = codes[starts] == ord('"')
    firsts = codes[np.minimum(starts + quoted, len(codes) - 1)]
    found: list[int] = starts[_IS_WORD[firsts]].tolist()
    return found


def _plain(line: bytes) -> str:
    return line.decode("utf-8", "replace").strip(" #%/*=-[]\"':\t")


def _is_header(line: bytes, below: bytes) -> bool:
    """Tell whether a line names the columns of the rows below it, one of which is a time."""
    layout = layout_of(line + b"\n" + below)
    if layout is None or not layout.has_header or layout.header_line != 0:
        return False
    return _rows_follow(below, layout) and understand_titles(layout.titles, Quantity.FORCE, layout.units).has_time


def _rows_follow(below: bytes, layout: TableLayout) -> bool:
    lines = [line for line in below.decode("utf-8", "replace").split("\n")[:-1] if line.strip()][: _FEWEST_ROWS + 1]
    rows = [split_line(line, layout.separator) for line in lines]
    numbers = [row for row in rows if sum(kind_of_cell(cell) in (Cell.NUMBER, Cell.DATE) for cell in row) >= 2]
    return len(numbers) >= min(_FEWEST_ROWS, len(rows))


def _without_next_name(content: bytes) -> bytes:
    """Cut off the lines of words at the end, which belong to the next table."""
    lines = content.rstrip().split(b"\n")
    while len(lines) > 1 and (not lines[-1].strip() or _starts_of_words(lines[-1])):
        lines.pop()
    return b"\n".join(lines) + b"\n"
