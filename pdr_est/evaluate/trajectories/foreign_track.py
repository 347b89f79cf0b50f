"""A trajectory of another program as a `Track`, or as true positions."""

import numpy as np

from pdr_est.evaluate.held_out_fixes import WAYPOINT_SIGMA_M
from pdr_est.frames import Array
from pdr_est.io.trajectories import Trajectory
from pdr_est.types.ground_truth import TruePositions, are_dense
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

ESTIMATOR = "another program"
"""Estimator of a track that was read from a file."""


def track_of_trajectory(trajectory: Trajectory, time_s: Array) -> Track:
    """Make a track of the positions of a trajectory in metres.

    Between two positions the walker moves all the time. What the file does not state is NaN: covariances, headings
    and their deviations. A stated standard deviation of each axis makes a covariance.

    Parameters
    ----------
    trajectory
        Positions in metres.
    time_s
        (n,) s, times of the positions on the clock that the track shall have.
    """
    count = len(trajectory)
    first = np.ones(count, dtype=np.bool_)
    first[1:] = trajectory.device[1:] != trajectory.device[:-1]
    legs = np.zeros(count)
    legs[1:] = np.linalg.norm(np.diff(trajectory.position, axis=0), axis=1)
    unknown = np.full(count, np.nan)
    return Track(
        time_s=time_s,
        moving_from_s=np.where(first, time_s, np.roll(time_s, 1)),
        device=trajectory.device,
        position_m=trajectory.position,
        heading_rad=unknown,
        covariance_m2=_covariance(trajectory),
        sigma_heading_rad=unknown,
        mode=np.full(count, CarryingMode.UNKNOWN, dtype=np.int8),
        step_length_m=np.where(first, 0.0, legs),
        kind="read from a file",
        estimator=ESTIMATOR,
    )


def _covariance(trajectory: Trajectory) -> Array:
    """Return the covariances (n, 2, 2), m²; NaN where the file states none."""
    if trajectory.covariance_m2 is not None:
        return trajectory.covariance_m2
    if trajectory.sigma_m is not None:
        return np.asarray(np.square(trajectory.sigma_m)[:, None, None] * np.eye(2))
    return np.full((len(trajectory), 2, 2), np.nan)


def true_positions_of(trajectory: Trajectory, time_s: Array, sigma_m: float | None = None) -> TruePositions:
    """Make true positions of a trajectory in metres.

    Positions that follow each other quickly (`are_dense`) count as recorded poses without error, in GPX as those of
    a satellite receiver; others as waypoints with 0.7 m per axis. The standard deviation is another one where the
    file or `sigma_m` states it; of deviations that differ, the root of the mean square counts.

    Parameters
    ----------
    trajectory
        Positions in metres of one person.
    time_s
        (n,) s, times of the positions on the clock of the track.
    sigma_m
        Standard deviation of each axis, m; None for that of the file.
    """
    order = np.argsort(time_s, kind="stable")
    dense = are_dense(time_s)
    if sigma_m is None and trajectory.sigma_m is not None and np.isfinite(trajectory.sigma_m).any():
        sigma_m = float(np.sqrt(np.nanmean(np.square(trajectory.sigma_m))))
    if sigma_m is None:
        sigma_m = 0.0 if dense else WAYPOINT_SIGMA_M
    source = ("gps" if trajectory.format == "GPX" else "poses") if dense else "waypoints"
    return TruePositions(time_s[order], trajectory.position[order], sigma_m, source)
