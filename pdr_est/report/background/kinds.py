"""Kinds of backgrounds, and how each is placed in the frame of a track for the script `map_background.js`."""

import base64
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Protocol
from urllib.parse import urlsplit

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.report.background.placement import MapPlacement, from_degrees, metres_per_degree
from pdr_est.report.packed_columns import pack_column
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.recording import GeoOrigin

Json = dict[str, Any]

MOST_TILES = 64  # in one page: about 1 MB
LINE_STEP_M = 0.01
PICTURE_TYPES: Mapping[str, str] = MappingProxyType(
    {
        ".png": "image/png",
        ".jpg": "image/jpeg",
        ".jpeg": "image/jpeg",
        ".gif": "image/gif",
        ".webp": "image/webp",
    }
)


class Background(Protocol):
    """Something that lies below the track."""

    @property
    def image_hosts(self) -> tuple[str, ...]:
        """Origins that the page loads pictures from."""

    def placed(self, placement: MapPlacement, low_m: Array, high_m: Array) -> Json:
        """Describe it for the script, in the frame of the track, which fills a rectangle from `low_m` to `high_m`.

        Raises
        ------
        RecordingError
            If it cannot be placed.
        """


@dataclass(frozen=True)
class PictureBackground:
    """Picture with square corners to the axes of the map.

    Attributes
    ----------
    place
        Path, for messages.
    content
        The file.
    media_type
        Its type, such as "image/png".
    pixel
        Size of a pixel along x and along y, where a picture goes from north to south: (2,) m or degrees.
    corner
        (2,) x and y of the outer corner of the first pixel, m or degrees.
    in_degrees
        True for longitudes and latitudes.
    """

    place: Path
    content: bytes
    media_type: str
    pixel: Array
    corner: Array
    in_degrees: bool
    image_hosts: tuple[str, ...] = ()

    def placed(self, placement: MapPlacement, low_m: Array, high_m: Array) -> Json:
        """Describe the picture by its corner and the size of its pixels."""
        corner_m, pixel_m = self.corner, self.pixel
        if self.in_degrees:
            origin = placement.on_earth()
            corner_m, pixel_m = from_degrees(self.corner, origin), self.pixel * metres_per_degree(origin)
        return {
            "kind": "picture",
            "url": _data_url(self.content, self.media_type),
            "corner_m": (corner_m - placement.in_metres()).tolist(),
            "pixel_m": pixel_m.tolist(),
        }


@dataclass(frozen=True)
class LineBackground:
    """Lines of a plan.

    Attributes
    ----------
    lines
        Points of each line (n, 2), m or degrees.
    in_degrees
        True for longitudes and latitudes.
    rings
        How many of the first lines are borders of walkable floor, which is shaded.
    """

    lines: tuple[Array, ...]
    in_degrees: bool = False
    rings: int = 0
    image_hosts: tuple[str, ...] = ()

    def placed(self, placement: MapPlacement, low_m: Array, high_m: Array) -> Json:
        """Describe the points of all lines, with a missing point between two lines."""
        lines = [from_degrees(line, placement.on_earth()) if self.in_degrees else line for line in self.lines]
        gap = np.full((1, 2), np.nan)
        points = np.concatenate([part for line in lines for part in (line, gap)]) - placement.in_metres()
        packed = {name: pack_column(points[:, axis], LINE_STEP_M) for axis, name in enumerate(("x_m", "y_m"))}
        return {"kind": "lines", "points": packed, "rings": self.rings}


def plan_background(plan: FloorPlan) -> LineBackground:
    """Return the borders of the walkable floor and the walls of a floor plan as lines."""
    rings = [np.vstack([ring, ring[:1]]) for ring in plan.rings_m()]
    return LineBackground((*rings, *plan.walls_m), rings=len(rings))


@dataclass(frozen=True)
class TileFolder:
    """Folder of map tiles `zoom/x/y.png` in the Web Mercator scheme, of which some become part of the page.

    Attributes
    ----------
    place
        The folder.
    """

    place: Path
    image_hosts: tuple[str, ...] = ()

    def placed(self, placement: MapPlacement, low_m: Array, high_m: Array) -> Json:
        """Put the tiles about the track, of the finest zoom of which few enough are needed, into the page."""
        origin = placement.on_earth()
        shift_m, room_m = placement.in_metres(), 0.3 * float((high_m - low_m).max()) + 10.0
        corners = np.array([low_m - room_m, high_m + room_m]) + shift_m
        west_south, east_north = corners / metres_per_degree(origin) + [origin.longitude_deg, origin.latitude_deg]
        zooms = sorted((int(one.name) for one in self.place.iterdir() if one.name.isdecimal()), reverse=True)
        for zoom in zooms:
            (left, low), (right, high) = (_tile_of(place, zoom) for place in (west_south, east_north))
            if (right - left + 1) * (low - high + 1) > MOST_TILES:
                continue
            paths = {
                f"{zoom}/{x}/{y}": path
                for x in range(left, right + 1)
                for y in range(high, low + 1)
                for path in (self.place / str(zoom) / str(x)).glob(f"{y}.*")
                if path.suffix.lower() in PICTURE_TYPES
            }
            if paths:
                tiles = {name: _data_url(path.read_bytes(), _media_type(path)) for name, path in paths.items()}
                return _earth_frame(origin, shift_m) | {"kind": "tiles", "tiles": tiles, "zooms": [zoom, zoom]}
        raise RecordingError(
            f"{self.place}: holds no tile where the track lies, about latitude {origin.latitude_deg:.4f}°, longitude "
            f"{origin.longitude_deg:.4f}°: give a folder with zoom/x/y.png of this place"
        )


@dataclass(frozen=True)
class NetworkTiles:
    """Map tiles that the reader's browser loads from a server.

    Attributes
    ----------
    template
        Address with {z}, {x} and {y}.
    """

    template: str

    @property
    def image_hosts(self) -> tuple[str, ...]:
        """Origin of the server."""
        parts = urlsplit(self.template)
        return (f"{parts.scheme}://{parts.netloc}",)

    def placed(self, placement: MapPlacement, low_m: Array, high_m: Array) -> Json:
        """Describe where the tiles come from."""
        host = urlsplit(self.template).hostname or ""
        credit = "© OpenStreetMap contributors" if host.endswith("openstreetmap.org") else f"Map: {host}"
        frame = _earth_frame(placement.on_earth(), placement.in_metres())
        return frame | {"kind": "tiles", "url": self.template, "zooms": [0, 19], "credit": credit}


def _earth_frame(origin: GeoOrigin, shift_m: Array) -> Json:
    """Describe where a point of the frame of the track lies on the Earth."""
    return {
        "origin_deg": [origin.longitude_deg, origin.latitude_deg],
        "metres_per_degree": metres_per_degree(origin),
        "shift_m": shift_m.tolist(),
    }


def _tile_of(longitude_latitude: Array, zoom: int) -> tuple[int, int]:
    """Find the column and row of the Web Mercator tile that holds a place."""
    longitude, latitude = (float(value) for value in longitude_latitude)
    count = 2**zoom
    across = (longitude + 180.0) / 360.0
    down = 0.5 - math.asinh(math.tan(math.radians(latitude))) / (2.0 * math.pi)
    return int(across * count), int(down * count)


def _media_type(path: Path) -> str:
    return PICTURE_TYPES[path.suffix.lower()]


def _data_url(content: bytes, media_type: str) -> str:
    return f"data:{media_type};base64,{base64.b64encode(content).decode('ascii')}"
