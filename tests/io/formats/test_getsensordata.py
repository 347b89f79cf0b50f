"""GetSensorData logs: the two clocks, units and signs, surveyed points and GNSS fixes."""

from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.frames import up_in_device
from pdr_est.io import read
from pdr_est.types.recording import DeviceRecording, Recording
from pdr_est.types.sensors import AttitudeReference

BOOT_S = 65_000.0
HEADER = (
    "% LogFile created by the 'GetSensorData' App for Android.\n% Manufacturer:   \tsamsung\n% Model:   \tSM-A520F\n"
)
METRES_PER_DEGREE_NORTH = 111_251.0  # meridian at 49.5 degrees north


def sensor_rows(tag: str, values: str, n: int = 10, delay_s: float = 0.003) -> str:
    """Rows at 50 Hz that the app reads after a delay that jitters."""
    rows = ""
    for i in range(n):
        jitter_s = 0.004 if i % 3 == 1 else 0.0
        rows += f"{tag};{0.02 * i + delay_s + jitter_s:.4f};{BOOT_S + 0.02 * i:.4f};{values}\n"
    return rows


def walk(force: str = "0.0;9.81;0.0", magnetic: str = "1.0;2.0;3.0;0") -> str:
    """A phone held upright, device y upwards: rotation by 90 degrees about x."""
    half = np.sqrt(0.5)
    return (
        HEADER
        + sensor_rows("ACCE", f"{force};3")
        + sensor_rows("GYRO", "0.1;0.2;0.3;3")
        + sensor_rows("MAGN", magnetic)
        + sensor_rows("PRES", "976.2273;3", n=3)
        + sensor_rows("AHRS", f"90.0;0.0;0.0;{half:.8f};0.0;0.0;3")
        + "WIFI;0.6;65000.1;SSID;20:23:00:00:00:25;2412;-78\nWIFI;0.6;65000.1;SSID;20:23:00:00:00:25;-78\n"
    )


POINTS = "POSI;0.05;1;49.461;11.111;0;100\nPOSI;0.15;2;49.462;11.111;0;100\n"
GNSS = (
    "GNSS;0.02;1686729678.0;49.462;11.112;346.0;79.5;9.0;0.1;22;19\n"
    "GNSS;0.03;1686729678.0;49.462;11.112;346.0;79.5;9.0;0.1;22;19\n"
    "GNSS;1.02;1686729679.0;49.463;11.112;346.0;79.5;5.0;0.1;22;19\n"
)


def read_text(folder: Path, text: str) -> Recording:
    path = folder / "log.txt"
    path.write_text(text, encoding="utf-8")
    return read(path)


def force_of(device: DeviceRecording) -> np.ndarray:
    assert device.specific_force is not None
    return device.specific_force.values


def test_channels_and_header(tmp_path: Path) -> None:
    recording = read_text(tmp_path, walk())
    (device,) = recording.devices
    assert recording.format == "GetSensorData (IPIN)"
    assert (device.model, device.platform, device.warnings) == ("samsung SM-A520F", "android", ())
    assert device.rotation_rate is not None
    assert device.magnetic_field is not None
    assert device.pressure is not None
    assert device.attitude is not None
    assert device.attitude_reference is AttitudeReference.MAGNETIC_NORTH
    np.testing.assert_array_equal(force_of(device)[0], [0.0, 9.81, 0.0])
    np.testing.assert_array_equal(device.rotation_rate.values[9], [0.1, 0.2, 0.3])
    np.testing.assert_allclose(device.pressure.values[:, 0], 97_622.73)
    np.testing.assert_allclose(device.attitude.values[0], [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0], atol=1e-7)


def test_samples_have_the_sensor_clocks_spacing_on_the_app_clock(tmp_path: Path) -> None:
    device = read_text(tmp_path, walk()).devices[0]
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.time_s, 0.02 * np.arange(10) + 0.003, atol=1e-9)
    assert any("ACCE: times are SensorTimestamp + " in decision for decision in device.decisions)


def test_a_sensor_clock_that_does_not_keep_pace_is_not_used(tmp_path: Path) -> None:
    broken = "".join(f"GYRO;{0.02 * i:.3f};{i:.1f};0.1;0.2;0.3;3\n" for i in range(100))
    text = "".join(line for line in walk().splitlines(True) if not line.startswith("GYRO")) + broken
    device = read_text(tmp_path, text).devices[0]
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.rotation_rate.time_s, 0.02 * np.arange(100))
    assert any(decision.startswith("GYRO: times are AppTimestamp, because") for decision in device.decisions)


def test_the_documented_empty_magnetometer_field(tmp_path: Path) -> None:
    device = read_text(tmp_path, walk(magnetic="1.0;;2.0;3.0;0")).devices[0]
    assert device.magnetic_field is not None
    np.testing.assert_array_equal(device.magnetic_field.values[0], [1.0, 2.0, 3.0])


def test_acceleration_in_g_with_apples_sign(tmp_path: Path) -> None:
    device = read_text(tmp_path, walk(force="0.0;-1.0;0.0")).devices[0]
    np.testing.assert_allclose(force_of(device)[0], [0.0, 9.80665, 0.0])
    assert device.platform == "ios"
    assert device.attitude_reference is AttitudeReference.UNKNOWN
    assert any("in g" in decision for decision in device.decisions)


def test_surveyed_points_are_truth_about_the_first_of_them(tmp_path: Path) -> None:
    recording = read_text(tmp_path, walk() + POINTS + "POSI;0.19;3;49.462;11.111;-2;100\n")
    truth = recording.truth.positions
    assert truth is not None
    assert recording.origin is not None
    assert (recording.origin.latitude_deg, recording.origin.longitude_deg) == (49.461, 11.111)
    assert truth.source == "surveyed points"
    np.testing.assert_array_equal(truth.time_s, [0.05, 0.15, 0.19])
    np.testing.assert_allclose(truth.position_m[:2], [[0.0, 0.0], [0.0, 0.001 * METRES_PER_DEGREE_NORTH]], atol=0.05)
    assert any("floors 0, -2" in note for note in recording.notes)


def test_an_incomplete_surveyed_point_is_left_out_and_reported(tmp_path: Path) -> None:
    recording = read_text(tmp_path, walk() + POINTS + "POSI;0.19;3;;11.111;0;100\n")
    assert recording.truth.positions is not None
    assert len(recording.truth.positions.time_s) == 2
    assert recording.notes == ("1 of 3 surveyed points are incomplete and are left out",)


@pytest.mark.parametrize("place", ["0;0", "91;11.111", "49.461;181"])
@pytest.mark.parametrize("time_s", [0.01, 0.19])
def test_a_surveyed_point_without_a_possible_place_is_left_out_and_reported(
    tmp_path: Path, place: str, time_s: float
) -> None:
    bad = f"POSI;{time_s};3;{place};0;100\n"
    recording = read_text(tmp_path, walk() + (bad + POINTS if time_s < 0.05 else POINTS + bad))
    assert recording.truth.positions is not None
    assert len(recording.truth.positions.time_s) == 2
    assert recording.origin is not None
    assert recording.origin.latitude_deg == 49.461
    assert "1 of 3 surveyed points have no possible latitude and longitude" in recording.notes[0]


def test_gnss_rows_are_fixes_in_the_frame_of_the_truth(tmp_path: Path) -> None:
    recording = read_text(tmp_path, walk() + POINTS + GNSS)
    first, second = recording.fixes
    assert (first.source, first.robust, first.time_s, second.time_s) == ("gps", True, 0.02, 1.02)
    np.testing.assert_array_equal(first.covariance_m2, 81.0 * np.eye(2))
    east_m = 0.001 * METRES_PER_DEGREE_NORTH * np.cos(np.radians(49.462)) * 1.00167  # the ellipsoid's wider parallel
    np.testing.assert_allclose(first.position_m, [east_m, 0.001 * METRES_PER_DEGREE_NORTH], atol=0.3)
    np.testing.assert_allclose(second.position_m - first.position_m, [0.0, 111.25], atol=0.05)
    assert recording.epoch_s == pytest.approx(1_686_729_678.0, abs=0.1)
    assert any("1 of 3 fixes that repeat the previous one are left out" in note for note in recording.notes)


def test_rows_on_another_clock_come_from_the_network(tmp_path: Path) -> None:
    of_network = "GNSS;2.31;1686729661.4;49.464;11.112;0.0;0.0;748.0;0.0;22;19\n"
    recording = read_text(tmp_path, walk() + POINTS + GNSS + of_network)
    assert [fix.source for fix in recording.fixes] == ["gps", "gps", "network"]


def test_without_surveyed_points_the_first_fix_is_the_origin(tmp_path: Path) -> None:
    recording = read_text(tmp_path, walk() + GNSS)
    assert recording.truth.positions is None
    assert recording.origin is not None
    assert recording.origin.latitude_deg == 49.462
    np.testing.assert_allclose(recording.fixes[0].position_m, [0.0, 0.0], atol=1e-9)


def test_neither_points_nor_fixes(tmp_path: Path) -> None:
    recording = read_text(tmp_path, walk())
    assert (recording.origin, recording.fixes, recording.epoch_s) == (None, (), None)


def test_no_accelerometer_and_no_gyroscope(tmp_path: Path) -> None:
    lines = walk().splitlines(True)
    with pytest.raises(RecordingError, match=r"log\.txt: no accelerometer \(ACCE\) rows"):
        read_text(tmp_path, "".join(line for line in lines if not line.startswith("ACCE")))
    recording = read_text(tmp_path, "".join(line for line in lines if not line.startswith("GYRO")))
    assert recording.devices[0].warnings == ("no gyroscope (GYRO) rows: steps can be found, but headings cannot",)


def test_bad_values(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"log\.txt, line 14, GYRO: 'x' is not a number"):
        read_text(tmp_path, walk().replace("0.1;0.2;0.3", "0.1;x;0.3", 1))
    device = read_text(tmp_path, walk().replace("0.1;0.2;0.3", "0.1;inf;0.3", 1)).devices[0]
    assert device.warnings == ("GYRO: 1 of 10 rows are left out: NaN or infinite values",)


def test_real_walks(shared_data: Path) -> None:
    paths = sorted((shared_data / "ipin2023").glob("*.txt*"))
    assert paths
    for path in paths[::3]:
        recording = read(path)
        (device,) = recording.devices
        assert recording.truth.positions is not None
        assert device.attitude is not None
        assert device.rotation_rate is not None
        assert device.specific_force is not None
        assert device.warnings == ()
        assert len(recording.fixes) > 20
        assert np.diff(device.rotation_rate.time_s).max() < 0.1
        up = up_in_device(device.attitude.values)
        assert (up * device.specific_force.values[: len(up)]).sum(1).mean() == pytest.approx(9.8, abs=0.5)
