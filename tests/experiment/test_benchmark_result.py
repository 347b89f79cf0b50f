import io
import json
import math

import numpy as np
import pytest
from rich.console import Console

from pdr_est.evaluate.statistics import Average
from pdr_est.experiment import BenchmarkResult, print_table
from pdr_est.experiment.results.score_rows import SkippedWalk, WalkRow


def row(walk, estimator, ate, group=None, headline=True, **labels):
    metrics = {"ate_rigid_m": ate, "final_drift": None}
    settings = {"estimator": estimator, "detector": "auto"}
    return WalkRow(walk, "device", settings, "HOLDING", metrics, 0.125, labels, {"truth_points": 9}, group, headline)


def result(estimators=("ekf",), rows=(), skipped=()):
    return BenchmarkResult(
        suite="oxiod",
        version="1.2.3",
        axis="estimator",
        names=estimators,
        settings={"estimator": "ekf", "detector": "auto"},
        metrics=("ate_rigid_m", "final_drift"),
        rows=tuple(rows),
        skipped=tuple(skipped),
    )


def test_average_of_values_by_hand():
    # Of 1, 2, 3, 10: mean 4, median 2.5. The 90th percentile lies at 0.9 * 3 = 2.7, between 3 and 10: 3 + 0.7 * 7.
    average = Average.of([10.0, 1.0, 3.0, 2.0])
    assert (average.mean, average.median, average.n) == (4.0, 2.5, 4)
    assert average.p90 == pytest.approx(7.9)


def test_average_leaves_unknown_values_out_and_counts_the_others():
    assert Average.of([None, 2.0, math.nan]) == Average(2.0, 2.0, 2.0, 1)
    assert Average.of([None]) == Average(None, None, None, 0)


def test_document_has_exactly_the_agreed_shape():
    document = result(
        rows=[row("a/imu1", "ekf", 2.0, "large-scale/hand", position="hand")], skipped=[SkippedWalk("b", "why")]
    ).to_dict()
    average = {"mean": 2.0, "median": 2.0, "p90": 2.0, "n": 1}
    nothing = {"mean": None, "median": None, "p90": None, "n": 0}
    assert document == {
        "suite": "oxiod",
        "version": "1.2.3",
        "estimator": "ekf",
        "detector": "auto",
        "summary": {"ate_rigid_m": average, "final_drift": nothing},
        "groups": {"large-scale/hand": {"ate_rigid_m": average, "final_drift": nothing}},
        "walks": [
            {
                "walk": "a/imu1",
                "track": "device",
                "estimator": "ekf",
                "detector": "auto",
                "mode": "HOLDING",
                "position": "hand",
                "ate_rigid_m": 2.0,
                "final_drift": None,
                "truth_points": 9,
                "seconds": 0.125,
            }
        ],
        "skipped": [{"walk": "b", "reason": "why"}],
    }


def test_document_is_strict_json():
    json.dumps(result(rows=[row("a", "ekf", None)]).to_dict(), allow_nan=False)


def test_walks_apart_count_in_their_group_and_not_in_the_summary():
    rows = [row("a", "ekf", 1.0, "large-scale/hand"), row("b", "ekf", 9.0, "vicon/hand", headline=False)]
    document = result(rows=rows).to_dict()
    assert document["summary"]["ate_rigid_m"] == {"mean": 1.0, "median": 1.0, "p90": 1.0, "n": 1}
    assert document["groups"]["vicon/hand"]["ate_rigid_m"]["mean"] == 9.0


def test_several_estimators_are_averaged_apart():
    rows = [row("a", "ekf", 1.0, "g"), row("a", "factor-graph", 3.0, "g")]
    document = result(estimators=("ekf", "factor-graph"), rows=rows).to_dict()
    assert document["estimator"] == "all"
    assert document["summary"]["ate_rigid_m"]["mean"] == 1.0
    assert {name: s["ate_rigid_m"]["mean"] for name, s in document["estimators"].items()} == {
        "ekf": 1.0,
        "factor-graph": 3.0,
    }
    assert document["estimator_groups"]["factor-graph"]["g"]["ate_rigid_m"]["mean"] == 3.0
    assert [walk["estimator"] for walk in document["walks"]] == ["ekf", "factor-graph"]


def test_several_detectors_are_averaged_apart():
    rows = [
        WalkRow("a", "device", {"estimator": "ekf", "detector": name}, "HOLDING", {"count_error": error}, 0.1)
        for name, error in (("auto", 0.01), ("mmpdr", 0.05))
    ]
    of_detectors = BenchmarkResult(
        suite="oxford-steps",
        version="1.2.3",
        axis="detector",
        names=("auto", "mmpdr"),
        settings={"estimator": "ekf", "detector": "auto"},
        metrics=("count_error",),
        rows=tuple(rows),
        skipped=(),
    )
    document = of_detectors.to_dict()
    assert (document["estimator"], document["detector"]) == ("ekf", "all")
    assert document["summary"] == document["detectors"]["auto"]
    assert {name: s["count_error"]["mean"] for name, s in document["detectors"].items()} == {
        "auto": 0.01,
        "mmpdr": 0.05,
    }
    assert document["detector_groups"] == {"auto": {}, "mmpdr": {}}
    assert [walk["detector"] for walk in document["walks"]] == ["auto", "mmpdr"]
    assert "estimators" not in document


@pytest.fixture
def printed():
    def lines(of: BenchmarkResult, width: int = 80) -> str:
        console = Console(file=io.StringIO(), width=width)
        print_table(of, console)
        return console.file.getvalue()

    return lines


def test_table_holds_the_numbers_of_the_document(printed):
    values = np.array([1.2345, 2.3456, 4.5678])
    rows = [row(f"walk{i}", "ekf", value, position="hand") for i, value in enumerate(values)]
    text = printed(result(rows=rows, skipped=[SkippedWalk("[b]", "no true positions: nothing to score")]))
    for number in (*values, values.mean(), np.median(values), np.percentile(values, 90)):
        assert f"{number:.3f}" in text
    assert "skipped [b]: no true positions: nothing to score" in text
    assert "position" in text


def test_narrow_terminal_shortens_no_name_and_no_number(printed):
    name = "site1/F1/" + 24 * "5"
    text = printed(result(rows=[row(name, "factor-graph", 1.5)], estimators=("factor-graph",)), width=20)
    assert name in text.replace("\n", "")
    assert "…" not in text
