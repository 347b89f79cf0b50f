"""Poses that say that the walker stands, for programs that know poses only."""

import numpy as np

from pdr_est.types.track import Track

_SHORTEST_PAUSE_S = 1e-3  # of a walker who stands; times are written to 1 µs


def with_standing_poses(track: Track) -> Track:
    """Add a pose where the walker begins to move after standing, so that straight lines between poses say so.

    Programs that know poses only interpolate between them, which would spread a step over the time before it.

    Parameters
    ----------
    track
        Track of one device.

    Returns
    -------
    Track
        The track with a copy of the pose before each pause at the end of the pause; the steps to them have no length.
    """
    stands = np.flatnonzero(track.moving_from_s[1:] > track.time_s[:-1] + _SHORTEST_PAUSE_S)
    order = np.insert(np.arange(len(track)), stands + 1, stands)
    added = stands + 1 + np.arange(len(stands))
    rows = track.rows_where(order)
    rows.time_s[added] = rows.moving_from_s[added] = track.moving_from_s[stands + 1]
    rows.step_length_m[added] = 0.0
    return rows
