"""Bring two other ways of writing a table to one value a cell and one sample a row, before anything else is read.

A cell may hold a whole vector, `"[0.1, 0.2, 9.8]"`, as programs write lists and arrays. A row may hold a single
value, with the name of its axis beside it, as in `time,sensor,axis,value`, or `time,name,value` with names such as
`acc_x`.
"""

import re
from collections.abc import Sequence

import polars as pl

from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.quantities import MOTION
from pdr_est.io.tables.signals import HEAD_BYTES, layout_of
from pdr_est.io.tables.titles import sensor_by_name, understand_title
from pdr_est.io.text.cells import BLANKS, Cell, kind_of_cell, split_line
from pdr_est.io.text.header_rows import SEPARATORS
from pdr_est.io.text.table_layout import TableLayout

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_VECTOR = re.compile(rf"[\"']?[\[(]\s*({_NUMBER}(?:(?:\s*[,;]\s*|\s+){_NUMBER}){{1,15}})\s*,?\s*[\])][\"']?")
_PARTS = re.compile(r"[\s,;]+")
_ROWS_LOOKED_AT = 60
_HOLDER = "\0"
_AXES = frozenset("xyzw")
_FEWEST_AXES = 3
_VALUE_TITLES = frozenset(
    {"value", "val", "reading", "measurement", "data", "wert", "valor", "valeur", "valore", "v"}
)


def respelt(text: bytes) -> bytes:
    """Return a table with one value a cell and one sample a row; a text that is so already as it is.

    Parameters
    ----------
    text
        Content in UTF-8, or its beginning.
    """
    return _one_sample_a_row(_one_value_a_cell(text))


def _one_value_a_cell(text: bytes) -> bytes:
    """Write the vectors in cells as cells of their own, where all rows have vectors of the same lengths."""
    if not re.search(rb"[\[(]\s*[-+.\d]", text[:HEAD_BYTES]):
        return text
    lines = text[:HEAD_BYTES].decode("utf-8", "replace").split("\n")[:_ROWS_LOOKED_AT]
    lines = [line for line in (lines[:-1] or lines) if line.strip()]
    titled = bool(lines) and not _VECTOR.search(lines[0])
    rows = lines[1:] if titled else lines
    lengths = {tuple(len(_PARTS.split(inside)) for inside in _VECTOR.findall(line)) for line in rows}
    if len(lengths) != 1 or not (sizes := lengths.pop()):
        return text
    separator = _outer_separator(lines[0] if titled else _VECTOR.sub(_HOLDER, lines[0]))
    body = text.decode("utf-8", "replace")
    top, rest = "", body
    if titled:
        top, _, rest = body.lstrip("\n").partition("\n")
        top = _titles_of_parts(top, rows[0], separator, sizes) + "\n"
    return (top + _VECTOR.sub(lambda found: separator.join(_PARTS.split(found[1])), rest)).encode()


def _outer_separator(line: str) -> str:
    found = max(SEPARATORS[:-1], key=line.count)
    return found if found in line else ","


def _titles_of_parts(titles: str, row: str, separator: str, sizes: Sequence[int]) -> str:
    """Count the parts of each vector behind its title: `acc.0`, `acc.1`, `acc.2`."""
    left = list(sizes)
    cells = split_line(_VECTOR.sub(_HOLDER, row), separator)
    result = []
    for title, cell in zip(split_line(titles, separator), cells, strict=False):
        size = left.pop(0) if cell.strip() == _HOLDER and left else 0
        result += [f"{title}.{i}" for i in range(size)] if size else [title]
    return separator.join(result)


def _one_sample_a_row(text: bytes) -> bytes:
    """Put the axes that share a time side by side; each axis has a column of its own then."""
    layout = layout_of(text[:HEAD_BYTES])
    if layout is None or not layout.has_header or layout.separator == BLANKS or layout.units:
        return text
    lines = text[:HEAD_BYTES].decode("utf-8", "replace").split("\n")[layout.first_line :][:_ROWS_LOOKED_AT]
    cells = [split_line(line, layout.separator) for line in lines[:-1]]
    cells = [row for row in cells if len(row) == len(layout.titles)]
    columns = {title: [row[i].strip().strip("\"'") for row in cells] for i, title in enumerate(layout.titles)}
    names = _columns_of_names(columns)
    value = _column_of_values(layout, columns, names)
    time = understand_titles(layout.titles).clocks[:1]
    if not names or not value or not time or time[0].fraction or time[0].parts:
        return text
    return _side_by_side(text, layout, (time[0].title, value, names))


def _columns_of_names(columns: dict[str, list[str]]) -> tuple[str, ...]:
    """Find the column of names with axes such as `acc_x`, or those of the sensor and of its axis."""
    texts = {
        title: {cell for cell in cells if cell}
        for title, cells in columns.items()
        if any(cells) and all(kind_of_cell(cell) in (Cell.TEXT, Cell.MISSING) for cell in cells)
    }
    for title, found in texts.items():
        meanings = [meaning for cell in found if (meaning := understand_title(cell)) is not None]
        with_axes = [m for m in meanings if m.word is not None and m.word.quantity in MOTION and m.axis in _AXES]
        if len(with_axes) >= min(_FEWEST_AXES, len(found)):  # a single name where axis follows axis
            return (title,)
    axis = next((t for t, found in texts.items() if len(found) >= _FEWEST_AXES and _are_axes(found)), "")
    sensor = next((t for t, found in texts.items() if t != axis and any(map(sensor_by_name, found))), "")
    return (sensor, axis) if sensor and axis else ()


def _are_axes(names: set[str]) -> bool:
    return {name.casefold() for name in names} <= _AXES


def _column_of_values(layout: TableLayout, columns: dict[str, list[str]], names: Sequence[str]) -> str:
    """Find the one column of values: by its title, or because no other has numbers with fractions; "" for several."""
    numbers = [
        title
        for title in layout.titles
        if title not in names and all(kind_of_cell(cell) in (Cell.NUMBER, Cell.MISSING) for cell in columns[title])
    ]
    titled = [title for title in numbers if title.strip("_ ").casefold() in _VALUE_TITLES]
    times = {title for clock in understand_titles(layout.titles).clocks for title in clock.titles}
    fractions = [t for t in numbers if t not in times and any("." in cell for cell in columns[t])]
    found = titled or fractions
    return found[0] if len(found) == 1 else ""


def _side_by_side(text: bytes, layout: TableLayout, roles: tuple[str, str, tuple[str, ...]]) -> bytes:
    """Write the table of a row for each time, in the order in which times come first."""
    time, value, names = roles
    body = b"\n".join(text.split(b"\n")[layout.first_line :])
    try:
        frame = pl.read_csv(
            body,
            separator=layout.separator,
            has_header=False,
            new_columns=[f"c{i}" for i in range(len(layout.titles))],
            infer_schema=False,
            truncate_ragged_lines=True,
        )
    except pl.exceptions.PolarsError:
        return text
    of = {title: f"c{i}" for i, title in enumerate(layout.titles)}
    name = pl.concat_str([pl.col(of[one]).str.strip_chars(" \"'") for one in names], separator=" ")
    long = frame.select(pl.col(of[time]).alias("time"), name.alias("name"), pl.col(of[value]).alias("value"))
    long = long.drop_nulls(["time", "name"]).with_columns(pl.int_range(pl.len()).over("time", "name").alias("copy"))
    wide = long.pivot(on="name", index=["time", "copy"], values="value", aggregate_function="first").drop("copy")
    if not (long["name"][:_ROWS_LOOKED_AT] != long["name"][0]).any():  # axis after axis: times come in several runs
        wide = _by_time(wide)
    return wide.rename({"time": time}).write_csv(separator=layout.separator).encode()


def _by_time(table: pl.DataFrame) -> pl.DataFrame:
    """Sort the rows by time: by its number, or by its letters where those are equally many, as in dates."""
    times = table["time"].str.strip_chars(" \"'")
    numbers = times.cast(pl.Float64, strict=False)
    if numbers.null_count() == 0:
        return table[numbers.arg_sort()]
    return table[times.arg_sort()] if times.str.len_bytes().n_unique() == 1 else table
