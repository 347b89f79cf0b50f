"""Make a floor plan of a picture: dark lines are walls, and two points of it are known in the map."""

import io
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import FloorPlanError, RecordingError
from pdr_est.frames import Array
from pdr_est.io.floor_plans.plan_units import require_near, required_sigma_m
from pdr_est.io.floor_plans.shapes import DrawnFloor, DrawnPolygon
from pdr_est.io.floor_plans.walkable import walkable_areas
from pdr_est.io.text.container import Source
from pdr_est.types.floor_plan import FloorPlan

LEAST_WALL_M = 1.0
"""Length of the shortest dark piece that is a wall, m; shorter ones are letters and furniture (ours)."""

LEAST_ROOM_M2 = 1.0
"""Smallest room that is walkable, m²; smaller ones are the insides of letters and of double lines (ours)."""

PICTURE_BEGINS = (b"\x89PNG", b"\xff\xd8\xff", b"GIF8", b"BM", b"II*\x00", b"MM\x00*", b"RIFF")
"""First bytes of PNG, JPEG, GIF, BMP, TIFF and WebP."""

_JPEG = b"\xff\xd8\xff"
_MOST_PIXELS = 100_000_000
_METRES_PER_PIXEL = (1e-3, 2.0)


@dataclass(frozen=True)
class KnownPoint:
    """Point of a picture whose position in the map is known.

    Attributes
    ----------
    column, row
        Place in the picture in pixels, from its upper left corner.
    x_m, y_m
        East and north in the map, m.
    """

    column: float
    row: float
    x_m: float
    y_m: float


def read_plan_picture(
    path: str | Path,
    points: Sequence[KnownPoint],
    *,
    darkness: float | None = None,
    inside_m: Sequence[tuple[float, float]] = (),
    floor: str = "",
    sigma_m: float | None = None,
) -> FloorPlan:
    """Make the plan of a floor from a picture of it.

    Parameters
    ----------
    path
        PNG, JPEG, TIFF or another picture.
    points
        Two points far apart; scale and rotation of the picture follow from them.
    darkness
        Pixels at least this dark, from 0 for white to 1 for black, are walls. By default the threshold that divides
        the pixels best into two groups (Otsu).
    inside_m
        Positions in the map, each in a room that is walkable. By default all rooms are that do not reach the edge of
        the picture.
    floor
        Name of the floor.
    sigma_m
        Standard deviation of the drawing, m; by default the width of two pixels, and at least 0.1 m.

    Raises
    ------
    FloorPlanError
        For a file that is no picture, points that give no scale, a picture without rooms, and where the packages of
        the extra `map` are not installed.
    """
    place = str(path)
    image = _picture(Path(path), place)
    to_map = _PictureToMap.of_points(points, image.shape, place)
    sigma = max(2.0 * to_map.metres_per_pixel, 0.1) if sigma_m is None else required_sigma_m(sigma_m, place)
    room = _rooms(image, to_map, darkness, inside_m, place)
    drawn = DrawnFloor(floor=_outlines(_skimage(place).measure, room, to_map))
    areas, _ = walkable_areas(drawn, place, repair=True)
    return FloorPlan(Path(path).stem, areas, np.empty((0, 2, 2)), sigma, floor)


@dataclass(frozen=True)
class _PictureToMap:
    """Similarity from columns and rows to the map, as complex numbers: the picture is mirrored, for rows go down."""

    factor: complex
    offset: complex

    @classmethod
    def of_points(cls, points: Sequence[KnownPoint], shape: tuple[int, ...], place: str) -> "_PictureToMap":
        if len(points) != 2:
            raise FloorPlanError(f"{place}: {len(points)} known points: give two that are far apart (--point)")
        for one in points:
            if not (0.0 <= one.column <= shape[1] and 0.0 <= one.row <= shape[0]):
                raise FloorPlanError(
                    f"{place}: the point at column {one.column:g}, row {one.row:g} lies outside of the picture of "
                    f"{shape[1]} x {shape[0]} pixels: count from its upper left corner"
                )
            if not (math.isfinite(one.x_m) and math.isfinite(one.y_m)):
                raise FloorPlanError(f"{place}: the known point ({one.x_m}, {one.y_m}) m is no position: correct it")
        require_near(np.array([(one.x_m, one.y_m) for one in points]), place)
        first, second = (complex(one.column, -one.row) for one in points)
        map_first, map_second = (complex(one.x_m, one.y_m) for one in points)
        factor = (map_second - map_first) / (second - first) if first != second else 0j
        low, high = _METRES_PER_PIXEL
        if not low <= abs(factor) <= high:
            raise FloorPlanError(
                f"{place}: by the two known points a pixel is {abs(factor):g} m wide, which no plan is: give column, "
                "row, x and y of two points that are far apart"
            )
        return cls(factor, map_first - factor * first)

    @property
    def metres_per_pixel(self) -> float:
        return abs(self.factor)

    def positions(self, row_column: Array) -> Array:
        """Convert rows and columns (n, 2) to positions (n, 2), m."""
        at = self.factor * (row_column[:, 1] - 1j * row_column[:, 0]) + self.offset
        return np.column_stack([at.real, at.imag])

    def pixel(self, position_m: tuple[float, float]) -> tuple[int, int]:
        """Return row and column of a position."""
        at = (complex(*position_m) - self.offset) / self.factor
        return math.floor(-at.imag), math.floor(at.real)


def _skimage(place: str) -> Any:
    try:
        import skimage
    except ImportError as error:
        raise FloorPlanError(f"{place}: pictures need scikit-image: `pip install pdr-est[map]`") from error
    return skimage


def _picture(path: Path, place: str) -> Array:
    """Read the brightness (rows, columns) of a picture, 0 for black to 1 for white, on white paper."""
    skimage = _skimage(place)
    try:
        source = Source.open(path)
        data = source.read(source.members[0]) if len(source.members) == 1 else b""
    except RecordingError as error:  # of files in general: missing, unreadable
        raise FloorPlanError(str(error)) from error
    if not data.startswith(PICTURE_BEGINS):
        raise FloorPlanError(f"{place}: is no picture: give PNG, JPEG or TIFF")
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("error", "Image size")  # of a size that fills the memory
            image = _upright_photo(data) if data.startswith(_JPEG) else skimage.io.imread(io.BytesIO(data))
    except Exception as error:  # each of the libraries for pictures has its own errors
        raise FloorPlanError(f"{place}: is no picture that can be read ({error}): give PNG, JPEG or TIFF") from error
    if image.ndim not in (2, 3) or image.shape[0] * image.shape[1] > _MOST_PIXELS:
        raise FloorPlanError(f"{place}: an image of shape {image.shape}: give one page of at most 100 megapixels")
    if image.dtype.kind not in "uib" and not np.isfinite(image).all():
        raise FloorPlanError(f"{place}: holds brightnesses that are no finite numbers: export it again")
    image = skimage.util.img_as_float(image)
    if image.ndim == 2:
        return np.asarray(image, dtype=np.float64)
    if image.shape[2] in (2, 4):  # the last channel is the opacity
        image = image[..., :-1] * image[..., -1:] + 1.0 - image[..., -1:]
    return np.asarray(image.mean(axis=2), dtype=np.float64)


def _upright_photo(data: bytes) -> Any:
    """Read a photo turned as every program shows it: phones store how they were held beside the pixels."""
    from PIL import Image, ImageOps

    with Image.open(io.BytesIO(data)) as photo:
        return np.asarray(ImageOps.exif_transpose(photo).convert("RGB"))


def _rooms(
    image: Array,
    to_map: _PictureToMap,
    darkness: float | None,
    inside_m: Sequence[tuple[float, float]],
    place: str,
) -> NDArray[np.int64]:
    """Return the number of the walkable room that each pixel (rows, columns) belongs to; 0 elsewhere."""
    skimage = _skimage(place)
    if np.ptp(image) == 0.0:
        raise FloorPlanError(f"{place}: the picture has a single colour: give one with walls")
    dark = image <= (skimage.filters.threshold_otsu(image) if darkness is None else 1.0 - darkness)
    walls = _without_small_pieces(skimage, dark, LEAST_WALL_M / to_map.metres_per_pixel)
    room: NDArray[np.int64] = skimage.measure.label(~walls, connectivity=1)
    if inside_m:
        chosen = [_room_at(room, to_map, one, place) for one in inside_m]
    else:
        at_edge = np.unique(np.concatenate([room[0], room[-1], room[:, 0], room[:, -1]]))
        size_m2 = np.bincount(room.ravel()) * to_map.metres_per_pixel**2
        chosen = [k for k in np.flatnonzero(size_m2 >= LEAST_ROOM_M2).tolist() if k and k not in at_edge]
    if not chosen:
        raise FloorPlanError(
            f"{place}: no room is closed by walls: give a position in one that is walkable (--inside X Y), or "
            "another --darkness"
        )
    return np.where(np.isin(room, chosen), room, 0)


def _room_at(room: NDArray[np.int64], to_map: _PictureToMap, position_m: tuple[float, float], place: str) -> int:
    row, column = to_map.pixel(position_m) if np.isfinite(position_m).all() else (-1, -1)
    in_picture = 0 <= row < room.shape[0] and 0 <= column < room.shape[1]
    found = int(room[row, column]) if in_picture else 0
    if not found:
        where = "on a wall" if in_picture else "outside of the picture"
        x, y = position_m
        raise FloorPlanError(f"{place}: the position ({x:g}, {y:g}) m lies {where}: correct it")
    return found


def _without_small_pieces(skimage: Any, dark: NDArray[np.bool_], least_px: float) -> NDArray[np.bool_]:
    """Leave out connected dark pieces whose bounding box has a shorter diagonal, pixels."""
    piece = skimage.measure.label(dark, connectivity=2)
    kept = np.zeros(int(piece.max()) + 1, dtype=bool)
    for one in skimage.measure.regionprops(piece):
        top, left, bottom, right = one.bbox
        kept[one.label] = np.hypot(bottom - top, right - left) >= least_px
    result: NDArray[np.bool_] = kept[piece]
    return result


def _outlines(measure: Any, room: NDArray[np.int64], to_map: _PictureToMap) -> list[DrawnPolygon]:
    """Trace the outline and the holes of each room, straight to about a pixel."""
    polygons = []
    for number in np.unique(room[room > 0]).tolist():
        padded = np.pad(room == number, 1).astype(np.float64)
        # Pixels are padded by one, and counted from the corner of the picture instead of the middle of the first.
        rings = [measure.approximate_polygon(ring, 1.0)[:-1] - 0.5 for ring in measure.find_contours(padded, 0.5)]
        traced = [to_map.positions(ring) for ring in rings if len(ring) >= 3]
        traced.sort(key=lambda ring: -float(np.ptp(ring, axis=0).prod()))
        if traced:
            polygons.append(DrawnPolygon(f"room {number}", tuple(traced)))
    return polygons
