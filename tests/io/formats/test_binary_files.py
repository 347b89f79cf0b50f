"""Files that need an optional package: workbooks, MAT files, HDF5; and what is said without it."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from app_exports import androsensor
from fabricated import Walk, as_folder, make_walk
from workbooks import write_old_workbook, write_workbook

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io import read

MOTION = ("Acceleration {} (m/s^2)", "Gyroscope {} (rad/s)")


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk(duration_s=6.0)


def sheet(walk: Walk, title: str, values: Array) -> list[list[Any]]:
    header = ["Time (s)", *(title.format(axis) for axis in "xyz")]
    return [header, *(list(row) for row in np.column_stack([walk.time_s, values]))]


def workbook(path: Path, walk: Walk, write: Callable[[Path, Any], Path] = write_workbook) -> Path:
    sheets: dict[str, list[list[Any]]] = {
        "Accelerometer": sheet(walk, MOTION[0], walk.force),
        "Gyroscope": sheet(walk, MOTION[1], walk.rate),
        "Metadata Device": [["property", "value"], ["deviceBrand", "acme"], ["deviceModel", "A1"]],
        "Metadata Time": [
            ["event", "experiment time", "system time", "system time text"],
            ["START", 0.0, 1.927e9, "2031-01-24 04:53:20.000 UTC+00:00"],
        ],
    }
    return write(path, sheets)


@pytest.mark.parametrize(("name", "write"), [("Walk.xlsx", write_workbook), ("Walk.xls", write_old_workbook)])
def test_a_workbook_of_phyphox_gives_the_walk(
    tmp_path: Path, walk: Walk, name: str, write: Callable[[Path, Any], Path]
) -> None:
    pytest.importorskip("python_calamine")
    path = workbook(tmp_path / name, walk, write)
    for recording in (read(path), read(tmp_path)):
        assert recording.format == "phyphox"
        assert recording.epoch_s == pytest.approx(1.927e9)
        device = recording.devices[0]
        assert device.model == "acme A1"
        assert device.specific_force is not None
        assert device.rotation_rate is not None
        assert device.specific_force.values == pytest.approx(walk.force, abs=1e-9)
        assert device.rotation_rate.values == pytest.approx(walk.rate, abs=1e-9)


def test_a_table_of_any_app_may_lie_in_a_workbook(tmp_path: Path, walk: Walk) -> None:
    pytest.importorskip("python_calamine")
    lines = androsensor(walk)["Sensor_record.csv"].decode().splitlines()
    rows = [[_value(cell) for cell in line.split(",")] for line in lines]
    recording = read(write_workbook(tmp_path / "walk.xlsx", {"Tabelle1": rows}))
    assert recording.format == "AndroSensor"
    assert recording.devices[0].specific_force is not None


def _value(cell: str) -> Any:
    try:
        return float(cell)
    except ValueError:
        return cell


def test_a_damaged_workbook_is_told(tmp_path: Path, walk: Walk) -> None:
    pytest.importorskip("python_calamine")
    (tmp_path / "old.xls").write_bytes(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + b"\0" * 2000)
    with pytest.raises(RecordingError, match="damaged Excel workbook"):
        read(tmp_path / "old.xls")


def timetable_file(path: Path, walk: Walk) -> Path:
    matio = pytest.importorskip("matio")
    pandas = pytest.importorskip("pandas")
    index = pandas.DatetimeIndex(
        np.datetime64("2031-02-03T04:05:06.789") + np.round(walk.time_s * 1e3).astype("timedelta64[ms]"),
        name="Timestamp",
    )
    tables = {
        name: pandas.DataFrame(dict(zip("XYZ", values.T, strict=True)), index=index)
        for name, values in (("Acceleration", walk.force), ("AngularVelocity", walk.rate), ("Orientation", walk.rate))
    }
    n = len(walk.time_s[::100])
    position = {"latitude": 12.3 + 1e-5 * np.arange(n), "longitude": np.full(n, -34.5), "hacc": np.full(n, 4.0)}
    tables["Position"] = pandas.DataFrame(position, index=index[::100])
    matio.save_to_mat(str(path), tables, version="v7.3" if path.stem == "new" else "v7")
    return path


@pytest.mark.parametrize("name", ["new.mat", "old.mat"])
def test_timetables_of_matlab_mobile_give_the_walk(tmp_path: Path, walk: Walk, name: str) -> None:
    recording = read(timetable_file(tmp_path / name, walk))
    device = recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.specific_force.time_s == pytest.approx(walk.time_s, abs=1e-3)
    assert device.specific_force.values == pytest.approx(walk.force, abs=1e-9)
    assert device.rotation_rate.values == pytest.approx(walk.rate, abs=1e-9)
    assert len(recording.fixes) == 6
    assert "timetables not used: Orientation" in device.decisions


def ronin_sequence(folder: Path, walk: Walk, start_frame: int, w_first: bool) -> Path:
    h5py = pytest.importorskip("h5py")
    folder.mkdir()
    quaternion = walk.quaternion if w_first else walk.quaternion[:, [1, 2, 3, 0]]
    with h5py.File(folder / "data.hdf5", "w") as file:
        for name, values in (
            ("time", 100.0 + walk.time_s),
            ("acce", walk.force),
            ("gyro", walk.rate),
            ("linacce", walk.user),
            ("game_rv", quaternion),
        ):
            file[f"synced/{name}"] = values
        file["pose/tango_pos"] = np.column_stack([walk.time_s, 2.0 * walk.time_s, 0.0 * walk.time_s])
    (folder / "info.json").write_text(json.dumps({"start_frame": start_frame}))
    return folder


@pytest.mark.parametrize("w_first", [True, False])
def test_a_ronin_sequence_has_its_reference(tmp_path: Path, walk: Walk, w_first: bool) -> None:
    recording = read(ronin_sequence(tmp_path / "a000_1", walk, 50, w_first))
    device, true = recording.devices[0], recording.truth.positions
    assert (recording.format, recording.name) == ("RoNIN", "a000_1")
    assert device.specific_force is not None
    assert device.attitude is not None
    assert true is not None
    assert device.specific_force.values == pytest.approx(walk.force[50:])
    assert device.specific_force.time_s[0] == 0.0
    assert device.attitude.values == pytest.approx(walk.quaternion[50:])
    assert true.position_m[:, 1] == pytest.approx(2.0 * walk.time_s[50:])
    assert "not used: linacce" in device.decisions


@pytest.mark.parametrize("start", [None, -100, 10**6, 1.5, True])
def test_a_start_frame_that_is_no_row_is_refused(tmp_path: Path, walk: Walk, start: object) -> None:
    folder = ronin_sequence(tmp_path / "a000_1", walk, 50, True)
    (folder / "info.json").write_text(json.dumps({"start_frame": start}))
    with pytest.raises(RecordingError, match=r"info\.json: start_frame is .*, no number of a row from 0 to \d+"):
        read(folder)


@pytest.mark.parametrize(("name", "columns"), [("synced/game_rv", 3), ("synced/acce", 2), ("pose/tango_pos", 1)])
def test_an_array_of_another_shape_is_refused(tmp_path: Path, walk: Walk, name: str, columns: int) -> None:
    h5py = pytest.importorskip("h5py")
    folder = ronin_sequence(tmp_path / "a000_1", walk, 50, True)
    with h5py.File(folder / "data.hdf5", "a") as file:
        values = file[name][:, :columns]
        del file[name]
        file[name] = values
    with pytest.raises(RecordingError, match=r"has the shape \(\d+, \d\), not \(\d+, \d\); copy the file again"):
        read(folder)


def test_rows_without_numbers_are_left_out(tmp_path: Path, walk: Walk) -> None:
    h5py = pytest.importorskip("h5py")
    folder = ronin_sequence(tmp_path / "a000_1", walk, 0, True)
    with h5py.File(folder / "data.hdf5", "a") as file:
        file["synced/game_rv"][10:20] = np.nan
        file["pose/tango_pos"][:5] = np.nan
        file["synced/magnet"] = np.full((len(walk.time_s), 3), np.nan)
    recording = read(folder)
    device, true = recording.devices[0], recording.truth.positions
    assert device.attitude is not None
    assert true is not None
    assert (len(device.attitude), len(true.time_s)) == (len(walk.time_s) - 10, len(walk.time_s) - 5)
    assert device.magnetic_field is None
    assert any("magnet: left out because all" in words for words in device.warnings)


def test_another_hdf5_file_names_its_content(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "data.h5", "w") as file:
        file["images"] = np.zeros(3)
    with pytest.raises(RecordingError, match=r"without synced/time and synced/acce \(it has images\)"):
        read(tmp_path / "data.h5")


@pytest.mark.parametrize(
    ("head", "package", "advice"),
    [
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "python_calamine", "pip install pdr-est[xls]"),
        (b"MATLAB 5.0 MAT-file, Platform: PCWIN64", "matio", "writetimetable(Acceleration, 'Acceleration.csv')"),
        (b"\x89HDF\r\n\x1a\n", "h5py", "pip install pdr-est[hdf5]"),
    ],
)
def test_a_missing_package_is_named_with_a_way_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, head: bytes, package: str, advice: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    (tmp_path / "walk.bin").write_bytes(head + b"\0" * 600)
    with pytest.raises(RecordingError) as caught:
        read(tmp_path / "walk.bin")
    assert advice in str(caught.value)


def test_a_workbook_beside_a_table_is_left_alone(tmp_path: Path, walk: Walk) -> None:
    files = {**androsensor(walk), "notes.xls": b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + b"\0" * 100}
    assert read(as_folder(tmp_path, files)).format == "AndroSensor"
