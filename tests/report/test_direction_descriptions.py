"""The building's directions in the summary and in the report."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.report.walk.descriptions import describe_directions
from pdr_est.report.walk.page import render_report
from pdr_est.report.walk.summary import summarise
from pdr_est.types.analysis import DominantDirections

NONE = np.empty(0)


def directions(number: int, log_odds: float, used: bool) -> DominantDirections:
    return DominantDirections(number, log_odds, used, 2.0 * np.pi / number, 0.0, 0.0, NONE, NONE, NONE, NONE)


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (directions(4, np.log(150.0), True), "building with 4 directions, odds 150:1"),
        (directions(1, 0.0, True), "building with 1 direction, odds 1.0:1"),
        (directions(6, 50.0, True), "building with 6 directions, odds more than 1\u202f000\u202f000:1"),
        (directions(4, np.log(4.0), False), "no dominant directions: odds 4.0:1 for 4 directions"),
        (directions(2, -np.log(20.0), False), "no dominant directions: odds 1:20 for 2 directions"),
        (
            directions(2, -50.0, False),
            "no dominant directions: odds less than 1:1\u202f000\u202f000 for 2 directions",
        ),
        (None, "no dominant directions: not searched, or no straight part"),
    ],
)
def test_in_words(found: DominantDirections | None, words: str) -> None:
    assert describe_directions(found) == words


def test_in_the_summary_and_the_report(make_walk) -> None:
    walk, recording = make_walk(steps=20, devices=("1L", "2R"))
    first = replace(walk.devices[0], directions=directions(4, np.log(150.0), True))
    second = replace(walk.devices[1], has_heading=False)
    walk = replace(walk, devices=(first, second))
    summary = summarise(walk, recording, {"heading": {"method": "auto"}}, {}, {})
    assert [heading["device"] for heading in summary["headings"]] == ["1L", "2R"]
    found = summary["headings"][0]
    assert found["method"] == "auto"
    assert found["directions"] == {
        "number": 4,
        "spacing_deg": pytest.approx(90.0),
        "log_odds": pytest.approx(np.log(150.0)),
        "used": True,
    }
    assert summary["headings"][1]["method"] is None
    assert summary["headings"][1]["directions"] is None
    page = render_report(walk, recording, summary)
    assert "<th>headings: 1L</th><td>auto; building with 4 directions, odds 150:1</td>" in page
    assert "<th>headings: 2R</th><td>none; no dominant directions" in page
