"""Damaged tables cost four times their size at most, name what is wrong in few words, and lose no other row."""

import tracemalloc
from functools import cache

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.text.loose_table import LooseTable, read_loose_table
from pdr_est.io.text.number_table import read_table
from pdr_est.io.text.table_layout import detect_layout

ROWS = 20_000
LONG = "x" * 200_000


@cache
def rows(count: int, dates: bool = False) -> tuple[str, ...]:
    values = np.random.default_rng(1).normal(size=(count, 3))
    stamps = [f"2031-02-03 04:05:{k % 60:02d}.{k % 1000:03d}" if dates else f"{k / 100:.2f}" for k in range(count)]
    return tuple(f"{stamp},{x},{y},{z}" for stamp, (x, y, z) in zip(stamps, values.tolist(), strict=True))


@cache
def numbers(count: int) -> Array:
    """The values of the rows, (n, 3)."""
    return np.array([line.split(",")[1:] for line in rows(count)], dtype=np.float64)


def loose(lines: list[str]) -> LooseTable:
    data = "\n".join(["time,x,y,z", *lines]).encode()
    layout = detect_layout(data[:8000])
    assert layout is not None
    return read_loose_table(data, "walk.csv", layout, ("x", "y", "z"), ("time",))


DAMAGES = {
    "short": "1.0,2.0",
    "long": "1.0,2.0,3.0,4.0,5.0",
    "text": "1.0,2.0,abc,4.0",
    "open quote": '1.0,2.0,"3.0,4.0',
    "two open quotes": '1.0,"2.0,"3.0,4.0',
    "long cell": f"1.0,2.0,{LONG},4.0",
    "long time": f"{LONG},2.0,3.0,4.0",
    "blank": "",
}


@pytest.mark.parametrize("dates", [False, True], ids=["numbers", "dates"])
@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
@pytest.mark.parametrize("at", [500, ROWS - 1])
def test_one_damaged_row_costs_no_other_row_and_little_memory(damage: str, dates: bool, at: int) -> None:
    lines = list(rows(ROWS, dates))
    lines[at] = damage
    size = sum(map(len, lines))
    tracemalloc.start()
    try:
        found = loose(lines)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert ROWS - 1 <= len(found.table) <= ROWS
    expected = np.delete(numbers(ROWS), at, axis=0)
    read = found.table.stack(("x", "y", "z"))
    np.testing.assert_array_equal(np.delete(read, at, axis=0) if len(read) == ROWS else read, expected)
    assert all(len(warning) < 300 for warning in found.warnings)
    # What polars needs besides is as large as the text columns.
    assert peak < 4 * size + (1 << 24)


def test_every_damaged_line_is_counted_and_the_first_are_named() -> None:
    lines = list(rows(ROWS))
    for at in (100, 9000, 15000, 19000):
        lines[at] = "1.0,2.0,abc,4.0"
    lines[12000] = "1.0,2.0"
    (warning,) = loose(lines).warnings
    assert warning == (
        "5 of 20000 rows are damaged and left out (line 102: 'abc' in column 'y', line 9002: 'abc' in column 'y', "
        "line 12002: 2 cells instead of 4)"
    )


@pytest.mark.parametrize("line", [0, 1, 50, 99])
@pytest.mark.parametrize("cell", [0, 1, 2])
def test_a_quote_that_is_not_closed_is_named_with_its_line(line: int, cell: int) -> None:
    table = [["time", "x", "y"], *([f"{k}", "1.0", "2.0"] for k in range(99))]
    table[line][cell] = '"' + table[line][cell]
    with pytest.raises(RecordingError, match=rf"walk\.csv, line {line + 1}: a quote is not closed"):
        read_table("\n".join(map(",".join, table)).encode(), "walk.csv")


def test_a_message_never_quotes_a_long_cell_in_full() -> None:
    with pytest.raises(RecordingError, match="200000 characters") as caught:
        read_table(f"time,x\n0.0,1.0\n1.0,{LONG}\n".encode(), "walk.csv")
    assert len(str(caught.value)) < 300
