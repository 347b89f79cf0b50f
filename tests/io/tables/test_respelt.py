"""Tables with a vector in a cell, or with one value a row."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from table_walk import TableWalk, dates, table_walk

from pdr_est.io import read
from pdr_est.io.tables.split.respelt import respelt

VECTORS = ('"[{}, {}, {}]"', '"({}, {}, {})"', "[{} {} {}]", '"[ {}  {}  {} ]"', "({};{};{})")


@pytest.fixture
def walk() -> TableWalk:
    return table_walk()


def assert_read(lines: list[str], walk: TableWalk, folder: Path) -> None:
    path = folder / "walk.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    device = read(path).devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate)
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s, atol=1e-6)


def samples(walk: TableWalk) -> Iterator[tuple[float, list[float], list[float]]]:
    return zip(walk.time_s.tolist(), walk.force.tolist(), walk.rate.tolist(), strict=True)


@pytest.mark.parametrize("vector", VECTORS)
def test_a_vector_in_a_cell_is_three_columns(vector: str, walk: TableWalk, tmp_path: Path) -> None:
    rows = [f"{t},{vector.format(*f)},{vector.format(*w)},walk" for t, f, w in samples(walk)]
    assert_read(["time,acc,gyro,label", *rows], walk, tmp_path)


def test_a_long_table_with_vectors(walk: TableWalk, tmp_path: Path) -> None:
    rows = [
        f'{t},android.sensor.{name},3,"[{v[0]}, {v[1]}, {v[2]}]"'
        for t, f, w in samples(walk)
        for name, v in (("accelerometer", f), ("gyroscope", w))
    ]
    assert_read(["timestamp,sensor_type,accuracy,values", *rows], walk, tmp_path)


def test_lines_in_brackets(walk: TableWalk, tmp_path: Path) -> None:
    assert_read([str([t, *f, *w]) for t, f, w in samples(walk)], walk, tmp_path)


def test_sensor_axis_and_value_in_a_row(walk: TableWalk, tmp_path: Path) -> None:
    rows = [
        f"{t},{name},{axis},{value}"
        for t, f, w in samples(walk)
        for name, v in (("ACC", f), ("GYRO", w))
        for axis, value in zip("XYZ", v, strict=True)
    ]
    assert_read(["timestamp,sensor,axis,value", *rows], walk, tmp_path)


def test_names_of_axes_and_their_values(walk: TableWalk, tmp_path: Path) -> None:
    rows = [
        f"{value};{name}_{axis};{t}"
        for t, f, w in samples(walk)
        for name, v in (("acc", f), ("gyro", w))
        for axis, value in zip("xyz", v, strict=True)
    ]
    assert_read(["value;name;time", *rows], walk, tmp_path)


@pytest.mark.parametrize("as_dates", [False, True])
def test_axis_after_axis(as_dates: bool, walk: TableWalk, tmp_path: Path) -> None:
    """A database writes all values of one axis before those of the next, whose times may lie between them."""
    later = {"acc": 0.0, "gyro": 0.005}
    rows = []
    for name, values in (("acc", walk.force), ("gyro", walk.rate)):
        times = walk.time_s + later[name]
        texts = dates(times, "{y}-{m}-{d}T{H}:{M}:{S}.{ms}Z") if as_dates else list(map(str, times.tolist()))
        for i, axis in enumerate("xyz"):
            rows += [f",0,{t},{v},{name}_{axis}" for t, v in zip(texts, values[:, i].tolist(), strict=True)]
    assert_read([",table,_time,_value,_field", *rows], walk, tmp_path)


def test_values_that_share_a_time_all_stay(walk: TableWalk) -> None:
    rows = [f"{t // 0.1},acc_{axis},{v}" for t, f, _ in samples(walk) for axis, v in zip("xyz", f, strict=True)]
    table = respelt("\n".join(["time,name,value", *rows, ""]).encode()).decode().split("\n")
    assert table[0] == "time,acc_x,acc_y,acc_z"
    assert len(table) - 2 == len(walk.time_s)


@pytest.mark.parametrize(
    "text",
    [
        b"time,acc_x,acc_y,acc_z,label\n0.0,1.0,2.0,9.8,walk (1)\n0.1,1.0,2.0,9.8,walk (2)\n",
        b"time (s),a [m/s^2]\n0.0,1.5\n0.1,1.6\n",
        b"time,sensor,x,y,z\n0.0,acc,1.5,2.5,9.5\n0.1,gyro,0.1,0.2,0.3\n",
        b"1 2 3\n4 5 6\n",
        b"",
    ],
)
def test_other_tables_stay_as_they_are(text: bytes) -> None:
    assert respelt(text) is text
