"""Place of the frame of a track on the map of the user and on the Earth."""

import math
from dataclasses import dataclass

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.report.walk.earth_placement import EarthPlacement
from pdr_est.types.recording import GeoOrigin, Recording
from pdr_est.types.track import Track

_WGS84_RADIUS_M, _WGS84_ECCENTRICITY2 = 6_378_137.0, 6.694379990141e-3


@dataclass(frozen=True)
class MapPlacement:
    """Place of the frame of a track.

    Attributes
    ----------
    shift_m
        (2,) what is added to a position of the track to get its place on the map, m; None where the track is turned
        arbitrarily.
    origin
        Latitude and longitude of the origin of the map; None where they are unknown.
    meaning
        Why something cannot be placed, in words.
    """

    shift_m: Array | None
    origin: GeoOrigin | None
    meaning: str

    def in_metres(self) -> Array:
        """Return the shift.

        Raises
        ------
        RecordingError
            If the track cannot be placed on a map.
        """
        if self.shift_m is None:
            raise RecordingError(f"the background cannot be placed below the track: {self.meaning}")
        return self.shift_m

    def on_earth(self) -> GeoOrigin:
        """Return the origin on the Earth.

        Raises
        ------
        RecordingError
            If the track cannot be placed on the Earth.
        """
        if self.shift_m is None or self.origin is None:
            raise RecordingError(f"the background cannot be placed below the track: {self.meaning}")
        return self.origin


def map_placement(track: Track, frame: str, recording: Recording, earth: EarthPlacement) -> MapPlacement:
    """Find out where the frame of a track lies.

    Parameters
    ----------
    track
        Track of the walk.
    frame
        "map", "north-up" or "own", as the summary has it.
    recording
        Recording that the track was made from.
    earth
        Its place on the Earth.
    """
    if earth.origin is not None:
        shift_m = earth.track.position_m[0] - track.position_m[0]
        return MapPlacement(shift_m, earth.origin, earth.meaning)
    if frame == "map" or (frame == "north-up" and recording.origin is None):
        return MapPlacement(np.zeros(2), None, earth.meaning)
    return MapPlacement(None, None, earth.meaning)


def metres_per_degree(origin: GeoOrigin) -> tuple[float, float]:
    """Compute the lengths of a degree of longitude and of latitude at a place on the WGS 84 ellipsoid, m.

    Within a kilometre of the origin, positions from them are right to about a decimetre.
    """
    sine, cosine = (f(math.radians(origin.latitude_deg)) for f in (math.sin, math.cos))
    flattened = 1.0 - _WGS84_ECCENTRICITY2 * sine**2
    east_m = _WGS84_RADIUS_M / math.sqrt(flattened) * cosine
    north_m = _WGS84_RADIUS_M * (1.0 - _WGS84_ECCENTRICITY2) / flattened**1.5
    return math.radians(east_m), math.radians(north_m)


def from_degrees(longitude_latitude: Array, origin: GeoOrigin) -> Array:
    """Convert longitudes and latitudes (n, 2), degrees, to east and north (n, 2), m, near the origin."""
    return (longitude_latitude - [origin.longitude_deg, origin.latitude_deg]) * metres_per_degree(origin)
