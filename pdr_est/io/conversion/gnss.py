"""Convert a recorder's own positions from latitude and longitude to position fixes in the map frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin

_SMALLEST_SIGMA_M = 1.0  # recorders print optimistic accuracies; no phone is better than this


@dataclass(frozen=True)
class GnssFixes:
    """Position fixes of a recorder.

    Attributes
    ----------
    fixes
        Fixes in the order of the file, marked as robust because they may be outliers; their source is "gps", or
        "network" for positions from radio masts and Wi-Fi where they can be told apart.
    origin
        Latitude and longitude of the first valid fix, which is the origin of the map frame; None without a valid fix.
    warnings
        Counts of the fixes that were left out, by reason.
    """

    fixes: tuple[PositionFix, ...]
    origin: GeoOrigin | None
    warnings: tuple[str, ...] = ()


def gnss_fixes(
    time_s: Array,
    latitude_deg: Array,
    longitude_deg: Array,
    sigma_m: Array,
    network: NDArray[np.bool_] | None = None,
) -> GnssFixes:
    """Make fixes with positions east and north, m, of the first valid one.

    Rows are left out, with a warning that counts them, when their position is impossible, missing or exactly (0, 0),
    when their accuracy is missing or not positive (recorders mark invalid fixes so), and when they repeat the
    previous row (a cached fix, not a new one).

    Parameters
    ----------
    time_s
        (n,) times on the recording's clock, s.
    latitude_deg, longitude_deg
        (n,) WGS 84 coordinates, degrees.
    sigma_m
        (n,) horizontal accuracy that the recorder gives, m, taken as standard deviation of each axis, at least 1 m.
    network
        (n,) True for positions that do not come from satellites; None if that is not known.
    """
    on_earth = (np.abs(latitude_deg) <= 90.0) & (np.abs(longitude_deg) <= 180.0)
    placed = np.isfinite(time_s) & on_earth & ((latitude_deg != 0.0) | (longitude_deg != 0.0))
    measured = np.isfinite(sigma_m) & (sigma_m > 0.0)
    valid = placed & measured
    kept = valid & ~_repeats(np.column_stack([latitude_deg, longitude_deg, sigma_m]), valid)
    warnings = _count_warnings(
        (
            (~placed, "without a possible position"),
            (placed & ~measured, "without a valid accuracy"),
            (valid & ~kept, "that repeat the previous one"),
        )
    )
    if not kept.any():
        return GnssFixes((), None, warnings)
    latitude, longitude = latitude_deg[kept], longitude_deg[kept]
    origin = GeoOrigin(float(latitude[0]), float(longitude[0]))
    position_m = east_north(latitude, longitude, origin)
    variance = np.square(np.maximum(sigma_m[kept], _SMALLEST_SIGMA_M))
    elsewhere = np.zeros(len(position_m), dtype=np.bool_) if network is None else network[kept]
    fixes = tuple(
        PositionFix(float(t), position, np.eye(2) * v, source="network" if other else "gps", robust=True)
        for t, position, v, other in zip(time_s[kept], position_m, variance, elsewhere, strict=True)
    )
    return GnssFixes(fixes, origin, warnings)


def drop_fixes_outside(gnss: GnssFixes, start_s: float, end_s: float, margin_s: float = 1.0) -> GnssFixes:
    """Leave out fixes made before or after the sensors ran, such as one cached earlier, and count them.

    Parameters
    ----------
    gnss
        Fixes of the recorder.
    start_s, end_s
        Time span of the sensors, s.
    margin_s
        Time, s, by which a fix may lie outside.
    """
    inside = tuple(fix for fix in gnss.fixes if start_s - margin_s <= fix.time_s <= end_s + margin_s)
    outside = len(gnss.fixes) - len(inside)
    if not outside:
        return gnss
    warning = (
        f"location: {outside} of {len(gnss.fixes)} fixes are left out because they were made before or after the "
        "sensors ran"
    )
    return GnssFixes(inside, gnss.origin, (*gnss.warnings, warning))


def _repeats(rows: Array, valid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Find the valid rows that equal the valid row before them."""
    index = np.flatnonzero(valid)
    same = (rows[index[1:]] == rows[index[:-1]]).all(axis=1)
    repeats = np.zeros(len(rows), dtype=np.bool_)
    repeats[index[1:][same]] = True
    return repeats


def _count_warnings(groups: tuple[tuple[NDArray[np.bool_], str], ...]) -> tuple[str, ...]:
    """Count the fixes with each fault."""
    return tuple(
        f"location: {int(mask.sum())} of {len(mask)} fixes {fault} are left out"
        for mask, fault in groups
        if mask.any()
    )


def east_north(latitude_deg: Array, longitude_deg: Array, origin: GeoOrigin) -> Array:
    """Convert WGS 84 latitudes and longitudes (n,), degrees, to positions (n, 2) east and north of an origin, m."""
    from pymap3d import geodetic2enu  # used by few recordings

    east, north, _ = geodetic2enu(latitude_deg, longitude_deg, 0.0, origin.latitude_deg, origin.longitude_deg, 0.0)
    return np.column_stack([east, north])
