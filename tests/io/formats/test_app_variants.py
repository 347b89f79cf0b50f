"""Exports of apps and devices in other languages, versions and selections than those of the other tests."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from table_layouts import DEG, UNIX_NS, G, ticks
from table_walk import TableWalk, dates, rows, table_walk, xyz

from pdr_est.io import read

Files = Mapping[str, Sequence[str]]


@pytest.fixture(scope="module")
def walk() -> TableWalk:
    return table_walk()


def in_german(columns: Mapping[str, Any]) -> list[str]:
    return rows(columns, ";", ",")


def androsensor(walk: TableWalk) -> Files:
    columns = {
        **xyz("GYROSCOPE {} (rad/s)", walk.rate, "XYZ"),
        **xyz("GRAVITY {} (m/s²)", walk.gravity, "XYZ"),
        **xyz("LINEAR ACCELERATION {} (m/s²)", walk.user, "XYZ"),
        "ORIENTATION Z (azimuth °)": np.full(len(walk.time_s), 3.0),
        "Time since start in ms ": ticks(walk, 1000, 13),
        "YYYY-MO-DD HH-MI-SS_SSS": dates(walk.time_s, "{y}-{m}-{d} {H}:{M}:{S}:{ms}"),
    }
    return {"Sensor_record.csv": in_german(columns)}


def physics_toolbox(walk: TableWalk) -> Files:
    columns = {"time": walk.time_s, **xyz("gF{}", walk.force / G), "TgF": walk.time_s, **xyz("w{}", walk.rate)}
    return {"walk.csv": in_german(columns)}


def sensorlog_without_units(walk: TableWalk) -> Files:
    columns = {
        "loggingTime": dates(walk.time_s, "{y}-{m}-{d}T{H}:{M}:{S}.{ms}+02:00"),
        "motionTimestamp_sinceReboot": np.round(walk.time_s + 12.0, 3),
        **xyz("motionRotationRate{}", walk.rate, "XYZ"),
        **xyz("motionUserAcceleration{}", -walk.user / G, "XYZ"),
        **xyz("motionGravity{}", -walk.gravity / G, "XYZ"),
    }
    return {"walk.csv": in_german(columns)}


def sensorlog_of_old(walk: TableWalk) -> Files:
    columns = {
        "loggingTime(txt)": dates(walk.time_s, "{y}-{m}-{d}T{H}:{M}:{S}.{ms}+02:00"),
        "loggingSample(N)": range(len(walk.time_s)),
        **xyz("accelerometerAcceleration{}(G)", -walk.force / G, "XYZ"),
        **xyz("gyroRotation{}(rad/s)", walk.rate, "XYZ"),
    }
    return {"walk.csv": rows(columns)}


def sensor_logger_uncalibrated(walk: TableWalk) -> Files:
    clock = {"time": ticks(walk, 10**9, UNIX_NS), "seconds_elapsed": walk.time_s}
    return {
        "AccelerometerUncalibrated.csv": rows({**clock, **xyz("{}", walk.force[:, ::-1], "zyx")}),
        "GyroscopeUncalibrated.csv": rows({**clock, **xyz("{}", walk.rate[:, ::-1], "zyx")}),
        "Metadata.csv": ["version,device name,recording time,platform", "3,Pixel,2031-01-24_04-53-20,android"],
    }


def sensor_logger_combined(walk: TableWalk) -> Files:
    clock = {"time": ticks(walk, 10**9, UNIX_NS), "seconds_elapsed": walk.time_s}
    sensors = {
        **xyz("accelerometer_{}", walk.user),
        **xyz("gravity_{}", walk.gravity),
        **xyz("gyroscope_{}", walk.rate),
    }
    return {"walk.csv": rows({**clock, **sensors})}


def matlab_in_german(walk: TableWalk) -> Files:
    stamps = dates(walk.time_s, "{d}-Mär-{y} {H}:{M}:{S}.{ms}")
    return {
        "Acceleration.csv": rows({"Timestamp": stamps, **xyz("{}", walk.force, "XYZ")}),
        "AngularVelocity.csv": rows({"Timestamp": stamps, **xyz("{}", walk.rate, "XYZ")}),
    }


def gnss_logger_with_accuracy(walk: TableWalk) -> Files:
    bias = (0.1, 0.2, 0.3)
    lines = ["# Version: v3.1.0.4 Platform: 14", "# Raw,utcTimeMillis,TimeNanos", "# Fix,Provider,LatitudeDegrees"]
    for unix_ms, boot, force, rate in zip(
        ticks(walk, 1000, UNIX_NS // 10**6), ticks(walk, 10**9, 65_972 * 10**9), walk.force, walk.rate, strict=True
    ):
        for tag, values in (("UncalAccel", force), ("UncalGyro", rate)):
            lines.append(",".join(map(str, (tag, unix_ms, boot, *(values + bias), *bias, 3))))
    return {"gnss_log.txt": lines}


def hyperimu_with_names_of_makers(walk: TableWalk) -> Files:
    columns = {
        "timestamp": ticks(walk, 1000, UNIX_NS // 10**6),
        **xyz("LSM6DSO Gyroscope Uncalibrated.{}", walk.rate + 0.1),
        **xyz("LSM6DSO Accelerometer Non-wakeup.{}", walk.force),
        **xyz("LSM6DSO Gyroscope Non-wakeup.{}", walk.rate),
    }
    return {"HIMU.csv": ["@ HyperIMU - ianovir", "@ Sampling Time: 20ms", "", *rows(columns)]}


def xsens_of_a_spreadsheet(walk: TableWalk) -> Files:
    columns = {
        "PacketCounter": range(len(walk.time_s)),
        "SampleTimeFine": ticks(walk, 10**6, 3 * 10**9),
        **xyz("FreeAcc_{}", walk.user, "XYZ"),
        **xyz("Acc_{}", walk.force, "XYZ"),
        **xyz("Gyr_{}", walk.rate / DEG, "XYZ"),
    }
    return {"dot.csv": ["DeviceTag:;left", *in_german(columns)]}


def shimmer_wide_range(walk: TableWalk) -> Files:
    titles = ["Timestamp_Unix", *(f"{sensor}_{axis}" for sensor in ("Accel_WR", "Gyro") for axis in "XYZ")]
    columns = {"t": ticks(walk, 1000, UNIX_NS // 10**6), **xyz("a{}", walk.force), **xyz("g{}", walk.rate / DEG)}
    above = ['"sep=\t"', "\t".join(f"Shimmer_8E3A_{title}_CAL" for title in titles)]
    return {"s.csv": [*above, "\t".join(["ms", *["m/(s^2)"] * 3, *["deg/s"] * 3]), *rows(columns, "\t")[1:]]}


def ngimu(walk: TableWalk) -> Files:
    clock = {"Time (s)": walk.time_s}
    motion = {
        **xyz("Gyroscope {} (deg/s)", walk.rate / DEG, "XYZ"),
        **xyz("Accelerometer {} (g)", walk.force / G, "XYZ"),
    }
    return {
        "sensors.csv": rows({**clock, **motion, **xyz("Magnetometer {} (uT)", walk.field, "XYZ")}),
        "magnetometer.csv": rows({**clock, **xyz("Magnetometer {} (uT)", walk.field, "XYZ")}),
        "battery.csv": rows({**clock, "Percentage (%)": walk.time_s}),
    }


def plotjuggler(walk: TableWalk) -> Files:
    stamps = [f"{1_900_000_000 + t:.3f}" for t in walk.time_s]
    sensors = {**xyz("/imu/linear_acceleration/{}", walk.force), **xyz("/imu/angular_velocity/{}", walk.rate)}
    return {"bag.csv": rows({"__time": stamps, **sensors})}


def ros_2(walk: TableWalk) -> Files:
    stamps = ticks(walk, 10**9, UNIX_NS + 123_456_789)
    clock = {"stamp_sec": [s // 10**9 for s in stamps], "stamp_nanosec": [s % 10**9 for s in stamps]}
    return {
        "imu.csv": rows(
            {**clock, **xyz("angular_velocity_{}", walk.rate), **xyz("linear_acceleration_{}", walk.force)}
        )
    }


def apple_watch(walk: TableWalk) -> Files:
    columns = {
        "timestamp": [f"{1_900_000_000 + t:.3f}" for t in walk.time_s],
        **xyz("rotation_rate_{}", walk.rate),
        **xyz("user_acceleration_{}", -walk.user / G),
        **xyz("gravity_{}", -walk.gravity / G),
    }
    return {"watch.csv": rows(columns)}


def sensor_record_with_semicolons(walk: TableWalk) -> Files:
    clock = {"Timestamp": dates(walk.time_s, "{y}-{m}-{d} {H}:{M}:{S}"), "Milliseconds": ticks(walk, 1000, 1)}
    return {
        "Accelerometer.csv": rows({**clock, **xyz("{}", walk.force, "XYZ")}, ";"),
        "Gyroscope.csv": rows({**clock, **xyz("{}", walk.rate, "XYZ")}, ";"),
    }


def phyphox_in_german(walk: TableWalk) -> Files:
    clock = {"Zeit (s)": walk.time_s}
    return {
        "Beschleunigung.csv": in_german({**clock, **xyz("Beschleunigung {} (m/s^2)", walk.force)}),
        "Gyroskop.csv": in_german({**clock, **xyz("Gyroskop {} (rad/s)", walk.rate)}),
    }


VARIANTS: Mapping[Callable[[TableWalk], Files], str] = {
    androsensor: "AndroSensor",
    physics_toolbox: "Physics Toolbox",
    sensorlog_without_units: "SensorLog",
    sensorlog_of_old: "SensorLog",
    sensor_logger_uncalibrated: "Sensor Logger",
    sensor_logger_combined: "Sensor Logger",
    matlab_in_german: "MATLAB Mobile",
    gnss_logger_with_accuracy: "GnssLogger",
    hyperimu_with_names_of_makers: "HyperIMU",
    xsens_of_a_spreadsheet: "Xsens, Movella",
    shimmer_wide_range: "Shimmer",
    ngimu: "x-io",
    plotjuggler: "ROS Imu messages",
    ros_2: "ROS Imu messages",
    apple_watch: "Core Motion table",
    sensor_record_with_semicolons: "Sensor Record",
    phyphox_in_german: "one file a sensor",
}


@pytest.mark.parametrize("variant", VARIANTS, ids=lambda variant: variant.__name__)
def test_the_walk_is_read(tmp_path: Path, walk: TableWalk, variant: Callable[[TableWalk], Files]) -> None:
    files = variant(walk)
    for name, lines in files.items():
        (tmp_path / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
    recording = read(tmp_path / next(iter(files)) if len(files) == 1 else tmp_path)
    assert recording.format == VARIANTS[variant]
    (device,) = recording.devices
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=1e-4)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, atol=1e-4)
    np.testing.assert_allclose(device.rotation_rate.time_s - device.rotation_rate.time_s[0], walk.time_s, atol=2e-3)
    assert [words for words in device.warnings if "sign of the acceleration" not in words] == []
