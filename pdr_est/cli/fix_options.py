"""Load the known positions of the option `--fixes`: a table, or the word `recording` or `waypoints`."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from pdr_est.cli.error_context import prefix_errors
from pdr_est.io.side_tables.position_fixes import read_position_fixes, recorded_fixes, waypoint_fixes
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
