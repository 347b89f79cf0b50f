"""Parse logs that mix the rows of many sensors in one file, each row tagged with its type."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import polars as pl
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.text.cells import brief_cell
from pdr_est.io.text.finite_values import discard_huge_values
from pdr_est.io.text.text_columns import as_texts


@dataclass(frozen=True)
class TaggedLog:
    """Rows of a log as text fields, selected by tag and converted to numbers on request.

    A row with fewer fields than asked for gives NaN there.

    Attributes
    ----------
    place
        The file, for messages.
    """

    place: str
    _data: bytes
    _separator: str
    _tag_column: str
    _rows: pl.DataFrame

    @classmethod
    def parse(cls, data: bytes, place: str, *, separator: str, tag_field: int, n_fields: int) -> "TaggedLog":
        """Split a log into rows and fields.

        Parameters
        ----------
        data
            Content of the file.
        place
            Name of the file, for messages.
        separator
            Character between two fields.
        tag_field
            Index of the field that holds the tag.
        n_fields
            Number of fields to keep; further ones are ignored.
        """
        names = [f"field_{i}" for i in range(n_fields)]
        header = separator.join(names).encode() + b"\n"
        rows = pl.read_csv(
            header + data.removeprefix(b"\xef\xbb\xbf"),
            separator=separator,
            quote_char=None,
            truncate_ragged_lines=True,
            infer_schema=False,
            encoding="utf8-lossy",
        )
        return cls(place, data, separator, names[tag_field], rows)

    def count(self, tag_prefix: str) -> int:
        """Count the rows whose tag begins with a prefix."""
        return int(self._rows[self._tag_column].str.starts_with(tag_prefix).sum())

    def tags(self) -> tuple[str, ...]:
        """Return the tags of all rows, sorted."""
        return tuple(sorted(tag for tag in self._rows[self._tag_column].unique() if tag))

    def texts(self, tag: str, field: int) -> NDArray[np.str_]:
        """Return a field (n,) of the rows with a tag, as text without outer blanks."""
        rows = self._rows.filter(pl.col(self._tag_column) == tag)
        return as_texts(rows[f"field_{field}"].str.strip_chars())

    def numbers(self, tag: str, fields: Sequence[int]) -> Array:
        """Convert fields of the rows with a tag to numbers, (n, len(fields)) float64.

        An empty or absent field is NaN, as is a number that no sensor can measure.

        Raises
        ------
        RecordingError
            For text in a number field, naming line, tag and value.
        """
        rows = self._rows.filter(pl.col(self._tag_column) == tag)
        text = rows.select(pl.col(f"field_{i}").alias(f"value_{k}") for k, i in enumerate(fields))
        numbers = text.cast(pl.Float64, strict=False)
        for name in numbers.columns:
            if numbers[name].null_count() == text[name].null_count():
                continue
            # Blanks and the CR of CRLF are rare: only a column with unreadable fields is looked at without them.
            text = text.with_columns(pl.col(name).str.strip_chars().replace("", None))
            numbers = numbers.with_columns(text[name].cast(pl.Float64, strict=False))
            if numbers[name].null_count() != text[name].null_count():
                wrong = int((numbers[name].is_null() & text[name].is_not_null()).arg_max() or 0)
                cell = brief_cell(text[name][wrong])
                raise RecordingError(
                    f"{self.place}, line {self._line_of(rows.row(wrong))}, {tag}: {cell} is not a number; correct or "
                    "remove this line"
                )
        return discard_huge_values(numbers.fill_null(np.nan).to_numpy().astype(np.float64).reshape(-1, len(fields)))

    def _line_of(self, row: tuple[str | None, ...]) -> int:
        """Find the line of the first row that equals this one, in the file as it was recorded."""
        fields = [field for field in row if field is not None]
        found = self._data.find(self._separator.join(fields).encode())
        return self._data[: max(found, 0)].count(b"\n") + 1
