"""Write a track as GPX 1.1, with times where the date of the recording is known."""

from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from pdr_est.frames import Array
from pdr_est.io.writers.geodesy import dates_or_none, degree_texts, longitude_latitude, utc_texts
from pdr_est.io.writers.xml_elements import add_element, write_document
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin
from pdr_est.types.track import Track


def write_gpx(
    track: Track,
    path: str | Path,
    origin: GeoOrigin,
    *,
    fixes: Sequence[PositionFix] = (),
    epoch_s: float | None = None,
    name: str = "track",
) -> None:
    """Write a GPX track (`trk`) for each device, and a waypoint for each fix.

    Points have a time where the date of the recording is known; otherwise the description says that it is not. GPX
    has no place for a covariance.

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
    name
        Name of the walk.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    attributes = {"version": "1.1", "creator": "pdr-est", "xmlns": "http://www.topografix.com/GPX/1/1"}
    root = Element("gpx", attributes)
    start = utc_texts(track.time_s[:1], epoch_s)
    metadata = SubElement(root, "metadata")
    add_element(metadata, "name", name)
    words = "" if start else " The date of the recording is unknown: there are no times."
    add_element(metadata, "desc", f"Pedestrian track by {track.estimator} ({track.kind}).{words}")
    if start:
        add_element(metadata, "time", start[0])
    if fixes:
        position_m = np.array([fix.position_m for fix in fixes])
        points = _add_points(root, "wpt", position_m, np.array([fix.time_s for fix in fixes]), origin, epoch_s)
        for fix, point in zip(fixes, points, strict=True):
            add_element(point, "name", fix.source)
    for device in track.devices:
        one = track.of_device(device)
        line = SubElement(root, "trk")
        add_element(line, "name", device)
        _add_points(SubElement(line, "trkseg"), "trkpt", one.position_m, one.time_s, origin, epoch_s)
    write_document(path, root)


def _add_points(
    parent: Element,
    tag: str,
    position_m: Array,
    time_s: Array,
    origin: GeoOrigin,
    epoch_s: float | None,
) -> list[Element]:
    dates = dates_or_none(time_s, epoch_s)
    points = []
    for (x, y), date in zip(degree_texts(longitude_latitude(position_m, origin)), dates, strict=True):
        point = SubElement(parent, tag, {"lat": y, "lon": x})
        if date is not None:
            add_element(point, "time", date)
        points.append(point)
    return points
