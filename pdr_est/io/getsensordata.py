"""GetSensorData logs, the format of the IPIN competition: `TYPE;AppTimestamp;SensorTimestamp;values` rows."""

import re

import numpy as np
import pymap3d

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, up_in_device
from pdr_est.io.choice import members_like, only_walk, stem
from pdr_est.io.orientation import quaternion_from_rotation_vector
from pdr_est.io.recording import DeviceRecording, GeoOrigin, Recording, Signal, TruePositions, Truth
from pdr_est.io.source import Source
from pdr_est.io.table import finite_rows
from pdr_est.io.tagged import TaggedLog
from pdr_est.records import PositionFix

NAME = "GetSensorData (IPIN)"

_POSI_SIGMA_M = 0.7  # surveyed points, marked while walking over them
_LARGEST_IN_G = 3.0  # median norm of specific force; 1 in g, 9.8 in m/s^2
_CLOCK_SPREAD_S = 0.5
_N_FIELDS = 10
_ROW = re.compile(rb"^(?:ACCE|GYRO|MAGN|AHRS|POSI|WIFI|GNSS|PRES|SOUN|LIGH|PROX|BLUE|BLE4);[\d.]+;", re.MULTILINE)
_HEADER_VALUE = re.compile(r"^%\s*(Manufacturer|Model):\s*(\S.*?)\s*$", re.MULTILINE)


def sniff(source: Source) -> bool:
    """Whether some member has rows of this format."""
    return bool(members_like(source, _looks_right))


def read(source: Source) -> Recording:
    """The walk of a GetSensorData log: one phone, surveyed points as truth, GNSS rows as fixes.

    Time is the app's clock; the map frame's origin is the first surveyed point, else the first GNSS position.
    Raises RecordingError when there are several walks or no accelerometer rows.
    """
    member = only_walk(source, members_like(source, _looks_right), NAME)
    data = source.read(member)
    log = TaggedLog.parse(data, source.place(member), separator=";", tag_field=0, n_fields=_N_FIELDS)
    points, floors = _surveyed_points(log)
    gnss, skipped = _gnss(log)
    origin = _origin(points, gnss)
    return Recording(
        name=stem(member),
        format=NAME,
        devices=(_device(log, data),),
        truth=Truth(positions=_truth(points, origin)),
        fixes=_fixes(gnss, origin),
        origin=origin,
        epoch_s=float(np.median(gnss[:, 1] - gnss[:, 0])) if len(gnss) else None,
        notes=(*floors, *skipped),
    )


def _looks_right(head: bytes) -> bool:
    return _ROW.search(head) is not None


# --- sensors ---------------------------------------------------------------------------------------------------


def _device(log: TaggedLog, data: bytes) -> DeviceRecording:
    header = dict(_HEADER_VALUE.findall(data[:8192].decode("utf-8", "replace")))
    decisions: list[str] = ["time zero is that of the app's clock (AppTimestamp)"]
    warnings: list[str] = []
    force = _signal(log, "ACCE", (3, 4, 5), decisions, warnings)
    if force is None:
        raise RecordingError(f"{log.place}: no accelerometer (ACCE) rows; record again with the accelerometer on")
    attitude = _attitude(log, decisions, warnings)
    force, is_apple = _in_si_upwards(force, attitude, decisions)
    rate = _signal(log, "GYRO", (3, 4, 5), decisions, warnings)
    if rate is None:
        warnings.append("no gyroscope (GYRO) rows")
    pressure = _signal(log, "PRES", (3,), decisions, warnings)
    return DeviceRecording(
        model=" ".join(header[key] for key in ("Manufacturer", "Model") if key in header),
        platform="ios" if is_apple else "android",
        specific_force=force,
        rotation_rate=rate,
        magnetic_field=_signal(log, "MAGN", _magnetic_fields(log), decisions, warnings),
        attitude=attitude,
        pressure=None if pressure is None else Signal(pressure.time_s, pressure.values * 100.0),  # hPa -> Pa
        decisions=tuple(decisions),
        warnings=tuple(warnings),
    )


def _signal(
    log: TaggedLog, tag: str, fields: tuple[int, ...], decisions: list[str], warnings: list[str]
) -> Signal | None:
    rows = log.numbers(tag, (1, 2, *fields))
    if not len(rows):
        return None
    time_s, decision = _on_app_clock(tag, rows[:, 0], rows[:, 1])
    decisions.append(decision)
    signal, dropped = finite_rows(time_s, rows[:, 2:], tag, log.place)
    warnings.extend(dropped)
    return signal


def _on_app_clock(tag: str, app_s: Array, sensor_s: Array) -> tuple[Array, str]:
    """Sample times with the sensor clock's even spacing, shifted to the app clock on which the truth is."""
    offset_s = app_s - sensor_s
    finite = np.isfinite(offset_s)
    if finite.any():
        median_s = float(np.median(offset_s[finite]))
        spread_s = float(np.quantile(np.abs(offset_s[finite] - median_s), 0.95))
        if spread_s <= _CLOCK_SPREAD_S:
            return (
                sensor_s + median_s,
                f"{tag}: SensorTimestamp shifted by the median of App - Sensor, {median_s:.4f} s",
            )
    return app_s, f"{tag}: AppTimestamp, because SensorTimestamp does not keep pace with it"


def _magnetic_fields(log: TaggedLog) -> tuple[int, int, int]:
    """The documented layout has an empty field after x, real files have none."""
    second = log.numbers("MAGN", (4,))
    return (3, 5, 6) if len(second) and np.isnan(second).all() else (3, 4, 5)


def _attitude(log: TaggedLog, decisions: list[str], warnings: list[str]) -> Signal | None:
    vector = _signal(log, "AHRS", (6, 7, 8), decisions, warnings)
    if vector is None:
        return None
    decisions.append(
        "attitude is the rotation vector of AHRS, device -> east, north, up; w = sqrt(1 - x^2 - y^2 - z^2)"
    )
    return Signal(vector.time_s, quaternion_from_rotation_vector(vector.values))


def _in_si_upwards(force: Signal, attitude: Signal | None, decisions: list[str]) -> tuple[Signal, bool]:
    """Specific force in m/s^2 that points up at rest, and whether it was recorded in g, as iPhones do."""
    norm = float(np.median(np.linalg.norm(force.values, axis=1)))
    in_g = norm < _LARGEST_IN_G
    scale = STANDARD_GRAVITY_MPS2 if in_g else 1.0
    decisions.append(f"ACCE is in {'g' if in_g else 'm/s^2'}: its median norm is {norm:.2f}")
    if attitude is not None:
        nearest = np.clip(np.searchsorted(attitude.time_s, force.time_s), 0, len(attitude) - 1)
        upwards = float(np.median((up_in_device(attitude.values[nearest]) * force.values).sum(axis=1))) * scale
        sign = -1.0 if upwards < 0.0 else 1.0
        decisions.append(
            f"ACCE {'negated' if sign < 0 else 'not negated'}: {upwards:.2f} m/s^2 along AHRS's vertical"
        )
    else:
        sign = -1.0 if in_g else 1.0
        reason = "g is Apple's unit and its sign is opposite" if in_g else "m/s^2 is Android's unit"
        decisions.append(f"ACCE {'negated' if in_g else 'not negated'}: no AHRS to tell, {reason}")
    return Signal(force.time_s, force.values * (sign * scale)), in_g


# --- positions -------------------------------------------------------------------------------------------------


def _surveyed_points(log: TaggedLog) -> tuple[Array, tuple[str, ...]]:
    """Rows (time s, latitude deg, longitude deg) of the surveyed points, and a note on their floors."""
    rows = log.numbers("POSI", (1, 3, 4, 5))
    rows = rows[np.isfinite(rows[:, :3]).all(axis=1)]
    floors = [f"{floor:g}" for floor in dict.fromkeys(rows[np.isfinite(rows[:, 3]), 3].tolist())]
    note = (f"surveyed points lie on floors {', '.join(floors)}",) if len(floors) > 1 else ()
    return rows[:, :3], note


def _gnss(log: TaggedLog) -> tuple[Array, tuple[str, ...]]:
    """Rows (app time s, Unix time s, latitude deg, longitude deg, accuracy m) and notes on what was left out."""
    rows = log.numbers("GNSS", (1, 2, 3, 4, 7))
    usable = rows[np.isfinite(rows).all(axis=1) & (rows[:, 4] > 0.0)]
    # A phone that listens to two providers writes the same fix twice, some milliseconds apart.
    _, first = np.unique(usable[:, 1:], axis=0, return_index=True)
    fixes = usable[np.sort(first)]
    notes = []
    if len(usable) < len(rows):
        notes.append(f"{len(rows) - len(usable)} GNSS rows without position or accuracy left out")
    if len(fixes) < len(usable):
        notes.append(f"{len(usable) - len(fixes)} repeated GNSS rows left out")
    return fixes, tuple(notes)


def _origin(points: Array, gnss: Array) -> GeoOrigin | None:
    if len(points):
        return GeoOrigin(float(points[0, 1]), float(points[0, 2]))
    return GeoOrigin(float(gnss[0, 2]), float(gnss[0, 3])) if len(gnss) else None


def _east_north(latitude_deg: Array, longitude_deg: Array, origin: GeoOrigin) -> Array:
    east, north, _ = pymap3d.geodetic2enu(
        latitude_deg, longitude_deg, 0.0, origin.latitude_deg, origin.longitude_deg, 0.0
    )
    return np.column_stack([east, north])


def _truth(points: Array, origin: GeoOrigin | None) -> TruePositions | None:
    if origin is None or not len(points):
        return None
    position_m = _east_north(points[:, 1], points[:, 2], origin)
    return TruePositions(points[:, 0], position_m, _POSI_SIGMA_M, "surveyed points")


def _fixes(gnss: Array, origin: GeoOrigin | None) -> tuple[PositionFix, ...]:
    if origin is None or not len(gnss):
        return ()
    position_m = _east_north(gnss[:, 2], gnss[:, 3], origin)
    return tuple(
        PositionFix(float(row[0]), position, np.eye(2) * row[4] ** 2, source="gps", robust=True)
        for row, position in zip(gnss, position_m, strict=True)
    )
