"""Sensor Logger exports of both platforms, in all layouts, give the same walk; damage is reported."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fabricated import (
    START_NS,
    Walk,
    as_folder,
    as_zip,
    make_walk,
    metadata,
    sensor_logger_columns,
    sensor_logger_files,
    sensor_logger_json,
    table,
    xyz,
)
from scipy.spatial.transform import Rotation

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, up_in_device
from pdr_est.io.conversion.restored_gravity import rotation_agreement
from pdr_est.io.formats.phone_apps.sensor_logger import reader as sensor_logger
from pdr_est.io.formats.registry import read
from pdr_est.io.text.container import Source
from pdr_est.types.recording import Recording, Signal

Columns = dict[str, dict[str, Sequence[Any] | Array]]


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk()


def export(walk: Walk, platform: str = "android", standardisation: str = "false", **options: Any) -> Columns:
    sign = -1.0 if platform == "ios" and standardisation == "false" else 1.0
    columns = sensor_logger_columns(walk, sign=sign, **options)
    columns["Metadata"] = dict(metadata(platform, standardisation))
    return columns


def read_folder(path: Path, columns: Columns) -> Recording:
    return read(as_folder(path, sensor_logger_files(columns)))


def force_of(recording: Recording) -> Signal:
    force = recording.devices[0].specific_force
    assert force is not None
    return force


@pytest.mark.parametrize(("platform", "standardisation"), [("android", "false"), ("ios", "false"), ("ios", "true")])
def test_every_platform_gives_the_same_specific_force(
    tmp_path: Path, walk: Walk, platform: str, standardisation: str
) -> None:
    recording = read_folder(tmp_path, export(walk, platform, standardisation))
    device = recording.devices[0]
    assert (recording.format, device.model, device.platform) == ("Sensor Logger", "TestPhone", platform)
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.attitude is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=1e-12)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, atol=1e-12)
    # Core Motion's attitude has x north, unless it is standardised; the recording has x east.
    quarter = Rotation.from_euler("z", 90.0 if (platform, standardisation) == ("ios", "false") else 0.0, degrees=True)
    expected = quarter * Rotation.from_quat(walk.quaternion, scalar_first=True)
    read_back = Rotation.from_quat(device.attitude.values, scalar_first=True)
    np.testing.assert_allclose((read_back.inv() * expected).magnitude(), 0.0, atol=1e-7)
    assert device.attitude_reference == ("magnetic-north" if platform == "android" else "true-north")
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s, atol=1e-9)
    assert recording.epoch_s == START_NS / 1e9
    assert device.warnings == ()


def test_folder_zip_wrapped_zip_and_json_are_the_same(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk, "ios")
    files = sensor_logger_files(columns)
    document = tmp_path / "walk.json"
    document.write_bytes(sensor_logger_json(columns))
    expected = force_of(read(as_folder(tmp_path / "folder", files)))
    for path in (
        as_zip(tmp_path / "flat.zip", files),
        as_zip(tmp_path / "wrapped.zip", {f"2024-06-10/{name}": data for name, data in files.items()}),
        document,
    ):
        force = force_of(read(path))
        np.testing.assert_array_equal(force.values, expected.values)
        np.testing.assert_array_equal(force.time_s, expected.time_s)


def test_the_attitude_settles_the_sign_when_the_platform_is_unknown(tmp_path: Path, walk: Walk) -> None:
    columns = sensor_logger_columns(walk, sign=-1.0)
    recording = read_folder(tmp_path, columns)
    np.testing.assert_allclose(force_of(recording).values, walk.force, atol=1e-12)
    assert any("negated" in words for words in recording.devices[0].decisions)


def test_metadata_that_contradict_the_attitude_are_reported(tmp_path: Path, walk: Walk) -> None:
    columns = sensor_logger_columns(walk, sign=-1.0)
    columns["Metadata"] = dict(metadata("android"))
    recording = read_folder(tmp_path, columns)
    np.testing.assert_allclose(force_of(recording).values, walk.force, atol=1e-12)
    assert any("contradicts the metadata" in words for words in recording.devices[0].warnings)


def test_the_platform_settles_the_sign_without_an_attitude(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk, "ios")
    del columns["Orientation"]
    np.testing.assert_allclose(force_of(read_folder(tmp_path, columns)).values, walk.force, atol=1e-12)


def test_an_inverted_attitude_is_turned_round(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk, "ios", "true")
    for name in ("qx", "qy", "qz"):
        columns["Orientation"][name] = -np.asarray(columns["Orientation"][name])
    device = read_folder(tmp_path, columns).devices[0]
    assert device.attitude is not None
    np.testing.assert_allclose(device.attitude.values, walk.quaternion, atol=1e-12)
    assert any("inverted" in words for words in device.decisions)


def test_total_acceleration_is_preferred_and_used_as_it_is(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk)
    columns["TotalAcceleration"] = {**columns["Gravity"], **xyz(walk.force + 0.01)}
    np.testing.assert_allclose(force_of(read_folder(tmp_path, columns)).values, walk.force + 0.01, atol=1e-12)


def test_gravity_at_other_times_is_interpolated(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk)
    columns["Gravity"] = {name: np.asarray(values)[::2] for name, values in columns["Gravity"].items()}
    force = force_of(read_folder(tmp_path, columns)).values
    np.testing.assert_allclose(force[:-1], walk.force[:-1], atol=0.02)


def test_uncalibrated_in_g_replaces_what_is_missing_on_ios(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk, "ios")
    raw = {**columns["Gravity"], **xyz(-walk.force / STANDARD_GRAVITY_MPS2)}
    del columns["Accelerometer"], columns["Gravity"]
    columns["AccelerometerUncalibrated"] = raw
    recording = read_folder(tmp_path, columns)
    np.testing.assert_allclose(force_of(recording).values, walk.force, rtol=1e-12, atol=1e-12)
    assert any("in g" in words for words in recording.devices[0].decisions)


def test_total_acceleration_in_g_is_converted(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk)
    columns["TotalAcceleration"] = {**columns["Gravity"], **xyz(walk.force / STANDARD_GRAVITY_MPS2)}
    device = read_folder(tmp_path, columns).devices[0]
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=1e-9)
    assert any("is in g" in words for words in device.decisions)


@pytest.mark.parametrize("platform", ["android", "ios"])
def test_gravity_can_come_from_the_attitude(tmp_path: Path, walk: Walk, platform: str) -> None:
    columns = export(walk, platform)
    del columns["Gravity"]
    np.testing.assert_allclose(force_of(read_folder(tmp_path, columns)).values, walk.force, atol=1e-9)


def test_an_attitude_that_does_not_fit_the_gyroscope_adds_no_gravity(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk)
    del columns["Gravity"]
    columns["Gyroscope"] |= xyz(walk.rate[:, [1, 2, 0]])
    device = read_folder(tmp_path, columns).devices[0]
    assert device.specific_force is None
    assert device.linear_acceleration is not None
    assert any("gravity cannot be restored" in words for words in device.warnings)
    assert any("Accelerometer is without gravity" in words for words in device.warnings)


def test_a_sensor_without_rows_is_a_warning(tmp_path: Path, walk: Walk) -> None:
    files = {**sensor_logger_files(export(walk)), "Magnetometer.csv": b"", "Barometer.csv": b"time,pressure\n"}
    device = read(as_zip(tmp_path / "walk.zip", files)).devices[0]
    assert device.magnetic_field is None
    assert set(device.warnings) == {
        f"{name} is in the export but has no rows" for name in ("Magnetometer", "Barometer")
    }


def test_an_accelerometer_without_rows_is_an_error_if_nothing_replaces_it(tmp_path: Path, walk: Walk) -> None:
    files = {**sensor_logger_files(export(walk)), "Accelerometer.csv": b""}
    with pytest.raises(RecordingError, match=r"walk\.zip: Accelerometer has no rows and no other sensor"):
        read(as_zip(tmp_path / "walk.zip", files))
    replaced = {**files, "TotalAcceleration.csv": table({**export(walk)["Gravity"], **xyz(walk.force)})}
    np.testing.assert_allclose(force_of(read(as_zip(tmp_path / "other.zip", replaced))).values, walk.force)


def test_missing_accelerometer_and_missing_gyroscope_still_read(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk)
    only_rate = {name: columns[name] for name in ("Gyroscope", "Metadata")}
    device = read_folder(tmp_path / "rate", only_rate).devices[0]
    assert device.specific_force is None
    assert "no accelerometer in the export" in device.warnings
    only_force = {name: columns[name] for name in ("Accelerometer", "Gravity", "Metadata")}
    assert read_folder(tmp_path / "force", only_force).devices[0].rotation_rate is None


def test_no_motion_sensor_at_all_is_an_error(tmp_path: Path, walk: Walk) -> None:
    columns = {name: values for name, values in export(walk).items() if name in ("Gravity", "Orientation")}
    message = "neither accelerometer nor gyroscope has rows; found Gravity, Orientation"
    with pytest.raises(RecordingError, match=message):
        read_folder(tmp_path, columns)


def test_text_in_a_number_column_names_line_and_column(tmp_path: Path, walk: Walk) -> None:
    files = sensor_logger_files(export(walk))
    lines = files["Gyroscope.csv"].splitlines()
    lines[5] = lines[5].rsplit(b",", 1)[0] + b",oops"
    files["Gyroscope.csv"] = b"\n".join(lines)
    with pytest.raises(RecordingError, match=r"Gyroscope\.csv, line 6, column 'x': 'oops' is not a number"):
        read(as_folder(tmp_path, files))


def test_nan_rows_are_left_out_with_a_warning(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk)
    rate = np.asarray(columns["Gyroscope"]["x"]).copy()
    rate[3] = np.nan
    columns["Gyroscope"]["x"] = rate
    device = read_folder(tmp_path, columns).devices[0]
    assert device.rotation_rate is not None
    assert len(device.rotation_rate) == len(walk.time_s) - 1
    assert any("Gyroscope: 1 of" in words for words in device.warnings)


def test_a_table_without_time_is_refused(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk)
    columns["Barometer"] = {"pressure": [1013.0, 1013.1]}
    with pytest.raises(RecordingError, match=r"Barometer\.csv: no column 'time'"):
        read_folder(tmp_path, columns)


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda data: data[:-40], "damaged JSON"),
        (lambda data: data.replace(b'"sensor": "Gyroscope"', b'"sensor": 1', 1), "no sensor name"),
        (lambda data: data.replace(b'"x": "', b'"x": "x', 1), r"sensor Accelerometer, reading 1, 'x'"),
    ],
)
def test_damaged_json_is_refused(tmp_path: Path, walk: Walk, damage: Any, message: str) -> None:
    document = tmp_path / "walk.json"
    document.write_bytes(damage(sensor_logger_json(export(walk))))
    with pytest.raises(RecordingError, match=message):
        read(document)


def location(time_s: Array, shift_s: float = 0.0, accuracy: Sequence[float] | None = None) -> dict[str, Any]:
    """Fixes going north by 1e-5 degrees a second."""
    return {
        "time": list(START_NS + np.round((time_s + shift_s) * 1e9).astype(np.int64)),
        "horizontalAccuracy": [5.0] * len(time_s) if accuracy is None else accuracy,
        "longitude": [24.9] * len(time_s),
        "latitude": 60.2 + 1e-5 * time_s,
    }


def test_fixes_lie_around_the_first_valid_one(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk)
    times_s = np.array([-30.0, 0.5, 1.5, 2.5, 3.5, 900.0])
    columns["Location"] = location(times_s, accuracy=[5.0, -1.0, 8.0, 4.0, 0.2, 5.0])
    columns["Location"]["latitude"][4] = columns["Location"]["latitude"][3]
    recording = read_folder(tmp_path, columns)
    assert recording.origin is not None
    assert recording.origin.latitude_deg == pytest.approx(60.2 - 30e-5)
    assert [fix.time_s for fix in recording.fixes] == pytest.approx([1.5, 2.5, 3.5])
    assert [fix.covariance_m2[0, 0] for fix in recording.fixes] == pytest.approx([64.0, 16.0, 1.0])
    # One degree of latitude is 111.4 km at 60 degrees north.
    assert recording.fixes[1].position_m == pytest.approx([0.0, 32.5e-5 * 111_415], abs=0.05)
    assert all(fix.source == "gps" and fix.robust for fix in recording.fixes)
    assert any("1 of 6 fixes without a valid accuracy" in words for words in recording.devices[0].warnings)
    assert any(
        "2 of 5 fixes are left out because they were made before or after" in words
        for words in recording.devices[0].warnings
    )


STALE_S = 20_562.0


def test_a_stale_motion_clock_is_aligned_by_the_local_time_of_schema_2(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk, "ios", elapsed=False)
    begin = np.datetime64(START_NS, "ns") + np.timedelta64(int(STALE_S), "s")
    local = (begin + np.timedelta64(2, "h")).astype("datetime64[s]").item()
    columns["Metadata"] = {
        "version": ["2"],
        "device name": ["iPhone"],
        # The month counts from zero, and there is neither a time zone nor a fraction of the second.
        "recording time": [f"{local.year}-{local.month - 1:02d}-{local.day:02d}_{local:%H-%M-%S}"],
        "platform": ["ios"],
    }
    columns["Location"] = location(np.arange(0.5, 7.5), shift_s=STALE_S)
    recording = read_folder(tmp_path, columns)
    assert recording.epoch_s == pytest.approx(START_NS / 1e9 + STALE_S, abs=1.0)
    assert [fix.time_s for fix in recording.fixes] == pytest.approx(np.arange(0.5, 7.5), abs=1.0)
    assert any("stale" in words and "metadata" in words for words in recording.devices[0].warnings)


def test_a_stale_motion_clock_is_aligned_by_seconds_elapsed(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk, "ios")
    times_s = np.arange(0.5, 7.5)
    columns["Location"] = {**location(times_s, shift_s=STALE_S), "seconds_elapsed": times_s}
    recording = read_folder(tmp_path, columns)
    assert [fix.time_s for fix in recording.fixes] == pytest.approx(times_s)
    assert recording.epoch_s == pytest.approx(START_NS / 1e9 + STALE_S)
    assert any("seconds_elapsed" in words for words in recording.devices[0].warnings)


def test_a_stale_motion_clock_without_metadata_ends_with_the_last_fix(tmp_path: Path, walk: Walk) -> None:
    columns = sensor_logger_columns(walk, elapsed=False)
    columns["Location"] = location(np.arange(0.5, 7.5), shift_s=STALE_S)
    recording = read_folder(tmp_path, columns)
    assert recording.fixes[-1].time_s == pytest.approx(walk.time_s[-1])
    assert any("last fix" in words for words in recording.devices[0].warnings)


def test_annotations_and_pedometer_become_notes(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk)
    columns["Pedometer"] = {"time": [START_NS, START_NS + 10**9], "steps": [4, 15]}
    columns["Annotation"] = {
        "time": [START_NS + 2 * 10**9],
        "text": ["door, left"],
        "millisecond_press_duration": [3],
    }
    files = sensor_logger_files(columns)
    files["Annotation.csv"] = files["Annotation.csv"].replace(b"door, left", b'"door, left"')
    recording = read(as_folder(tmp_path, files))
    assert recording.notes == ("the phone's pedometer counted 15 steps", "2.00 s: door, left")


def test_pressure_becomes_pascal(tmp_path: Path, walk: Walk) -> None:
    columns = export(walk)
    columns["Barometer"] = {
        "time": [START_NS, START_NS + 10**9],
        "relativeAltitude": [0.0, 0.1],
        "pressure": [1013.0, 1014.0],
    }
    pressure = read_folder(tmp_path, columns).devices[0].pressure
    assert pressure is not None
    np.testing.assert_allclose(pressure.values[:, 0], [101_300.0, 101_400.0])


def test_a_folder_of_several_walks_is_refused(tmp_path: Path, walk: Walk) -> None:
    files = sensor_logger_files(export(walk))
    as_folder(tmp_path / "a", files)
    as_folder(tmp_path / "b", files)
    with pytest.raises(RecordingError, match=r"contains 2 Sensor Logger recordings \(a, b\)"):
        read(tmp_path)


def test_other_tables_are_not_taken_for_sensor_logger(tmp_path: Path) -> None:
    for content in (b"time,x,y,z\n0.01,1,2,3\n", b"time,acc\n1,2\n", b"[1, 2]", b"\x89PNG\r\n\x1a\n"):
        path = tmp_path / "file.csv"
        path.write_bytes(content)
        assert not sensor_logger.sniff(Source.open(path))


def test_real_recordings_are_physically_right(shared_data: Path) -> None:
    folders = sorted((shared_data / "sensor-logger").iterdir())
    assert folders
    for folder in folders:
        recording = read(folder)
        device = recording.devices[0]
        assert device.specific_force is not None
        assert device.rotation_rate is not None
        assert device.attitude is not None
        norm = np.median(np.linalg.norm(device.specific_force.values, axis=1))
        assert norm == pytest.approx(9.8, abs=0.4)
        up = up_in_device(device.attitude.values)
        level = (up * device.specific_force.values).sum(axis=1).mean()
        assert level == pytest.approx(9.8, abs=0.3)
        correlation = rotation_agreement(device.attitude, device.rotation_rate)
        assert correlation is not None
        assert correlation > 0.99
        assert recording.fixes
        assert recording.epoch_s is not None
        assert 1_610_478_000 < recording.epoch_s < 1_610_479_500
