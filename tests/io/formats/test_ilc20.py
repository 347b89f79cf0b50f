"""ILC20 logs: values, clock, waypoints, joined rows, fallbacks and bad rows."""

import time
from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.frames import up_in_device
from pdr_est.io import read
from pdr_est.types.recording import Recording
from pdr_est.types.sensors import AttitudeReference

START_MS = 1_574_560_118_902
HEADER = (
    f"#\tstartTime:{START_MS}\n"
    "#\tSiteID:5dd3\tSiteName:杭州\tFloorId:5dd4\tFloorName:F1\n"
    "#\tBrand:OPPO\tModel:PBCM10\tAndroidName:8.1.0\tAPILevel:27\t\n"
)
SENSORS = ("ACCELEROMETER\t0.1\t0.2\t9.8\t2", "GYROSCOPE\t0.01\t0.02\t0.5\t3", "MAGNETIC_FIELD\t-38\t-24\t-33\t3")


def row(at_ms: int, text: str) -> str:
    return f"{START_MS + at_ms}\tTYPE_{text}\n"


def walk(n_samples: int = 5) -> str:
    rows = [row(9, "WAYPOINT\t174.9853\t55.232815"), row(10, "WIFI\tcafe\t12:34\t-60\t2412\t1574560118000")]
    for i in range(n_samples):
        rows += [row(100 + 20 * i, sensor) for sensor in SENSORS]
        rows.append(row(100 + 20 * i, "ROTATION_VECTOR\t0.0\t0.6\t0.0\t3"))
    rows.append(row(100 + 20 * n_samples, "WAYPOINT\t179.0\t55.0"))
    return HEADER + "".join(rows) + f"#\tendTime:{START_MS + 9000}\n"


def read_text(folder: Path, text: str) -> Recording:
    path = folder / "walk.txt"
    path.write_text(text, encoding="utf-8", newline="")
    return read(path)


def test_signals_clock_truth_and_device(tmp_path: Path) -> None:
    recording = read_text(tmp_path, walk())
    (device,) = recording.devices
    assert (recording.format, recording.name, recording.epoch_s) == ("ILC20", "walk", START_MS / 1e3)
    assert (device.model, device.platform) == ("OPPO PBCM10", "android")
    assert recording.notes == ("site 杭州, floor F1",)
    assert device.warnings == ()
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.magnetic_field is not None
    assert device.attitude is not None
    assert device.attitude_reference is AttitudeReference.MAGNETIC_NORTH
    np.testing.assert_array_equal(device.specific_force.time_s, [0.1, 0.12, 0.14, 0.16, 0.18])
    np.testing.assert_array_equal(device.specific_force.values[0], [0.1, 0.2, 9.8])
    np.testing.assert_array_equal(device.rotation_rate.values[4], [0.01, 0.02, 0.5])
    np.testing.assert_array_equal(device.magnetic_field.values[4], [-38.0, -24.0, -33.0])
    np.testing.assert_allclose(device.attitude.values[0], [0.8, 0.0, 0.6, 0.0])
    truth = recording.truth.positions
    assert truth is not None
    assert truth.source == "waypoints"
    np.testing.assert_array_equal(truth.time_s, [0.009, 0.2])
    np.testing.assert_array_equal(truth.position_m, [[174.9853, 55.232815], [179.0, 55.0]])


def test_carriage_returns_change_nothing(tmp_path: Path) -> None:
    plain, windows = read_text(tmp_path, walk()), read_text(tmp_path, walk().replace("\n", "\r\n"))
    assert plain.truth.positions is not None
    assert windows.truth.positions is not None
    np.testing.assert_array_equal(plain.truth.positions.position_m, windows.truth.positions.position_m)
    assert plain.devices[0].model == windows.devices[0].model


def test_repeated_and_backward_time_stamps_are_kept(tmp_path: Path) -> None:
    text = HEADER + "".join(row(ms, SENSORS[0]) for ms in (100, 120, 120, 90))
    force = read_text(tmp_path, text).devices[0].specific_force
    assert force is not None
    np.testing.assert_array_equal(force.time_s, [0.1, 0.12, 0.12, 0.09])


def test_without_a_usable_start_time_the_first_sample_is_zero(tmp_path: Path) -> None:
    for text in (walk().split("\n", 1)[1], walk().replace(f"startTime:{START_MS}", "startTime:1000")):
        recording = read_text(tmp_path, text)
        assert recording.epoch_s == (START_MS + 100) / 1e3
        assert recording.devices[0].specific_force is not None
        assert recording.devices[0].specific_force.time_s[0] == 0.0
        assert "first accelerometer row" in recording.devices[0].decisions[0]


def test_joined_rows_are_split_and_counted(tmp_path: Path) -> None:
    lines = walk().split("\n")
    at = next(i for i, line in enumerate(lines) if "TYPE_ACCELEROMETER" in line)
    joined = "\n".join([*lines[: at + 1], lines[at + 1] + lines[at + 2] + lines[at + 3], *lines[at + 4 :]])
    device, whole = read_text(tmp_path, joined).devices[0], read_text(tmp_path, walk()).devices[0]
    assert device.warnings == ("2 rows were joined to the end of another row and have been split off",)
    for name in ("rotation_rate", "magnetic_field", "attitude"):
        np.testing.assert_array_equal(getattr(device, name).values, getattr(whole, name).values)
        np.testing.assert_array_equal(getattr(device, name).time_s, getattr(whole, name).time_s)


def test_uncalibrated_rows_stand_in_without_their_bias(tmp_path: Path) -> None:
    raw = "GYROSCOPE_UNCALIBRATED\t0.51\t0.02\t0.5\t0.5\t0.0\t-0.1\t3"
    device = read_text(tmp_path, walk().replace(SENSORS[1], raw)).devices[0]
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.rotation_rate.values[0], [0.01, 0.02, 0.6])
    assert any("gyroscope: uncalibrated rows minus their bias" in decision for decision in device.decisions)


def test_an_incomplete_waypoint_is_left_out_and_reported(tmp_path: Path) -> None:
    recording = read_text(tmp_path, walk().replace("\t179.0\t55.0", "\t179.0"))
    assert recording.truth.positions is not None
    assert len(recording.truth.positions.time_s) == 1
    assert recording.notes[-1] == "1 of 2 waypoints are incomplete and are left out"


def test_no_gyroscope_and_no_waypoints(tmp_path: Path) -> None:
    text = "".join(line for line in walk().splitlines(True) if "GYRO" not in line and "WAYPOINT" not in line)
    recording = read_text(tmp_path, text)
    assert recording.truth.positions is None
    assert recording.devices[0].rotation_rate is None
    assert recording.devices[0].warnings == ("no gyroscope rows: steps can be found, but headings cannot",)


def test_no_accelerometer(tmp_path: Path) -> None:
    text = "".join(line for line in walk().splitlines(True) if "ACCEL" not in line)
    with pytest.raises(RecordingError, match=r"walk\.txt: no accelerometer rows; record again"):
        read_text(tmp_path, text)


def test_text_in_a_number_field_names_line_and_value(tmp_path: Path) -> None:
    text = walk().replace("\t0.01\t0.02\t0.5", "\t0.01\tfast\t0.5", 1)
    with pytest.raises(RecordingError, match=r"walk\.txt, line 7, TYPE_GYROSCOPE: 'fast' is not a number; correct"):
        read_text(tmp_path, text)


def test_rows_that_are_not_finite_or_cut_short_are_dropped_and_counted(tmp_path: Path) -> None:
    text = (
        walk().replace(SENSORS[0], "ACCELEROMETER\t0.1\tNaN\t9.8\t2", 1).replace(SENSORS[0], "ACCELEROMETER\t0.1", 1)
    )
    device = read_text(tmp_path, text).devices[0]
    assert device.specific_force is not None
    assert len(device.specific_force) == 3
    assert device.warnings == ("accelerometer: 2 of 5 rows are left out: NaN or infinite values",)
    with pytest.raises(RecordingError, match="all 5 rows of accelerometer are NaN or infinite"):
        read_text(tmp_path, walk().replace(SENSORS[0], "ACCELEROMETER\tinf\t0\t9.8\t2"))


def test_three_megabytes_are_read_in_well_under_a_tenth_of_a_second(tmp_path: Path) -> None:
    wifi = row(0, "WIFI\tsome network\t12:34:56:78:9a:bc\t-60\t2412\t1574560118000") * 4
    block = "".join(row(100, sensor) for sensor in SENSORS) * 2 + wifi
    path = tmp_path / "large.txt"
    path.write_text(HEADER + block * (3_000_000 // len(block) + 1), encoding="utf-8")
    seconds = []
    for _ in range(5):
        before = time.perf_counter()
        read(path)
        seconds.append(time.perf_counter() - before)
    assert min(seconds) < 0.1


def test_real_walks(shared_data: Path) -> None:
    paths = sorted((shared_data / "ilc20").glob("*/*/*.txt*"))[::8]
    assert paths
    for path in paths:
        recording = read(path)
        (device,) = recording.devices
        assert recording.truth.positions is not None
        assert device.specific_force is not None
        assert device.attitude is not None
        assert device.warnings == ()
        assert np.median(np.diff(device.specific_force.time_s)) == pytest.approx(0.02, abs=0.002)
        upwards = (up_in_device(device.attitude.values) * device.specific_force.values[: len(device.attitude)]).sum(1)
        assert upwards.mean() == pytest.approx(9.8, abs=0.5)
