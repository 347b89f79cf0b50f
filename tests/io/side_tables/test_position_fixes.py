"""Tables of position fixes: the columns that tell how a source errs."""

from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.io.side_tables.position_fixes import read_position_fixes
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording

RECORDING = Recording.from_arrays(np.arange(0.0, 60.0, 0.02), np.tile([0.0, 0.0, 9.81], (3000, 1)))


def read_rows(folder: Path, *lines: str) -> tuple[PositionFix, ...]:
    table = folder / "fixes.csv"
    table.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return read_position_fixes(table, RECORDING)


def test_sources_and_their_wandering_errors(tmp_path: Path) -> None:
    gps, file = read_rows(
        tmp_path,
        "time_s,x_m,y_m,Source,sigma_m,sigma_wander_m,wander_time_s",
        "1,0,0,gps,0.5,3,40",
        "2,5,1,,0.7,,",
    )
    assert (gps.source, gps.sigma_wander_m, gps.wander_time_s) == ("gps", 3.0, 40.0)
    assert gps.total_covariance_m2[0, 0] == pytest.approx(9.25)
    assert (file.source, file.sigma_wander_m, file.wander_time_s) == ("file", 0.0, 60.0)


def test_tables_without_these_columns_have_independent_errors(tmp_path: Path) -> None:
    (fix,) = read_rows(tmp_path, "time_s;x_m;y_m", "1,5;0;0")
    assert (fix.time_s, fix.source, fix.sigma_wander_m) == (1.5, "file", 0.0)


@pytest.mark.parametrize(
    ("column", "cell", "words"),
    [
        ("sigma_wander_m", "-1", r"line 2: sigma_wander_m = -1: give a number of metres from 0 to 100000"),
        ("sigma_wander_m", "nan", r"line 2: sigma_wander_m = nan: give"),
        ("wander_time_s", "0", r"line 2: wander_time_s = 0: give a positive number of seconds, 0\.001 to 1e\+06"),
        ("wander_time_s", "long", r"line 2, column 'wander_time_s': 'long' is not a number"),
    ],
)
def test_impossible_wandering_errors_are_refused(tmp_path: Path, column: str, cell: str, words: str) -> None:
    with pytest.raises(RecordingError, match=words):
        read_rows(tmp_path, f"time_s,x_m,y_m,{column}", f"1,0,0,{cell}")
