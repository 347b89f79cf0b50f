"""Sensor Logger: SQLite, combined CSV, the watch, single and renamed files, stale samples, no gravity."""

import sqlite3
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fabricated import (
    START_NS,
    Walk,
    as_folder,
    make_walk,
    metadata,
    sensor_logger_columns,
    sensor_logger_files,
    sensor_logger_json,
    table,
    xyz,
)

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.io import read
from pdr_est.types.recording import DeviceRecording

Sensors = dict[str, dict[str, Any]]


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk(duration_s=4.0)


def with_metadata(walk: Walk, platform: str = "android") -> Sensors:
    return {**sensor_logger_columns(walk), "Metadata": dict(metadata(platform))}


def assert_is_walk(device: DeviceRecording, walk: Walk) -> None:
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.specific_force.values == pytest.approx(walk.force, abs=1e-6)
    assert device.rotation_rate.values == pytest.approx(walk.rate, abs=1e-6)
    assert device.specific_force.time_s == pytest.approx(walk.time_s, abs=1e-6)


def write_database(path: Path, sensors: Mapping[str, Mapping[str, Sequence[Any]]], as_text: bool) -> None:
    with closing(sqlite3.connect(path)) as database:
        database.execute("PRAGMA journal_mode = WAL")
        for sensor, columns in sensors.items():
            titles = ", ".join(f'"{title}"' for title in columns)
            database.execute(f'CREATE TABLE "{sensor}" ({titles})')
            convert = str if as_text else _plain
            rows = [[convert(value) for value in row] for row in zip(*columns.values(), strict=True)]
            database.executemany(f'INSERT INTO "{sensor}" VALUES ({", ".join("?" * len(columns))})', rows)
        database.commit()
        database.execute("PRAGMA wal_checkpoint(TRUNCATE)")


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


@pytest.mark.parametrize("as_text", [True, False])
def test_the_sqlite_export_gives_the_walk(tmp_path: Path, walk: Walk, as_text: bool) -> None:
    write_database(tmp_path / "walk.sqlite", with_metadata(walk), as_text)
    recording = read(tmp_path / "walk.sqlite")
    assert recording.format == "Sensor Logger"
    assert recording.epoch_s == pytest.approx(START_NS / 1e9)
    assert recording.devices[0].platform == "android"
    assert_is_walk(recording.devices[0], walk)


def test_another_database_names_its_tables(tmp_path: Path) -> None:
    write_database(tmp_path / "other.db", {"messages": {"text": ["a"]}}, as_text=True)
    with pytest.raises(RecordingError, match=r"SQLite database without tables of Sensor Logger \(its tables: messag"):
        read(tmp_path / "other.db")


def test_a_damaged_database_is_told(tmp_path: Path, walk: Walk) -> None:
    write_database(tmp_path / "walk.sqlite", with_metadata(walk), as_text=False)
    content = (tmp_path / "walk.sqlite").read_bytes()
    (tmp_path / "cut.sqlite").write_bytes(content[:5000])
    with pytest.raises(RecordingError, match="damaged SQLite database"):
        read(tmp_path / "cut.sqlite")


@pytest.mark.parametrize("lower", [True, False])
def test_the_combined_table_gives_the_walk(tmp_path: Path, walk: Walk, lower: bool) -> None:
    sensors = sensor_logger_columns(walk)
    clock = sensors["Gyroscope"]
    columns: dict[str, Any] = {"time": clock["time"], "seconds_elapsed": clock["seconds_elapsed"]}
    for sensor, of_sensor in sensors.items():
        name = sensor[0].lower() + sensor[1:] if lower else sensor
        columns |= {f"{name}_{title}": values for title, values in of_sensor.items() if title not in columns}
    columns["location_latitude"] = [12.3 + 1e-4 * i if i % 100 == 0 else "" for i in range(len(walk.time_s))]
    columns["location_longitude"] = [-34.5 if i % 100 == 0 else "" for i in range(len(walk.time_s))]
    columns["location_horizontalAccuracy"] = [4.0 if i % 100 == 0 else "" for i in range(len(walk.time_s))]
    (tmp_path / "combined.csv").write_bytes(table(columns))
    recording = read(tmp_path / "combined.csv")
    assert recording.format == "Sensor Logger"
    assert_is_walk(recording.devices[0], walk)
    assert len(recording.fixes) == 4
    assert not recording.devices[0].warnings


def wrist_motion(walk: Walk, sign: float = -1.0, unit: float = STANDARD_GRAVITY_MPS2) -> dict[str, Any]:
    w, x, y, z = walk.quaternion.T
    return {
        "time": sensor_logger_columns(walk)["Gyroscope"]["time"],
        "seconds_elapsed": ["np.float64(0.1)"] * len(w),  # not needed, so that damage there does no harm
        **xyz(walk.rate, ("rotationRateX", "rotationRateY", "rotationRateZ")),
        **xyz(sign * walk.gravity / unit, ("gravityX", "gravityY", "gravityZ")),
        **xyz(sign * walk.user / unit, ("accelerationX", "accelerationY", "accelerationZ")),
        "quaternionW": w,
        "quaternionX": x,
        "quaternionY": y,
        "quaternionZ": z,
    }


@pytest.mark.parametrize(("sign", "unit"), [(-1.0, STANDARD_GRAVITY_MPS2), (1.0, 1.0)])
def test_the_watch_is_the_device_where_the_phone_has_no_motion(
    tmp_path: Path, walk: Walk, sign: float, unit: float
) -> None:
    location = {**xyz(np.array([[12.3, -34.5, 4.0], [12.4, -34.5, 4.0]])), "time": [START_NS, START_NS + 10**9]}
    files = sensor_logger_files(
        {
            "WristMotion": wrist_motion(walk, sign, unit),
            "WatchLocation": {
                "time": location["time"],
                "latitude": location["x"],
                "longitude": location["y"],
                "horizontalAccuracy": location["z"],
            },
            "Annotation": {"time": [], "text": []},
            "Metadata": dict(metadata("ios", "false" if sign < 0 else "true")),
        }
    )
    folder = read(as_folder(tmp_path, files))
    single = read(tmp_path / "WristMotion.csv")
    for recording in (folder, single):
        device = recording.devices[0]
        assert device.name == "watch"
        assert_is_walk(device, walk)
        assert device.attitude is not None
    assert len(folder.fixes) == 2


def test_the_phone_is_the_device_beside_a_watch(tmp_path: Path, walk: Walk) -> None:
    files = sensor_logger_files({**with_metadata(walk), "WristMotion": wrist_motion(walk)})
    recording = read(as_folder(tmp_path, files))
    assert [device.name for device in recording.devices] == ["device"]
    assert any("sensors not used: WristMotion" in decision for decision in recording.devices[0].decisions)


@pytest.mark.parametrize("name", ["TotalAcceleration.csv", "Walking_TotalAcceleration.csv", "walk 3.csv"])
def test_a_single_accelerometer_is_enough_for_steps(tmp_path: Path, walk: Walk, name: str) -> None:
    total = {**sensor_logger_columns(walk)["Gyroscope"], **xyz(walk.force)}
    (tmp_path / name).write_bytes(table(total))
    device = read(tmp_path / name).devices[0]
    assert device.specific_force is not None
    assert device.specific_force.values == pytest.approx(walk.force, abs=1e-6)
    assert device.rotation_rate is None


def test_an_unnamed_table_without_gravity_is_asked_for_its_sensor(tmp_path: Path, walk: Walk) -> None:
    (tmp_path / "walk 3.csv").write_bytes(table(sensor_logger_columns(walk)["Gyroscope"]))
    with pytest.raises(RecordingError, match="walk 3: the name of the file does not tell the sensor; rename it"):
        read(tmp_path / "walk 3.csv")


@pytest.mark.parametrize(("platform", "sign"), [("android", 1.0), ("ios", -1.0)])
def test_without_gravity_there_are_steps_and_advice(tmp_path: Path, walk: Walk, platform: str, sign: float) -> None:
    sensors = {**sensor_logger_columns(walk, sign=sign), "Metadata": dict(metadata(platform))}
    kept = {name: sensors[name] for name in ("Accelerometer", "Gyroscope", "Metadata")}
    (tmp_path / "walk.json").write_bytes(sensor_logger_json(kept))
    for path in (as_folder(tmp_path / "folder", sensor_logger_files(kept)), tmp_path / "walk.json"):
        device = read(path).devices[0]
        assert device.specific_force is None
        assert device.linear_acceleration is not None
        assert device.linear_acceleration.values == pytest.approx(walk.user, abs=1e-6)
        assert device.rotation_rate is not None
        assert any("switch on Gravity" in warning for warning in device.warnings)


def test_gravity_of_another_time_leaves_the_steps(tmp_path: Path, walk: Walk) -> None:
    sensors = with_metadata(walk)
    del sensors["Orientation"]
    sensors["Gravity"]["time"] = [tick + 3600 * 10**9 for tick in sensors["Gravity"]["time"]]
    device = read(as_folder(tmp_path, sensor_logger_files(sensors))).devices[0]
    assert device.specific_force is None
    assert device.linear_acceleration is not None
    assert "acceleration and gravity do not overlap in time: gravity is not used" in device.warnings


def test_an_accelerometer_with_gravity_needs_no_other(tmp_path: Path, walk: Walk) -> None:
    sensors = with_metadata(walk)
    sensors["Accelerometer"] |= xyz(walk.force)
    device = read(as_folder(tmp_path, sensor_logger_files(sensors))).devices[0]
    assert_is_walk(device, walk)
    assert "Accelerometer is with gravity by its values" in device.decisions


def test_a_sample_measured_days_before_is_left_out(tmp_path: Path, walk: Walk) -> None:
    sensors = with_metadata(walk)
    for sensor in ("Accelerometer", "Gravity", "Gyroscope"):
        columns = sensors[sensor]
        first = {title: [0.0] for title in columns} | {"time": [START_NS - 328_883 * 10**9]}
        sensors[sensor] = {title: [*first[title], *values] for title, values in columns.items()}
    recording = read(as_folder(tmp_path, sensor_logger_files(sensors)))
    assert recording.epoch_s == pytest.approx(START_NS / 1e9)
    assert_is_walk(recording.devices[0], walk)
    assert sum("measured long before the recording" in warning for warning in recording.devices[0].warnings) == 3


def test_two_files_of_one_sensor_are_told(tmp_path: Path, walk: Walk) -> None:
    files = sensor_logger_files(with_metadata(walk))
    files["Run_Gyroscope.csv"] = files["Gyroscope.csv"]
    with pytest.raises(RecordingError, match=r"Gyroscope\.csv and Run_Gyroscope\.csv hold the same sensor"):
        read(as_folder(tmp_path, files))
