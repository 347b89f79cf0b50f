"""Names that come from files never become formulas of a spreadsheet, in any table that is written."""

import csv
from pathlib import Path

import numpy as np
import pytest

from pdr_est.output.csv_cells import harmless_cell
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

FORMULAS = ('=HYPERLINK("http://x","y")', "+1", "-1", "@SUM(A1)", "\t=1", "\r=1")


@pytest.mark.parametrize("text", FORMULAS)
def test_what_begins_like_a_formula_gets_an_apostrophe(text: str) -> None:
    assert harmless_cell(text) == f"'{text}".replace("\r", " ")


@pytest.mark.parametrize("cell", ["phone", "a=b", "", -1.5, None])
def test_other_cells_stay(cell: object) -> None:
    assert harmless_cell(cell) == cell


@pytest.mark.parametrize("name", FORMULAS)
def test_a_device_called_like_a_formula_is_text_in_the_table_of_its_track(tmp_path: Path, name: str) -> None:
    track = Track(
        estimator="test",
        kind="filtered",
        time_s=np.zeros(1),
        moving_from_s=np.zeros(1),
        device=np.array([name]),
        position_m=np.zeros((1, 2)),
        heading_rad=np.zeros(1),
        covariance_m2=np.eye(2)[None],
        sigma_heading_rad=np.ones(1),
        mode=np.array([int(CarryingMode.HOLDING)], dtype=np.int8),
        step_length_m=np.zeros(1),
    )
    track.to_csv(tmp_path / "track.csv")
    with (tmp_path / "track.csv").open(newline="", encoding="utf-8") as stream:
        (row,) = csv.DictReader(stream)
    assert row["device"] == harmless_cell(name)
