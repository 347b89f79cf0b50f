"""Trajectories on the clock of a recording and in its frame: its truth, and tracks that other programs made of it."""

from dataclasses import replace

from pdr_est.evaluate.trajectories.common_clock import on_clock_of_recording
from pdr_est.evaluate.trajectories.common_frame import in_metres
from pdr_est.evaluate.trajectories.foreign_track import track_of_trajectory, true_positions_of
from pdr_est.evaluate.trajectories.person import person_in
from pdr_est.io.trajectories import Trajectory
from pdr_est.types.recording import Recording
from pdr_est.types.track import Track


def with_surveyed_truth(recording: Recording, truth: Trajectory) -> Recording:
    """Return a recording with true positions from a file, in place of those that it has.

    Raises
    ------
    RecordingError
        If no position lies within the time of the recording, or they are in degrees and its origin on the Earth is
        not known.
    """
    person = person_in(truth)
    placed = in_metres(person, recording.origin, recording.name)
    positions = true_positions_of(placed, on_clock_of_recording(person, recording))
    note = f"{len(person)} true positions ({positions.source}) from {truth.place}"
    return replace(
        recording, truth=replace(recording.truth, positions=positions), notes=(*recording.notes, *person.notes, note)
    )


def track_on_recording(trajectory: Trajectory, recording: Recording) -> Track:
    """Make a track of what another program computed from a recording.

    Its times are those of the recording. Latitudes and longitudes are converted about the recording's origin.

    Raises
    ------
    RecordingError
        As `with_surveyed_truth` does.
    """
    placed = in_metres(trajectory, recording.origin, recording.name)
    return track_of_trajectory(placed, on_clock_of_recording(trajectory, recording))
