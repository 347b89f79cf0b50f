"""The experiments on MMPDR's tables run, on fewer people, and say what the acceptance asks for."""

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType

import pytest

from pdr_est.types.steps import CarryingMode

EXPERIMENTS = Path(__file__).resolve().parents[2] / "experiments"


def experiment(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, EXPERIMENTS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
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


def test_no_walker_of_table_7_as_recorded_loses_much_of_the_way():
    """Slow ones hold the phone as quietly as passengers do, and must not be taken for them."""
    document = json.loads((EXPERIMENTS / "results" / "mmpdr_table7.json").read_text(encoding="utf-8"))
    distance_m = document["auto"]["distance_m"]
    assert len(distance_m) == 30
    assert min(distance_m) > 0.85 * 28.0
    assert max(distance_m) < 1.2 * 28.0


@pytest.mark.slow
def test_table_7_of_two_people():
    table = experiment("mmpdr_table7")
    walks = table.walks_of(people=2, seed=0)
    assert [(walk.walker.gender, walk.walker.height_m) for walk in walks] == [("male", 1.67)] * 3 + [
        ("female", 1.56)
    ] * 3
    slow, moderate, fast = (len(walk.steps) for walk in walks[:3])
    assert slow > moderate > fast
    rows = table.measured(walks)
    assert set(rows) == set(table.LENGTH_MODELS)
    for model in ("auto", "weinberg", "mmpdr"):
        assert rows[model].distance_m.mean() == pytest.approx(28.0)
        assert 0.88 < rows[model].factor < 1.1
        assert rows[model].numbers()[3] < 3.0
    assert rows["static"].factor == 1.0
    men = rows["mmpdr"].distance_m[:3]
    assert men.mean() == pytest.approx(28.0)  # tuned for each gender
    assert "22.19   36.31   26.92    3.58" in table.as_text(rows)
    assert table.as_document(rows)["kim"]["paper"] is None


def test_tables_8_and_9_of_one_walker():
    table = experiment("mmpdr_tables8_9")
    row = table.ROWS[0]
    counts = {row.words: table.measured(row, [1]) for row in table.ROWS[:1]}
    assert counts[row.words].taken.tolist() == [131]
    assert counts[row.words].error("auto") <= 1.0
    assert counts[row.words].replaced == 0
    assert table.paper_ratio(row) == pytest.approx(100.0)


@pytest.mark.parametrize("number", [0, 1, 2])
def test_walks_in_one_mode_are_recognised_as_such_by_the_papers_chain(number):
    walks = experiment("mmpdr_walks")
    row = walks.ROWS[number]
    assert row.modes == ((walks.HOLDING,), (walks.SWING,), (walks.POCKET,))[number]
    for walk in row.walks([0, 8]):
        assert walks.labelled(walk, row.modes[0]) > 0.9


def test_a_walker_whose_mode_is_mistaken_is_replaced_and_counted():
    walks = experiment("mmpdr_walks")
    row = walks.ROWS[2]
    lost = walks.simulate_walk(row.scenario(8))
    assert walks.labelled(lost, walks.POCKET) < 0.9
    found = row.walks([8])
    assert walks.replaced(found) >= 1
    assert found[0].scenario.seed % walks.NEXT_WALKER == 8


def test_the_chain_of_the_paper_is_the_shipped_settings_file():
    chain = experiment("mmpdr_walks").PAPER_CHAIN
    parts = (chain.mode.method, chain.steps.detector, chain.heading.method, chain.step_length.model)
    assert parts == ("mmpdr",) * 4
    assert chain.estimator.name == "dead-reckoning"


def test_tables_8_to_10_as_recorded():
    """Issue: counts within 3 % of the paper's, headings within 1.5 times its median and twice its 95th percentile."""
    results = EXPERIMENTS / "results"
    steps = json.loads((results / "mmpdr_tables8_9.json").read_text(encoding="utf-8"))["rows"]
    published = [row for words, row in steps.items() if words.startswith("indoor")]
    assert len(published) == 5
    for row in published:
        assert abs(row["mmpdr"]["ratio"] - row["paper_ratio"]) <= 3.0
    assert all(row["auto"]["error"] <= 0.6 for row in steps.values())
    causes = json.loads((results / "mmpdr_causes.json").read_text(encoding="utf-8"))["rows"]
    found = causes["indoor, all modes; recognised"]
    assert found["median, deg"] <= 1.5 * 2.88
    assert found["95 %, deg"] <= 2.0 * 12.06
    assert causes["indoor, all modes"]["95 %, deg"] <= 2.0 * 12.06
    # one missed change decides the row of two modes; where the modes are found, lengths are what is wrong
    others = [
        row for words, row in causes.items() if words.startswith("indoor") and words != "indoor HOLDING, POCKET"
    ]
    assert min(row["lengths"] for row in others) >= 97.0
