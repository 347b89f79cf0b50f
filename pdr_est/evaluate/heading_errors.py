"""Metrics of headings against annotated turns, which are changes of heading and not headings."""

import math

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.types.track import Track

HEADING_METRICS = ("turn_error_deg", "heading_net_error_deg")
TURN_MARGIN_S = 2.0


def turn_error_deg(track: Track, turn_time_s: Array, turn_angle_rad: Array) -> float:
    """Compute `turn_error_deg`: the median error of the heading change from 2 s before to 2 s after a turn.

    Errors are wrapped: half a turn to the left and half a turn to the right are the same change.

    Parameters
    ----------
    track : Track
        Track of one device.
    turn_time_s : ndarray
        Times (n,) of the turns, s.
    turn_angle_rad : ndarray
        Angles (n,) of the turns, rad, counter-clockwise positive.

    Returns
    -------
    float
        Median error, degrees; NaN without a turn.
    """
    if not len(turn_time_s):
        return math.nan
    change = heading_at(track, turn_time_s + TURN_MARGIN_S) - heading_at(track, turn_time_s - TURN_MARGIN_S)
    return float(np.degrees(np.median(np.abs(wrap_angle(change - turn_angle_rad)))))


def heading_net_error_deg(track: Track, start_s: float, end_s: float, turn_angle_rad: Array) -> float:
    """Compute `heading_net_error_deg`: the absolute, wrapped error of the heading change over the whole walk.

    Parameters
    ----------
    track : Track
        Track of one device.
    start_s, end_s : float
        Begin and end of the annotated walk, s; turns outside of it are not known.
    turn_angle_rad : ndarray
        Angles (n,) of the turns, rad, whose sum is the true change.
    """
    first, last = heading_at(track, np.array([start_s, end_s]))
    return float(np.degrees(np.abs(wrap_angle(last - first - np.sum(turn_angle_rad)))))


def heading_at(track: Track, time_s: Array) -> Array:
    """Interpolate the headings (k,), rad, of the track of one device at times (k,); they are not wrapped."""
    return np.asarray(np.interp(time_s, track.time_s, np.unwrap(track.heading_rad)))
