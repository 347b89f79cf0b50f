"""Logs that mix the rows of many sensors: GnssLogger and FlySight, and the header-less rows of WISDM."""

from pathlib import Path

import numpy as np
import pytest
from app_exports import DEGREE, ns, plain_rows
from fabricated import START_NS, Walk, make_walk

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.io import read

GNSS_FIELDS = {
    "Raw": "TimeNanos,LeapSecond",
    "UncalAccel": "UncalAccelXMps2,UncalAccelYMps2,UncalAccelZMps2,BiasXMps2,BiasYMps2,BiasZMps2",
    "UncalGyro": "UncalGyroXRadPerSec,UncalGyroYRadPerSec,UncalGyroZRadPerSec,DriftXRadPerSec,DriftYRadPerSec,"
    "DriftZRadPerSec",
    "Accel": "AccelXMps2,AccelYMps2,AccelZMps2",
    "OrientationDeg": "yawDeg,rollDeg,pitchDeg",
}
GNSS_FIX = "Provider,LatitudeDegrees,LongitudeDegrees,AltitudeMeters,SpeedMps,AccuracyMeters,BearingDegrees,"
GNSS_HEADER = "".join(
    [
        "#\n# Header Description:\n# Version: v3.0.0.1 Platform: 12 Manufacturer: acme Model: A1\n#\n",
        *(f"# {tag},utcTimeMillis,elapsedRealtimeNanos,{fields}\n" for tag, fields in GNSS_FIELDS.items()),
        f"# Fix,{GNSS_FIX}UnixTimeMillis,MockLocation\n#\n",
    ]
)


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk(duration_s=6.0)


def gnss_log(walk: Walk, calibrated: bool) -> str:
    bias = np.array([0.01, -0.02, 0.03])
    unix_ms = [START_NS // 10**6 + round(1e3 * t) for t in walk.time_s]
    lines = []
    for i, (u, n) in enumerate(zip(unix_ms, ns(walk), strict=True)):
        force, rate = walk.force[i], walk.rate[i] + bias
        if calibrated:
            lines.append(f"Accel,{u},{n},{force[0]},{force[1]},{force[2]}")
        shifted = ",".join(map(str, (*(force + bias), *bias)))
        lines.append(f"UncalAccel,{u},{n},{shifted}")
        lines.append(f"UncalGyro,{u},{n},{','.join(map(str, (*rate, *bias)))}")
        if i % 100 == 0:
            lines += [f"Fix,{p},{12.3 + 1e-6 * i},-34.5,7,1.2,4.0,0,{u},0" for p in ("GPS", "FLP")]
            lines.append(f"Raw,{u},1,18")
    return GNSS_HEADER + "\n".join(lines) + "\n"


@pytest.mark.parametrize("calibrated", [True, False])
def test_gnss_logger_gives_the_walk_on_the_boot_clock(tmp_path: Path, walk: Walk, calibrated: bool) -> None:
    (tmp_path / "gnss_log.txt").write_text(gnss_log(walk, calibrated))
    recording = read(tmp_path / "gnss_log.txt")
    assert recording.format == "GnssLogger"
    device = recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.specific_force.time_s == pytest.approx(walk.time_s, abs=1e-6)
    assert device.specific_force.values == pytest.approx(walk.force, abs=1e-6)
    assert device.rotation_rate.values == pytest.approx(walk.rate, abs=1e-6)
    assert recording.epoch_s == pytest.approx(START_NS / 1e9, abs=1e-3)
    assert [round(fix.time_s) for fix in recording.fixes] == [0, 1, 2, 3, 4, 5]
    assert any("6 fixes of the fused provider are left out" in warning for warning in device.warnings)
    assert any("rows not used" in decision and "Raw" in decision for decision in device.decisions)


def test_gnss_logger_without_motion_says_what_to_switch_on(tmp_path: Path) -> None:
    (tmp_path / "log.txt").write_text(GNSS_HEADER + "Fix,GPS,12.3,-34.5,7,1.2,4.0,0,1718030736000,0\n")
    with pytest.raises(RecordingError, match="neither accelerometer nor gyroscope rows; switch on Sensors"):
        read(tmp_path / "log.txt")


@pytest.mark.parametrize("marked", [True, False])
def test_flysight_takes_the_units_of_its_header(tmp_path: Path, walk: Walk, marked: bool) -> None:
    column, unit, row = ("$COL,", "$UNIT,", "$") if marked else ("", "", "")
    header = [
        "$FLYS,1" if marked else "FIRMWARE_VER,v1",
        f"{column}BARO,time,pressure,temperature",
        f"{unit}BARO,s,Pa,deg C",
        f"{column}IMU,time,wx,wy,wz,ax,ay,az,temperature",
        f"{unit}IMU,s,deg/s,deg/s,deg/s,g,g,g,deg C",
        f"{column}TIME,time,tow,week",
        f"{unit}TIME,s,s,",
        "$DATA",
        f"{row}TIME,59970.0,100.0,2300",
    ]
    rates, forces = walk.rate / DEGREE, walk.force / STANDARD_GRAVITY_MPS2
    rows = [
        f"{row}IMU,{59970.0 + t},{','.join(map(str, (*rate, *force)))},25.2"
        for t, rate, force in zip(walk.time_s, rates, forces, strict=True)
    ]
    rows.insert(5, f"{row}BARO,59970.3,98765.0,25.0")
    (tmp_path / "SENSOR.CSV").write_text("\n".join([*header, *rows]) + "\n")
    recording = read(tmp_path / "SENSOR.CSV")
    device = recording.devices[0]
    assert recording.format == "FlySight"
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.pressure is not None
    assert device.specific_force.time_s == pytest.approx(walk.time_s, abs=1e-6)
    assert device.specific_force.values == pytest.approx(walk.force, abs=1e-6)
    assert device.rotation_rate.values == pytest.approx(walk.rate, abs=1e-6)
    assert recording.epoch_s == pytest.approx(315_964_800 + 2300 * 604_800 + 100 - 18)


def wisdm(walk: Walk, values: np.ndarray[tuple[int, int], np.dtype[np.float64]], activity: str = "Walking") -> bytes:
    n = len(walk.time_s)
    rows = plain_rows(["33"] * n, [activity] * n, ns(walk), *values.T)
    return rows.replace(b"\n", b";\n")


def test_wisdm_is_an_accelerometer_with_its_activity(tmp_path: Path, walk: Walk) -> None:
    (tmp_path / "raw.txt").write_bytes(wisdm(walk, walk.force))
    recording = read(tmp_path / "raw.txt")
    device = recording.devices[0]
    assert recording.format == "WISDM"
    assert recording.truth.activity == "walking"
    assert device.specific_force is not None
    assert device.specific_force.values == pytest.approx(walk.force, abs=1e-6)
    assert device.specific_force.time_s == pytest.approx(walk.time_s, abs=1e-6)


def test_wisdm_has_the_gyroscope_in_another_file(tmp_path: Path, walk: Walk) -> None:
    (tmp_path / "data_1600_accel_phone.txt").write_bytes(wisdm(walk, walk.force, "A"))
    (tmp_path / "data_1600_gyro_phone.txt").write_bytes(wisdm(walk, walk.rate, "A"))
    device = read(tmp_path).devices[0]
    assert device.rotation_rate is not None
    assert device.rotation_rate.values == pytest.approx(walk.rate, abs=1e-6)


def test_wisdm_of_several_activities_is_refused(tmp_path: Path, walk: Walk) -> None:
    (tmp_path / "raw.txt").write_bytes(wisdm(walk, walk.force) + wisdm(walk, walk.force, "Jogging"))
    with pytest.raises(RecordingError, match=r"2 people and activities \(33 Walking, 33 Jogging, …\); cut out"):
        read(tmp_path / "raw.txt")
