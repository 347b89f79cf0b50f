"""Positions of trajectories in metres and in one frame; what cannot be is refused."""

from dataclasses import replace

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.gnss import east_north
from pdr_est.io.trajectories import Trajectory
from pdr_est.types.recording import GeoOrigin

_FARTHEST_FROM_ORIGIN_M = 1e5  # swapped latitude and longitude lie further away than anybody walks
_METRES_PER_DEGREE = 1.11e5  # of latitude
_LEAST_EXTENT_M = 5.0  # of a walk that can be told from one that stands
_ALIKE = 4.0  # ratio of extents below which one in degrees, as metres, may be that of the same walk


def in_one_frame(
    track: Trajectory, truth: Trajectory, origin: GeoOrigin | None = None
) -> tuple[Trajectory, Trajectory, GeoOrigin | None]:
    """Bring a track and the truth into metres, about one origin on the Earth where both are in degrees.

    Parameters
    ----------
    track, truth
        The trajectories.
    origin
        Place of the origin of positions in metres; needed where only one of both is in degrees.

    Returns
    -------
    track, truth : Trajectory
        The same in metres.
    origin : GeoOrigin or None
        Origin of their frame; None where neither is on the Earth.

    Raises
    ------
    RecordingError
        If only one of both is in degrees and no origin is known, or the positions in metres look like degrees.
    """
    _refuse_unnamed_degrees(track, truth)
    _refuse_unnamed_degrees(truth, track)
    if not track.in_degrees and not truth.in_degrees:
        return track, truth, origin
    if origin is None:
        if track.in_degrees != truth.in_degrees:
            geodetic, metric = (track, truth) if track.in_degrees else (truth, track)
            raise RecordingError(
                f"{geodetic.place}: positions are latitude and longitude, those of {metric.place} metres from an "
                "origin that is not known: give its latitude and longitude (--origin LAT LON)"
            )
        origin = GeoOrigin(float(truth.position[0, 0]), float(truth.position[0, 1]))
    return in_metres(track, origin), in_metres(truth, origin), origin


def in_metres(trajectory: Trajectory, origin: GeoOrigin | None, owner: str = "") -> Trajectory:
    """Convert latitudes and longitudes to metres east and north of an origin; metres stay as they are.

    Parameters
    ----------
    trajectory
        The trajectory.
    origin
        Origin of the frame; None where it is not known.
    owner
        What the frame is that of, for messages.

    Raises
    ------
    RecordingError
        If an origin is needed and not known, or a position is far from it.
    """
    if not trajectory.in_degrees:
        return trajectory
    if origin is None:
        raise RecordingError(
            f"{trajectory.place}: positions are latitude and longitude, but the origin of {owner} on the Earth is "
            "unknown: give x_m and y_m instead"
        )
    latitude, longitude = trajectory.position.T
    position = east_north(latitude, longitude, origin)
    far = np.flatnonzero(np.linalg.norm(position, axis=1) > _FARTHEST_FROM_ORIGIN_M)
    if len(far):
        raise RecordingError(
            f"{trajectory.place}, position {far[0] + 1}: latitude {latitude[far[0]]:g}, longitude "
            f"{longitude[far[0]]:g} lies far from the origin at {origin.latitude_deg:.4f}, "
            f"{origin.longitude_deg:.4f}: check whether they are swapped, or of another walk"
        )
    return replace(trajectory, position=position, in_degrees=False)


def _refuse_unnamed_degrees(one: Trajectory, other: Trajectory) -> None:
    """Refuse columns x and y that hold degrees: as degrees, they would be as wide as the other trajectory is.

    A trajectory in metres that is as narrow as a walk in degrees, 0.1 mm to a few cm, is nobody's walk, and one about
    an origin of its own has positions near zero, which a place on land hardly has in degrees.
    """
    width_m = _width_m(other)
    if one.in_degrees or width_m < _LEAST_EXTENT_M:
        return
    size = np.abs(one.position)
    on_earth = bool((size <= 180.0).all() and (size.min(axis=1) <= 90.0).all())
    near_zero = bool((size.max(axis=1) < 1.0).any())
    as_degrees_m = float(np.ptp(one.position, axis=0).max()) * _METRES_PER_DEGREE
    if on_earth and not near_zero and width_m / _ALIKE <= as_degrees_m <= width_m * _ALIKE:
        x, y = one.position[0]
        raise RecordingError(
            f"{one.place}: x = {x:.6f}, y = {y:.6f} look like degrees, because they vary by only "
            f"{as_degrees_m / _METRES_PER_DEGREE:.2g}: name the columns longitude and latitude, or give metres"
        )


def _width_m(trajectory: Trajectory) -> float:
    scale = _METRES_PER_DEGREE if trajectory.in_degrees else 1.0
    return float(np.ptp(trajectory.position, axis=0).max()) * scale
