"""phyphox exports of both platforms in all CSV variants give the same walk; pauses, fixes and damage."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fabricated import Walk, as_folder, as_zip, make_walk

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.formats.phone_apps.phyphox import reader as phyphox
from pdr_est.io.formats.registry import read
from pdr_est.io.text.container import Source

VARIANTS = [(",", "."), ("\t", "."), (";", "."), ("\t", ","), (";", ",")]
START_S = 1_698_501_144.401


def phyphox_table(columns: Mapping[str, Array | Sequence[Any]], separator: str = ",", decimal: str = ".") -> bytes:
    """A table as phyphox writes it: quoted titles, ten digits in scientific notation."""
    lines = [separator.join(f'"{title}"' for title in columns)]
    for row in zip(*columns.values(), strict=True):
        cells = [cell if isinstance(cell, str) else f"{cell:.9E}".replace(".", decimal) for cell in row]
        lines.append(separator.join(cells))
    return ("\n".join(lines) + "\n").encode()


def vector(walk: Walk, values: Array, titles: Sequence[str]) -> dict[str, Array]:
    return {"Time (s)": walk.time_s, **dict(zip(titles, values.T, strict=True))}


def titles(pattern: str, axes: str = "xyz") -> tuple[str, ...]:
    return tuple(pattern.format(axis) for axis in axes)


def android(walk: Walk) -> dict[str, dict[str, Any]]:
    absolute = {"Absolute acceleration (m/s^2)": np.linalg.norm(walk.force, axis=1)}
    w, x, y, z = walk.quaternion.T
    return {
        "Accelerometer.csv": {**vector(walk, walk.force, titles("Acceleration {} (m/s^2)")), **absolute},
        "Linear Acceleration.csv": vector(walk, walk.user, titles("Linear Acceleration {} (m/s^2)")),
        "Gravity.csv": vector(walk, walk.gravity, titles("Gravity {} (m/s^2)")),
        "Gyroscope.csv": vector(walk, walk.rate, titles("Gyroscope {} (rad/s)")),
        "Magnetometer.csv": vector(walk, walk.gravity, titles("Magnetic field {} (µT)")),
        "Orientation.csv": {"Time (s)": walk.time_s, "w": w, "x": x, "y": y, "z": z, "Yaw (°)": 0 * w},
        "Pressure.csv": {"Time (s)": walk.time_s, "Pressure (hPa)": 1013.0 + 0 * w},
    }


def ios(walk: Walk) -> dict[str, dict[str, Any]]:
    w, x, y, z = walk.quaternion.T
    return {
        "Accelerometer.csv": vector(walk, walk.force, titles("{} (m/s^2)", "XYZ")),
        "Linear Accelerometer.csv": vector(walk, walk.user, titles("{} (m/s^2)", "XYZ")),
        "Gravity.csv": vector(walk, walk.gravity, titles("Gravity {} (m/s^2)", "XYZ")),
        "Gyroscope.csv": vector(walk, walk.rate, titles("{} (rad/s)", "XYZ")),
        "Magnetometer.csv": vector(walk, walk.gravity, titles("{} (µT)", "XYZ")),
        "Orientation.csv": {"Time (s)": walk.time_s, "w": w, "x": x, "y": y, "z": z, "Yaw (°)": 0 * w},
        "Barometer.csv": {"Time (s)": walk.time_s, "X (hPa)": 1013.0 + 0 * w},
    }


def files(tables: Mapping[str, Mapping[str, Any]], separator: str = ",", decimal: str = ".") -> dict[str, bytes]:
    return {member: phyphox_table(columns, separator, decimal) for member, columns in tables.items()}


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk(duration_s=4.0)


def assert_is_walk(path: Path, walk: Walk, time_offset_s: float = 0.0) -> None:
    device = read(path).devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.attitude is not None
    assert device.magnetic_field is not None
    assert device.pressure is not None
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s + time_offset_s, atol=1e-8)
    np.testing.assert_allclose(device.specific_force.values, walk.force, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(device.attitude.values, walk.quaternion, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(device.magnetic_field.values, walk.gravity, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(device.pressure.values, 101_300.0)
    assert device.warnings == ()


@pytest.mark.parametrize("platform", [android, ios])
@pytest.mark.parametrize(("separator", "decimal"), VARIANTS)
def test_all_variants_give_the_same_walk(
    tmp_path: Path, walk: Walk, platform: Any, separator: str, decimal: str
) -> None:
    exported = files(platform(walk), separator, decimal)
    assert_is_walk(as_folder(tmp_path / "export", exported), walk)
    assert_is_walk(as_zip(tmp_path / "export.zip", exported), walk)


@pytest.mark.parametrize("platform", [android, ios])
def test_linear_acceleration_and_gravity_replace_the_accelerometer(tmp_path: Path, walk: Walk, platform: Any) -> None:
    tables = platform(walk)
    del tables["Accelerometer.csv"]
    assert_is_walk(as_folder(tmp_path, files(tables)), walk)


def test_linear_acceleration_alone_is_kept_for_steps(tmp_path: Path, walk: Walk) -> None:
    tables = android(walk)
    del tables["Accelerometer.csv"], tables["Gravity.csv"]
    restored = read(as_folder(tmp_path / "attitude", files(tables))).devices[0].specific_force
    assert restored is not None
    np.testing.assert_allclose(restored.values, walk.force, atol=1e-6)
    del tables["Orientation.csv"]
    device = read(as_folder(tmp_path / "alone", files(tables))).devices[0]
    assert device.specific_force is None
    assert device.linear_acceleration is not None
    assert device.linear_acceleration.values == pytest.approx(walk.user, abs=1e-8)
    assert "without gravity: steps can be counted" in device.warnings[0]


def test_a_stock_experiment_is_recognised_by_its_titles(tmp_path: Path, walk: Walk) -> None:
    for name, part in (("Accelerometer.csv", "specific_force"), ("Gyroscope.csv", "rotation_rate")):
        raw = {"Raw Data.csv": phyphox_table(android(walk)[name])}
        path = as_zip(tmp_path / f"{part}.zip", raw)
        device = read(path).devices[0]
        assert len(getattr(device, part)) == len(walk.time_s)
        assert [getattr(device, other) is None for other in ("specific_force", "rotation_rate")].count(True) == 1


def test_a_single_table_can_be_given(tmp_path: Path, walk: Walk) -> None:
    path = tmp_path / "Raw Data.csv"
    path.write_bytes(phyphox_table(android(walk)["Accelerometer.csv"]))
    device = read(path).devices[0]
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, rtol=1e-8, atol=1e-8)


META = {
    "meta/device.csv": b'"property","value"\n"deviceModel","Pixel 6"\n"deviceBrand","google"\n',
    "meta/time.csv": (
        b'"event","experiment time","system time","system time text"\n'
        b'"START",0.000000000E0,1698501144.401,"2023-10-28 14:12:24.401 UTC+02:00"\n'
        b'"PAUSE",4.000000000E0,1698501148.401,"2023-10-28 14:12:28.401 UTC+02:00"\n'
    ),
}


def test_metadata_name_the_phone_and_the_start(tmp_path: Path, walk: Walk) -> None:
    recording = read(as_zip(tmp_path / "walk.zip", {**files(android(walk)), **META}))
    assert (recording.name, recording.format) == ("walk", "phyphox")
    assert (recording.devices[0].model, recording.devices[0].platform) == ("google Pixel 6", "android")
    assert recording.epoch_s == pytest.approx(START_S)


def test_a_pause_becomes_a_gap(tmp_path: Path, walk: Walk) -> None:
    times = META["meta/time.csv"].replace(b"4.0000", b"1.5050").replace(b"48.401", b"45.906")
    times += b'"START",1.505000000E0,1698501155.906,"later"\n"PAUSE",4.0,1698501158.401,"end"\n'
    device = read(as_folder(tmp_path, {**files(android(walk)), "meta/time.csv": times})).devices[0]
    assert device.specific_force is not None
    expected = walk.time_s + np.where(walk.time_s >= 1.505, 10.0, 0.0)
    np.testing.assert_allclose(device.specific_force.time_s, expected, atol=1e-6)
    assert any("paused 1 times, for 10.0 s" in words for words in device.warnings)


def ios_location(walk: Walk) -> dict[str, Any]:
    n = 4
    return {
        "Time (s)": np.arange(n) + 0.25,
        "Latitude (°)": 43.5 + 1e-5 * np.arange(n),
        "Longitude (°)": np.full(n, 1.39),
        "Height (m)": np.full(n, 157.0),
        "Velocity (m/s)": np.full(n, -1.0),
        "Direction (°)": np.full(n, -1.0),
        "Horizontal Accuracy (m)": np.array([670.0, 35.0, -1.0, 22.0]),
        "Vertical Accuracy (°)": np.full(n, 10.0),  # the unit is a fault of the app
    }


def test_poor_fixes_keep_their_covariance_and_invalid_ones_are_left_out(tmp_path: Path, walk: Walk) -> None:
    recording = read(as_folder(tmp_path, files({**ios(walk), "Location.csv": ios_location(walk)})))
    assert [fix.time_s for fix in recording.fixes] == pytest.approx([0.25, 1.25, 3.25])
    assert [fix.covariance_m2[1, 1] for fix in recording.fixes] == pytest.approx([670.0**2, 35.0**2, 22.0**2])
    assert recording.fixes[2].position_m == pytest.approx([0.0, 3e-5 * 111_105], abs=0.05)
    assert recording.origin is not None
    assert recording.origin.longitude_deg == 1.39
    assert any("1 of 4 fixes without a valid accuracy" in words for words in recording.devices[0].warnings)


@pytest.mark.parametrize("filler", ["NaN", '""'])
def test_a_short_column_beside_a_long_one(tmp_path: Path, walk: Walk, filler: str) -> None:
    """In a user's own export set a slower sensor's columns end earlier and are filled up."""
    columns: dict[str, Any] = vector(walk, walk.force, titles("Acceleration {} (m/s^2)"))
    short = [*walk.rate[:300, 0], *[filler] * (len(walk.time_s) - 300)]
    columns |= {"Gyroscope x (rad/s)": short, "Gyroscope y (rad/s)": short, "Gyroscope z (rad/s)": short}
    device = read(as_folder(tmp_path, {"mine.csv": phyphox_table(columns)})).devices[0]
    assert device.rotation_rate is not None
    assert len(device.rotation_rate) == 300
    assert any("gyroscope: 100 of 400 rows" in words for words in device.warnings)


def test_an_empty_channel_in_a_good_zip_is_a_warning(tmp_path: Path, walk: Walk) -> None:
    exported = files(android(walk))
    exported["Magnetometer.csv"] = b""
    exported["Gyroscope.csv"] = exported["Gyroscope.csv"].splitlines(keepends=True)[0]
    device = read(as_zip(tmp_path / "walk.zip", exported)).devices[0]
    assert device.magnetic_field is None
    assert device.rotation_rate is None
    assert set(device.warnings) == {"Magnetometer.csv is empty", "gyroscope: Gyroscope.csv has no rows"}


def test_no_motion_sensor_is_an_error(tmp_path: Path, walk: Walk) -> None:
    tables = {"Pressure.csv": android(walk)["Pressure.csv"]}
    with pytest.raises(RecordingError, match="neither accelerometer nor gyroscope has rows; found pressure"):
        read(as_folder(tmp_path, files(tables)))


def test_text_in_a_number_column_names_line_and_column(tmp_path: Path, walk: Walk) -> None:
    exported = files(android(walk))
    lines = exported["Gyroscope.csv"].splitlines()
    lines[7] = b"0.06,1.0,two,3.0"
    exported["Gyroscope.csv"] = b"\n".join(lines)
    with pytest.raises(RecordingError, match=r"Gyroscope\.csv, line 8, column 'Gyroscope y \(rad/s\)': 'two'"):
        read(as_folder(tmp_path, exported))


def test_other_tables_are_not_taken_for_phyphox(tmp_path: Path) -> None:
    for content in (b'"Time (s)","Loudness (dB)"\n0.0,1.0\n', b"time_s,acc_x_mps2\n0,1\n"):
        path = tmp_path / "file.csv"
        path.write_bytes(content)
        assert not phyphox.sniff(Source.open(path))


def test_the_real_recording_is_physically_right(shared_data: Path) -> None:
    recording = read(shared_data / "phyphox/hallway-loop")
    device = recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert np.median(np.linalg.norm(device.specific_force.values, axis=1)) == pytest.approx(9.8, abs=0.2)
    assert device.specific_force.values.mean(axis=0)[2] > 9.0
    assert len(recording.fixes) == 35
    assert device.platform == "ios"
