"""The experiments on MMPDR's tables run, on fewer people, and say what the acceptance asks for."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

from pdr_est.records import CarryingMode

EXPERIMENTS = Path(__file__).resolve().parents[2] / "experiments"


def experiment(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, EXPERIMENTS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def test_table_6_of_three_people():
    table = experiment("mmpdr_table6")
    scores = table.measured(people=3, seeds=[0])
    auto = scores["auto"]
    for mode in (CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET):
        assert table.percent(auto.time)[mode.name][mode.name] >= 97.0
    assert table.missed_and_false(auto.changes) == (0.0, 0.0)
    assert scores["mmpdr"].changes.real == auto.changes.real == 18
    text = table.as_text(scores, 3, [0])
    assert "missed 7.55, false 1.89" in text
    assert table.as_document(scores, 3, [0])["methods"]["auto"]["true_changes"] == 18


def test_tables_8_and_9_of_one_walker():
    table = experiment("mmpdr_tables8_9")
    row = table.ROWS[0]
    counts = {row.words: table.measured(row, [1]) for row in table.ROWS[:1]}
    assert counts[row.words].taken.tolist() == [131]
    assert counts[row.words].error("auto") <= 1.0
    assert table.paper_ratio(row) == pytest.approx(100.0)
