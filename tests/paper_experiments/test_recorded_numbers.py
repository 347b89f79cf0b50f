"""The recorded numbers are those of the present code: a small part of each table, computed anew."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_mmpdr_tables import experiment

from pdr_est.simulate import robust_dr_trials, simulate_walk

RESULTS = Path(__file__).resolve().parents[2] / "experiments" / "results"
REMEDY = "run experiments/all.py"


def recorded(stem: str) -> Any:
    return json.loads((RESULTS / f"{stem}.json").read_text(encoding="utf-8"))


@pytest.mark.slow
def test_psp_table_1_of_the_first_test() -> None:
    table, document = experiment("psp_table1"), recorded("psp_table1")
    for block in document["blocks"]:
        if block["trajectory"] == "I":
            seeds, chosen = [document["seed"]], document["increment_radps"]
            returns = table.measured("I", block["set_up"], seeds, chosen, tests=1)
            for method, errors_m in returns.error_m.items():
                assert errors_m[0] == pytest.approx(block["methods"][method]["error_m"][0], abs=2e-3), REMEDY


@pytest.mark.slow
def test_psp_figure_3_of_one_walk() -> None:
    figure, document = experiment("psp_figure3"), recorded("psp_figure3")
    row = document["return_error_percent"][0]
    panel = figure.panel(row["trajectory"], row["set_up"], row["way"], document["seed"])
    for method in figure.SHOWN:
        assert panel.return_error_percent(method) == pytest.approx(row[method], abs=0.02), REMEDY


@pytest.mark.parametrize(
    ("words", "opposed"), [pytest.param("trials", False, marks=pytest.mark.slow), ("opposed compasses", True)]
)
def test_robust_dr_figure_4_of_the_first_trial(words: str, opposed: bool) -> None:
    figure, document = experiment("robust_dr_figure4"), recorded("robust_dr_figure4")
    (scenario,) = robust_dr_trials(document["seed"], 1, opposed_compasses=opposed)
    walk = simulate_walk(scenario)
    for chain, of in document["sets"][words].items():
        trial = figure.fused(walk, figure.settings(walk, chain), ("dead-reckoning", "map-closed-form"))
        for name in trial.tracks:
            np.testing.assert_allclose(trial.mean_m(name), of["trials"][0][name], atol=0.01, err_msg=REMEDY)


def test_mmpdr_table_7_of_the_first_person() -> None:
    table, document = experiment("mmpdr_table7"), recorded("mmpdr_table7")
    first, *_ = table.walks_of(1, 0)
    for model in ("static", "weinberg", "auto"):  # "mmpdr" has a factor for each gender
        distance_m = document[model]["factor"] * table.distance_m(model, first)
        assert distance_m == pytest.approx(document[model]["distance_m"][0], abs=0.02), REMEDY


@pytest.mark.parametrize("words", ["indoor HOLDING", "indoor SWING", "indoor POCKET", "indoor, all modes"])
def test_mmpdr_tables_8_and_9_of_the_first_walker(words: str) -> None:
    table, document = experiment("mmpdr_tables8_9"), recorded("mmpdr_tables8_9")
    row = next(row for row in table.ROWS if row.words == words)
    counts = table.measured(row, document["seeds"][:1])
    assert counts.taken[0] == document["rows"][words]["taken"][0], REMEDY
    for method, counted in counts.counted.items():
        assert counted[0] == document["rows"][words][method]["counted"][0], REMEDY


@pytest.mark.slow
def test_mmpdr_table_10_of_one_row() -> None:
    table, document = experiment("mmpdr_table10"), recorded("mmpdr_table10")
    row = table.ROWS[0]
    errors = table.measured(row, document["seeds"])
    for chain, numbers in document["rows"][row.words].items():
        assert table.of_row(errors[chain])[3] == pytest.approx(numbers["position_m"], abs=0.02), (chain, REMEDY)


@pytest.mark.slow
def test_uptime_figure_7_of_the_simulated_trip() -> None:
    figure, document = experiment("uptime_figure7"), recorded("uptime_figure7")
    trips = figure.as_document({"simulated": figure.simulated_trip(0)})
    for model, numbers in document["simulated"]["as_it_is"].items():
        found = trips["simulated"]["as_it_is"][model]["final_percent"]
        assert found == pytest.approx(numbers["final_percent"], abs=0.02), (model, REMEDY)
