"""A recorder's own position fixes, from latitude and longitude to the local map frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pymap3d import geodetic2enu

from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin

_SMALLEST_SIGMA_M = 1.0  # recorders print optimistic accuracies; no phone is better than this


@dataclass(frozen=True)
class GnssFixes:
    """fixes: in the order of the file, source "gps", robust. origin: where the first valid fix lies, or None."""

    fixes: tuple[PositionFix, ...]
    origin: GeoOrigin | None
    warnings: tuple[str, ...] = ()


def gnss_fixes(time_s: Array, latitude_deg: Array, longitude_deg: Array, sigma_m: Array) -> GnssFixes:
    """Fixes east and north of the first valid one.

    time_s, latitude_deg, longitude_deg, sigma_m: (n,); sigma_m is the recorder's horizontal accuracy, taken as the
    standard deviation of each axis. Rows are left out, with a warning that counts them, when their position is
    impossible, missing or exactly (0, 0), when their accuracy is missing or not positive (recorders mark invalid
    fixes so), and when they repeat the row before (a cached fix, not a new one).
    """
    on_earth = (np.abs(latitude_deg) <= 90.0) & (np.abs(longitude_deg) <= 180.0)
    placed = np.isfinite(time_s) & on_earth & ((latitude_deg != 0.0) | (longitude_deg != 0.0))
    measured = np.isfinite(sigma_m) & (sigma_m > 0.0)
    valid = placed & measured
    kept = valid & ~_repeats(np.column_stack([latitude_deg, longitude_deg, sigma_m]), valid)
    warnings = _counts(
        (
            (~placed, "without a possible position"),
            (placed & ~measured, "without a valid accuracy"),
            (valid & ~kept, "that repeat the one before"),
        )
    )
    if not kept.any():
        return GnssFixes((), None, warnings)
    latitude, longitude = latitude_deg[kept], longitude_deg[kept]
    origin = GeoOrigin(float(latitude[0]), float(longitude[0]))
    east, north, _ = geodetic2enu(latitude, longitude, 0.0, origin.latitude_deg, origin.longitude_deg, 0.0)
    variance = np.square(np.maximum(sigma_m[kept], _SMALLEST_SIGMA_M))
    fixes = tuple(
        PositionFix(float(t), position, np.eye(2) * v, source="gps", robust=True)
        for t, position, v in zip(time_s[kept], np.column_stack([east, north]), variance, strict=True)
    )
    return GnssFixes(fixes, origin, warnings)


def drop_fixes_outside(found: GnssFixes, start_s: float, end_s: float, slack_s: float = 1.0) -> GnssFixes:
    """The fixes made while the sensors ran; the others, such as one cached before, are counted and left out."""
    inside = tuple(fix for fix in found.fixes if start_s - slack_s <= fix.time_s <= end_s + slack_s)
    outside = len(found.fixes) - len(inside)
    if not outside:
        return found
    warning = f"location: {outside} of {len(found.fixes)} fixes lie outside the time of the sensors and are left out"
    return GnssFixes(inside, found.origin, (*found.warnings, warning))


def _repeats(rows: Array, valid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which valid rows equal the valid row before them."""
    index = np.flatnonzero(valid)
    same = (rows[index[1:]] == rows[index[:-1]]).all(axis=1)
    repeats = np.zeros(len(rows), dtype=np.bool_)
    repeats[index[1:][same]] = True
    return repeats


def _counts(groups: tuple[tuple[NDArray[np.bool_], str], ...]) -> tuple[str, ...]:
    return tuple(
        f"location: {int(mask.sum())} of {len(mask)} fixes {words} are left out"
        for mask, words in groups
        if mask.any()
    )
