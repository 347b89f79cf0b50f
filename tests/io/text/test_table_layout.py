"""How a table is written, found from its first lines."""

import pytest

from pdr_est.io.tables.quantities import is_unit
from pdr_est.io.text.encoding import as_utf8, repair_signs
from pdr_est.io.text.table_layout import BLANKS, detect_layout

ROWS = "0.00,1.5,2.5\n0.02,1.6,2.6\n0.04,1.7,2.7\n"


@pytest.mark.parametrize(
    ("text", "separator", "decimal_comma", "first_line"),
    [
        ("t,x,y\n" + ROWS, ",", False, 1),
        ("t;x;y\n" + ROWS.replace(",", ";"), ";", False, 1),
        ("t;x;y\n" + ROWS.replace(",", ";").replace(".", ","), ";", True, 1),
        ("t\tx\ty\n" + ROWS.replace(",", "\t").replace(".", ","), "\t", True, 1),
        ("t|x|y\n" + ROWS.replace(",", "|"), "|", False, 1),
        ("t  x   y\n" + ROWS.replace(",", "   "), BLANKS, False, 1),
        ("# t, x, y\n" + ROWS.replace(",", " "), BLANKS, False, 1),
        ("\n\nsep=,\nt,x,y\n" + ROWS, ",", False, 4),
        ("Logger 1.2\nStart, today\n\nt,x,y\n" + ROWS, ",", False, 4),
        ('"t","x","y"\n"0,00","1,5","2,5"\n"0,02","1,6","2,6"\n', ",", True, 1),
        ("t,x,y,\n" + ROWS.replace("\n", ",\n"), ",", False, 1),
    ],
)
def test_separator_decimal_mark_and_first_row(
    text: str, separator: str, decimal_comma: bool, first_line: int
) -> None:
    layout = detect_layout(text.encode(), is_unit)
    assert layout is not None
    assert (layout.separator, layout.decimal_comma, layout.first_line) == (separator, decimal_comma, first_line)
    assert layout.titles[:3] == ("t", "x", "y")
    assert layout.has_header


def test_a_row_of_units() -> None:
    layout = detect_layout(b"time,ax,note\n[s],[m/s^2],\n0.0,1.0,a\n0.1,1.1,b\n", is_unit)
    assert layout is not None
    assert layout.titles == ("time", "ax", "note")
    assert layout.units == ("[s]", "[m/s^2]", "")
    assert layout.first_line == 2


def test_a_date_whose_time_is_split_off_by_blanks() -> None:
    layout = detect_layout(b"stamp x y\n2031-02-03 04:05:06.1 1.0 2.0\n2031-02-03 04:05:06.2 1.1 2.1\n", is_unit)
    assert layout is not None
    assert layout.titles == ("stamp", "stamp (time of day)", "x", "y")


def test_without_header_the_columns_are_numbered() -> None:
    layout = detect_layout(ROWS.encode(), is_unit)
    assert layout is not None
    assert layout.titles == ("column 1", "column 2", "column 3")
    assert not layout.has_header


def test_repeated_titles_are_distinct() -> None:
    layout = detect_layout(b"t,x,x\n" + ROWS.encode(), is_unit)
    assert layout is not None
    assert layout.titles == ("t", "x", "x (2)")


@pytest.mark.parametrize("text", ["", "hello\n", "a,b\nx,y\n", '{"a": 1, "b": [1, 2]}\n', "<html></html>\n"])
def test_what_is_no_table(text: str) -> None:
    assert detect_layout(text.encode(), is_unit) is None


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_encodings(encoding: str) -> None:
    assert as_utf8("t,acc (m/s²)\r\n1,2\r3,4".encode(encoding)) == "t,acc (m/s²)\n1,2\n3,4".encode()


def test_single_bytes_are_latin_1_unless_a_letter_is_cut() -> None:
    assert as_utf8("30 °/s".encode("latin-1")).decode() == "30 °/s"
    assert as_utf8("30 °".encode()[:-1]) == b"30 "


@pytest.mark.parametrize(
    ("text", "encoding"),
    [("时间,加速度X(g),角速度Y(°/s)\n", "gb18030"), ("時刻,加速度センサーX,ジャイロY\n", "cp932")],
)
def test_chinese_and_japanese_titles(text: str, encoding: str) -> None:
    assert as_utf8((text + "0,1,2\n").encode(encoding)).decode() == text + "0,1,2\n"


def test_german_titles_are_latin_1() -> None:
    text = "Zeit,Größe,Länge,Höhe (m)\n0,1,2,3\n"
    assert as_utf8(text.encode("latin-1")).decode() == text


def test_signs_in_the_wrong_encoding() -> None:
    assert repair_signs("acc (m/sÂ²), field (Î¼T), gyro (Â°/s)") == "acc (m/s²), field (μT), gyro (°/s)"


@pytest.mark.parametrize(
    ("title", "encoding"),
    [("時間,加速度x,角速度x", "cp932"), ("时间,加速度x,角速度x", "gb18030"), ("Länge,Höhe,Breite", "cp1252")],
)
def test_titles_in_the_encodings_of_a_country(title: str, encoding: str) -> None:
    assert as_utf8(f"{title}\n1,2,3\n".encode(encoding)).decode().startswith(title)
