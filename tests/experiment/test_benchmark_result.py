import io
import json
import math
from pathlib import Path

import numpy as np
import pytest
from result_rows import SECONDS, benchmark_result, result_row
from rich.console import Console

from pdr_est import __version__
from pdr_est.config import Config
from pdr_est.evaluate.metric_definitions import pooled_average
from pdr_est.evaluate.statistics import Average
from pdr_est.experiment import BenchmarkResult, print_benchmark
from pdr_est.experiment.results.walk_result import Failure
from pdr_est.experiment.suite import WalkFile
from pdr_est.experiment.variants.axes import AXES

SETTINGS = {axis.name: axis.value_in(Config()) for axis in AXES} | {"estimator": "ekf"}


def row(walk, estimator, ate):
    return result_row(walk, estimator, {"ate_rigid_m": ate, "final_drift": None}, counts={"truth_points": 9})


def result(rows, estimators=("ekf",), files=(), failures=()):
    metrics = ("ate_rigid_m", "final_drift")
    return benchmark_result("oxiod", "estimator", estimators, metrics, rows, files, failures)


def file(walk, group=None, headline=True, **labels):
    return WalkFile(walk, Path(walk), labels, group, headline)


def test_average_of_values_by_hand():
    # Of 1, 2, 3, 10: mean 4, median 2.5. The 90th percentile lies at 0.9 * 3 = 2.7, between 3 and 10: 3 + 0.7 * 7.
    average = Average.of([10.0, 1.0, 3.0, 2.0])
    assert (average.mean, average.median, average.n) == (4.0, 2.5, 4)
    assert average.p90 == pytest.approx(7.9)


def test_average_leaves_unknown_values_out_and_counts_the_others():
    assert Average.of([None, 2.0, math.nan]) == Average(2.0, 2.0, 2.0, 1)
    assert Average.of([None]) == Average(None, None, None, 0)


def test_a_weighted_average_by_hand():
    # Legs: one of 4 m, three of 2 m on average, and a walk without the metric, whose weight counts for nothing.
    average = Average.of([4.0, None, 2.0], weights=[1.0, 7.0, 3.0])
    assert average == Average(mean=2.5, median=3.0, p90=pytest.approx(3.8), n=2)


def test_leg_metrics_are_pooled_over_the_legs_of_all_walks():
    rows = [
        result_row("a", "ekf", {"leg_length_mae_m": 4.0, "ate_rigid_m": 4.0}, counts={"legs": 1}),
        result_row("b", "ekf", {"leg_length_mae_m": 2.0, "ate_rigid_m": 2.0}, counts={"legs": 3}),
    ]
    summary = benchmark_result("ilc20", "estimator", ("ekf",), tuple(rows[0].metrics), rows).summary("ekf")
    assert (summary["leg_length_mae_m"].mean, summary["ate_rigid_m"].mean) == (2.5, 3.0)


def test_weights_are_not_made_up():
    with pytest.raises(ValueError, match="shorter"):
        Average.of([4.0, 2.0], weights=[1.0])
    with pytest.raises(KeyError, match="legs"):
        pooled_average("leg_length_mae_m", [(4.0, {"legs": 1}), (2.0, {})])
    assert pooled_average("leg_length_mae_m", [(4.0, {"legs": 1}), (None, {})]).mean == 4.0


def test_document_has_exactly_the_agreed_shape():
    document = result(
        rows=[row("a/imu1", "ekf", 2.0)],
        files=[file("a/imu1", "large-scale/hand", position="hand")],
        failures=[Failure("b", "why")],
    ).to_dict()
    average = {"mean": 2.0, "median": 2.0, "p90": 2.0, "n": 1}
    nothing = {"mean": None, "median": None, "p90": None, "n": 0}
    assert document == {
        "suite": "oxiod",
        "version": __version__,
        **SETTINGS,
        "summary": {"ate_rigid_m": average, "final_drift": nothing},
        "groups": {"large-scale/hand": {"ate_rigid_m": average, "final_drift": nothing}},
        "walks": [
            {
                "walk": "a/imu1",
                "track": "device",
                **SETTINGS,
                "mode": "HOLDING",
                "position": "hand",
                "ate_rigid_m": 2.0,
                "final_drift": None,
                "truth_points": 9,
                "findings": 0,
                "seconds": SECONDS,
            }
        ],
        "skipped": [{"walk": "b", "reason": "why"}],
    }


def test_document_is_strict_json():
    json.dumps(result(rows=[row("a", "ekf", None)]).to_dict(), allow_nan=False)


def test_walks_apart_count_in_their_group_and_not_in_the_summary():
    rows = [row("a", "ekf", 1.0), row("b", "ekf", 9.0)]
    files = [file("a", "large-scale/hand"), file("b", "vicon/hand", headline=False)]
    document = result(rows, files=files).to_dict()
    assert document["summary"]["ate_rigid_m"] == {"mean": 1.0, "median": 1.0, "p90": 1.0, "n": 1}
    assert document["groups"]["vicon/hand"]["ate_rigid_m"]["mean"] == 9.0


def test_several_estimators_are_averaged_apart():
    rows = [row("a", "ekf", 1.0), row("a", "factor-graph", 3.0)]
    document = result(rows, ("ekf", "factor-graph"), [file("a", "g")]).to_dict()
    assert document["estimator"] == "all"
    assert document["summary"]["ate_rigid_m"]["mean"] == 1.0
    assert {name: s["ate_rigid_m"]["mean"] for name, s in document["estimators"].items()} == {
        "ekf": 1.0,
        "factor-graph": 3.0,
    }
    assert document["estimator_groups"]["factor-graph"]["g"]["ate_rigid_m"]["mean"] == 3.0
    assert [walk["estimator"] for walk in document["walks"]] == ["ekf", "factor-graph"]


def test_several_detectors_are_averaged_apart():
    rows = [result_row("a", name, {"count_error": error}) for name, error in (("auto", 0.01), ("mmpdr", 0.05))]
    detectors = ("auto", "mmpdr")
    document = benchmark_result("oxford-steps", "detector", detectors, ("count_error",), rows).to_dict()
    assert (document["estimator"], document["detector"]) == ("factor-graph", "all")
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
        print_benchmark(of, console)
        return console.file.getvalue()

    return lines


@pytest.mark.parametrize("name", ["mall [old]/walk", "odd[/b]", "ends\\\\"])
def test_names_with_brackets_are_printed_as_they_are(printed, name):
    text = printed(result([row(name, "ekf", 1.0)], files=[file(name, f"group {name}", person=f"[x] {name}")]), 400)
    assert f" {name} " in text
    assert f" group {name} " in text
    assert f" [x] {name} " in text


def test_table_holds_the_numbers_of_the_document(printed):
    values = np.array([1.2345, 2.3456, 4.5678])
    rows = [row(f"walk{i}", "ekf", value) for i, value in enumerate(values)]
    files = [file(row.walk, position="hand") for row in rows]
    text = printed(result(rows, files=files, failures=[Failure("[b]", "no true positions: nothing to score")]))
    for number in (*values, values.mean(), np.median(values), np.percentile(values, 90)):
        assert f"{number:.3f}" in text
    assert "skipped [b]: no true positions: nothing to score" in text
    assert "position" in text


def test_narrow_terminal_shortens_no_name_and_no_number(printed):
    name = "site1/F1/" + 24 * "5"
    text = printed(result([row(name, "factor-graph", 1.5)], ("factor-graph",)), width=20)
    assert name in text.replace("\n", "")
    assert "…" not in text


@pytest.mark.parametrize(("metric", "aligned"), [("error_heldout_m", True), ("ate_rigid_m", False)])
def test_an_estimator_that_only_aligns_with_the_fixes_is_marked_where_they_matter(printed, metric, aligned):
    names = ("dead-reckoning", "factor-graph")
    rows = [result_row("a", name, {metric: 1.0}) for name in names]
    found = benchmark_result("ilc20", "estimator", names, (metric,), rows, [file("a")], ())
    text = printed(found)
    assert ("dead-reckoning *" in text) == aligned == ("* This estimator takes no measurement" in text)
    assert "factor-graph *" not in text
    assert found.to_dict().get("aligned_with_fixes") == (["dead-reckoning"] if aligned else None)
