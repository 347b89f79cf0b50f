"""Headings of a track against annotated turns, which tell changes of heading and no heading itself."""

import math

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.types.track import Track

HEADING_METRICS = ("turn_error_deg", "heading_net_error_deg")
TURN_MARGIN_S = 2.0


def turn_error_deg(track: Track, turn_time_s: Array, turn_angle_rad: Array) -> float:
    """`turn_error_deg`: median over the turns of the error of the change from 2 s before to 2 s after.

    track: of one device; turn_time_s, turn_angle_rad: (n,), counter-clockwise positive. The error is wrapped: to turn
    round by the left or by the right is the same change. NaN without a turn.
    """
    if not len(turn_time_s):
        return math.nan
    change = heading_at(track, turn_time_s + TURN_MARGIN_S) - heading_at(track, turn_time_s - TURN_MARGIN_S)
    return float(np.degrees(np.median(np.abs(wrap_angle(change - turn_angle_rad)))))


def heading_net_error_deg(track: Track, start_s: float, end_s: float, turn_angle_rad: Array) -> float:
    """`heading_net_error_deg`: change of heading less the sum of the turns (n,), wrapped, absolute.

    start_s, end_s: of the annotated walk, outside of which turns are not known; the change is between them.
    """
    first, last = heading_at(track, np.array([start_s, end_s]))
    return float(np.degrees(np.abs(wrap_angle(last - first - np.sum(turn_angle_rad)))))


def heading_at(track: Track, time_s: Array) -> Array:
    """Headings (k,) rad of one device's track at some times (k,), linear between poses, not wrapped."""
    return np.asarray(np.interp(time_s, track.time_s, np.unwrap(track.heading_rad)))
