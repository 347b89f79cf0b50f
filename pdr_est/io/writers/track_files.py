"""Write the files of a finished walk: TUM and GeoJSON tracks, and the table of steps.

The table of the track itself is written by `Track.to_csv`. Every writer raises OutputError when the file cannot be
written.
"""

import csv
import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.output.atomic_output import text_output
from pdr_est.types.csv_cells import harmless_name
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin
from pdr_est.types.steps import CarryingMode, Step
from pdr_est.types.track import Track, with_standing_poses

STEP_COLUMNS = (
    "time_s",
    "device",
    "index",
    "segment",
    "mode",
    "mode_probability",
    "gait",
    "gait_probability",
    "frequency_hz",
    "length_m",
    "heading_rad",
    "confidence",
)

Json = dict[str, Any]


def write_tum(track: Track, path: str | Path, epoch_s: float | None = None) -> tuple[Path, ...]:
    """Write the poses as `time x y z qx qy qz qw` lines, the format of the TUM RGB-D benchmark that evo reads.

    z is 0, and the quaternion rotates by the heading about z. Where the walker stands, a line more says when the next
    step begins: other programs take the walker to move evenly between two lines.

    Parameters
    ----------
    track
        Track of one or more devices.
    path
        File of the first device. The format has one trajectory a file, so every further device is written beside it
        to `<stem>-<device><suffix>`.
    epoch_s
        Unix time of time zero. When it is given, times are Unix times, else seconds of the recording.

    Returns
    -------
    tuple of Path
        The files written.
    """
    first = Path(path)
    files: dict[Path, str] = {}
    for number, device in enumerate(track.devices):
        file = first
        if number:
            name = re.sub(r"[^\w.-]+", "_", device)
            file = first.with_name(f"{first.stem}-{name}{first.suffix}")
        if file in files:
            file = file.with_name(f"{file.stem}-{number + 1}{file.suffix}")
        files[file] = device
    for file, device in files.items():
        with text_output(file) as stream:
            stream.writelines(_tum_lines(with_standing_poses(track.of_device(device)), epoch_s or 0.0))
    return tuple(files)


def _tum_lines(track: Track, epoch_s: float) -> Iterator[str]:
    half_heading = wrap_angle(track.heading_rad) / 2.0
    qz, qw = np.sin(half_heading), np.cos(half_heading)
    for i in range(len(track)):
        x, y = track.position_m[i]
        yield f"{epoch_s + track.time_s[i]:.6f} {x:.4f} {y:.4f} 0 0 0 {qz[i]:.9f} {qw[i]:.9f}\n"


def write_geojson(
    track: Track,
    path: str | Path,
    origin: GeoOrigin | None = None,
    *,
    fixes: Sequence[PositionFix] = (),
    with_steps: bool = False,
) -> None:
    """Write the track as a GeoJSON FeatureCollection (RFC 7946).

    It has a LineString for each device (a Point for a single pose) and a Point for each fix. Coordinates are WGS 84
    longitude and latitude when the origin is known, else metres east and north; the members `crs_note` and
    `coordinate_unit` ("degree" or "metre") of the collection say which.

    Parameters
    ----------
    track
        Track of one or more devices.
    path
        File to write.
    origin
        Latitude and longitude of the origin of the map frame.
    fixes
        Position fixes to draw.
    with_steps
        True to add a Point for each pose with its time, heading, covariance and carrying mode.
    """
    features = [_line_feature(track.of_device(device), origin) for device in track.devices]
    if fixes:
        coordinates = _coordinates(np.array([fix.position_m for fix in fixes]), origin)
        features += [_fix_feature(fix, at) for fix, at in zip(fixes, coordinates, strict=True)]
    if with_steps:
        features += _pose_features(track, origin)
    collection = {
        "type": "FeatureCollection",
        "crs_note": _crs_note(origin),
        "coordinate_unit": "metre" if origin is None else "degree",
        "features": features,
    }
    with text_output(path) as stream:
        json.dump(collection, stream, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
        stream.write("\n")


def _crs_note(origin: GeoOrigin | None) -> str:
    if origin is None:
        return (
            "Local metres, x east and y north, NOT longitude and latitude: "
            "the place of the map frame on the Earth is unknown."
        )
    return (
        "WGS 84 longitude and latitude in degrees; the origin of the map frame lies at "
        f"latitude {origin.latitude_deg:.8f}, longitude {origin.longitude_deg:.8f}."
    )


def _coordinates(position_m: Array, origin: GeoOrigin | None) -> list[list[float]]:
    """Convert map positions (n, 2) to GeoJSON coordinates, to 0.1 mm in metres or about 1 mm in degrees."""
    if origin is None:
        return [[float(x), float(y)] for x, y in np.round(position_m, 4)]
    from pymap3d import enu2geodetic

    east, north = position_m.T
    latitude, longitude, _ = enu2geodetic(
        east, north, np.zeros(len(east)), origin.latitude_deg, origin.longitude_deg, 0.0
    )
    return [[float(x), float(y)] for x, y in np.round(np.column_stack([longitude, latitude]), 8)]


def _feature(kind: str, coordinates: Any, properties: Json) -> Json:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": properties}


def _line_feature(track: Track, origin: GeoOrigin | None) -> Json:
    coordinates = _coordinates(track.position_m, origin)
    properties: Json = {
        "feature": "track",
        "device": str(track.device[0]),
        "estimator": track.estimator,
        "kind": track.kind,
        "start_s": round(float(track.time_s[0]), 6),
        "end_s": round(float(track.time_s[-1]), 6),
        "steps": len(track) - 1,
        "distance_m": round(track.distance_m, 3),
    }
    if len(track) == 1:
        return _feature("Point", coordinates[0], properties)
    return _feature("LineString", coordinates, properties)


def _fix_feature(fix: PositionFix, coordinates: list[float]) -> Json:
    properties: Json = {
        "feature": "fix",
        "source": fix.source,
        "time_s": round(float(fix.time_s), 6),
        "sigma_east_m": _number(math.sqrt(fix.covariance_m2[0, 0]), 3),
        "sigma_north_m": _number(math.sqrt(fix.covariance_m2[1, 1]), 3),
    }
    return _feature("Point", coordinates, properties)


def _pose_features(track: Track, origin: GeoOrigin | None) -> list[Json]:
    return [
        _feature(
            "Point",
            coordinates,
            {
                "feature": "pose",
                "device": str(track.device[i]),
                "time_s": round(float(track.time_s[i]), 6),
                "heading_rad": _number(float(wrap_angle(track.heading_rad[i])), 6),
                "sigma_heading_rad": _number(track.sigma_heading_rad[i], 6),
                "cov_xx_m2": _number(track.covariance_m2[i, 0, 0], 9),
                "cov_xy_m2": _number(track.covariance_m2[i, 0, 1], 9),
                "cov_yy_m2": _number(track.covariance_m2[i, 1, 1], 9),
                "mode": CarryingMode(int(track.mode[i])).name,
                "step_length_m": _number(track.step_length_m[i], 4),
            },
        )
        for i, coordinates in enumerate(_coordinates(track.position_m, origin))
    ]


def _number(value: float, digits: int) -> float | None:
    """Round a number for JSON, which has neither NaN nor infinity; those become None."""
    return round(float(value), digits) if math.isfinite(value) else None


def write_steps_csv(steps: Mapping[str, Sequence[Step]], path: str | Path) -> None:
    """Write one row for each step, with the columns `STEP_COLUMNS`, device by device.

    `heading_rad` is the mean yaw of the device over the step (with an arbitrary zero), not the heading of the
    track. `gait_probability` is that of the gait in the cell before it. A value that was not determined is an empty
    cell, an unknown mode or gait is UNKNOWN.

    Parameters
    ----------
    steps
        Device name -> its steps.
    path
        File to write.
    """
    with text_output(path) as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(STEP_COLUMNS)
        for device, of_device in steps.items():
            writer.writerows(_step_row(device, step) for step in of_device)


def _step_row(device: str, step: Step) -> tuple[str | int, ...]:
    return (
        f"{step.event.time_s:.6f}",
        harmless_name(device),
        step.event.index,
        step.event.segment,
        step.event.mode.name,
        _cell(step.event.mode_probability, 4),
        step.gait.name,
        _cell((math.nan, *step.gait_probability)[step.gait], 4),
        _cell(step.frequency_hz, 4),
        _cell(step.length_m, 4),
        _cell(step.heading_rad, 6),
        _cell(step.event.confidence, 4),
    )


def _cell(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else ""
