"""Tables of numbers: exact integers, tolerated oddities, and errors that name the place."""

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.io.text.number_table import read_table


def test_columns_by_name() -> None:
    table = read_table(b"t,x,y\n0,1.5,2\n1,-2e-3,3\n", "walk.csv")
    assert table.names == ("t", "x", "y")
    assert len(table) == 2
    assert "x" in table
    np.testing.assert_array_equal(table.stack(("y", "x")), [[2.0, 1.5], [3.0, -0.002]])


def test_nanosecond_clocks_lose_nothing() -> None:
    first = 1_718_030_736_872_695_301
    table = read_table(f"time,x\n{first},0\n{first + 1},0\n{first + 10_000_003},0\n".encode(), "walk.csv")
    epoch_s, relative_s = table.relative_time("time", ticks_per_s=1e9)
    assert epoch_s == pytest.approx(first / 1e9)
    np.testing.assert_array_equal(relative_s, np.array([0, 1, 10_000_003]) / 1e9)


def test_nanosecond_clocks_stay_exact_where_another_column_changes_type_late() -> None:
    first = 1_718_030_736_872_695_301
    rows = "".join(f"{first + i},{i}\n" for i in range(300)) + f"{first + 300},NaN\n"
    _, relative_s = read_table(f"time,x\n{rows}".encode(), "walk.csv").relative_time("time", ticks_per_s=1e9)
    np.testing.assert_array_equal(relative_s, np.arange(301) / 1e9)


@pytest.mark.parametrize(
    "data",
    [
        b"\xef\xbb\xbft,x\n0,1\n1,2\n",
        b"t,x\r\n0,1\r\n1,2\r\n",
        b"t,x\n0,1\n1,2\n\n\r\n  \n",
        b'"t","x"\n0,1\n1,2',
        b'"t" , "x"\n 0, 1\n 1 , 2 \n',
        b't,x\n"0","1"\n"1","2"\n',
    ],
    ids=["byte-order mark", "CRLF", "blank lines at the end", "quoted header", "blanks", "quoted numbers"],
)
def test_tolerated_oddities(data: bytes) -> None:
    table = read_table(data, "walk.csv")
    np.testing.assert_array_equal(table.stack(("t", "x")), [[0.0, 1.0], [1.0, 2.0]])


def test_separator_and_decimal_comma() -> None:
    table = read_table(b'"t";"x"\n0,5;1,25E-1\n1;"NaN"\n', "walk.csv", separator=";", decimal_comma=True)
    np.testing.assert_array_equal(table.stack(("t", "x")), [[0.5, 0.125], [1.0, np.nan]])


def test_missing_nan_and_infinite_values() -> None:
    table = read_table(b'x,y\nNaN,1\n,2\n"",3\nInf,4\n-inf,5\n1.5,6\n', "walk.csv")
    np.testing.assert_array_equal(table.numbers("x"), [np.nan, np.nan, np.nan, np.nan, np.nan, 1.5])


def test_header_less_tables_take_the_given_names() -> None:
    table = read_table(b"1 2\n3 4\n", "walk.txt", separator=" ", has_header=False, columns=("a", "b"))
    np.testing.assert_array_equal(table.numbers("b"), [2.0, 4.0])
    with pytest.raises(RecordingError, match=r"walk\.txt: 2 columns instead of 3"):
        read_table(b"1 2\n3 4\n", "walk.txt", separator=" ", has_header=False, columns=("a", "b", "c"))


def test_only_wanted_columns_must_be_numbers() -> None:
    table = read_table(b"t,label,x\n0,07,1\n1,door,2\n", "walk.csv", columns=("t", "x"), text_columns=("label",))
    assert table.texts("label").tolist() == ["07", "door"]
    assert read_table(b"t,label\n0,door\n", "walk.csv", columns=("t", "absent")).names == ("t",)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"t,x\n0,1\n1,n/a\n2,3\n", r"walk\.csv, line 3, column 'x': 'n/a' is not a number; correct"),
        (b"t,x\n0,true\n", r"walk\.csv, line 2, column 'x': 'true' is not a number"),
        (b"t,x\n" + b"0,1\n" * 300 + b"0,?\n", r"line 302, column 'x': '\?' is not a number"),
        (b"t,x\n0,1\n2\n3,4\n", r"walk\.csv, line 3: 1 fields instead of 2; complete or remove"),
        (b"t,x\n0,1\n2,3,4\n", r"walk\.csv, line 3: 3 fields instead of 2"),
        (b"", r"walk\.csv: the table is empty"),
        (b"\xef\xbb\xbf\r\n \n", r"walk\.csv: the table is empty"),
    ],
)
def test_bad_tables_name_the_place(data: bytes, message: str) -> None:
    with pytest.raises(RecordingError, match=message):
        read_table(data, "walk.csv")


def test_an_empty_last_field_is_a_missing_value_and_no_ragged_row() -> None:
    assert np.isnan(read_table(b"t,x\n0,1\n1,", "walk.csv").numbers("x")[-1])


def test_a_missing_column_lists_those_that_are_there() -> None:
    table = read_table(b"t,x\n0,1\n", "walk.csv")
    with pytest.raises(RecordingError, match=r"walk\.csv: no column 'y' among t, x"):
        table.numbers("y")


def test_a_clock_without_rows_or_first_value() -> None:
    with pytest.raises(RecordingError, match="no rows"):
        read_table(b"t,x\n", "walk.csv").relative_time("t")
    with pytest.raises(RecordingError, match="the first row has no time"):
        read_table(b"t,x\n,1\n1.0,2\n", "walk.csv").relative_time("t")
