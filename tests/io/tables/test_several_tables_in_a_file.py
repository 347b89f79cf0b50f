"""Files with rows of several sensors, devices or persons, or with several tables, are never mixed silently."""

from collections.abc import Callable, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from table_layouts import BOOT_22_DAYS_NS, UNIX_NS, plain, text, ticks
from table_walk import TableWalk, rows, table_walk, xyz

from pdr_est.errors import RecordingError, SeveralWalksError
from pdr_est.frames import Array
from pdr_est.io import read
from pdr_est.types.recording import DeviceRecording, Recording


@pytest.fixture(scope="module")
def walk() -> TableWalk:
    return table_walk()


def recording_of(folder: Path, lines: Sequence[str], devices: Sequence[str] = ()) -> Recording:
    (folder / "walk.csv").write_bytes(text(lines))
    return read(folder / "walk.csv", devices=devices)


def assert_walk(device: DeviceRecording, walk: TableWalk, factor: float = 1.0) -> None:
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.values, factor * walk.force, atol=2e-5)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, atol=2e-5)
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s, atol=2e-3)
    assert abs(device.rotation_rate.time_s[0]) < 0.005


def owned(walk: TableWalk, title: str, name: Any, start_s: float = 0.0, factor: float = 1.0) -> list[str]:
    """Lines of the walk with a column that names an owner."""
    columns = {**plain(walk, walk.time_s + start_s), title: [name] * len(walk.time_s)}
    columns |= xyz("acc_{}", factor * walk.force)
    return rows(columns)


def below(first: list[str], second: list[str]) -> list[str]:
    return [*first, *second[1:]]


def in_turn(first: list[str], second: list[str]) -> list[str]:
    return [first[0], *chain.from_iterable(zip(first[1:], second[1:], strict=True))]


Order = Callable[[list[str], list[str]], list[str]]


@pytest.mark.parametrize("order", [below, in_turn])
@pytest.mark.parametrize(
    ("title", "names"), [("device", ("left", "right")), ("phone_id", (1, 2)), ("Sensor Position", ("hip", "wrist"))]
)
def test_devices_of_one_walk_are_told_apart(
    tmp_path: Path, walk: TableWalk, order: Order, title: str, names: tuple[Any, Any]
) -> None:
    lines = order(owned(walk, title, names[0]), owned(walk, title, names[1], factor=0.99))
    first, second = recording_of(tmp_path, lines).devices
    assert (first.name, second.name) == tuple(map(str, names))
    assert_walk(first, walk)
    assert_walk(second, walk, 0.99)
    assert any("the rows of 2 devices" in words and "--device NAME" in words for words in first.warnings)
    (chosen,) = recording_of(tmp_path, lines, [str(names[1])]).devices
    assert_walk(chosen, walk, 0.99)
    assert chosen.warnings == second.warnings


def test_devices_keep_one_clock(tmp_path: Path, walk: TableWalk) -> None:
    lines = below(owned(walk, "device", "a"), owned(walk, "device", "b", start_s=3.5))
    first, second = recording_of(tmp_path, lines).devices
    assert first.specific_force is not None
    assert second.specific_force is not None
    assert (first.specific_force.time_s[0], second.specific_force.time_s[0]) == (0.0, 3.5)


@pytest.mark.parametrize("order", [below, in_turn])
@pytest.mark.parametrize(("title", "start_s"), [("user", 0.0), ("Subject ID", 0.0), ("participant", 100.0)])
def test_persons_are_walks_of_which_one_is_chosen(
    tmp_path: Path, walk: TableWalk, order: Order, title: str, start_s: float
) -> None:
    lines = order(owned(walk, title, "ann"), owned(walk, title, "bob", start_s, 0.99))
    with pytest.raises(SeveralWalksError, match=r"column .*: ann, bob; choose one with --device NAME") as caught:
        recording_of(tmp_path, lines)
    assert caught.value.walks == ("ann", "bob")
    for name, factor in (("ann", 1.0), ("bob", 0.99)):
        (device,) = recording_of(tmp_path, lines, [name]).devices
        assert device.name == name
        assert_walk(device, walk, factor)
    with pytest.raises(SeveralWalksError):
        recording_of(tmp_path, lines, ["carol"])


@pytest.mark.parametrize("title", ["trial", "session_id", "activity"])
def test_sessions_whose_clock_starts_again_are_walks(tmp_path: Path, walk: TableWalk, title: str) -> None:
    lines = below(owned(walk, title, 1), owned(walk, title, 2))
    with pytest.raises(SeveralWalksError, match=r"1, 2; choose one"):
        recording_of(tmp_path, lines)


def test_an_id_with_one_clock_may_be_of_two_devices(tmp_path: Path, walk: TableWalk) -> None:
    lines = below(owned(walk, "id", 1), owned(walk, "id", 2))
    assert len(recording_of(tmp_path, lines).devices) == 2


@pytest.mark.parametrize("title", ["activity", "session", "label", "remark"])
def test_a_label_that_changes_while_the_clock_goes_on_is_one_walk(
    tmp_path: Path, walk: TableWalk, title: str
) -> None:
    names = np.where((walk.time_s > 15.0) & (walk.time_s < 25.0), "sit", "go")
    (device,) = recording_of(tmp_path, rows({**plain(walk), title: names})).devices
    assert_walk(device, walk)
    assert device.name == "device"


def test_row_numbers_are_no_owners(tmp_path: Path, walk: TableWalk) -> None:
    (device,) = recording_of(tmp_path, rows({"id": range(len(walk.time_s)), **plain(walk)})).devices
    assert_walk(device, walk)


def long_rows(walk: TableWalk, form: str, names: tuple[str, str], start: int = 0) -> list[str]:
    """Rows by a form with the time t in ms, the name and the axes x, y, z; the gyroscope 3 ms later."""
    return [
        form.format(t=tick + delay, name=name, x=v[0], y=v[1], z=v[2])
        for i, tick in enumerate(ticks(walk, 1000, start))
        for name, v, delay in ((names[0], walk.force[i], 0), (names[1], walk.rate[i], 3))
    ]


@pytest.mark.parametrize(
    ("header", "form", "names"),
    [
        (
            "timestamp,sensorType,accuracy,v1,v2,v3",
            "{t},{name},3,{x},{y},{z}",
            ("android.sensor.accelerometer", "android.sensor.gyroscope"),
        ),
        ("t,name,v1,v2,v3", "{t},{name},{x},{y},{z}", ("ACC", "GYRO")),
        ("v0,v1,v2,accuracy,time,name", "{x},{y},{z},high,{t},{name}", ("Accelerometer", "Gyroscope")),
        ("name;status;value[0];value[1];value[2];ms", "{name};2;{x};{y};{z};{t}", ("Beschleunigung", "Gyroskop")),
        ("ms,p,q,r,type", "{t},{x},{y},{z},{name}", ("TYPE_ACCELEROMETER", "TYPE_GYROSCOPE")),
        ("", "{t},{name},3,{x},{y},{z}", ("accelerometer", "gyroscope")),
        ("", "{t},{x},{y},{z},{name}", ("BMI160 Accelerometer", "BMI160 Gyroscope")),
        ("ms,acc,x,y,z,sensor", "{t},3,{x},{y},{z},{name}", ("K6DS3TR Accelerometer", "K6DS3TR Gyroscope")),
    ],
)
def test_long_tables_in_any_order(
    tmp_path: Path, walk: TableWalk, header: str, form: str, names: tuple[str, str]
) -> None:
    lines = [header] * bool(header) + long_rows(walk, form, names)
    (device,) = recording_of(tmp_path, lines).devices
    assert_walk(device, walk)


def test_a_long_table_of_two_devices(tmp_path: Path, walk: TableWalk) -> None:
    lines = ["t,device,sensor,x,y,z"]
    for name in ("a", "b"):
        lines += long_rows(walk, f"{{t}},{name},{{name}},{{x}},{{y}},{{z}}", ("acc", "gyro"))
    first, second = recording_of(tmp_path, lines).devices
    assert_walk(first, walk)
    assert_walk(second, walk)


def test_a_column_that_describes_the_sensor_is_no_owner(tmp_path: Path, walk: TableWalk) -> None:
    chips = {"acc": "LSM6DSO Acc", "gyro": "LSM6DSO Gyr"}
    lines = ["t,device,sensor,x,y,z"]
    for line in long_rows(walk, "{t},@{name}@,{name},{x},{y},{z}", ("acc", "gyro")):
        _, name, _ = line.split("@")
        lines.append(line.replace(f"@{name}@", chips[name]))
    (device,) = recording_of(tmp_path, lines).devices
    assert_walk(device, walk)


def test_a_calibrated_sensor_of_a_long_table_is_preferred(tmp_path: Path, walk: TableWalk) -> None:
    lines = ["t,sensor,x,y,z"]
    for i, tick in enumerate(ticks(walk, 1000, 0)):
        for name, v in (("gyro_uncalibrated", walk.rate[i] + 0.1), ("acc", walk.force[i]), ("gyro", walk.rate[i])):
            lines.append(f"{tick},{name},{v[0]},{v[1]},{v[2]}")
    (device,) = recording_of(tmp_path, lines).devices
    assert_walk(device, walk)


def sensor_table(walk: TableWalk, values: Array, pattern: str = "{}") -> list[str]:
    return rows({"time": walk.time_s, **xyz(pattern, values)})


@pytest.mark.parametrize(
    "names", [("# Accelerometer", "# Gyroscope"), ("[Beschleunigung]", "[Gyroskop]"), ("Acceleration:", "Gyro data:")]
)
def test_tables_one_below_the_other_with_names(tmp_path: Path, walk: TableWalk, names: tuple[str, str]) -> None:
    first, second = (
        [name, *sensor_table(walk, values)] for name, values in zip(names, (walk.force, walk.rate), strict=True)
    )
    (device,) = recording_of(tmp_path, [*first, "", "", *second]).devices
    assert_walk(device, walk)


@pytest.mark.parametrize("between", [[], [""], ["", "# next"]])
def test_tables_one_below_the_other_with_titles(tmp_path: Path, walk: TableWalk, between: list[str]) -> None:
    parts = (sensor_table(walk, walk.force, "acc_{}"), sensor_table(walk, walk.rate, "gyro_{}"))
    (device,) = recording_of(tmp_path, [*parts[0], *between, *parts[1]]).devices
    assert_walk(device, walk)


def test_a_table_below_that_is_not_understood_is_told(tmp_path: Path, walk: TableWalk) -> None:
    weather = rows({"time": walk.time_s[::50], "temperature": walk.time_s[::50], "humidity": walk.time_s[::50]})
    (device,) = recording_of(tmp_path, [*rows(plain(walk)), "", *weather]).devices
    assert_walk(device, walk)
    assert any("line 2003 has no sensor that is known and is left out" in words for words in device.warnings)


def test_a_header_that_is_written_again_begins_no_table(tmp_path: Path, walk: TableWalk) -> None:
    lines = rows(plain(walk))
    (device,) = recording_of(tmp_path, [*lines[:700], lines[0], *lines[700:]]).devices
    assert_walk(device, walk)


def test_zeros_of_sensors_without_a_sample_are_no_values(tmp_path: Path, walk: TableWalk) -> None:
    zero = (0.0, 0.0, 0.0)
    lines = ["time,acc_x,acc_y,acc_z,gyro_x,gyro_y,gyro_z"]
    for i, tick in enumerate(ticks(walk, 1000, 0)):
        lines.append(",".join(map(str, (tick, *walk.force[i], *zero))))
        lines.append(",".join(map(str, (tick + 3, *zero, *walk.rate[i]))))
    (device,) = recording_of(tmp_path, lines).devices
    assert_walk(device, walk)
    assert any("zeros for the others" in words for words in device.warnings)


def test_zeros_that_were_measured_stay(tmp_path: Path, walk: TableWalk) -> None:
    rate = walk.rate.copy()
    rate[: len(rate) // 2] = 0.0
    (device,) = recording_of(tmp_path, rows({**plain(walk), **xyz("gyro_{}", rate)})).devices
    assert device.rotation_rate is not None
    assert len(device.rotation_rate) == len(rate)


@pytest.mark.parametrize("start", [0, BOOT_22_DAYS_NS, UNIX_NS])
def test_sensors_with_a_time_column_each(tmp_path: Path, walk: TableWalk, start: int) -> None:
    stamps = ticks(walk, 10**9, start)
    half = [*stamps[::2], *[""] * (len(stamps) - len(stamps[::2]))]
    filled = {
        f"gyro_{axis}": [*values[::2].tolist(), *[""] * (len(values) - len(values[::2]))]
        for axis, values in zip("xyz", walk.rate.T, strict=True)
    }
    columns = {"acc_time": stamps, **xyz("acc_{}", walk.force), "gyro_time": half, **filled}
    (device,) = recording_of(tmp_path, rows(columns)).devices
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=2e-5)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate[::2], atol=2e-5)
    np.testing.assert_allclose(device.rotation_rate.time_s, walk.time_s[::2], atol=1e-6)


def test_a_long_table_without_time_is_refused(tmp_path: Path, walk: TableWalk) -> None:
    lines = ["sensor,x,y,z", *(f"{name},{v[0]},{v[1]},{v[2]}" for v in walk.force for name in ("acc", "gyro"))]
    with pytest.raises(RecordingError, match=r"have no time among 'x', 'y', 'z'; name the column with --map"):
        recording_of(tmp_path, lines)
