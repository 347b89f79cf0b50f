"""Collect the whole rows of a table that has damaged ones, a few thousand lines at a time.

Rows as lists of Python texts would need twenty times the memory of the table.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import polars as pl
from numpy.typing import NDArray

from pdr_est.io.text.cells import brief_cell, split_line
from pdr_est.io.text.table_layout import TableLayout
from pdr_est.io.text.text_columns import ParsedColumn, join_numbers, parse_numbers, parse_text_column

_PIECE_BYTES = 1 << 21
_NAMED = 3  # cells of a column and piece


def pieces_of_lines(body: memoryview) -> Iterator[memoryview]:
    """Cut a text into pieces of about 2 MiB at the ends of lines, without those ends."""
    at = 0
    while at < len(body):
        end = at + _PIECE_BYTES
        while end < len(body) and (found := bytes(body[end : end + _PIECE_BYTES]).find(b"\n")) < 0:
            end += _PIECE_BYTES
        end = min(end + found, len(body)) if end < len(body) else len(body)
        yield body[at:end]
        at = end + 1


class WholeRows:
    """Rows with as many cells as there are titles, piece by piece; numbers are converted at once.

    Parameters
    ----------
    layout
        How the table is written.
    numbers, times
        Titles of the columns to keep: those that hold numbers, and those that may be text.

    Attributes
    ----------
    damaged
        Line number -> fault of the other rows.
    """

    def __init__(self, layout: TableLayout, numbers: Sequence[str], times: Sequence[str]) -> None:
        self._layout = layout
        self._at = {title: layout.titles.index(title) for title in (*numbers, *times)}
        self._numbers: dict[str, list[ParsedColumn]] = {title: [] for title in numbers}
        self._texts: dict[str, list[pl.Series]] = {title: [] for title in times}
        self._wrong: dict[int, str] = {}  # line number -> fault of rows that are whole
        self._lines: list[NDArray[np.int64]] = []
        self._next_line = layout.first_line + 1
        self.damaged: dict[int, str] = {}

    def add_columns(self, columns: Mapping[str, pl.Series]) -> None:
        """Add the rows of a piece of which every line is a whole row."""
        count = len(next(iter(columns.values())))
        self._add(columns, np.arange(self._next_line, self._next_line + count))
        self._next_line += count

    def add_lines(self, piece: memoryview) -> None:
        """Add the whole rows of a piece; empty cells too many at the end of a row are cut off."""
        width = len(self._layout.titles)
        rows: list[list[str]] = []
        lines = []
        # Line by line, so that a quote that is not closed spoils no other line.
        for number, text in enumerate(str(piece, "utf-8", "replace").split("\n"), start=self._next_line):
            if not text.strip() or text.startswith("#"):
                continue
            row = split_line(text, self._layout.separator)
            while len(row) > width and not row[-1].strip():
                row.pop()
            if len(row) == width:
                rows.append(row)
                lines.append(number)
            elif any(cell.strip() for cell in row):
                self.damaged[number] = f"{len(row)} cells instead of {width}"
        columns = {title: pl.Series([row[at] for row in rows], dtype=pl.String) for title, at in self._at.items()}
        self._add(columns, np.array(lines, dtype=np.int64))
        self._next_line += bytes(piece).count(b"\n") + 1

    def _add(self, columns: Mapping[str, pl.Series], lines: NDArray[np.int64]) -> None:
        self._lines.append(lines)
        for title, column in columns.items():
            if title in self._texts:
                self._texts[title].append(column.rename(title))
                continue
            parsed = parse_numbers(column)
            self._numbers[title].append(parsed)
            self._note(title, column, parsed, lines)

    def _note(self, title: str, column: pl.Series, parsed: ParsedColumn, lines: NDArray[np.int64]) -> None:
        """Remember some cells that are no numbers."""
        for i in np.flatnonzero(parsed.wrong & ~parsed.empty)[:_NAMED]:
            self._wrong.setdefault(int(lines[i]), f"{brief_cell(column[int(i)])} in column {title!r}")

    def parsed(self) -> tuple[dict[str, ParsedColumn], NDArray[np.int64], dict[int, str]]:
        """Return the columns, the line number of each row, and faults of whole rows by their lines; forget them."""
        lines = np.concatenate(self._lines) if self._lines else np.zeros(0, dtype=np.int64)
        columns = {}
        for title in tuple(self._numbers):
            columns[title] = join_numbers(self._numbers.pop(title))
        for title in tuple(self._texts):
            column = pl.concat(self._texts.pop(title))
            columns[title] = parse_text_column(column, may_be_text=True)
            self._note(title, column, columns[title], lines)
        # A column of other things than numbers was left out as a whole.
        bad = set(lines[np.any([one.wrong for one in columns.values()], axis=0)].tolist()) if columns else set()
        return columns, lines, {line: fault for line, fault in self._wrong.items() if line in bad}
