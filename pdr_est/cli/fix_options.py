"""What `--fixes` means: a table of known positions, or the word `recording`."""

from pathlib import Path

from pdr_est.cli.error_context import naming
from pdr_est.io.side_tables.position_fixes import read_position_fixes, recorded_fixes
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording

RECORDED = "recording"


def chosen_fixes(choice: str | None, recorded: Recording, path: Path) -> tuple[PositionFix, ...]:
    """The fixes of a choice, none without one. path: of the recording. Raises RecordingError when there are none."""
    if choice is None:
        return ()
    if choice != RECORDED:
        return read_position_fixes(choice, recorded)
    with naming(path):
        return recorded_fixes(recorded)
