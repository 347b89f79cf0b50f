"""The figures of MMPDR and PSP are drawn, of fewer walks, and the recorded numbers are of all of them."""

import json
from pathlib import Path

import numpy as np
import pytest
from test_mmpdr_tables import experiment

RESULTS = Path(__file__).resolve().parents[2] / "experiments" / "results"


@pytest.mark.slow
def test_mmpdr_figures_of_one_walker() -> None:
    figures = experiment("mmpdr_figures")
    panels = figures.single_mode_panels(1)
    assert [one.title for one in panels] == ["(a) indoor HOLDING", "(b) indoor SWING", "(c) indoor POCKET"]
    drawn = figures.paths_figure(panels)
    assert [axes.get_title() for axes in drawn.axes] == [
        f"{one.title}, chain {chain}" for chain in figures.SHOWN for one in panels
    ]
    default = drawn.axes[3]
    assert default.get_xlabel() == "east, m"
    assert "tab:red" in {line.get_color() for line in default.lines}
    curves = figures.mean_errors([1])
    assert len(curves["default"]["indoor HOLDING"]) == 95  # every metre of 96.33 m less what the corners cut off
    means = [curves["default"][row.words][:50] for row in figures.SINGLE]
    np.testing.assert_allclose(curves["default"]["mean"][:50], np.mean(means, axis=0))
    text = figures.as_text(curves, [1])
    assert "paper, its Fig. 11" in text
    assert len(figures.errors_figure(curves).axes) == 2


@pytest.mark.slow
def test_psp_figure_3_of_one_walk() -> None:
    figure = experiment("psp_figure3")
    scenario = figure.of_a_man("I", "paper", "clockwise", 0)
    assert scenario.gait.gender == "male"
    assert figure.group_of(scenario) == "left, clockwise"
    one = figure.panel("I", "paper", "clockwise", 0)
    assert one.return_error_percent("auto") < one.return_error_percent("magnetometer")
    drawn = figure.draw([one, one])
    assert {line.get_label() for line in drawn.axes[0].lines} == {"true path", *figure.SHOWN}
    (row,) = figure.as_document([one], 0)["return_error_percent"]
    assert (row["trajectory"], row["way"]) == ("I", "clockwise")


@pytest.mark.parametrize("name", ["mmpdr_figure10", "mmpdr_figure11", "mmpdr_figure13", "psp_figure3"])
def test_the_pictures_are_there(name: str) -> None:
    assert (RESULTS / f"{name}.png").read_bytes().startswith(b"\x89PNG")


def test_the_curves_are_of_the_walks_of_the_tables() -> None:
    """The mean of a curve of figure 11 is the position error of Table VIII."""
    chains = json.loads((RESULTS / "mmpdr_figures.json").read_text(encoding="utf-8"))["chains"]
    rows = json.loads((RESULTS / "mmpdr_table10.json").read_text(encoding="utf-8"))["rows"]
    for chain, by_row in chains.items():
        for row in ("indoor HOLDING", "indoor SWING", "indoor POCKET"):
            assert by_row[row]["mean_m"] == pytest.approx(rows[row][chain]["position_m"], abs=0.02)
