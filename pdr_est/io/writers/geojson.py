"""Write a track as GeoJSON (RFC 7946): lines, points with times, and 95 % ellipses."""

import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.io.writers.geodesy import DEGREE_DIGITS, dates_or_none, ellipses95, longitude_latitude
from pdr_est.output.atomic_output import text_output
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin
from pdr_est.types.region import ellipses_of_poses
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

Json = dict[str, Any]


def write_geojson(
    track: Track,
    path: str | Path,
    origin: GeoOrigin | None = None,
    *,
    fixes: Sequence[PositionFix] = (),
    epoch_s: float | None = None,
    with_steps: bool = False,
) -> None:
    """Write the track as a GeoJSON FeatureCollection.

    It has a LineString for each device (a Point for a single pose) and a Point for each fix. Coordinates are WGS 84
    longitude and latitude when the origin is known, else metres east and north; the members `crs_note` and
    `coordinate_unit` ("degree" or "metre") of the collection say which. The property `feature` tells what a feature
    is: "track", "fix", "pose" or "ellipse". The properties `time` (of fixes, poses and ellipses) and `start` and
    `end` (of lines) are dates in UTC where the date of the recording is known, else null; `time_s`, `start_s` and
    `end_s` are always seconds of the recording.

    Parameters
    ----------
    track
        Track of one or more devices.
    path
        File to write.
    origin
        Latitude and longitude of the origin of the frame of the track.
    fixes
        Position fixes to draw.
    epoch_s
        Unix time of time zero, s; None where it is unknown.
    with_steps
        True to add, for each pose, a Point with its time, heading, covariance and carrying mode, and a Polygon of
        its 95 % ellipse where that can be drawn. A pose whose region has several components gets one for each,
        with its `weight`; together they hold 95 %.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    devices = [track.of_device(device) for device in track.devices]
    features = [_line_feature(one, origin, epoch_s) for one in devices]
    features += _fix_features(fixes, origin, epoch_s)
    if with_steps:
        for one in devices:
            features += _pose_features(one, origin, epoch_s)
            features += _ellipse_features(one, origin, epoch_s)
    collection = {
        "type": "FeatureCollection",
        "crs_note": _crs_note(origin),
        "coordinate_unit": "metre" if origin is None else "degree",
        "features": features,
    }
    with text_output(path) as stream:  # json.dump would not use the fast encoder
        stream.write(json.dumps(collection, ensure_ascii=False, allow_nan=False, separators=(",", ":")))
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


def _coordinates(position_m: Array, origin: GeoOrigin | None, coarser: int = 0) -> list[list[float]]:
    """Convert positions (n, 2) to GeoJSON coordinates, to 0.1 mm or about 1 mm, with `coarser` decimals less."""
    local = origin is None
    values = position_m if origin is None else longitude_latitude(position_m, origin)
    rounded: list[list[float]] = np.round(values, (4 if local else DEGREE_DIGITS) - coarser).tolist()
    return rounded


def _feature(kind: str, coordinates: Any, properties: Json) -> Json:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": properties}


def _line_feature(track: Track, origin: GeoOrigin | None, epoch_s: float | None) -> Json:
    coordinates = _coordinates(track.position_m, origin)
    start, end = dates_or_none(track.time_s[[0, -1]], epoch_s)
    properties: Json = {
        "feature": "track",
        "device": str(track.device[0]),
        "estimator": track.estimator,
        "kind": track.kind,
        "start": start,
        "end": end,
        "start_s": round(float(track.time_s[0]), 6),
        "end_s": round(float(track.time_s[-1]), 6),
        "steps": len(track) - 1,
        "distance_m": round(track.distance_m, 3),
    }
    if len(track) == 1:
        return _feature("Point", coordinates[0], properties)
    return _feature("LineString", coordinates, properties)


def _fix_features(fixes: Sequence[PositionFix], origin: GeoOrigin | None, epoch_s: float | None) -> list[Json]:
    if not fixes:
        return []
    coordinates = _coordinates(np.array([fix.position_m for fix in fixes]), origin)
    dates = dates_or_none(np.array([fix.time_s for fix in fixes]), epoch_s)
    return [_fix_feature(fix, at, date) for fix, at, date in zip(fixes, coordinates, dates, strict=True)]


def _fix_feature(fix: PositionFix, coordinates: list[float], date: str | None) -> Json:
    properties: Json = {
        "feature": "fix",
        "source": fix.source,
        "time": date,
        "time_s": round(float(fix.time_s), 6),
        "sigma_east_m": _number(math.sqrt(fix.covariance_m2[0, 0]), 3),
        "sigma_north_m": _number(math.sqrt(fix.covariance_m2[1, 1]), 3),
    }
    return _feature("Point", coordinates, properties)


def _heights(track: Track) -> list[Json]:
    """Return height and floor of each pose, where they are known."""
    profile = track.height
    if profile is None:
        return [{}] * len(track)
    return [
        {
            "height_m": _number(profile.height_m[place], 3),
            "sigma_height_m": _number(profile.sigma_m[place], 3),
            "floor": int(profile.floor[place]),
            "floor_probability": _number(profile.floor_probability[place], 4),
        }
        for place in profile.nearest(track.time_s).tolist()
    ]


def _pose_features(track: Track, origin: GeoOrigin | None, epoch_s: float | None) -> list[Json]:
    heights = _heights(track)
    dates, headings = dates_or_none(track.time_s, epoch_s), wrap_angle(track.heading_rad)
    return [
        _feature(
            "Point",
            coordinates,
            {
                "feature": "pose",
                "device": str(track.device[i]),
                "time": dates[i],
                "time_s": round(float(track.time_s[i]), 6),
                "heading_rad": _number(headings[i], 6),
                "sigma_heading_rad": _number(track.sigma_heading_rad[i], 6),
                "cov_xx_m2": _number(track.covariance_m2[i, 0, 0], 9),
                "cov_xy_m2": _number(track.covariance_m2[i, 0, 1], 9),
                "cov_yy_m2": _number(track.covariance_m2[i, 1, 1], 9),
                "mode": CarryingMode(int(track.mode[i])).name,
                "step_length_m": _number(track.step_length_m[i], 4),
                **heights[i],
            },
        )
        for i, coordinates in enumerate(_coordinates(track.position_m, origin))
    ]


def _ellipse_features(track: Track, origin: GeoOrigin | None, epoch_s: float | None) -> Iterator[Json]:
    ellipses = ellipses_of_poses(track.position_m, track.covariance_m2, track.region)
    dates, rings = dates_or_none(track.time_s, epoch_s), ellipses95(ellipses.centre_m, ellipses.covariance_m2)
    drawn = [(k, ring) for k, ring in enumerate(rings) if ring is not None]
    if not drawn:
        return
    # All at once, as one by one is slow, and to about 1 cm: ellipses make most of the file.
    corners = _coordinates(np.concatenate([ring for _, ring in drawn]), origin, coarser=1)
    size = len(drawn[0][1])
    for number, (k, _) in enumerate(drawn):
        i = ellipses.pose[k]
        properties: Json = {
            "feature": "ellipse",
            "device": str(track.device[i]),
            "time": dates[i],
            "time_s": round(float(track.time_s[i]), 6),
            "probability": 0.95,
        }
        if track.region is not None:
            properties["weight"] = _number(ellipses.weight[k], 4)
        yield _feature("Polygon", [corners[size * number : size * (number + 1)]], properties)


def _number(value: float, digits: int) -> float | None:
    """Round a number for JSON, which has neither NaN nor infinity; those become None."""
    return round(float(value), digits) if math.isfinite(value) else None
