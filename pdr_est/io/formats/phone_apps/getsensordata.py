"""Read logs of GetSensorData, the app of the IPIN competition.

A log is a text file with rows `TYPE;AppTimestamp;SensorTimestamp;values` of one phone. Rows ACCE, GYRO, MAGN, PRES
(hPa) and AHRS (rotation vector) are read; POSI rows are surveyed points, the ground truth, and GNSS rows are fixes.
iPhones record the acceleration in g with Apple's sign, Android phones in m/s^2, up at rest.
"""

import re
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.axes import quaternion_from_rotation_vector
from pdr_est.io.conversion.gnss import GnssFixes, east_north, gnss_fixes
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.conversion.units import detect_acceleration_unit
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import finite_signal
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.tagged_lines import TaggedLog
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, GeoOrigin, Recording, Signal
from pdr_est.types.sensors import AttitudeReference

NAME = "GetSensorData (IPIN)"

_SENSORS = {
    "ACCE": RawSensor.FORCE,
    "GYRO": RawSensor.RATE,
    "MAGN": RawSensor.FIELD,
    "PRES": RawSensor.PRESSURE,
}
_FACTORS = {RawSensor.RATE: 1.0, RawSensor.FIELD: 1.0, RawSensor.PRESSURE: 100.0}  # hPa -> Pa
_POSI_SIGMA_M = 0.7  # surveyed points, marked while walking over them
_CLOCK_SPREAD_S = 0.5
_OTHER_CLOCK_S = 5.0  # the clocks of two providers of positions differ by more than this
_N_FIELDS = 10
_ROW = re.compile(rb"^(?:ACCE|GYRO|MAGN|AHRS|POSI|WIFI|GNSS|PRES|SOUN|LIGH|PROX|BLUE|BLE4);[\d.]+;", re.MULTILINE)
_HEADER_VALUE = re.compile(r"^%\s*(Manufacturer|Model):\s*(\S.*?)\s*$", re.MULTILINE)


def sniff(source: Source) -> bool:
    """Tell whether a member of the source is a log of this format."""
    return bool(find_members(source, _is_log))


def read_source(source: Source) -> Recording:
    """Read the walk of a GetSensorData log: one phone, surveyed points as truth, GNSS rows as fixes.

    Time is the clock of the app; the origin of the map frame is the first surveyed point, else the first GNSS
    position.

    Raises
    ------
    RecordingError
        When there are several walks or no accelerometer rows.
    """
    member = require_single_walk(source, find_members(source, _is_log), NAME)
    data = source.read(member)
    log = TaggedLog.parse(data, source.place(member), separator=";", tag_field=0, n_fields=_N_FIELDS)
    points, floors = _surveyed_points(log)
    gnss = log.numbers("GNSS", (1, 2, 3, 4, 7))  # app time, Unix time, latitude, longitude, accuracy
    gps = gnss_fixes(gnss[:, 0], gnss[:, 2], gnss[:, 3], gnss[:, 4], _from_network(gnss))
    origin = GeoOrigin(float(points[0, 1]), float(points[0, 2])) if len(points) else gps.origin
    return Recording(
        name=member_stem(member),
        format=NAME,
        devices=(_device(log, data),),
        truth=Truth(positions=_truth(points, origin)),
        fixes=_relative_to_origin(gps, origin),
        origin=origin,
        epoch_s=_epoch_s(gnss),
        notes=(*floors, *gps.warnings),
    )


def _is_log(head: bytes) -> bool:
    return _ROW.search(head) is not None


def _device(log: TaggedLog, data: bytes) -> DeviceRecording:
    header = dict(_HEADER_VALUE.findall(data[:8192].decode("utf-8", "replace")))
    model = " ".join(header[key] for key in ("Manufacturer", "Model") if key in header)
    device = RawDevice({}, model=model, decisions=["time zero is that of the app's clock (AppTimestamp)"])
    fields = {"ACCE": (3, 4, 5), "GYRO": (3, 4, 5), "MAGN": _magnetic_fields(log), "PRES": (3,)}
    for tag, sensor in _SENSORS.items():
        signal = _signal(log, tag, fields[tag], device.decisions, device.warnings)
        if signal is not None:
            device.signals[sensor] = RawSignal(signal, tag, _FACTORS.get(sensor))
    force = device.signals.get(RawSensor.FORCE)
    if force is None:
        raise RecordingError(
            f"{log.place}: no accelerometer (ACCE) rows; record again with the accelerometer switched on"
        )
    is_apple = detect_acceleration_unit(force.signal.values).factor != 1.0
    device.platform = "ios" if is_apple else "android"
    device.sign = -1.0 if is_apple else 1.0
    device.sign_reason = "iPhones record in g" if is_apple else "Android phones record in m/s^2"
    attitude = _attitude(log, device.decisions, device.warnings)
    if attitude is not None:
        device.signals[RawSensor.ATTITUDE] = RawSignal(attitude, "AHRS")
    # Android defines its rotation vector so; what an iPhone's AHRS rows count from is not documented.
    device.attitude_reference = AttitudeReference.UNKNOWN if is_apple else AttitudeReference.MAGNETIC_NORTH
    if RawSensor.RATE not in device.signals:
        device.warnings.append("no gyroscope (GYRO) rows: steps can be found, but headings cannot")
    return device.convert()


def _signal(
    log: TaggedLog, tag: str, fields: tuple[int, ...], decisions: list[str], warnings: list[str]
) -> Signal | None:
    rows = log.numbers(tag, (1, 2, *fields))
    if not len(rows):
        return None
    time_s, decision = _on_app_clock(tag, rows[:, 0], rows[:, 1])
    decisions.append(decision)
    signal, dropped = finite_signal(time_s, rows[:, 2:], tag, log.place)
    warnings.extend(dropped)
    return signal


def _on_app_clock(tag: str, app_s: Array, sensor_s: Array) -> tuple[Array, str]:
    """Shift the evenly spaced times of the sensor clock to the app clock, which the truth uses."""
    offset_s = app_s - sensor_s
    finite = np.isfinite(offset_s)
    if finite.any():
        median_s = float(np.median(offset_s[finite]))
        spread_s = float(np.quantile(np.abs(offset_s[finite] - median_s), 0.95))
        if spread_s <= _CLOCK_SPREAD_S:
            return (
                sensor_s + median_s,
                f"{tag}: times are SensorTimestamp + {median_s:.4f} s, the median of AppTimestamp - SensorTimestamp",
            )
    return app_s, f"{tag}: times are AppTimestamp, because SensorTimestamp does not run in step with it"


def _magnetic_fields(log: TaggedLog) -> tuple[int, int, int]:
    """Choose the field indices: the documented layout has an empty field after x, real files have none."""
    second = log.numbers("MAGN", (4,))
    return (3, 5, 6) if len(second) and np.isnan(second).all() else (3, 4, 5)


def _attitude(log: TaggedLog, decisions: list[str], warnings: list[str]) -> Signal | None:
    vector = _signal(log, "AHRS", (6, 7, 8), decisions, warnings)
    if vector is None:
        return None
    decisions.append("attitude is the rotation vector of AHRS, device -> magnetic east, magnetic north, up")
    return Signal(vector.time_s, quaternion_from_rotation_vector(vector.values))


def _surveyed_points(log: TaggedLog) -> tuple[Array, tuple[str, ...]]:
    """Read the surveyed points (time s, latitude deg, longitude deg), with notes on floors and gaps."""
    rows = log.numbers("POSI", (1, 3, 4, 5))
    finite = np.isfinite(rows[:, :3]).all(axis=1)
    notes = []
    latitude_deg, longitude_deg = rows[:, 1], rows[:, 2]
    unplaced = finite & (((latitude_deg == 0.0) & (longitude_deg == 0.0)) | (np.abs(latitude_deg) > 90.0))
    unplaced |= finite & (np.abs(longitude_deg) > 180.0)
    if unplaced.any():
        notes.append(
            f"{np.count_nonzero(unplaced)} of {len(rows)} surveyed points have no possible latitude and longitude, "
            "such as (0, 0), and are left out"
        )
    placed = finite & ~unplaced
    if not finite.all():
        notes.append(f"{np.count_nonzero(~finite)} of {len(rows)} surveyed points are incomplete and are left out")
    known_floors = rows[placed & np.isfinite(rows[:, 3]), 3].tolist()
    floors = [f"{floor:g}" for floor in dict.fromkeys(known_floors)]
    if len(floors) > 1:
        notes.append(f"surveyed points lie on floors {', '.join(floors)}")
    return rows[placed, :3], tuple(notes)


def _truth(points: Array, origin: GeoOrigin | None) -> TruePositions | None:
    if origin is None or not len(points):
        return None
    position_m = east_north(points[:, 1], points[:, 2], origin)
    return TruePositions(points[:, 0], position_m, _POSI_SIGMA_M, "surveyed points")


def _relative_to_origin(gnss: GnssFixes, origin: GeoOrigin | None) -> tuple[PositionFix, ...]:
    """Move fixes from their own origin to another one; over the extent of a walk a shift is exact to 1 mm."""
    if origin is None or gnss.origin is None:
        return gnss.fixes
    own = gnss.origin
    shift_m = east_north(np.array([own.latitude_deg]), np.array([own.longitude_deg]), origin)[0]
    return tuple(replace(fix, position_m=fix.position_m + shift_m) for fix in gnss.fixes)


def _from_network(gnss: Array) -> NDArray[np.bool_]:
    """Find the GNSS rows (n,) that do not come from satellites.

    Android's other provider of positions writes into the same rows. Its time stamps are on another clock, which lacks
    the leap seconds of GPS, so that they are off by many seconds.
    """
    offset_s = gnss[:, 0] - gnss[:, 1]
    finite = np.isfinite(offset_s)
    median_s = float(np.median(offset_s[finite])) if finite.any() else 0.0
    return np.asarray(finite & (np.abs(offset_s - median_s) > _OTHER_CLOCK_S))


def _epoch_s(gnss: Array) -> float | None:
    """Find the Unix time of time zero to about a second: GNSS rows carry whole Unix seconds."""
    offset_s = gnss[:, 1] - gnss[:, 0]
    offset_s = offset_s[np.isfinite(offset_s)]
    return float(np.median(offset_s)) if len(offset_s) else None
