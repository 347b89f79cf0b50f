"""The made-up walk of `fabricated`, as tables of apps and devices that are known by name."""

from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
from fabricated import START_NS, Walk, table, xyz

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array

BOOT_NS = 65_972_053_803_181
DEGREE = np.pi / 180.0

Columns = Mapping[str, Sequence[Any] | Array]
Files = dict[str, bytes]


def dates(walk: Walk, form: str) -> list[str]:
    """Times of the rows as local dates; %f is cut to milliseconds."""
    start = datetime(2031, 2, 3, 4, 5, 6, 789_000, tzinfo=UTC)
    return [
        (start + timedelta(seconds=float(t))).strftime(form).replace("%L", f"{(789 + round(t * 1e3)) % 1000:03d}")
        for t in walk.time_s
    ]


def ns(walk: Walk, start: int = BOOT_NS) -> list[int]:
    return [start + round(t * 1e9) for t in walk.time_s]


def plain_rows(*columns: Sequence[Any] | Array, separator: str = ",") -> bytes:
    """Rows without a header."""
    return "".join(separator.join(map(str, row)) + "\n" for row in zip(*columns, strict=True)).encode()


def titled(pattern: str, values: Array, axes: str = "XYZ") -> dict[str, Array]:
    return xyz(values, [pattern.format(axis) for axis in axes])


def androsensor(walk: Walk) -> Files:
    columns: Columns = {
        **titled("ACCELEROMETER {} (m/s²)", walk.force),
        **titled("GRAVITY {} (m/s²)", walk.gravity),
        **titled("LINEAR ACCELERATION {} (m/s²)", walk.user),
        **titled("GYROSCOPE {} (rad/s)", walk.rate),
        "ORIENTATION Z (azimuth °)": 0.0 * walk.time_s,
        "LOCATION Latitude : ": 12.3 + 1e-6 * walk.time_s,
        "LOCATION Longitude : ": -34.5 + 0.0 * walk.time_s,
        "LOCATION Accuracy ( m)": 4.0 + 0.0 * walk.time_s,
        "Time since start in ms ": [round(13 + 1e3 * t) for t in walk.time_s],
        "YYYY-MO-DD HH-MI-SS_SSS": dates(walk, "%Y-%m-%d %H:%M:%S:%L"),
    }
    return {"Sensor_record.csv": table(columns)}


def physics_toolbox(walk: Walk) -> Files:
    columns = {
        "time": walk.time_s,
        **titled("gF{}", walk.force / STANDARD_GRAVITY_MPS2, "xyz"),
        **titled("a{}", walk.user, "xyz"),
        **titled("w{}", walk.rate, "xyz"),
    }
    return {"walk.csv": b"\n" + table(columns).replace(b"\n", b",\n")}


def physics_toolbox_ios(walk: Walk) -> Files:
    columns = {
        "time": [text.replace(" 0", " ") + "0" for text in dates(walk, "%Y-%m-%d %H:%M:%S.%L")],
        **titled("gF{}", -walk.force / STANDARD_GRAVITY_MPS2, "xyz"),
        **titled("w{}", walk.rate, "xyz"),
    }
    return {"walk.csv": table(columns)}


def sensorlog(walk: Walk) -> Files:
    w, x, y, z = walk.quaternion.T
    columns = {
        "loggingTime(txt)": [f"{text}+01:00" for text in dates(walk, "%Y-%m-%dT%H:%M:%S.%L")],
        "locationLatitude(WGS84)": 12.3 + 0.0 * walk.time_s,
        "locationLongitude(WGS84)": -34.5 + 0.0 * walk.time_s,
        "locationHorizontalAccuracy(m)": 5.0 + 0.0 * walk.time_s,
        "accelerometerTimestamp_sinceReboot(s)": 1234.5 + walk.time_s,
        **titled("accelerometerAcceleration{}(G)", -walk.force / STANDARD_GRAVITY_MPS2),
        "motionTimestamp_sinceReboot(s)": 1234.501 + walk.time_s,
        **titled("motionRotationRate{}(rad/s)", walk.rate),
        **titled("motionUserAcceleration{}(G)", -walk.user / STANDARD_GRAVITY_MPS2),
        "motionAttitudeReferenceFrame(txt)": ["XArbitraryZVertical"] * len(w),
        **{f"motionQuaternion{axis}(R)": values for axis, values in zip("XYZW", (x, y, z, w), strict=True)},
        **titled("motionGravity{}(G)", -walk.gravity / STANDARD_GRAVITY_MPS2),
        "label": ["N/A"] * len(w),
    }
    return {"my iPhone_2031-02-03.csv": table(columns)}


def sensorlog_without_raw(walk: Walk) -> Files:
    """Core Motion's gravity and user acceleration only."""
    lines = sensorlog(walk)["my iPhone_2031-02-03.csv"].decode().splitlines()
    kept = [i for i, title in enumerate(lines[0].split(",")) if not title.startswith("accelerometer")]
    rows = (line.split(",") for line in lines)
    return {"log.csv": "".join(",".join(row[i] for i in kept) + "\n" for row in rows).encode()}


def hyperimu(walk: Walk) -> Files:
    columns = {
        "timestamp": [START_NS // 10**6 + round(t * 1e3) for t in walk.time_s],
        **titled("MPL_Gyroscope.{}", walk.rate, "xyz"),
        **titled("MPL_Accelerometer.{}", walk.force, "xyz"),
        **titled("MPL_Linear_Acceleration.{}", walk.user, "xyz"),
    }
    return {"HIMU.csv": b"@ HyperIMU - ianovir - 2017\n@ Date: Sat, Sampling Time: 10ms\n\n" + table(columns)}


def hyperimu_without_time(walk: Walk) -> Files:
    lines = hyperimu(walk)["HIMU.csv"].decode().split("\n")
    return {"HIMU.csv": "\n".join([*lines[:3], *(line.partition(",")[2] for line in lines[3:])]).encode()}


def core_motion(walk: Walk) -> Files:
    columns = {
        "timestamp": walk.time_s,
        **titled("userAcceleration.{}", -walk.user / STANDARD_GRAVITY_MPS2, "xyz"),
        **titled("gravity.{}", -walk.gravity / STANDARD_GRAVITY_MPS2, "xyz"),
        **titled("rotationRate.{}", walk.rate, "xyz"),
    }
    return {"watch.csv": table(columns)}


def xsens_dot(walk: Walk) -> Files:
    columns = {
        "PacketCounter": list(range(len(walk.time_s))),
        "SampleTimeFine": [3_000_000_000 + round(t * 1e6) for t in walk.time_s],
        **titled("Euler_{}", 0.0 * walk.force),
        **titled("FreeAcc_{}", walk.user),
        **titled("Acc_{}", walk.force),
        **titled("Gyr_{}", walk.rate / DEGREE),
    }
    return {"dot.csv": b"sep=,\nDeviceTag:,DOT A\nFirmwareVersion:,2.0.0\nOutputRate:,100Hz\n\n" + table(columns)}


def mt_manager(walk: Walk) -> Files:
    columns = {
        "PacketCounter": list(range(7, 7 + len(walk.time_s))),
        "SampleTimeFine": [""] * len(walk.time_s),
        **titled("Acc_{}", walk.force),
        **titled("Gyr_{}", walk.rate),
        **{f"Quat_q{i}": values for i, values in enumerate(walk.quaternion.T)},
    }
    preamble = b"// General information:\n//  MT Manager version: 2019.1\n// Update Rate: 100.0Hz\n"
    return {"MT_0120.txt": preamble + table(columns, "\t")}


def shimmer(walk: Walk) -> Files:
    name = "Shimmer_8E3A_"
    columns = {
        f"{name}Timestamp_Unix_CAL": [START_NS // 10**6 + round(t * 1e3) for t in walk.time_s],
        **titled(f"{name}Accel_WR_{{}}_CAL", 0.97 * walk.force),
        **titled(f"{name}Accel_LN_{{}}_CAL", walk.force),
        **titled(f"{name}Gyro_{{}}_CAL", walk.rate / DEGREE),
    }
    header, _, rows = table(columns, "\t").partition(b"\n")
    units = "\t".join(["ms", *["m/(s^2)"] * 6, *["deg/s"] * 3]).encode()
    return {"session.csv": b'"sep=\t"\n' + header + b"\n" + units + b"\n" + rows}


def ximu3(walk: Walk) -> Files:
    columns = {
        "Timestamp (us)": [5_000_000 + round(t * 1e6) for t in walk.time_s],
        **titled("Gyroscope {} (deg/s)", walk.rate / DEGREE),
        **titled("Accelerometer {} (g)", walk.force / STANDARD_GRAVITY_MPS2),
    }
    return {"Inertial.csv": table(columns), "Temperature.csv": b"Timestamp (us),Temperature (degC)\n1,20\n2,20\n"}


def rostopic(walk: Walk) -> Files:
    columns = {
        "%time": [START_NS + 3_000_000 + round(t * 1e9) for t in walk.time_s],
        "field.header.seq": list(range(len(walk.time_s))),
        "field.header.stamp": ns(walk, START_NS),
        "field.header.frame_id": ["imu"] * len(walk.time_s),
        **{f"field.orientation.{axis}": walk.quaternion[:, i] for axis, i in zip("xyzw", (1, 2, 3, 0), strict=True)},
        "field.orientation_covariance0": 0.0 * walk.time_s,
        **titled("field.angular_velocity.{}", walk.rate, "xyz"),
        "field.angular_velocity_covariance0": 0.0 * walk.time_s,
        **titled("field.linear_acceleration.{}", walk.force, "xyz"),
    }
    return {"imu.csv": table(columns)}


def bagpy(walk: Walk) -> Files:
    stamps = ns(walk, START_NS)
    columns = {
        "Time": [stamp / 1e9 + 0.002 for stamp in stamps],
        "header.seq": list(range(len(stamps))),
        "header.stamp.secs": [stamp // 10**9 for stamp in stamps],
        "header.stamp.nsecs": [stamp % 10**9 for stamp in stamps],
        **titled("angular_velocity.{}", walk.rate, "xyz"),
        **titled("linear_acceleration.{}", walk.force, "xyz"),
    }
    return {"imu.csv": table(columns)}


def sensor_record(walk: Walk) -> Files:
    clock: dict[str, Any] = {
        "Timestamp": dates(walk, "%Y-%m-%d %H:%M:%S"),
        "Milliseconds": [round(1 + 1e3 * t) for t in walk.time_s],
    }
    sensors = {"Accelerometer": walk.force, "AccelerometerLinear": walk.user, "Gyroscope": walk.rate}
    return {f"{name}.csv": table({**clock, **xyz(values, "XYZ")}) for name, values in sensors.items()}


def imu_recorder(walk: Walk) -> Files:
    created = b"# Created at Mon Feb 03 04:05:06 GMT+01:00 2031\n"
    w, x, y, z = walk.quaternion.T
    files = {
        name: created + plain_rows(ns(walk), *values.T, separator=" ")
        for name, values in (("acce.txt", walk.force), ("gyro.txt", walk.rate), ("linacce.txt", walk.user))
    }
    rotation = created + plain_rows(ns(walk), x, y, z, w, separator=" ")
    return {**files, "rv.txt": rotation, "gps.txt": created, "reference_time.txt": created + b"0\n"}


def opencamera(walk: Walk) -> Files:
    return {
        f"VID_20310203_040506{name}.csv": plain_rows(*values.T, ns(walk))
        for name, values in (("accel", walk.force), ("gyro", walk.rate))
    }


def matlab_csv(walk: Walk) -> Files:
    clock = {"Timestamp": dates(walk, "%d-%b-%Y %H:%M:%S.%L")}
    sensors = {"Acceleration": walk.force, "AngularVelocity": walk.rate}
    return {f"{name}.csv": table({**clock, **xyz(values, "XYZ")}) for name, values in sensors.items()}


def metawear(walk: Walk) -> Files:
    clock = {
        "epoc (ms)": [START_NS // 10**6 + round(t * 1e3) for t in walk.time_s],
        "timestamp (+0200)": dates(walk, "%Y-%m-%dT%H.%M.%S.%L"),
        "elapsed (s)": walk.time_s,
    }
    acc = titled("{}-axis (g)", walk.force / STANDARD_GRAVITY_MPS2, "xyz")
    gyr = titled("{}-axis (deg/s)", walk.rate / DEGREE, "xyz")
    stem = "MetaWear_2031-02-03T04.05.06_C0FFEE_{}_100.000Hz_1.5.0.csv"
    return {stem.format(name): table({**clock, **v}) for name, v in (("Accelerometer", acc), ("Gyroscope", gyr))}


APPS: Mapping[str, tuple[str, Callable[[Walk], Files]]] = {
    "AndroSensor": ("AndroSensor", androsensor),
    "Physics Toolbox on Android": ("Physics Toolbox", physics_toolbox),
    "Physics Toolbox on iOS": ("Physics Toolbox", physics_toolbox_ios),
    "SensorLog": ("SensorLog", sensorlog),
    "SensorLog without the raw accelerometer": ("SensorLog", sensorlog_without_raw),
    "HyperIMU": ("HyperIMU", hyperimu),
    "HyperIMU without time": ("HyperIMU", hyperimu_without_time),
    "Core Motion": ("Core Motion table", core_motion),
    "Xsens DOT": ("Xsens, Movella", xsens_dot),
    "MT Manager": ("Xsens, Movella", mt_manager),
    "Shimmer": ("Shimmer", shimmer),
    "x-IMU3": ("x-io", ximu3),
    "rostopic": ("ROS Imu messages", rostopic),
    "bagpy": ("ROS Imu messages", bagpy),
    "Sensor Record": ("Sensor Record", sensor_record),
    "AndroidIMURecorder": ("AndroidIMURecorder (RoNIN, RIDI)", imu_recorder),
    "OpenCamera": ("OpenCamera Sensors", opencamera),
    "MATLAB Mobile CSV": ("MATLAB Mobile", matlab_csv),
    "MetaWear": ("MetaWear", metawear),
}
"""Name of the test -> name of the format and the files of a walk."""
