"""Recognise and read the background that the user names."""

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pdr_est.errors import ConfigError, RecordingError
from pdr_est.frames import Array
from pdr_est.io.text.geojson import features_of, simple_geometries
from pdr_est.report.background.kinds import (
    PICTURE_TYPES,
    Background,
    LineBackground,
    NetworkTiles,
    PictureBackground,
    TileFolder,
)

_WHAT = (
    "a picture (.png, .jpg, .gif, .webp) with a world file beside it, GeoJSON, a folder of tiles zoom/x/y.png, or "
    "https://…/{z}/{x}/{y}.png"
)
_LARGEST_BYTES = 20_000_000
_SMALLEST_PIXEL_M = 1e-3  # a plan with finer pixels is in degrees


def read_background(text: str) -> Background:
    """Read a background.

    Parameters
    ----------
    text
        Path of a picture with a world file beside it, of a GeoJSON file, or of a folder of tiles; or the address of a
        tile server with {z}, {x} and {y}, which the page then loads tiles from.

    Raises
    ------
    ConfigError
        For something else, or an address that is not of tiles.
    RecordingError
        For a file that cannot be read.
    """
    if re.match(r"[a-z]+://", text):
        return _network_tiles(text)
    path = Path(text)
    if path.is_dir():
        return TileFolder(path)
    if not path.is_file():
        raise RecordingError(f"{path}: no such file or folder: give {_WHAT}")
    if path.suffix.lower() in PICTURE_TYPES:
        return _picture(path)
    if path.suffix.lower() in (".geojson", ".json"):
        return _lines(path)
    raise ConfigError(f"{path}: is no background: give {_WHAT}")


def _network_tiles(text: str) -> NetworkTiles:
    complete = all(part in text for part in ("{z}", "{x}", "{y}"))
    if not complete or not re.fullmatch(r"https?://[\w.:-]+/[^\s\"'<>;,]*", text):
        raise ConfigError(f"{text}: is no address of map tiles: give one like https://…/{{z}}/{{x}}/{{y}}.png")
    return NetworkTiles(text)


def _content(path: Path) -> bytes:
    try:
        if path.stat().st_size > _LARGEST_BYTES:
            raise RecordingError(
                f"{path}: has more than {_LARGEST_BYTES // 1_000_000} MB, and would stand inside the report: give a "
                "smaller one"
            )
        return path.read_bytes()
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror}): give a file that can") from error


def _picture(path: Path) -> PictureBackground:
    a, d, b, e, c, f = _world_file(path)
    if abs(b) > 1e-9 or abs(d) > 1e-9 or a <= 0.0 or e >= 0.0:
        raise RecordingError(
            f"{path}: its world file turns or mirrors the picture: give a picture with north up, whose third and "
            "second lines are 0, the first is positive and the fourth negative"
        )
    pixel = np.array([a, e])
    corner = np.array([c, f]) - 0.5 * pixel  # the file gives the middle of the first pixel
    in_degrees = a < _SMALLEST_PIXEL_M and abs(c) <= 180.0 and abs(f) <= 90.0
    return PictureBackground(path, _content(path), PICTURE_TYPES[path.suffix.lower()], pixel, corner, in_degrees)


def _world_file(path: Path) -> list[float]:
    """Read the six numbers of the world file of a picture."""
    suffix = path.suffix
    names = [f"{suffix[:2]}{suffix[-1]}w", f"{suffix}w", ".wld"]  # .pgw, .pngw, .wld
    beside = [path.with_suffix(name) for name in names]
    world = next((one for one in beside if one.is_file()), None)
    if world is None:
        raise RecordingError(
            f"{path}: where it lies is unknown: write a world file {beside[0].name} beside it with six lines: width "
            "of a pixel (m), 0, 0, minus its height (m), x and y of the middle of the upper left pixel (m)"
        )
    try:
        numbers = [float(word) for word in _content(world).decode("ascii").split()]
    except ValueError as error:
        raise RecordingError(f"{world}: is no world file ({error}): give six lines with a number each") from error
    if len(numbers) != 6 or not all(map(math.isfinite, numbers)):
        raise RecordingError(f"{world}: is no world file: give six lines with a finite number each")
    return numbers


def _lines(path: Path) -> LineBackground:
    try:
        document = json.loads(_content(path))
        lines = tuple(_lines_of(features_of(document)))
    except (ValueError, TypeError, RecursionError) as error:
        raise RecordingError(f"{path}: is no GeoJSON ({error}): export it again") from error
    if not lines:
        raise RecordingError(f"{path}: holds no line and no polygon: give GeoJSON with the lines of a plan")
    return LineBackground(lines, document.get("coordinate_unit") != "metre")


def _lines_of(features: Sequence[Mapping[str, Any]] | None) -> Iterator[Array]:
    """List the lines of features; polygons give their rings, points nothing."""
    if features is None:
        raise ValueError("neither features nor a geometry")
    for feature in features:
        for kind, coordinates in simple_geometries(feature.get("geometry")):
            lines = {"LineString": [coordinates], "Polygon": coordinates}.get(kind, [])
            yield from (_points(line) for line in lines)


def _points(coordinates: list[list[float]]) -> Array:
    points = np.array([point[:2] for point in coordinates], dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise ValueError("a line without finite coordinates")
    return points
