"""The experiments on headings run, on fewer walks, and their recorded results say what they are cited for."""

import json
from pathlib import Path

import numpy as np
import pytest
from test_mmpdr_tables import experiment

from pdr_est.pipeline import smooth_recording
from pdr_est.simulate import simulate_walk

RESULTS = Path(__file__).resolve().parents[2] / "experiments" / "results"


@pytest.mark.slow
def test_psp_table_1_of_two_tests() -> None:
    table = experiment("psp_table1")
    trained = table.training_percent({"I": table.walks("I", "paper", 101, tests=2)})
    assert set(trained) == set(table.CONTROLLERS)
    assert set(trained["hde"]) == set(table.INCREMENTS_RADPS)
    returns = table.measured("I", "paper", [0], dict.fromkeys(table.CONTROLLERS, 0.005), tests=2)
    assert returns.group == ("left, clockwise", "left, counter-clockwise")
    assert set(returns.error_m) == set(table.METHODS)
    assert returns.percent("psp") == pytest.approx(returns.error_m["psp"].mean() / 2.04)
    assert returns.median_percent("psp") == pytest.approx(np.median(returns.error_m["psp"]) / 2.04)
    assert returns.mean_m("psp") < returns.mean_m("gyro")
    chosen = dict.fromkeys(table.CONTROLLERS, 0.005)
    text = table.as_text([returns], trained, chosen)
    assert "psp                   1.97    0.96" in text
    (block,) = table.as_document([returns], trained, chosen, 0)["blocks"]
    assert block["methods"]["gyro"]["paper_m"] == 20.547
    assert np.isnan(returns.mean_m("psp", "right, clockwise"))


@pytest.mark.slow
def test_psp_table_1_is_of_the_pipeline() -> None:
    """The headings of the table, reckoned by themselves, are the dead reckoning of the pipeline."""
    table = experiment("psp_table1")
    (scenario,) = table.walks("II", "circling legs", 0, tests=1)
    walk = simulate_walk(scenario)
    for method in table.RECKONED:
        track = smooth_recording(walk.recording, table.settings(method, 0.005)).track
        away_m = float(np.linalg.norm(track.position_m[-1] - track.position_m[0]))
        assert table.reckoned_error_m(table.steps_of(walk), table.heading(method, 0.005)) == pytest.approx(away_m)


def test_psp_table_1_as_recorded() -> None:
    """The bare gyroscope errs as the paper's; the controllers hold straight paths, and TIE the circle."""
    document = json.loads((RESULTS / "psp_table1.json").read_text(encoding="utf-8"))
    blocks = {(block["trajectory"], block["set_up"]): block["methods"] for block in document["blocks"]}
    assert len(blocks) == 8
    assert all(len(block["group"]) >= 25 for block in document["blocks"])
    straight, turning = blocks["I", "paper"], blocks["II", "paper"]
    assert straight["gyro"]["percent"] == pytest.approx(10.07, rel=0.25)
    assert turning["gyro"]["percent"] == pytest.approx(7.62, rel=0.35)
    assert straight["psp"]["percent"] <= 1.2
    assert turning["psp"]["median_percent"] <= 2.0
    assert turning["psp"]["median_percent"] < 0.25 * turning["hde"]["median_percent"]
    assert turning["psp"]["percent"] < 0.3 * turning["hde"]["percent"]
    assert blocks["II", "small drift"]["psp"]["percent"] < 0.25 * blocks["II", "small drift"]["hde"]["percent"]
    assert blocks["II", "circling legs"]["psp"]["percent"] > 5.0  # there the method fails


@pytest.mark.slow
def test_mmpdr_table_10_of_one_walker() -> None:
    table = experiment("mmpdr_table10")
    rows = {row.words: table.measured(row, [1]) for row in (table.ROWS[0], table.ROWS[4])}
    held = table.of_row(rows["indoor HOLDING"]["mmpdr"])
    assert held[1] < 4.0  # median heading error, deg
    changed = rows["indoor HOLDING, POCKET"]
    (walk,) = changed["mmpdr"]
    assert len(walk.position_m) == 95
    assert len(table.offsets_deg([walk], table.POCKET)) == 1
    # what the phone was turned by when it went into the pocket is not taken for a turn of the walker
    assert table.of_row(changed["mmpdr"])[3] < table.of_row(changed["step-yaw"])[3]
    assert set(table.as_document(rows, [1])["rows"]) == set(rows)


def test_the_curved_park_is_not_bent_straight() -> None:
    """As recorded: the default is no worse than the plain yaw of the steps."""
    rows = json.loads((RESULTS / "mmpdr_table10.json").read_text(encoding="utf-8"))["rows"]["park, all modes"]
    assert rows["default"]["heading_p95_deg"] <= 1.05 * rows["step-yaw"]["heading_p95_deg"]
    assert rows["default"]["position_m"] <= 1.05 * rows["step-yaw"]["position_m"]
