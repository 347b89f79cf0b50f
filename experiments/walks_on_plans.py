"""Walks of ILC20 with the plans of their floors, for the scripts about floor plans."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import pdr_est
from pdr_est import Config
from pdr_est.estimators import SPECS
from pdr_est.evaluate.held_out_fixes import WAYPOINT_SIGMA_M
from pdr_est.experiment.recording_files import recordings
from pdr_est.frames import Array
from pdr_est.pipeline import analyse_recording
from pdr_est.pipeline.measurements import measurements_of
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.measurements import DeviceMeasurements, PositionFix


@dataclass(frozen=True)
class WalkOnPlan:
    """A walk of one phone.

    Attributes
    ----------
    name : str
        Name of the recording.
    plan : FloorPlan
        Plan of its floor.
    time_s, truth_m : Array
        Times (n,), s, and true positions (n, 2), m, in order.
    measurements : DeviceMeasurements
        Steps and headings, without the plan.
    """

    name: str
    plan: FloorPlan
    time_s: Array
    truth_m: Array
    measurements: DeviceMeasurements

    @property
    def length_m(self) -> float:
        """Length of the straight lines through the true positions, m."""
        return float(np.hypot(*np.diff(self.truth_m, axis=0).T).sum())

    @property
    def minutes(self) -> float:
        """Time from the first to the last true position, min."""
        return float(self.time_s[-1] - self.time_s[0]) / 60.0

    def true_place(self, time_s: float) -> Array:
        """Return the true position (2,) at a time, m."""
        return np.array([np.interp(time_s, self.time_s, coordinate) for coordinate in self.truth_m.T])


def walks_on_plans(data: Path, fixes: int = 0) -> Iterator[WalkOnPlan]:
    """Yield the walks below DATA/ilc20; the first `fixes` true positions are among their measurements."""
    plans: dict[Path, FloorPlan] = {}
    for name, path in recordings(data / "ilc20", "*.txt"):
        recording = pdr_est.read(path)
        truth = recording.truth.positions
        if truth is None or len(truth.time_s) < 2:
            continue
        folder = Path(path).parent
        plan = plans.setdefault(folder, plans.get(folder) or pdr_est.read_floor_plan(folder))
        order = np.argsort(truth.time_s, kind="stable")
        time_s, truth_m = truth.time_s[order], truth.position_m[order]
        known = [PositionFix(float(time_s[i]), truth_m[i], WAYPOINT_SIGMA_M**2 * np.eye(2)) for i in range(fixes)]
        device = analyse_recording(recording, Config())[0]
        measured = measurements_of(device, Config(), known, SPECS["particle"])
        yield WalkOnPlan(name, plan, time_s, truth_m, measured)
