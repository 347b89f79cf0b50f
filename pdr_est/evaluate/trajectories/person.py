"""The one person in a trajectory of several devices."""

from dataclasses import replace

from pdr_est.errors import RecordingError
from pdr_est.estimators.person.track import NAME as FUSED
from pdr_est.io.trajectories import Trajectory


def person_in(trajectory: Trajectory) -> Trajectory:
    """Return the trajectory of the only device, or of the person among several.

    Raises
    ------
    RecordingError
        If there are several devices and no person.
    """
    names = trajectory.devices
    if len(names) == 1:
        return trajectory
    if FUSED not in names:
        raise RecordingError(
            f"{trajectory.place}: has several devices ({', '.join(names[:5])}) and none called {FUSED!r}: give a "
            "file with one"
        )
    return replace(trajectory.of_device(FUSED), notes=(*trajectory.notes, f"of {', '.join(names)} {FUSED} is used"))
