"""Positions that a source repeats: the last one given again is no new measurement."""

from pdr_est.types.measurements import PositionFix

_REPEATED_S = 5.0  # within which exactly the same position of a source is a repetition; ours

GivenFixes = tuple[tuple[float, float, float], ...]
"""Times (s) and positions (east and north, m) that a source gave in the last seconds."""


def given_at(fix: PositionFix) -> tuple[float, float, float]:
    """Return time (s), east and north (m) of a fix."""
    east_m, north_m = fix.position_m
    return float(fix.time_s), float(east_m), float(north_m)


def is_repeated(earlier: GivenFixes, fix: PositionFix) -> bool:
    """Tell whether a source gave exactly the same position a few seconds before.

    A phone repeats its last position while it has no new one, and tables have rows twice. Independent measurements
    are never exactly the same, and a point that is marked twice in one place has the same error both times.
    """
    return any(given_at(fix)[1:] == one[1:] and abs(fix.time_s - one[0]) <= _REPEATED_S for one in earlier)


def with_given(earlier: GivenFixes, fix: PositionFix) -> GivenFixes:
    """Return what a source gave in the last seconds after one more fix."""
    kept = (one for one in earlier if fix.time_s - one[0] <= _REPEATED_S and one[1:] != given_at(fix)[1:])
    return (*kept, given_at(fix))
