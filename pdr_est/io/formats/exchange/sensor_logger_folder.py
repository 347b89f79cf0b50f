"""Write a recording as Sensor Logger exports it on Android: a folder with one table for each sensor."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl

from pdr_est.errors import OutputError
from pdr_est.io.formats.exchange.left_out import left_out, only_device
from pdr_est.output.atomic_output import staged_file
from pdr_est.output.csv_cells import harmless_cell
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording, Signal
from pdr_est.types.sensors import AttitudeReference

APP_VERSION = "pdr_est"
"""Version of the app in the metadata; only with one the yaw of the attitude counts from north."""

NO_DATE_S = 946_684_800.0
"""Unix time, s, that stands for time zero of a recording without a date: 1 January 2000. The format needs one."""

_NS = 1e9
_PLATFORM = "android"
_QUATERNION = ("qw", "qx", "qy", "qz")


def write_sensor_logger_folder(recording: Recording, folder: Path) -> tuple[str, ...]:
    """Write the tables of a recording of one device into an existing folder.

    Without a date, times count from `NO_DATE_S`. Fixes of GPS are written where latitude and longitude are known.

    Returns
    -------
    tuple of str
        What of the recording is not in the folder, in words.

    Raises
    ------
    OutputError
        For several devices, for a recording without samples, and when a file cannot be written.
    """
    device = only_device(recording)
    epoch_s = NO_DATE_S if recording.epoch_s is None else recording.epoch_s
    tables = {
        "TotalAcceleration": _table(device.specific_force, ("x", "y", "z"), epoch_s),
        "Gyroscope": _table(device.rotation_rate, ("x", "y", "z"), epoch_s),
        "Magnetometer": _table(device.magnetic_field, ("x", "y", "z"), epoch_s),
        "Orientation": _table(device.attitude, _QUATERNION, epoch_s),
        "Barometer": _table(_in_hpa(device.pressure), ("pressure",), epoch_s),
        "Location": _locations(recording, epoch_s),
        "Annotation": _annotations(recording, epoch_s),
    }
    if tables["TotalAcceleration"] is None and tables["Gyroscope"] is None:
        raise OutputError(f"{folder}: the recording has no samples to write")
    by_north = device.attitude_reference is AttitudeReference.MAGNETIC_NORTH
    metadata = {"device name": device.model, "platform": _PLATFORM, "appVersion": APP_VERSION if by_north else ""}
    tables["Metadata"] = pl.DataFrame({key: [harmless_cell(value)] for key, value in metadata.items()})
    for name, frame in tables.items():
        if frame is not None:
            with staged_file(folder / f"{name}.csv", overwrite=True) as staging:
                frame.write_csv(staging)
    others = tuple(fix for fix in recording.fixes if not _is_location(fix, recording))
    held = ["date", "waypoints", "pressure", "model"]
    held += ["platform"] if device.platform == _PLATFORM else []
    held += ["reference"] if by_north else []
    return left_out(replace(recording, fixes=others), held)


def _table(signal: Signal | None, titles: tuple[str, ...], epoch_s: float) -> pl.DataFrame | None:
    if signal is None or not len(signal):
        return None
    columns = dict(zip(titles, signal.values.T, strict=True))
    return pl.DataFrame({**_times(signal.time_s, epoch_s), **columns})


def _times(time_s: np.ndarray, epoch_s: float) -> dict[str, np.ndarray]:
    """Return Unix times in ns, as whole numbers, and the seconds of the recording."""
    zero_ns = round(epoch_s * _NS)
    return {"time": zero_ns + np.round(time_s * _NS).astype(np.int64), "seconds_elapsed": time_s}


def _in_hpa(pressure: Signal | None) -> Signal | None:
    return None if pressure is None else Signal(pressure.time_s, pressure.values / 100.0)


def _locations(recording: Recording, epoch_s: float) -> pl.DataFrame | None:
    origin, fixes = recording.origin, [fix for fix in recording.fixes if _is_location(fix, recording)]
    if origin is None or not fixes:
        return None
    from pymap3d import enu2geodetic

    east, north = np.array([fix.position_m for fix in fixes]).T
    latitude, longitude, _ = enu2geodetic(east, north, 0.0, origin.latitude_deg, origin.longitude_deg, 0.0)
    sigma_m = np.sqrt([0.5 * np.trace(fix.covariance_m2) for fix in fixes])
    times = _times(np.array([fix.time_s for fix in fixes]), epoch_s)
    return pl.DataFrame({**times, "latitude": latitude, "longitude": longitude, "horizontalAccuracy": sigma_m})


def _is_location(fix: PositionFix, recording: Recording) -> bool:
    """Tell whether the table of locations can hold a fix."""
    return recording.origin is not None and fix.source == "gps"


def _annotations(recording: Recording, epoch_s: float) -> pl.DataFrame | None:
    if not recording.waypoints:
        return None
    times = _times(np.array([fix.time_s for fix in recording.waypoints]), epoch_s)
    texts = [f"{fix.position_m[0]:.3f} {fix.position_m[1]:.3f}" for fix in recording.waypoints]
    return pl.DataFrame({**times, "text": texts})
