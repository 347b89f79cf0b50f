"""The option `--fixes`: a table of known positions, or the word `recording`."""

from pathlib import Path

from pdr_est.cli.error_context import prefix_errors
from pdr_est.io.side_tables.position_fixes import read_position_fixes, recorded_fixes
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording

RECORDED = "recording"


def load_fixes(choice: str | None, recorded: Recording, path: Path) -> tuple[PositionFix, ...]:
    """Load the position fixes that an option `--fixes` names; none without the option.

    Parameters
    ----------
    choice : str or None
        Path of a table, or `recording` for the fixes in the recording itself.
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
    if choice != RECORDED:
        return read_position_fixes(choice, recorded)
    with prefix_errors(path):
        return recorded_fixes(recorded)
