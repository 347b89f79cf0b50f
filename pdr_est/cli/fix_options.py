"""Load what is known beside a recording: positions (`--fixes`) and the floor plan (`--plan` and `--floor`).

Positions are in a table, or the word `recording` or `waypoints` stands for those in the recording.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import click

from pdr_est.cli.error_context import prefix_errors
from pdr_est.frames import GeoOrigin
from pdr_est.io.floor_plans.building import read_building_plan
from pdr_est.io.side_tables.position_fixes import read_position_fixes, recorded_fixes, waypoint_fixes
from pdr_est.io.writers.checksums import file_digests
from pdr_est.pipeline.present_floors import without_air_pressure
from pdr_est.pipeline.warnings import notes_of_plan
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Recording

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
    paths : tuple of Path
        Files or folders of the plans; empty for none.
    floor : str
        Name of the floor on which the walk begins; empty where it is not given.
    """

    paths: tuple[Path, ...] = ()
    floor: str = ""

    @classmethod
    def of_options(cls, plans: tuple[Path, ...], floor: str | None) -> "PlanChoice":
        """Take the values of the options; raise UsageError for a floor without a plan."""
        if floor is not None and not plans:
            raise click.UsageError(f"--floor {floor}: is a floor of a plan: give --plan FILE, too")
        return cls(plans, floor or "")

    def load(self, origin: GeoOrigin | None) -> FloorPlan | BuildingPlan | None:
        """Read the plans in a map frame; None if none is chosen.

        Raises
        ------
        FloorPlanError
            For plans that cannot be used, or a floor that they do not show.
        """
        return read_building_plan(self.paths, self.floor, origin) if self.paths else None

    @property
    def arguments(self) -> list[str]:
        """Options of a command that mean the same choice."""
        given = [word for path in self.paths for word in ("--plan", str(path))]
        return [*given, *(["--floor", self.floor] if self.floor else [])]

    def digests(self) -> dict[str, str]:
        """Compute checksums of the files of the plans, by their paths."""
        found: dict[str, str] = {}
        for path in self.paths:
            files = [path] if path.is_file() else sorted((*path.glob("*.*json*"), *path.glob("*/*.*json*")))
            found |= {str(file): digest for file in files for digest in file_digests(file).values()}
        return found


NO_FLOOR_PLAN = PlanChoice()
"""The options are not given."""


def tell_notes_of_plan(plan: FloorPlan | BuildingPlan | None, devices: Sequence[DeviceRecording] = ()) -> None:
    """Warn of what was assumed to read a plan, and of plans of several floors for devices without air pressure."""
    words = [] if plan is None else notes_of_plan(plan)
    if isinstance(plan, BuildingPlan) and devices and all(device.pressure is None for device in devices):
        words.append(without_air_pressure(plan))
    for one in words:
        click.echo(f"warning: {one}", err=True)


def placed_by_plan(recording: Recording, plan: FloorPlan | BuildingPlan | None) -> Recording:
    """Put the map frame of a recording without a place on the Earth where its plan is."""
    if plan is None or plan.origin is None or recording.origin is not None:
        return recording
    return replace(recording, origin=plan.origin)
