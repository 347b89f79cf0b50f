"""Tables of the simulated walk in the layouts of recorders are read to the same samples, or say what is wrong."""

import re
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from table_layouts import CLEAN, DEG, G, edited, physics_toolbox_ios, plain, text, ticks, with_cells
from table_walk import TableWalk, dates, rows, table_walk, xyz

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io import read
from pdr_est.types.recording import DeviceRecording, Recording


@pytest.fixture(scope="module")
def walk() -> TableWalk:
    return table_walk()


def recording_of(folder: Path, data: bytes, name: str = "walk.csv") -> Recording:
    (folder / name).write_bytes(data)
    return read(folder / name)


def device_of(folder: Path, data: bytes, name: str = "walk.csv") -> DeviceRecording:
    return recording_of(folder, data, name).devices[0]


def assert_walk(device: DeviceRecording, walk: TableWalk, kept: Sequence[int] | Array | slice = slice(None)) -> None:
    """The samples of the walk, or those rows of them."""
    force, rate = device.specific_force, device.rotation_rate
    assert force is not None
    assert rate is not None
    np.testing.assert_allclose(force.values, walk.force[kept], atol=2e-5)
    np.testing.assert_allclose(force.time_s - force.time_s[0], walk.time_s[kept] - walk.time_s[kept][0], atol=2e-3)
    own = slice(None) if len(rate) == len(walk.rate) else kept
    np.testing.assert_allclose(rate.values, walk.rate[own], atol=2e-5)


@pytest.mark.parametrize("layout", CLEAN)
def test_the_walk_is_read_in_every_layout(tmp_path: Path, walk: TableWalk, layout: str) -> None:
    name = "WristMotion.csv" if layout == "WristMotion" else "walk.csv"
    device = device_of(tmp_path, CLEAN[layout](walk), name)
    assert_walk(device, walk)
    told = ("sign of the acceleration", "the date is doubtful")
    assert [words for words in device.warnings if not any(doubt in words for doubt in told)] == []


def test_every_column_without_use_is_named(tmp_path: Path, walk: TableWalk) -> None:
    columns = {**plain(walk), "Temperature (C)": walk.time_s, "roll": walk.time_s, **xyz("foo_{}", walk.user)}
    decisions = device_of(tmp_path, text(rows(columns))).decisions
    assert "not used: Temperature (C), roll, foo_x, foo_y, foo_z" in decisions


def test_a_sensor_with_a_missing_axis_is_told(tmp_path: Path, walk: TableWalk) -> None:
    columns = plain(walk)
    del columns["gyro_y"]
    device = device_of(tmp_path, text(rows(columns)))
    assert device.rotation_rate is None
    assert any("an axis is missing beside gyro_x, gyro_z" in words for words in device.warnings)


def test_acceleration_without_gravity_is_no_specific_force(tmp_path: Path, walk: TableWalk) -> None:
    device = device_of(tmp_path, text(rows({"time": walk.time_s, **xyz("acc_{}", walk.user)})))
    assert device.specific_force is None
    assert device.linear_acceleration is not None
    np.testing.assert_allclose(device.linear_acceleration.values, walk.user, atol=1e-6)
    assert any("without gravity" in words for words in device.warnings)


@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["Android", "Apple"])
def test_gravity_and_gyroscope_both_called_g_are_told_apart(tmp_path: Path, walk: TableWalk, sign: float) -> None:
    columns = {"time": walk.time_s, **xyz("a{}", sign * walk.user), **xyz("g{}", sign * walk.gravity)}
    device = device_of(tmp_path, text(rows(columns | xyz("w{}", walk.rate))))
    assert device.specific_force is not None
    np.testing.assert_allclose(np.abs(device.specific_force.values), np.abs(walk.force), atol=2e-5)


def test_the_date_of_an_iphone_implies_its_sign(tmp_path: Path, walk: TableWalk) -> None:
    assert_walk(device_of(tmp_path, physics_toolbox_ios(walk)), walk, slice(1, None))


@pytest.mark.parametrize("word", ["None", "N/A", "null", "-", "NaN", "nan", "NULL", ""])
def test_words_for_a_missing_value(tmp_path: Path, walk: TableWalk, word: str) -> None:
    device = device_of(tmp_path, with_cells(walk, word))
    assert_walk(device, walk, np.flatnonzero(np.arange(len(walk.time_s)) % 10 != 5))


def cut(lines: list[str]) -> list[str]:
    return [*lines[:-1], lines[-1][:20]]


def repeated_header(lines: list[str]) -> list[str]:
    return [*lines[:1001], lines[0], *lines[1001:]]


def spoilt(lines: list[str]) -> list[str]:
    return [*lines[:500], lines[500].replace(".", "?!", 1), *lines[501:]]


def glued(lines: list[str]) -> list[str]:
    return [*lines[:500], lines[500] + "," + lines[501], *lines[502:]]


@pytest.mark.parametrize(
    ("damage", "line", "lost"),
    [
        (cut, 2001, [1999]),
        (repeated_header, 1002, []),
        (spoilt, 501, [499]),
        (glued, 501, [499, 500]),
    ],
)
def test_damaged_rows_are_left_out_and_told(
    tmp_path: Path, walk: TableWalk, damage: Callable[[list[str]], list[str]], line: int, lost: list[int]
) -> None:
    device = device_of(tmp_path, edited(damage)(walk))
    assert_walk(device, walk, np.delete(np.arange(len(walk.time_s)), lost))
    assert any(f"1 of 200{len(lost) == 0:d}" in words or "damaged" in words for words in device.warnings)
    assert any(f"line {line}: " in words for words in device.warnings)


def test_a_damaged_cell_of_a_sparse_column_costs_one_row(tmp_path: Path, walk: TableWalk) -> None:
    pressure = ["100000" if i % 10 == 0 else "" for i in range(len(walk.time_s))]
    pressure[500] = "1000?0"
    device = device_of(tmp_path, text(rows({**plain(walk), "pressure": pressure})))
    assert_walk(device, walk, np.delete(np.arange(len(walk.time_s)), 500))
    assert device.pressure is not None
    assert len(device.pressure) == 199
    assert set(device.pressure.values[:, 0]) == {100_000.0}
    assert any("1 of 2000 rows are damaged" in words and "line 502: '1000?0'" in words for words in device.warnings)


def test_a_motion_sensor_that_is_lost_from_a_tagged_log_is_told(tmp_path: Path, walk: TableWalk) -> None:
    lines = []
    for i, (t, force, rate) in enumerate(zip(walk.time_s, walk.force, walk.rate, strict=True)):
        lines.append(f"ACC,{t},{','.join(map(str, force))}")
        lines.append(f"GYRO,{t}" if i % 10 == 9 else f"GYRO,{t},{','.join(map(str, rate))}")
    device = device_of(tmp_path, text(lines))
    assert device.specific_force is not None
    assert device.rotation_rate is None
    assert any("rows GYRO are left out" in words and "rows are damaged" in words for words in device.warnings)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_gravity_in_g_is_evidence_and_no_proof_of_a_sign(tmp_path: Path, walk: TableWalk, sign: float) -> None:
    columns = {
        "time": walk.time_s,
        **xyz("linear_acc_{}", sign * walk.user / G),
        **xyz("gravity_{}", sign * walk.gravity / G),
        **xyz("gyro_{}", walk.rate),
    }
    device = device_of(tmp_path, text(rows(columns)))
    assert_walk(device, walk)
    assert any("gravity in g, apart from the motion, is mostly Core Motion's" in words for words in device.decisions)


def test_many_damaged_rows_refuse_the_table(tmp_path: Path, walk: TableWalk) -> None:
    with pytest.raises(RecordingError, match=r"200 of 2000 rows are damaged \(line 11: .*\); export"):
        device_of(
            tmp_path, edited(lambda lines: [x[:20] if i % 10 == 0 and i else x for i, x in enumerate(lines)])(walk)
        )


def test_bursts_are_spread_evenly(tmp_path: Path, walk: TableWalk) -> None:
    device = device_of(tmp_path, text(rows(plain(walk, np.repeat(walk.time_s[::10], 10)))))
    assert_walk(device, walk)
    assert any("10 rows share one time stamp" in words for words in device.warnings)


def test_whole_seconds_are_seconds(tmp_path: Path, walk: TableWalk) -> None:
    device = device_of(tmp_path, text(rows(plain(walk, np.floor(walk.time_s).astype(int).tolist()))))
    assert_walk(device, walk)
    assert any("50 rows share one time stamp" in words for words in device.warnings)


def test_repeated_rows_are_no_burst(tmp_path: Path, walk: TableWalk) -> None:
    lines = rows(plain(walk))
    device = device_of(tmp_path, text([lines[0], *(line for line in lines[1:] for _ in range(3))]))
    assert device.specific_force is not None
    assert np.unique(device.specific_force.time_s).tolist() == walk.time_s.tolist()


def test_a_stale_first_row_is_left_out(tmp_path: Path, walk: TableWalk) -> None:
    time_s = np.concatenate([[-328_883.35], walk.time_s[1:]])
    device = device_of(tmp_path, text(rows(plain(walk, time_s))))
    assert_walk(device, walk, slice(1, None))
    assert any("measured long before the recording" in words for words in device.warnings)


def test_unix_time_is_known_by_number_or_zone(tmp_path: Path, walk: TableWalk) -> None:
    unix = recording_of(tmp_path, text(rows(plain(walk, ticks(walk, 1000, 1_927_857_906_789)))))
    zoned = recording_of(tmp_path, text(rows(plain(walk, dates(walk.time_s, "{y}-{m}-{d} {H}:{M}:{S}.{ms}Z")))))
    local = recording_of(tmp_path, text(rows(plain(walk, dates(walk.time_s)))))
    assert unix.epoch_s == pytest.approx(1_927_857_906.789)
    assert zoned.epoch_s == pytest.approx(1_927_857_906.789)
    assert local.epoch_s is None


def test_a_date_whose_month_is_open_is_told(tmp_path: Path, walk: TableWalk) -> None:
    (doubt,) = device_of(tmp_path, CLEAN["date and time of day in two columns"](walk)).warnings[:1]
    assert "the day is taken to come first in '03/02/2031 04:05:06.789', but it may be the month" in doubt


def test_a_unit_of_the_clock_that_cannot_be_is_told(tmp_path: Path, walk: TableWalk) -> None:
    device = device_of(tmp_path, text(rows(plain(walk, ticks(walk, 1000, 0), "time (ns)"))))
    assert_walk(device, walk)
    assert any("contradicts the values" in words for words in device.warnings)


@pytest.mark.parametrize("unit", [1.0, G, G / 1000.0], ids=["m/s^2", "g", "mg"])
def test_three_axes_without_a_name_are_an_accelerometer_by_gravity(
    tmp_path: Path, walk: TableWalk, unit: float
) -> None:
    device = device_of(tmp_path, text(rows({"time": walk.time_s, **xyz("{}", walk.force / unit)})))
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=2e-5)


def test_three_axes_without_a_name_and_gravity_are_not_guessed(tmp_path: Path, walk: TableWalk) -> None:
    with pytest.raises(RecordingError, match="three axes without a sensor's name do not look like an accelerometer"):
        device_of(tmp_path, text(rows({"time": walk.time_s, **xyz("{}", walk.rate)})))


def test_the_name_of_the_file_names_the_sensor(tmp_path: Path, walk: TableWalk) -> None:
    data = text(rows({"time": walk.time_s, **xyz("{}", walk.user)}))
    device = device_of(tmp_path, data, "2031-02-03 Linear Acceleration.csv")
    assert device.linear_acceleration is not None


def test_a_table_without_header_is_read_by_its_values(tmp_path: Path, walk: TableWalk) -> None:
    lines = rows({"user": [33] * len(walk.time_s), "label": ["Walking"] * len(walk.time_s), **plain(walk)})[1:]
    device = device_of(tmp_path, text([line + ";" for line in lines]), "raw.txt")
    assert_walk(device, walk)
    assert any("no header" in words and "--map" in words for words in device.warnings)


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (("acc", "gyro"), "the table has no time column .*rate_hz.* among the columns 'acc_x', 'acc_y'"),
        (("time", "foo"), "no accelerometer or gyroscope among the columns 'time', 'foo_x'.*first row is 0, "),
        (("foo",), "no accelerometer or gyroscope and no time among the columns 'foo_x'"),
    ],
)
def test_what_was_seen_is_said_of_a_table_that_is_not_read(
    tmp_path: Path, walk: TableWalk, columns: Sequence[str], message: str
) -> None:
    values = {name: xyz(f"{name}_{{}}", walk.force) for name in ("acc", "gyro", "foo")}
    values["time"] = {"time": walk.time_s}
    table = {title: cells for name in columns for title, cells in values[name].items()}
    with pytest.raises(RecordingError, match=message) as caught:
        device_of(tmp_path, text(rows(table)))
    assert re.search(r"--map FILE\.yaml.*--write-map", str(caught.value))


def test_gyroscope_units_of_single_columns(tmp_path: Path, walk: TableWalk) -> None:
    columns = {
        "time": walk.time_s,
        "acc_x_mps2": walk.force[:, 0],
        "Acceleration Y (g)": walk.force[:, 1] / G,
        "z_acc [mg]": walk.force[:, 2] / G * 1000.0,
        "gyro_x": walk.rate[:, 0] / DEG,
        "Gyroscope Y (rad/s)": walk.rate[:, 1],
        "angular_velocity.z": walk.rate[:, 2] / DEG,
    }
    device = device_of(tmp_path, text(rows(columns)))
    assert_walk(device, walk)
    assert any("in deg/s, by comparison with the axes" in words for words in device.decisions)
