"""Read trajectories from GeoJSON (RFC 7946) and GPX 1.0 and 1.1."""

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

from pdr_est.errors import RecordingError
from pdr_est.io.side_tables.fix_table import (
    GEODETIC_COLUMNS,
    MAP_COLUMNS,
    TRAJECTORY_COLUMNS,
    position_table_of_cells,
)
from pdr_est.io.text.geojson import features_of, properties_of, simple_geometries
from pdr_est.io.trajectories.trajectory import Trajectory, trajectory_from_table

_TIMES_OF_LINES = ("coordTimes", "times", "time_s")
_UNTIMED = "give each position a time"

Row = dict[str, Any]


def read_geojson_trajectory(data: bytes, place: str) -> Trajectory:
    """Read the points with times of a GeoJSON document, or its lines with a time for each vertex.

    A point has its time in a property such as `time_s` or `time`; a line in one of the lists `coordTimes`, `times` or
    `time_s`, of the same length. Points are preferred where there are both, and what pdr-est wrote as fix, truth or
    ellipse is left out. Coordinates are longitude and latitude, unless the member `coordinate_unit` of the collection
    is "metre", as pdr-est writes it.

    Raises
    ------
    RecordingError
        For a file that is no GeoJSON, positions without times, and as `trajectory_from_table` does.
    """
    try:
        document = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise RecordingError(f"{place}: is no JSON ({error}): export it again") from error
    features = _features(document, place)
    metres = isinstance(document, dict) and document.get("coordinate_unit") == "metre"
    names = MAP_COLUMNS if metres else tuple(reversed(GEODETIC_COLUMNS))
    points = [row for feature in features for row in _point_rows(feature, names, place)]
    rows = points or [row for feature in features for row in _line_rows(feature, names, place)]
    if not rows:
        raise RecordingError(
            f"{place}: no point with a time in a property such as time_s, and no line with a list coordTimes: "
            f"{_UNTIMED}, as `pdr-est` does in track.geojson with timed points"
        )
    titles = dict.fromkeys(title for row in rows for title in row)
    cells = {title: [row.get(title) for row in rows] for title in titles}
    table = position_table_of_cells(cells, place, TRAJECTORY_COLUMNS, "position")
    return trajectory_from_table(table, "GeoJSON", "position", 1)


def _features(document: Any, place: str) -> list[Mapping[str, Any]]:
    found = features_of(document)
    if found is None:
        raise RecordingError(f"{place}: is no GeoJSON Feature or FeatureCollection: give one with timed points")
    return found


def _point_rows(feature: Mapping[str, Any], names: tuple[str, ...], place: str) -> Iterator[Row]:
    properties = properties_of(feature)
    if properties.get("feature") in _NO_POSES or not _has_time(properties):
        return
    # Numbers and short texts only: what else a program writes about a point is no column of a trajectory.
    own = {key: value for key, value in properties.items() if isinstance(value, int | float | str | None)}
    for coordinates in _single(feature, "Point"):
        yield {**own, **_coordinates(coordinates, names, place)}


def _line_rows(feature: Mapping[str, Any], names: tuple[str, ...], place: str) -> Iterator[Row]:
    properties = properties_of(feature)
    times = next((properties[name] for name in _TIMES_OF_LINES if isinstance(properties.get(name), list)), None)
    device = properties.get("device") or properties.get("name")
    for vertices in _single(feature, "LineString"):
        if times is None or not isinstance(vertices, list):
            continue
        if len(times) != len(vertices):
            raise RecordingError(f"{place}: a line has {len(vertices)} vertices and {len(times)} times: {_UNTIMED}")
        for time, vertex in zip(times, vertices, strict=True):
            yield {"time": time, "device": device, **_coordinates(vertex, names, place)}


def _single(feature: Mapping[str, Any], kind: str) -> list[Any]:
    """Return the coordinates of a feature that is one geometry of a kind; several would share their times."""
    shapes = list(simple_geometries(feature.get("geometry")))
    return [coordinates for found, coordinates in shapes if found == kind and len(shapes) == 1]


_NO_POSES = ("fix", "truth", "ellipse")  # features of pdr-est that are no poses of the track


def _has_time(properties: Mapping[str, Any]) -> bool:
    _, titles = TRAJECTORY_COLUMNS["time_s"]
    return any(key.casefold() == "time_s" or re.sub(r"[\W_]", "", key.casefold()) in titles for key in properties)


def _coordinates(vertex: Any, names: tuple[str, ...], place: str) -> Row:
    if not isinstance(vertex, list) or len(vertex) < 2:
        raise RecordingError(f"{place}: {str(vertex)[:60]} is no pair of coordinates: export the file again")
    return dict(zip(names, vertex, strict=False))


def read_gpx(data: bytes, place: str) -> Trajectory:
    """Read the track points of a GPX file, or its waypoints where it has no tracks; each needs a time.

    The name of a track is that of the device. Elevations are not used.

    Raises
    ------
    RecordingError
        For a file that is no GPX, points without times, and as `trajectory_from_table` does.
    """
    from xml.etree.ElementTree import ParseError

    from defusedxml import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        root = fromstring(data)
    except (ParseError, DefusedXmlException, ValueError) as error:
        raise RecordingError(f"{place}: is no XML that can be read ({error}): export the GPX file again") from error
    if _plain_tag(root) != "gpx":
        raise RecordingError(f"{place}: is {_plain_tag(root)!r} and no GPX: give GPX, GeoJSON, TUM or a table")
    rows = [row for track in root if _plain_tag(track) == "trk" for row in _gpx_points(track, "trkpt", place)]
    rows = rows or list(_gpx_points(root, "wpt", place))
    if not rows:
        raise RecordingError(f"{place}: has neither track points nor waypoints: give a recorded track")
    cells = {title: [row[title] for row in rows] for title in rows[0]}
    table = position_table_of_cells(cells, place, TRAJECTORY_COLUMNS, "point")
    return trajectory_from_table(table, "GPX", "point", 1)


def _gpx_points(parent: Any, tag: str, place: str) -> Iterator[Row]:
    """Go through the points of a track, or of the file; a waypoint's name is no device."""
    name = _text_of(parent, "name") if tag == "trkpt" else ""
    for number, point in enumerate((one for one in parent.iter() if _plain_tag(one) == tag), start=1):
        time = _text_of(point, "time")
        if not time:
            raise RecordingError(f"{place}, {tag} {number}: has no <time>: {_UNTIMED}; a planned route has none")
        yield {
            "time": time,
            "latitude_deg": point.get("lat"),
            "longitude_deg": point.get("lon"),
            "device": name,
        }


def _text_of(element: Any, tag: str) -> str:
    return next(((one.text or "").strip() for one in element if _plain_tag(one) == tag), "")


def _plain_tag(element: Any) -> str:
    """Return the tag without its namespace, which differs between the versions of GPX."""
    return str(element.tag).rpartition("}")[2]
