"""The experiment that repeats UPTIME's Table III: its averages, and that its recorded files tell the same."""

import json
import runpy
from pathlib import Path

import pytest
from result_rows import benchmark_result, result_row

EXPERIMENTS = Path(__file__).parents[2] / "experiments"
SCRIPT = runpy.run_path(str(EXPERIMENTS / "uptime_table3.py"))


def result(errors):
    """A result from {(position, detector): count error}."""
    rows = [
        result_row(f"walk_{position}", detector, {"count_error": error}, labels={"position": position})
        for (position, detector), error in errors.items()
    ]
    return benchmark_result("oxford-steps", "detector", SCRIPT["TUNED"], ("count_error",), rows)


def test_averages_by_place_and_detector():
    errors = {
        (position, detector): (i + 1) * percent / 100.0
        for i, detector in enumerate(SCRIPT["DETECTORS"])
        for position, percent in (("InHand", 1.0), ("FrontPocket", 2.0), ("BackPocket", 4.0), ("Purse", 9.0))
    }
    table = SCRIPT["measured"](result(errors))
    assert {place: cells["walks"] for place, cells in table.items()} == {
        "in hand": 1,
        "in pocket": 2,
        "hand and pocket": 3,
        "all positions": 4,
    }
    assert table["in pocket"]["uptime-fsm"] == pytest.approx(3.0)
    assert table["all positions"]["zero-crossing"] == pytest.approx(5 * 4.0)


def test_the_baselines_are_there_as_the_paper_had_them():
    untuned = SCRIPT["UNTUNED"]
    assert list(SCRIPT["DETECTORS"]) == ["uptime-fsm", *untuned, "local-variance", "zero-crossing", "auto"]
    foot = untuned["local-variance, untuned"].local_variance
    assert (foot.swing_mps2, foot.stance_mps2, foot.min_interval_s) == (2.0, 1.0, 0.0)
    crossing = untuned["zero-crossing, untuned"].zero_crossing
    assert (crossing.dead_band_mps2, crossing.min_interval_s) == (0.0, 0.0)


def test_recorded_text_is_that_of_the_recorded_numbers_and_the_papers():
    document = json.loads((EXPERIMENTS / "results/uptime_table3.json").read_text(encoding="utf-8"))
    text = (EXPERIMENTS / "results/uptime_table3.txt").read_text(encoding="utf-8")
    table = {place: cells["measured_percent"] for place, cells in document.items()}
    assert SCRIPT["as_text"](table) == text
    assert SCRIPT["as_markdown"](table) in (EXPERIMENTS / "paper-details.md").read_text(encoding="utf-8")
    assert {place.words: place.paper_percent for place in SCRIPT["PLACES"]} == {
        place: cells["paper_percent"] for place, cells in document.items()
    }
