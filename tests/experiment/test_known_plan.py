"""Metrics of a track that knows its start and the floor plan beside the recording."""

import json
import re
from io import StringIO

import numpy as np
import pytest
from rich.console import Console

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.evaluate.held_out_fixes import fixes_at
from pdr_est.experiment import comparison_on_axis, print_benchmark, run_benchmark
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.scoring.known_plan import PLAN_METRICS
from pdr_est.experiment.suites import ilc20
from pdr_est.front_end.mode import ModeParams
from pdr_est.io import read
from pdr_est.io.floor_plans.reading import read_floor_plan

pytest.importorskip("shapely")

HELD = Config(mode=ModeParams(method="fixed"))
REASON = f"{', '.join(PLAN_METRICS)}: "


def write_map(folder, ring=((0, 0), (10, 0), (10, 40), (0, 40))):
    """Write the map of a corridor of 10 m x 40 m, in which the walk goes north at x = 5 m."""
    folder.mkdir(parents=True, exist_ok=True)
    degrees = [[120.0 + 1e-5 * x, 30.0 + 1e-5 * y] for x, y in (*ring, ring[0])]
    feature = {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [degrees]}}
    (folder / "geojson_map.json").write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
    (folder / "floor_info.json").write_text(json.dumps({"map_info": {"width": 10.0, "height": 40.0}}))


def test_the_metrics_are_those_of_the_track_with_start_and_plan(tmp_path, write_ilc20):
    write_map(tmp_path)
    recording, plan = read(write_ilc20(tmp_path / "log.txt")), read_floor_plan(tmp_path)
    walk = AnalysedWalk(recording, pipeline.analyse_recording(recording, HELD), HELD, plan=plan)
    (scores,) = ilc20.SUITE.score(walk)
    truth = recording.truth.positions
    fixes = fixes_at(truth.time_s[:1], truth.position_m[:1])
    track = pipeline.smooth_recording(recording, HELD, fixes, plan=plan).track
    position_m, _ = track.at(truth.time_s[1:])
    expected_m = np.linalg.norm(position_m - truth.position_m[1:], axis=1).mean()
    assert scores.values["error_plan_m"] == pytest.approx(expected_m)
    assert scores.values["outside_plan"] == pytest.approx(np.mean(plan.distance_outside_m(track.position_m) > 0.0))
    assert 0.0 <= scores.values["coverage95_plan"] <= 1.0
    assert (walk.last_on_plan.position_m == track.position_m).all()
    assert "no fixes" in scores.missing["error_heldout_plan_m"]


def test_the_benchmark_reads_the_map_beside_a_recording(tmp_path, write_ilc20):
    floor = tmp_path / "ilc20/site1/F1"
    write_ilc20(floor / "one.txt")
    write_map(floor)
    result = run_benchmark("ilc20", tmp_path, comparison_on_axis(HELD))
    document, text = result.to_dict(), StringIO()
    print_benchmark(result, Console(file=text, width=300))
    assert re.search(r"error_plan_m +│ particle ", text.getvalue())
    assert re.search(r"error_start_m +│ factor-graph ", text.getvalue())
    assert "Metrics on a floor plan (…_plan) are those of particle" in text.getvalue()
    (row,) = document["walks"]
    assert all(np.isfinite(row[metric]) for metric in PLAN_METRICS)
    assert row["outside_plan"] <= 0.05  # the walk begins on the southern wall
    assert row["error_heldout_plan_m"] == pytest.approx(row["error_heldout_m"], abs=0.5)
    assert document["summary"]["error_plan_m"]["n"] == 1
    assert (document["estimator"], document["estimator_on_plan"]) == ("factor-graph", "particle")
    chosen = run_benchmark("ilc20", tmp_path, comparison_on_axis(HELD, values=("factor-graph", "particle"))).to_dict()
    assert "estimator_on_plan" not in chosen
    graph, particle = chosen["walks"]
    assert row["error_plan_m"] == particle["error_plan_m"] != graph["error_plan_m"]
    assert row["error_start_m"] == graph["error_start_m"] != particle["error_start_m"]


def test_a_plan_that_cannot_be_used_costs_its_own_metrics_and_is_told(tmp_path, write_ilc20):
    floor = tmp_path / "ilc20/site1/F1"
    write_ilc20(floor / "one.txt")
    write_map(floor)
    (floor / "floor_info.json").write_text("{}")
    document = run_benchmark("ilc20", tmp_path, comparison_on_axis(HELD)).to_dict()
    assert document["walks"][0]["error_plan_m"] is None
    assert document["walks"][0]["error_start_m"] is not None
    (reason,) = [one["reason"] for one in document["skipped"] if one["reason"].startswith(REASON)]
    assert "no width and height" in reason


def test_an_estimator_that_makes_no_use_of_plans_has_none_of_the_metrics(tmp_path, write_ilc20):
    floor = tmp_path / "ilc20/site1/F1"
    write_ilc20(floor / "one.txt")
    write_map(floor)
    document = run_benchmark("ilc20", tmp_path, comparison_on_axis(HELD, values=("ekf",))).to_dict()
    assert [one["reason"] for one in document["skipped"] if one["reason"].startswith(REASON)] == [
        f"{REASON}ekf makes no use of a floor plan"
    ]
