"""Load what is known beside a recording: positions (`--fixes`) and the floor plan (`--plan` and `--floor`).

Positions are in a table, or the word `recording` or `waypoints` stands for those in the recording.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import click

from pdr_est.cli.error_context import prefix_errors
from pdr_est.io.floor_plans.reading import read_floor_plan
from pdr_est.io.side_tables.position_fixes import read_position_fixes, recorded_fixes, waypoint_fixes
from pdr_est.io.writers.checksums import file_digests
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording

RECORDED, WAYPOINTS = "recording", "waypoints"


def fix_tables(choices: Iterable[str | None]) -> list[Path]:
    """Select the tables among the values of options `--fixes`."""
    return [Path(choice) for choice in choices if choice is not None and choice not in (RECORDED, WAYPOINTS)]


def load_fixes(choice: str | None, recorded: Recording, path: Path) -> tuple[PositionFix, ...]:
    """Load the position fixes that an option `--fixes` names; none without the option.

    Parameters
    ----------
    choice : str or None
        Path of a table, `recording` for the fixes in the recording itself, or `waypoints` for the points in it that
        somebody marked.
    recorded : Recording
        Recording that they belong to.
    path : Path
        Path of the recording, for messages.

    Raises
    ------
    RecordingError
        If there are no fixes.
    """
    if choice is None:
        return ()
    if choice not in (RECORDED, WAYPOINTS):
        return read_position_fixes(choice, recorded)
    with prefix_errors(path):
        return recorded_fixes(recorded) if choice == RECORDED else waypoint_fixes(recorded)


def without_used_truth(recording: Recording, choice: str | None) -> Recording:
    """Remove the true positions that are fixes: errors against them would say nothing of the track."""
    if choice != WAYPOINTS or recording.truth.positions is None:
        return recording
    note = "the marked points are fixes, and therefore no reference"
    return replace(recording, truth=replace(recording.truth, positions=None), notes=(*recording.notes, note))


@dataclass(frozen=True)
class PlanChoice:
    """Values of the options about the floor plan.

    Attributes
    ----------
    path : Path or None
        File or folder of the plan; None for none.
    floor : str
        Name of the floor; empty where it is not given.
    """

    path: Path | None = None
    floor: str = ""

    @classmethod
    def of_options(cls, plan: Path | None, floor: str | None) -> "PlanChoice":
        """Take the values of the options; raise UsageError for a floor without a plan."""
        if floor is not None and plan is None:
            raise click.UsageError(f"--floor {floor}: is a floor of a plan: give --plan FILE, too")
        return cls(plan, floor or "")

    def load(self, recording: Recording) -> FloorPlan | None:
        """Read the plan in the map frame of a recording; None if none is chosen.

        Raises
        ------
        FloorPlanError
            For a plan that cannot be used, or a floor that it does not show.
        """
        return None if self.path is None else read_floor_plan(self.path, self.floor, recording.origin)

    def digests(self) -> dict[str, str]:
        """Compute checksums of the files of the plan, by their paths."""
        if self.path is None:
            return {}
        files = [self.path] if self.path.is_file() else sorted(self.path.glob("*.*json*"))
        return {str(file): digest for file in files for digest in file_digests(file).values()}


NO_FLOOR_PLAN = PlanChoice()
"""The options are not given."""


def placed_by_plan(recording: Recording, plan: FloorPlan | None) -> Recording:
    """Put the map frame of a recording without a place on the Earth where its plan is."""
    if plan is None or plan.origin is None or recording.origin is not None:
        return recording
    return replace(recording, origin=plan.origin)
