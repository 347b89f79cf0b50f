"""Parse tables of numbers into arrays by a fast engine (polars), with errors that name line, column and value."""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.text.cells import brief_cell
from pdr_est.io.text.finite_values import discard_huge_values
from pdr_est.io.text.text_columns import as_texts

_BOM = b"\xef\xbb\xbf"
_TYPE_INFERENCE_ROWS = 100


@dataclass(frozen=True)
class NumberTable:
    """Columns of a table, all of one length.

    Attributes
    ----------
    place
        The file, for messages.
    columns
        Name -> (n,) float64; int64 where every value is an integer, because nanosecond clocks exceed what float64
        holds exactly; str for the columns that were asked for as text.
    empty
        Name -> (n,) which cells are empty, for number columns with empty cells. A written NaN is not an empty cell.
    """

    place: str
    columns: Mapping[str, NDArray[Any]]
    empty: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()))) if self.columns else 0

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    @property
    def names(self) -> tuple[str, ...]:
        """Return the column names in the order of the file."""
        return tuple(self.columns)

    def numbers(self, name: str) -> Array:
        """Return a column as float64, (n,); a missing value is NaN."""
        return self._column(name).astype(np.float64)

    def stack(self, names: Sequence[str]) -> Array:
        """Return several columns side by side, (n, len(names)) float64."""
        values = np.empty((len(self), len(names)))
        for i, name in enumerate(names):
            values[:, i] = self._column(name)
        return values

    def has_values(self, names: Sequence[str]) -> NDArray[np.bool_]:
        """Find the rows (n,) in which at least one of some number columns is not empty."""
        present = np.zeros(len(self), dtype=np.bool_)
        for name in names:
            present |= ~self.empty[name] if name in self.empty else True
        return present

    def texts(self, name: str) -> NDArray[Any]:
        """Return a column that was asked for as text; a missing value is the empty string."""
        return self._column(name).astype(np.str_)

    def relative_time(self, name: str, ticks_per_s: float = 1.0) -> tuple[float, Array]:
        """Split a time column into its first time and the seconds since then.

        The difference is taken before the conversion to float64, so that integer nanoseconds since 1970 lose nothing.

        Returns
        -------
        first_s : float
            First time, s.
        since_s : (n,)
            Seconds since the first time.

        Raises
        ------
        RecordingError
            When there are no rows or the first time is missing.
        """
        ticks = self._column(name)
        if len(ticks) == 0:
            raise RecordingError(f"{self.place}: has no rows; record again or leave this file out")
        if not np.isfinite(ticks[0]):
            raise RecordingError(f"{self.place}: the first row has no time in column {name!r}; remove that row")
        return float(ticks[0]) / ticks_per_s, (ticks - ticks[0]).astype(np.float64) / ticks_per_s

    def _column(self, name: str) -> NDArray[Any]:
        if name not in self.columns:
            raise RecordingError(
                f"{self.place}: no column {name!r} among {', '.join(self.names)}; export it with this column"
            )
        return self.columns[name]


def read_table(
    data: bytes,
    place: str,
    *,
    separator: str = ",",
    decimal_comma: bool = False,
    has_header: bool = True,
    columns: Sequence[str] | None = None,
    text_columns: Sequence[str] = (),
) -> NumberTable:
    """Parse a table from the bytes of a file.

    A byte-order mark, the line ends of every system and trailing blank lines are tolerated. Empty cells, NaN and
    numbers that no sensor can measure become NaN.

    Parameters
    ----------
    data
        Content of the file.
    place
        Name of the file, for messages.
    separator, decimal_comma, has_header
        Way in which the table is written.
    columns
        Names of the columns to keep; absent ones are simply not in the result. Without a header they name all columns
        from the left.
    text_columns
        Names of columns that stay text. Every other column must hold numbers.

    Raises
    ------
    RecordingError
        For an empty table, text in a number column and rows of unequal length, naming line, column and value.
    """
    content = data.removeprefix(_BOM).rstrip(b"\r\n \0")
    if b"\n" not in content:
        content = content.replace(b"\r", b"\n")
    if not content:
        raise RecordingError(f"{place}: the table is empty; export it again or leave this file out")
    _refuse_open_quote(content, place)
    layout = _TableLayout(separator, decimal_comma, has_header)
    frame = _parse_frame(content, place, layout, text_columns)
    if not has_header:
        frame.columns = _headerless_names(frame.width, columns, place)
    else:
        frame.columns = [name.strip().strip('"') for name in frame.columns]
        if columns is not None:
            frame = frame.select([name for name in frame.columns if name in set(columns) | set(text_columns)])
    arrays: dict[str, NDArray[Any]] = {}
    empty: dict[str, NDArray[np.bool_]] = {}
    for name in frame.columns:
        if name in text_columns:
            arrays[name] = as_texts(frame[name].cast(pl.String))
            continue
        arrays[name] = discard_huge_values(_as_numbers(frame[name], place, layout))
        cells = _empty_cells(frame[name])
        if cells.any():
            empty[name] = cells
    return NumberTable(place, arrays, empty)


@dataclass(frozen=True)
class _TableLayout:
    """Separator, decimal mark and header of a table."""

    separator: str
    decimal_comma: bool
    has_header: bool


def _refuse_open_quote(content: bytes, place: str) -> None:
    """Refuse a quote that is never closed: it would make one cell of all that follows."""
    top = content[: content.find(b"\n")] if b"\n" in content else content
    in_header = top.count(b'"') % 2 == 1
    if in_header or content.count(b'"') % 2 == 1:
        lines = [top] if in_header else content.split(b"\n")
        number = next(i for i, line in enumerate(lines, start=1) if line.count(b'"') % 2 == 1)
        raise RecordingError(f"{place}, line {number}: a quote is not closed; remove it")


def _parse_frame(content: bytes, place: str, layout: _TableLayout, text_columns: Sequence[str]) -> pl.DataFrame:
    """Parse all columns, of types found from the first rows or, if a later row differs, as text."""
    try:
        frame = _read_frame(content, layout, text_columns, _TYPE_INFERENCE_ROWS)
    except (pl.exceptions.PolarsError, ValueError):
        # A later row is not of the type of the first rows: all fields as text, which is slower.
        try:
            frame = _read_frame(content, layout, text_columns, 0)
        except (pl.exceptions.PolarsError, ValueError) as error:
            _check_row_lengths(content, place, layout)
            raise RecordingError(
                f"{place}: cannot be read as a table ({_first_line(error)}); export it again"
            ) from error
    # The engine fills rows that are too short with nulls; only then is the slow look at the lines needed.
    if frame.width > 1 and frame[frame.columns[-1]].null_count():
        _check_row_lengths(content, place, layout)
    return frame


def _read_frame(
    content: bytes, layout: _TableLayout, text_columns: Sequence[str], inference_rows: int
) -> pl.DataFrame:
    return pl.read_csv(
        content,
        separator=layout.separator,
        decimal_comma=layout.decimal_comma,
        has_header=layout.has_header,
        infer_schema_length=inference_rows,
        schema_overrides=dict.fromkeys(text_columns, pl.String),
        encoding="utf8-lossy",
    )


def _check_row_lengths(content: bytes, place: str, layout: _TableLayout) -> None:
    """Raise an error for the first row whose number of fields differs from the header's."""
    rows = csv.reader(io.StringIO(content.decode("utf-8", "replace"), newline=""), delimiter=layout.separator)
    expected = 0
    try:
        for row in rows:
            expected = expected or len(row)
            if len(row) != expected and row:
                raise RecordingError(
                    f"{place}, line {rows.line_num}: {len(row)} fields instead of {expected}; "
                    "complete or remove this line"
                )
    except csv.Error as error:
        raise RecordingError(f"{place}, line {rows.line_num}: {error}; look for an open quote") from error


def _headerless_names(width: int, names: Sequence[str] | None, place: str) -> list[str]:
    if names is None:
        return [f"column_{i + 1}" for i in range(width)]
    if len(names) != width:
        raise RecordingError(f"{place}: {width} columns instead of {len(names)}; this is not the expected table")
    return list(names)


def _empty_cells(column: pl.Series) -> NDArray[np.bool_]:
    """Find the cells without any text."""
    empty = column.is_null()
    if column.dtype == pl.String:
        empty |= (column.str.strip_chars() == "").fill_null(True)
    return empty.to_numpy()


def _as_numbers(column: pl.Series, place: str, layout: _TableLayout) -> NDArray[Any]:
    """Convert a column to int64 when all values are integers, else to float64 with NaN for missing values."""
    if column.dtype == pl.Int64 and column.null_count() == 0:
        return column.to_numpy()
    if column.dtype.is_numeric():
        return column.cast(pl.Float64).to_numpy().astype(np.float64)
    text = column.cast(pl.String).str.strip_chars().replace("", None)
    if layout.decimal_comma:
        text = text.str.replace_all(",", ".", literal=True)
    integers = text.cast(pl.Int64, strict=False)
    if integers.null_count() == 0:
        return integers.to_numpy()
    numbers = text.cast(pl.Float64, strict=False)
    wrong = (numbers.is_null() & text.is_not_null()).arg_max()
    if wrong is not None and numbers[wrong] is None and text[wrong] is not None:
        line = wrong + 1 + layout.has_header
        raise RecordingError(
            f"{place}, line {line}, column {brief_cell(column.name)}: {brief_cell(text[wrong])} is not a "
            "number; correct or remove it"
        )
    return numbers.to_numpy().astype(np.float64)


def _first_line(error: Exception) -> str:
    return str(error).strip().split("\n", 1)[0]
