"""Folders with a file for each sensor: of any program, of several walks, with empty files, and without time."""

from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from table_layouts import UNIX_NS, text, ticks
from table_walk import TableWalk, rows, table_walk, xyz

from pdr_est.errors import RecordingError, SeveralWalksError
from pdr_est.frames import Array
from pdr_est.io import read
from pdr_est.io.formats.walks_in_folder import walks_in_folder
from pdr_est.types.recording import DeviceRecording


@pytest.fixture(scope="module")
def walk() -> TableWalk:
    return table_walk()


def folder_of(place: Path, files: Mapping[str, Sequence[str]]) -> Path:
    for name, lines in files.items():
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_bytes(text(lines))
    return place


def assert_walk(device: DeviceRecording, walk: TableWalk, factor: float = 1.0) -> None:
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.values, factor * walk.force, atol=2e-5)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, atol=2e-5)
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s, atol=1e-3)


def table(walk: TableWalk, values: Array, time: str = "time", pattern: str = "{}", ns: bool = True) -> list[str]:
    return rows({time: ticks(walk, 10**9, UNIX_NS) if ns else walk.time_s, **xyz(pattern, values)})


@pytest.mark.parametrize(
    ("names", "format_name"),
    [
        (("acc.csv", "gyro.csv"), "one file a sensor"),
        (("beschleunigung.csv", "gyroskop.csv"), "one file a sensor"),
        (("accelerometer.csv", "gyroscope.csv"), "one file a sensor"),
        (("Accelerometer.csv", "Gyroscope.csv"), "Sensor Logger"),  # as its first versions wrote them
    ],
)
def test_unix_nanoseconds_alone_are_no_mark_of_an_app(
    tmp_path: Path, walk: TableWalk, names: tuple[str, str], format_name: str
) -> None:
    files = dict(zip(names, (table(walk, walk.force), table(walk, walk.rate)), strict=True))
    recording = read(folder_of(tmp_path, files))
    assert recording.format == format_name
    assert_walk(recording.devices[0], walk)


def test_files_of_sensor_logger_may_be_renamed(tmp_path: Path, walk: TableWalk) -> None:
    columns = {"time": ticks(walk, 10**9, UNIX_NS), "seconds_elapsed": walk.time_s}
    files = {
        "my acc.csv": rows({**columns, **xyz("{}", walk.force[:, ::-1], "zyx")}),
        "my gyro.csv": rows({**columns, **xyz("{}", walk.rate[:, ::-1], "zyx")}),
    }
    recording = read(folder_of(tmp_path, files))
    assert recording.format == "Sensor Logger"
    assert_walk(recording.devices[0], walk)


def test_rows_of_two_phones_are_not_one_export(tmp_path: Path, walk: TableWalk) -> None:
    """A table of Sensor Logger's or phyphox's columns that somebody has joined from two phones."""
    n = len(walk.time_s)
    for time, pattern, title in (
        (ticks(walk, 10**9, UNIX_NS), "{}_{{}}", ("accelerometer", "gyroscope")),
        (walk.time_s, "{} {{}}", ("Acceleration", "Gyroscope")),
    ):
        clock = "time" if "_" in pattern else "Time (s)"
        units = ("", "") if "_" in pattern else (" (m/s^2)", " (rad/s)")
        patterns = [pattern.format(name) + unit for name, unit in zip(title, units, strict=True)]
        columns = {clock: time, **xyz(patterns[0], walk.force), **xyz(patterns[1], walk.rate)}
        a, b = (rows({**columns, "device": [name] * n}) for name in ("a", "b"))
        recording = read(
            folder_of(tmp_path, {"walk.csv": [a[0], *chain(*zip(a[1:], b[1:], strict=True))]}) / "walk.csv"
        )
        assert [device.name for device in recording.devices] == ["a", "b"]
        assert_walk(recording.devices[1], walk)


@pytest.mark.parametrize("content", [["time,x,y,z"], [""], []])
def test_an_empty_file_is_told_and_left_out(tmp_path: Path, walk: TableWalk, content: list[str]) -> None:
    files = {
        "Accelerometer.csv": table(walk, walk.force, ns=False),
        "Gyroscope.csv": table(walk, walk.rate, ns=False),
        "Magnetometer.csv": content,
        "Light.csv": [],
    }
    (device,) = read(folder_of(tmp_path, files)).devices
    assert_walk(device, walk)
    assert device.magnetic_field is None
    assert "Magnetometer.csv has no rows and is left out" in device.warnings


def test_an_empty_accelerometer_is_told(tmp_path: Path, walk: TableWalk) -> None:
    files = {"Accelerometer.csv": ["time,x,y,z"], "Gyroscope.csv": table(walk, walk.rate, ns=False)}
    (device,) = read(folder_of(tmp_path, files)).devices
    assert device.specific_force is None
    assert "Accelerometer.csv has no rows and is left out" in device.warnings


@pytest.mark.parametrize("accuracy", ["3", "3.0", "high"])
def test_an_accuracy_before_the_axes_is_no_axis(tmp_path: Path, walk: TableWalk, accuracy: str) -> None:
    """Tables without titles, as those of the Oxford data set, but with a gyroscope beside."""
    files = {
        f"{name}.csv": [
            f"{tick},{accuracy},{v[0]},{v[1]},{v[2]}"
            for tick, v in zip(ticks(walk, 10**9, UNIX_NS), values, strict=True)
        ]
        for name, values in (("accelerometer", walk.force), ("gyroscope", walk.rate))
    }
    recording = read(folder_of(tmp_path, files))
    assert recording.format == "one file a sensor"
    assert_walk(recording.devices[0], walk)


def mobiact(walk: TableWalk, values: Array, trial: int) -> list[str]:
    above = ["#Activity: WAL - 1 - Walking", f"#Subject ID: {trial}", "", "@DATA"]
    return above + [
        f"{tick}, {v[0]},{v[1]},{v[2]}" for tick, v in zip(ticks(walk, 10**9, UNIX_NS), values, strict=True)
    ]


def test_walks_told_by_the_names_of_files(tmp_path: Path, walk: TableWalk) -> None:
    files = {
        f"WAL_{name}_1_{trial}.txt": mobiact(walk, values, trial)
        for trial, factor in ((1, 1.0), (2, 0.99))
        for name, values in (("acc", factor * walk.force), ("gyro", walk.rate))
    }
    place = folder_of(tmp_path, files)
    with pytest.raises(SeveralWalksError, match=r"of 2 walks \(wal_1_1, wal_1_2\): choose one with --device NAME"):
        read(place)
    for name, factor in (("wal_1_1", 1.0), ("wal_1_2", 0.99)):
        (device,) = read(place, devices=[name]).devices
        assert device.name == name
        assert_walk(device, walk, factor)


def test_a_single_walk_of_such_a_folder_needs_no_choice(tmp_path: Path, walk: TableWalk) -> None:
    files = {"WAL_acc_1_1.txt": mobiact(walk, walk.force, 1), "WAL_gyro_1_1.txt": mobiact(walk, walk.rate, 1)}
    assert_walk(read(folder_of(tmp_path, files)).devices[0], walk)


def test_titles_with_a_word_in_front(tmp_path: Path, walk: TableWalk) -> None:
    files = {
        f"{name}_walking_waist.csv": rows(
            {
                "id": range(1, len(walk.time_s) + 1),
                "attr_time": ticks(walk, 1000, UNIX_NS // 10**6),
                **xyz("attr_{}", values),
            }
        )
        for name, values in (("acc", walk.force), ("Gyroscope", walk.rate))
    }
    assert_walk(read(folder_of(tmp_path, files)).devices[0], walk)


def test_files_with_the_rows_of_several_persons(tmp_path: Path, walk: TableWalk) -> None:
    files = {
        f"Phones_{name}.csv": [
            "Index,Arrival_Time,Creation_Time,x,y,z,User,Model,Device,gt",
            *(
                f"{i},{tick // 10**6},{tick},{v[0]},{v[1]},{v[2]},{user},nexus4,nexus4_1,walk"
                for user in "ab"
                for i, (tick, v) in enumerate(zip(ticks(walk, 10**9, UNIX_NS), values, strict=True))
            ),
        ]
        for name, values in (("accelerometer", walk.force), ("gyroscope", walk.rate))
    }
    place = folder_of(tmp_path, files)
    with pytest.raises(SeveralWalksError, match=r"by the person in column 'User': a, b; choose one with --device"):
        read(place)
    (device,) = read(place, devices=["b"]).devices
    assert device.name == "b"
    assert_walk(device, walk)


def test_files_without_time_say_how_to_give_the_rate(tmp_path: Path, walk: TableWalk) -> None:
    files = {
        f"{name}_exp01_user01.txt": [" ".join(map(str, v)) for v in values]
        for name, values in (("acc", walk.force), ("gyro", walk.rate))
    }
    with pytest.raises(RecordingError, match=r"acc_exp01_user01.txt, gyro_.* have three axes and no time; a mapping"):
        read(folder_of(tmp_path, files))


def test_counts_of_a_chip_are_refused(tmp_path: Path, walk: TableWalk) -> None:
    counts = np.round(walk.force / 9.80665 * 16384).astype(int)
    lines = rows({"micros": ticks(walk, 10**6, 523), **xyz("a{}", counts), **xyz("g{}", np.round(walk.rate * 7506))})
    with pytest.raises(RecordingError, match=r"ax, ay, az are integers whose mean has length .* state what one is"):
        read(folder_of(tmp_path, {"walk.csv": lines}) / "walk.csv")


@pytest.mark.parametrize("first", ["rv.txt", "orientation.txt", "game_rv.txt"])
def test_a_second_rotation_vector_is_not_used(tmp_path: Path, walk: TableWalk, first: str) -> None:
    """Android has three: the one from magnetic north alone is the worst, and the walk does not depend on any."""
    vectors = np.roll(walk.attitude, -1, axis=1)  # w last
    files = {
        "acce.txt": table(walk, walk.force),
        "gyro.txt": table(walk, walk.rate),
        first: rows({"time": ticks(walk, 10**9, UNIX_NS), **dict(zip("xyzw", vectors.T, strict=True))}),
        "magnetic_rv.txt": rows({"time": ticks(walk, 10**9, UNIX_NS), **dict(zip("xyzw", -vectors.T, strict=True))}),
    }
    device = read(folder_of(tmp_path, files)).devices[0]
    assert_walk(device, walk)
    assert device.attitude is not None
    assert "files not used: magnetic_rv.txt" in " | ".join(device.decisions)


def test_a_table_that_cannot_be_read_beside_walks_is_not_dropped(tmp_path: Path, walk: TableWalk) -> None:
    """The first walk is a folder: the extension of the others tells that it should be one, too."""
    plain = rows({"time": walk.time_s, **xyz("acc_{}", walk.force), **xyz("gyro_{}", walk.rate)})
    files = {"a/acc.csv": table(walk, walk.force), "a/gyro.csv": table(walk, walk.rate)}
    files |= {"walk.csv": plain, "broken.csv": [line.partition(",")[2] for line in plain], "info.json": ['{"a": 1}']}
    found = {path.name for path in walks_in_folder(folder_of(tmp_path, files))}
    assert found == {"a", "walk.csv", "broken.csv"}


@pytest.mark.parametrize("axes", [("x_uncalib", "y_uncalib", "z_uncalib"), ("values_0", "values_1", "values_2")])
def test_axes_that_only_the_name_of_the_file_tells(tmp_path: Path, walk: TableWalk, axes: Sequence[str]) -> None:
    found = {}
    for name, values in (("accelerometer.csv", walk.force), ("gyroscope.csv", walk.rate)):
        columns = dict(zip(axes, values.T, strict=True))
        found[name] = rows({"timestamp": ticks(walk, 10**9, UNIX_NS), "accuracy": [3] * len(values), **columns})
    assert_walk(read(folder_of(tmp_path, found)).devices[0], walk)
