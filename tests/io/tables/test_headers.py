"""Two header lines, repeated axes, rows of units and of types, and numbers in any way of writing are understood."""

import re
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from read_tables import assert_same_samples, device_of
from table_layouts import G, plain, text
from table_walk import TableWalk, rows, table_walk, xyz

from pdr_est.errors import RecordingError


@pytest.fixture(scope="module")
def walk() -> TableWalk:
    return table_walk()


HEADS: dict[str, Sequence[str]] = {
    "sensor over axis": [",acc,acc,acc,gyro,gyro,gyro", "time,x,y,z,x,y,z"],
    "merged cells": ["Time (s),Acceleration (m/s^2),,,Gyroscope (rad/s),,", ",X,Y,Z,X,Y,Z"],
    "merged cells and units": [
        ",Beschleunigung,,,Drehrate,,",
        "Zeit,x,y,z,x,y,z",
        "s,m/s²,m/s²,m/s²,rad/s,rad/s,rad/s",
    ],
    "types": ["time,acc_x,acc_y,acc_z,gyro_x,gyro_y,gyro_z", "float,float,float,float,float,float,float"],
    "types above units": [
        "time,acc_x,acc_y,acc_z,gyro_x,gyro_y,gyro_z",
        "float64,float64,float64,float64,float64,float64,float64",
        "s,m/s^2,m/s^2,m/s^2,rad/s,rad/s,rad/s",
    ],
    "units in words": [
        "time,acc_x,acc_y,acc_z,gyro_x,gyro_y,gyro_z",
        f"seconds,{','.join(3 * ['meters per second squared'])},{','.join(3 * ['radians per second'])}",
    ],
    "units behind commas": ["time, s,acc_x, m/s²,acc_y, m/s²,acc_z, m/s²,gyro_x, rad/s,gyro_y, rad/s,gyro_z, rad/s"],
    "one unit that is not known": [
        "time,acc_x,acc_y,acc_z,gyro_x,gyro_y,gyro_z",
        "s,m/s^2,m/s^2,zorg,rad/s,rad/s,rad/s",
    ],
}


@pytest.mark.parametrize("head", HEADS.values(), ids=HEADS)
def test_lines_above_the_rows(tmp_path: Path, walk: TableWalk, head: Sequence[str]) -> None:
    assert_same_samples(device_of(tmp_path, text([*head, *rows(plain(walk))[1:]])), walk)


def test_a_unit_of_another_column_that_is_not_known(tmp_path: Path, walk: TableWalk) -> None:
    columns = {**plain(walk), "event": [0] * len(walk.time_s)}
    lines = rows(columns)
    lines.insert(1, "s,g,g,g,rad/s,rad/s,rad/s,no idea")
    device = device_of(tmp_path, text(lines))
    assert any("contradicts its values" in words for words in device.warnings)  # the unit was read: it is wrong
    assert_same_samples(device, walk)


@pytest.mark.parametrize(
    "titles",
    ["x,y,z,x.1,y.1,z.1", "x,y,z,x,y,z", "X,Y,Z,X (2),Y (2),Z (2)", "x1,y1,z1,x2,y2,z2"],
)
@pytest.mark.parametrize("first", ["accelerometer", "gyroscope"])
def test_axes_without_a_sensor(tmp_path: Path, walk: TableWalk, titles: str, first: str) -> None:
    two = (walk.force, walk.rate) if first == "accelerometer" else (walk.rate, walk.force)
    lines = rows({"time": walk.time_s, **xyz("a_{}", two[0]), **xyz("b_{}", two[1])})
    device = device_of(tmp_path, text([f"time,{titles}", *lines[1:]]))
    assert_same_samples(device, walk)
    assert any("the titles name no sensor" in words for words in device.warnings)


def comma(line: str) -> str:
    return line.replace(".", ",")


NUMBERS: dict[str, Callable[[str], str]] = {
    "minus sign": lambda line: line.replace("-", "\u2212"),
    "dash": lambda line: line.replace("-", "\u2013"),
    "full-width digits": lambda line: line.translate(str.maketrans("0123456789", "０１２３４５６７８９")),
    "Arabic digits": lambda line: line.translate(str.maketrans("0123456789", "٠١٢٣٤٥٦٧٨٩")),
    "quoted decimal commas": lambda line: ",".join(f'"{comma(cell)}"' for cell in line.split(",")),
    "exponents of Fortran": lambda line: ",".join(f"{float(cell):.9E}".replace("E", "D") for cell in line.split(",")),
}


@pytest.mark.parametrize("written", NUMBERS.values(), ids=NUMBERS)
def test_ways_of_writing_numbers(tmp_path: Path, walk: TableWalk, written: Callable[[str], str]) -> None:
    lines = rows(plain(walk))
    assert_same_samples(device_of(tmp_path, text([lines[0], *map(written, lines[1:])])), walk)


@pytest.mark.parametrize(("form", "scale"), [("{:,.6f}", 1.0), ("{:_.6f}", 1.0)])
def test_thousands_that_are_set_apart(tmp_path: Path, walk: TableWalk, form: str, scale: float) -> None:
    values = {title: [form.format(v).replace("_", " ") for v in 1000.0 * column / G] if title != "time" else column
              for title, column in plain(walk).items()}  # fmt: skip
    lines = [";".join(values), *(";".join(map(str, row)) for row in zip(*values.values(), strict=True))]
    device = device_of(tmp_path, text(lines))
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=2e-5)


def test_a_clock_whose_thousands_are_set_apart(tmp_path: Path, walk: TableWalk) -> None:
    micros = [f'"{tick:,}"' for tick in np.round(1e6 * walk.time_s).astype(int).tolist()]
    device = device_of(tmp_path, text(rows({**plain(walk), "time": micros})))
    assert_same_samples(device, walk)
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s, atol=1e-6)


@pytest.mark.parametrize("word", ["<null>", "#NUM!", "#N/A", "inf", "-", "--", "#DIV/0!", "-1.#IND", "(null)", "—"])
def test_words_for_no_value(tmp_path: Path, walk: TableWalk, word: str) -> None:
    lines = rows(plain(walk))
    for at in range(6, len(lines), 10):
        cells = lines[at].split(",")
        lines[at] = ",".join([cells[0], *3 * [word], *cells[4:]])
    device = device_of(tmp_path, text(lines))
    assert device.specific_force is not None
    kept = np.flatnonzero(np.arange(len(walk.time_s)) % 10 != 5)
    np.testing.assert_allclose(device.specific_force.values, walk.force[kept], atol=2e-5)


def fixed(walk: TableWalk) -> list[str]:
    titles = plain(walk)
    return [",".join(titles), *(",".join(f"{v:.6f}" for v in row) for row in zip(*titles.values(), strict=True))]


def test_commas_between_cells_and_in_numbers(tmp_path: Path, walk: TableWalk) -> None:
    lines = fixed(walk)
    assert_same_samples(device_of(tmp_path, text([lines[0], *map(comma, lines[1:])])), walk)


def test_commas_that_cannot_be_told_apart_are_refused(tmp_path: Path, walk: TableWalk) -> None:
    lines = fixed(walk)
    short = [re.sub(r"\.?0+(?=,|$)", "", line) for line in lines[1:]]
    with pytest.raises(RecordingError, match="commas separate the cells and the decimals"):
        device_of(tmp_path, text([lines[0], *map(comma, short)]))


def test_an_unlabelled_axis_has_the_unit_of_its_sisters(tmp_path: Path, walk: TableWalk) -> None:
    titles = ["time", "acc_x", "acc_y (mps2)", "acc_z (mps2)", "gyro_x", "gyro_y (rad/s)", "gyro_z (rad/s)"]
    device = device_of(tmp_path, text([",".join(titles), *rows(plain(walk))[1:]]))
    assert_same_samples(device, walk)
    assert not any("not certain" in words and "unit" in words for words in device.warnings)


def test_an_unknown_unit_of_all_axes_is_told(tmp_path: Path, walk: TableWalk) -> None:
    columns = {"time": walk.time_s, **xyz("acc_{} (zorgs/s)", walk.force), **xyz("gyro_{}", walk.rate)}
    device = device_of(tmp_path, text(rows(columns)))
    assert_same_samples(device, walk)
    assert any("the unit 'zorgs/s' of acc_x" in words for words in device.warnings)


@pytest.mark.parametrize("turned", [False, True], ids=["phone", "vehicle"])
def test_pitch_and_roll_of_a_gyroscope_are_settled_by_gravity(tmp_path: Path, walk: TableWalk, turned: bool) -> None:
    names = ("Roll", "Pitch", "Yaw") if turned else ("Pitch", "Roll", "Yaw")
    columns = {"time": walk.time_s, **xyz("acc_{}", walk.force)}
    columns |= {f"GYROSCOPE {name} (rad/s)": column for name, column in zip(names, walk.rate.T, strict=True)}
    assert_same_samples(device_of(tmp_path, text(rows(columns))), walk)
