"""The times of trajectories on one clock; what cannot be on one clock is refused."""

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.evaluate.time_association import END_TOLERANCE_S
from pdr_est.frames import Array
from pdr_est.io.trajectories import Clock, Trajectory
from pdr_est.types.clock import utc_date
from pdr_est.types.recording import Recording

_UNIX_FROM_S = 1e9  # larger times are Unix times


def require_one_clock(track: Trajectory, truth: Trajectory, offset_s: float | None, standing_s: float = 0.0) -> None:
    """Check that the times of a track and of the truth count from the same start, and overlap.

    Parameters
    ----------
    track, truth
        The trajectories.
    offset_s
        Time that the user adds to those of the track, s; None for none. With it, times of different meaning are
        accepted.
    standing_s
        Time that the walker stands before and after the track, s.

    Raises
    ------
    RecordingError
        If the clocks differ, or no true position lies within the time of the track.
    """
    if track.clock is not truth.clock and offset_s is None:
        raise RecordingError(
            f"{track.place}: its times are {track.clock}, those of {truth.place} are {truth.clock}: write both on "
            "one clock, or give the seconds to add to the track's times (--time-offset)"
        )
    begin_s, end_s = (time_s + (offset_s or 0.0) for time_s in track.span_s)
    span_s = (begin_s - standing_s, end_s + standing_s)
    _require_overlap(span_s, truth, f"{track.place}: from {_moment(begin_s)} to {_moment(end_s)}")


def on_clock_of_recording(trajectory: Trajectory, recording: Recording) -> Array:
    """Convert the times of a trajectory to the clock of a recording.

    Unix times and dates need a recording that tells its date. Other times count as those of the recording's own
    clock.

    Returns
    -------
    Array
        Times (n,), s.

    Raises
    ------
    RecordingError
        If the date of the recording is not known, or no time lies within the recording.
    """
    span_s = (-np.inf, np.inf) if recording.span_s is None else recording.span_s
    time_s = trajectory.time_s
    # The clock of some recorders counts from 1970 itself.
    if trajectory.clock is not Clock.OWN and not (trajectory.clock is Clock.UNIX and span_s[0] >= _UNIX_FROM_S):
        time_s = time_s - _time_zero(trajectory, recording)
    inside = (time_s >= span_s[0] - END_TOLERANCE_S) & (time_s <= span_s[1] + END_TOLERANCE_S)
    if not inside.any():
        raise RecordingError(
            f"{trajectory.place}: no time, {time_s.min():.3f} to {time_s.max():.3f} s, lies within the recording "
            f"{recording.name}, {span_s[0]:.3f} to {span_s[1]:.3f} s: use the recording's clock"
        )
    return time_s


def _time_zero(trajectory: Trajectory, recording: Recording) -> float:
    """Return what the times of a trajectory show when the clock of the recording shows 0, s."""
    is_local = trajectory.clock is Clock.LOCAL and recording.tells_local_date
    epoch_s = recording.local_epoch_s if is_local else recording.epoch_s
    if epoch_s is None:
        begin, end = (f"{time_s:.3f}" for time_s in recording.span_s or (0.0, 0.0))
        raise RecordingError(
            f"{trajectory.place}: its times are {trajectory.clock}, but the date of {recording.name} is unknown: "
            f"give seconds on its own clock, {begin} to {end}"
        )
    return epoch_s


def _require_overlap(span_s: tuple[float, float], truth: Trajectory, words: str) -> None:
    inside = (truth.time_s >= span_s[0] - END_TOLERANCE_S) & (truth.time_s <= span_s[1] + END_TOLERANCE_S)
    if inside.any():
        return
    first_s, last_s = truth.span_s
    raise RecordingError(
        f"{words}; no time of {truth.place}, {_moment(first_s)} to {_moment(last_s)}, lies within it: the clocks "
        "differ, or the files are of different walks: write both on one clock, or give the seconds to add to the "
        "track's times (--time-offset)"
    )


def _moment(time_s: float) -> str:
    """Write a time in seconds, with the date where it is a Unix time."""
    if not _UNIX_FROM_S <= time_s <= 1e11:
        return f"{time_s:.3f} s"
    date = utc_date(time_s)
    return f"{time_s:.3f} s" if date is None else f"{time_s:.3f} s ({date.isoformat(timespec='seconds')})"
