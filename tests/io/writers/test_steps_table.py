"""The table of steps holds what the steps hold."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import OutputError
from pdr_est.io.writers.steps_table import STEP_COLUMNS, write_steps_csv
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, Gait, Step, StepEvent


def make_step(index: int, length_m: float = 0.7, heading_rad: float = 1.5) -> Step:
    none, empty = np.zeros(0), np.zeros((0, 3))
    samples = LevelBlock(0, 0, none, empty, empty, none, none, empty, none, none.astype(np.int8), none)
    event = StepEvent(index, 1.25 + index, 2, CarryingMode.SWING, 0.875, 0.96875)
    step = Step(event, 1.0 + index, 1.8, samples, length_m, heading_rad)
    return step if index else replace(step, gait=Gait.JOGGING, gait_probability=(0.125, 0.625, 0.25))


def test_steps_table_has_a_row_a_step_and_blanks_for_what_is_unknown(tmp_path: Path) -> None:
    steps = {"left, “old”": [make_step(0), make_step(1, math.nan, math.nan)], "right": [make_step(0)]}
    write_steps_csv(steps, tmp_path / "steps.csv")
    with (tmp_path / "steps.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.reader(stream))
    assert rows[0] == list(STEP_COLUMNS)
    assert rows[1][:6] == ["1.250000", "left, “old”", "0", "2", "SWING", "0.9688"]
    assert rows[1][6:] == ["JOGGING", "0.6250", "1.8000", "0.7000", "1.500000", "0.8750"]
    assert rows[2][6:8] == ["UNKNOWN", ""]
    assert rows[2][9:11] == ["", ""]
    assert [row[1] for row in rows[1:]] == ["left, “old”", "left, “old”", "right"]


def test_a_table_that_cannot_be_written_is_an_output_error_with_its_place(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"nowhere.steps: cannot be written"):
        write_steps_csv({}, tmp_path / "nowhere" / "steps")
