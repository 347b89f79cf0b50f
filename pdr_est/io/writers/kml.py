"""Write a track as KML 2.2 for Google Earth, with times where the date of the recording is known."""

from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from pdr_est.io.writers.geodesy import (
    compass_deg,
    dates_or_none,
    degree_texts,
    longitude_latitude,
    semi_axes95_m,
    utc_texts,
)
from pdr_est.io.writers.xml_elements import add_element, write_document
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

_COLOURS = ("ff0000ff", "ffff8000", "ff00a000", "ffff00ff")  # alpha, blue, green, red
_SCHEMA = "pose"
_ARRAYS = (("radius95_m", "float"), ("mode", "string"))
_GROUND = "clampToGround"


def write_kml(
    track: Track,
    path: str | Path,
    origin: GeoOrigin,
    *,
    fixes: Sequence[PositionFix] = (),
    epoch_s: float | None = None,
    name: str = "track",
) -> None:
    """Write a placemark for each device and each fix, clamped to the ground.

    Where the date is known, a device is a `gx:Track`, whose poses have a time, a heading (degrees clockwise from
    north), the semi-major axis of the 95 % ellipse and the carrying mode. Without a date it is a line (a point for a
    single pose), and the description says that times are unknown.

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
    dated = utc_texts(track.time_s, epoch_s) is not None
    namespaces = {"xmlns": "http://www.opengis.net/kml/2.2", "xmlns:gx": "http://www.google.com/kml/ext/2.2"}
    root = Element("kml", namespaces)
    document = SubElement(root, "Document")
    add_element(document, "name", name)
    add_element(document, "description", _description(track, dated))
    for number in range(len(track.devices)):
        _add_style(document, number)
    schema = SubElement(document, "Schema", {"id": _SCHEMA})
    for array, kind in _ARRAYS:
        SubElement(schema, "gx:SimpleArrayField", {"name": array, "type": kind})
    for number, device in enumerate(track.devices):
        place = SubElement(document, "Placemark")
        add_element(place, "name", device)
        add_element(place, "styleUrl", f"#{_style(number)}")
        _add_poses(place, track.of_device(device), origin, epoch_s)
    _add_fixes(document, fixes, origin, epoch_s)
    write_document(path, root)


def _description(track: Track, dated: bool) -> str:
    words = "" if dated else " The date of the recording is unknown: there are no times."
    return f"Pedestrian track by {track.estimator} ({track.kind}), WGS 84.{words}"


def _style(number: int) -> str:
    return f"device{number + 1}"


def _add_style(document: Element, number: int) -> None:
    style = SubElement(document, "Style", {"id": _style(number)})
    line = SubElement(style, "LineStyle")
    add_element(line, "color", _COLOURS[number % len(_COLOURS)])
    add_element(line, "width", "4")


def _add_poses(place: Element, track: Track, origin: GeoOrigin, epoch_s: float | None) -> None:
    coordinates = degree_texts(longitude_latitude(track.position_m, origin))
    dates = utc_texts(track.time_s, epoch_s)
    if dates is None:
        shape = SubElement(place, "Point" if len(track) == 1 else "LineString")
        if len(track) > 1:
            add_element(shape, "tessellate", "1")
        add_element(shape, "altitudeMode", _GROUND)
        add_element(shape, "coordinates", " ".join(f"{x},{y},0" for x, y in coordinates))
        return
    shape = SubElement(place, "gx:Track")
    add_element(shape, "altitudeMode", _GROUND)
    for date in dates:
        add_element(shape, "when", date)
    for angle in compass_deg(track.heading_rad).tolist():
        add_element(shape, "gx:angles", f"{angle:.2f} 0 0")
    for x, y in coordinates:
        add_element(shape, "gx:coord", f"{x} {y} 0")
    data = SubElement(SubElement(shape, "ExtendedData"), "SchemaData", {"schemaUrl": f"#{_SCHEMA}"})
    radii = [f"{radius:.2f}" for radius in semi_axes95_m(track.covariance_m2)[:, 0].tolist()]
    modes = [CarryingMode(int(mode)).name for mode in track.mode]
    for (array, _), values in zip(_ARRAYS, (radii, modes), strict=True):
        element = SubElement(data, "gx:SimpleArrayData", {"name": array})
        for value in values:
            add_element(element, "gx:value", value)


def _add_fixes(document: Element, fixes: Sequence[PositionFix], origin: GeoOrigin, epoch_s: float | None) -> None:
    if not fixes:
        return
    folder = SubElement(document, "Folder")
    add_element(folder, "name", "fixes")
    coordinates = degree_texts(longitude_latitude(np.array([fix.position_m for fix in fixes]), origin))
    dates = dates_or_none(np.array([fix.time_s for fix in fixes]), epoch_s)
    for fix, (x, y), date in zip(fixes, coordinates, dates, strict=True):
        place = SubElement(folder, "Placemark")
        add_element(place, "name", fix.source)
        if date is not None:
            add_element(SubElement(place, "TimeStamp"), "when", date)
        point = SubElement(place, "Point")
        add_element(point, "altitudeMode", _GROUND)
        add_element(point, "coordinates", f"{x},{y},0")
