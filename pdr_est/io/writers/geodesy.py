"""Convert positions and times of a track to what maps of the Earth use: longitude, latitude and dates in UTC."""

import math
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.recording import GeoOrigin

DEGREE_DIGITS = 8
"""Decimals of a longitude or latitude in a file; the last one is about 1 mm."""

_CHI_SQUARED_95 = -2.0 * math.log(0.05)  # 95 % quantile with two degrees of freedom
_CORNERS = 16  # of a polygon for an ellipse, which covers 97.4 % of its area
_LEAST_AXIS_M, _MOST_AXIS_M = 0.01, 1e5
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def longitude_latitude(position_m: Array, origin: GeoOrigin) -> Array:
    """Convert positions (n, 2) east and north of an origin, m, to WGS 84 longitude and latitude (n, 2), degrees."""
    from pymap3d import enu2geodetic

    east, north = position_m.T
    latitude, longitude, _ = enu2geodetic(
        east, north, np.zeros(len(east)), origin.latitude_deg, origin.longitude_deg, 0.0
    )
    return np.column_stack([longitude, latitude])


def utc_texts(time_s: Array, epoch_s: float | None) -> list[str] | None:
    """Format times as ISO 8601 dates in UTC with microseconds.

    Parameters
    ----------
    time_s
        (n,) s on the clock of the recording.
    epoch_s
        Unix time of time zero, s; None where it is unknown.

    Returns
    -------
    list of str or None
        Texts such as 2024-06-10T14:03:05.250000Z; None where the date is unknown or outside the years 1 to 9999.
    """
    if epoch_s is None:
        return None
    try:
        dates = [_EPOCH + timedelta(seconds=epoch_s + time) for time in time_s.tolist()]
    except (OverflowError, ValueError):
        return None
    return [f"{date.replace(tzinfo=None).isoformat(timespec='microseconds')}Z" for date in dates]


def dates_or_none(time_s: Array, epoch_s: float | None) -> Sequence[str | None]:
    """Return the dates of `utc_texts`, or None for each time (n,) where they are unknown."""
    return utc_texts(time_s, epoch_s) or [None] * len(time_s)


def ellipses95(position_m: Array, covariance_m2: Array) -> list[Array | None]:
    """Compute polygons of 95 % ellipses of normal distributions.

    Parameters
    ----------
    position_m
        (n, 2) centres, m.
    covariance_m2
        (n, 2, 2) covariances, m².

    Returns
    -------
    list of Array or None
        Corners (17, 2) in counter-clockwise order, m, the last one equal to the first. None for an ellipse that
        cannot be drawn: its covariance is not finite, or a semi-axis is below 1 cm or above 100 km.
    """
    angle = np.linspace(0.0, 2.0 * np.pi, _CORNERS + 1)
    circle = math.sqrt(_CHI_SQUARED_95) * np.stack([np.cos(angle), np.sin(angle)])
    circle[:, -1] = circle[:, 0]
    axes = semi_axes95_m(covariance_m2)
    drawn = (axes.min(axis=1) >= _LEAST_AXIS_M) & (axes.max(axis=1) <= _MOST_AXIS_M)
    found: list[Array | None] = [None] * len(position_m)
    # A Cholesky factor has a positive determinant, and therefore keeps the order of the corners.
    factors = np.linalg.cholesky(covariance_m2[drawn])
    for i, factor in zip(np.flatnonzero(drawn).tolist(), factors, strict=True):
        found[i] = position_m[i] + (factor @ circle).T
    return found


def semi_axes95_m(covariance_m2: Array) -> Array:
    """Compute the semi-axes (n, 2), m, the longer one first, of the 95 % ellipses of covariances (n, 2, 2), m².

    They are NaN where a covariance is not finite.
    """
    finite = np.asarray(np.isfinite(covariance_m2).all(axis=(1, 2)))
    covariance = np.where(finite[:, None, None], covariance_m2, 0.0)
    xx, xy, yy = covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1]
    mean, spread = (xx + yy) / 2.0, np.hypot((xx - yy) / 2.0, xy)
    variances = np.column_stack([mean + spread, mean - spread])
    return np.where(finite[:, None], np.sqrt(_CHI_SQUARED_95 * np.maximum(variances, 0.0)), np.nan)


def compass_deg(heading_rad: Array) -> Array:
    """Convert headings (n,), rad counter-clockwise from east, to degrees clockwise from north in [0, 360)."""
    return np.mod(90.0 - np.degrees(heading_rad), 360.0)


def degree_texts(coordinates_deg: Array) -> Sequence[tuple[str, str]]:
    """Format coordinates (n, 2), degrees, with `DEGREE_DIGITS` decimals."""
    return [(f"{x:.{DEGREE_DIGITS}f}", f"{y:.{DEGREE_DIGITS}f}") for x, y in coordinates_deg.tolist()]
