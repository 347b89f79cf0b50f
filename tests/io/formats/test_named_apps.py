"""Every app and device that is known by name gives the same walk, whatever its titles, units, signs and clock."""

from pathlib import Path

import numpy as np
import pytest
from app_exports import APPS, androsensor, imu_recorder, physics_toolbox, sensor_record
from fabricated import Walk, as_folder, as_zip, make_walk

from pdr_est.errors import RecordingError
from pdr_est.io import read
from pdr_est.types.recording import Recording


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk(duration_s=12.0)


def assert_is_walk(recording: Recording, walk: Walk, tolerance: float = 1e-6) -> None:
    device = recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    for signal, values in ((device.specific_force, walk.force), (device.rotation_rate, walk.rate)):
        assert signal.time_s == pytest.approx(walk.time_s, abs=2e-3)
        assert signal.values == pytest.approx(values, abs=tolerance)


@pytest.mark.parametrize("name", APPS)
def test_the_walk_of_every_app_is_read(tmp_path: Path, walk: Walk, name: str) -> None:
    format_name, export = APPS[name]
    files = export(walk)
    recording = read(as_folder(tmp_path / "folder", files))
    assert recording.format == format_name
    assert_is_walk(recording, walk)
    assert_is_walk(read(as_zip(tmp_path / "walk.zip", files)), walk)
    if len(files) == 1:
        assert read(tmp_path / "folder" / next(iter(files))).format == format_name


@pytest.mark.parametrize("name", APPS)
def test_what_is_not_used_is_named(tmp_path: Path, walk: Walk, name: str) -> None:
    files = APPS[name][1](walk)
    recording = read(as_folder(tmp_path, files))
    told = " ".join(recording.devices[0].decisions)
    unused = [title for title in ("FreeAcc_X", "Satellites", "Temperature.csv", "gps.txt") if _has(files, title)]
    assert all(title in told for title in unused)


def _has(files: dict[str, bytes], title: str) -> bool:
    return title in files or any(title.encode() in data[:2000] for data in files.values())


def test_positions_of_every_row_give_one_fix_a_second(tmp_path: Path, walk: Walk) -> None:
    recording = read(as_folder(tmp_path, androsensor(walk)))
    assert len(recording.fixes) == 12
    assert [round(fix.time_s) for fix in recording.fixes] == list(range(12))


def test_the_rotation_vector_with_w_last_is_an_attitude(tmp_path: Path, walk: Walk) -> None:
    device = read(as_folder(tmp_path, imu_recorder(walk))).devices[0]
    assert device.attitude is not None
    assert np.abs((device.attitude.values * walk.quaternion).sum(axis=1)) == pytest.approx(1.0, abs=1e-6)


def test_linear_acceleration_alone_is_kept_for_steps(tmp_path: Path, walk: Walk) -> None:
    lines = physics_toolbox(walk)["walk.csv"].decode().splitlines()
    rows = [line.split(",") for line in lines[1:]]
    kept = [0, *range(4, 11)]  # time, a, w and the empty last cell
    text = "\n" + "".join(",".join(row[i] for i in kept) + "\n" for row in rows)
    (tmp_path / "walk.csv").write_text(text)
    device = read(tmp_path / "walk.csv").devices[0]
    assert device.specific_force is None
    assert device.linear_acceleration is not None
    assert device.linear_acceleration.values == pytest.approx(walk.user, abs=1e-6)
    assert any("without gravity" in warning and "g-Force Meter" in warning for warning in device.warnings)


def test_a_signal_is_named_by_its_file(tmp_path: Path, walk: Walk) -> None:
    files = sensor_record(walk)
    del files["Accelerometer.csv"]
    device = read(as_folder(tmp_path, files)).devices[0]
    assert device.linear_acceleration is not None
    assert any(warning.startswith("AccelerometerLinear is without gravity") for warning in device.warnings)


def test_two_files_of_one_sensor_are_two_walks(tmp_path: Path, walk: Walk) -> None:
    files = sensor_record(walk)
    files["second Accelerometer.csv"] = files["Accelerometer.csv"]
    with pytest.raises(RecordingError, match="both hold the specific force; put the files of each walk"):
        read(as_folder(tmp_path, files))


def test_an_uncalibrated_file_is_the_second_choice(tmp_path: Path, walk: Walk) -> None:
    files = sensor_record(walk)
    files["AccelerometerUncalibrated.csv"] = files["Gyroscope.csv"]
    assert_is_walk(read(as_folder(tmp_path, files)), walk)


def test_folders_named_by_their_sensor(tmp_path: Path, walk: Walk) -> None:
    files = sensor_record(walk)
    moved = {f"walk/{name.lower().removesuffix('.csv')}/1.csv": data for name, data in files.items()}
    moved["other/note.txt"] = b"hello"
    assert_is_walk(read(as_folder(tmp_path, moved)), walk)


def test_each_folder_is_a_walk(tmp_path: Path, walk: Walk) -> None:
    files = {f"{folder}/{name}": data for folder in "ab" for name, data in sensor_record(walk).items()}
    with pytest.raises(RecordingError, match=r"contains 2 one file a sensor recordings \(a, b\); choose one"):
        read(as_folder(tmp_path, files))
