"""Metrics of headings against annotated turns, and of directions of travel against true positions.

A turn is a change of heading; no annotation tells headings themselves.
"""

import math

import numpy as np

from pdr_est.evaluate.position_errors import thinned
from pdr_est.evaluate.rigid_alignment import best_alignment
from pdr_est.frames import Array, wrap_angle
from pdr_est.types.track import Track

HEADING_METRICS = ("turn_error_deg", "heading_net_error_deg")
TURN_MARGIN_S = 2.0
TRAVEL_METRIC = "heading_rms_deg"
LEAST_TRAVEL_LEGS = 5

_LEG_M, _LEG_SIGMAS, _LONGEST = 3.0, 4.0, 3.0
_LEAST_MOVED_M = 0.3  # of the track; a walker who was lost sight of has no direction


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


def travel_direction_rms_deg(track_m: Array, truth_m: Array, truth_sigma_m: float = 0.0) -> tuple[float, int]:
    """Compute `heading_rms_deg`: the rms difference of the directions of travel of track and truth.

    The track is turned by the best rigid alignment to the truth. A direction of travel is that of the leg between two
    true positions at least 3 m, or four standard deviations of the truth, apart; the track's leg is the one between
    the same two times. Legs more than three times as long are left out, because the walker may have turned within
    them, and so are legs on which the track moved less than 0.3 m.

    Parameters
    ----------
    track_m, truth_m : ndarray
        Paired positions (n, 2), m, n at least 2.
    truth_sigma_m : float
        Standard deviation of the true positions per axis, m.

    Returns
    -------
    rms_deg : float
        Root of the mean square, degrees; NaN without a leg.
    legs : int
        Number of legs.
    """
    least_m = max(_LEG_M, _LEG_SIGMAS * truth_sigma_m)
    kept = thinned(truth_m, least_m)
    own, true = np.diff(track_m[kept], axis=0), np.diff(truth_m[kept], axis=0)
    usable = np.hypot(*true.T) <= _LONGEST * least_m
    usable &= np.hypot(*own.T) >= _LEAST_MOVED_M
    if not usable.any():
        return math.nan, 0
    turned_rad = best_alignment(track_m, truth_m).rotation_rad
    direction_rad, true_rad = (np.arctan2(legs[usable, 1], legs[usable, 0]) for legs in (own, true))
    error_rad = wrap_angle(direction_rad + turned_rad - true_rad)
    return float(np.degrees(np.sqrt(np.square(error_rad).mean()))), int(usable.sum())
