"""`pdr-est benchmark`: its JSON document, its options, and what it refuses before the work begins."""

import importlib
import json
import re
from pathlib import Path
from typing import Any

import pytest
from cli_recordings import Walk, ilc20_log, save
from cli_runs import PROGRAM, interrupt, refused, run

ESTIMATORS = ["dead-reckoning", "map-closed-form", "map-general", "ekf", "factor-graph", "fixed-lag", "particle"]
LENGTH_MODELS = ["auto", "harmonic", "walk-run", "range-power", "static", "weinberg", "scarlett", "mmpdr"]
LENGTH_MODELS += ["gait-table", "kim"]
DETECTORS = ["auto", "mmpdr", "uptime-fsm", "relative-threshold", "local-variance", "zero-crossing"]
DETECTORS += ["magnitude-peaks"]
METRICS = {
    *("error_open_m", "final_drift", "ate_rigid_m", "length_ratio", "error_heldout_m", "coverage95", "nees_mean"),
    *("leg_length_mae_m", "leg_vector_mae_m", "leg_turn_mae_m"),
    *("error_start_m", "heading_start_error_deg", "coverage95_start"),
    *("error_plan_m", "coverage95_plan", "outside_plan", "error_heldout_plan_m", "coverage95_heldout_plan"),
    "mode_accuracy",
    *("ate_rigid_profile_m", "length_ratio_profile", "scale_coverage68_profile"),
}
NO_NORTH = "error_start_m, heading_start_error_deg, coverage95_start: no device of the walk knows north"
NO_PLAN = (
    "error_plan_m, coverage95_plan, outside_plan, error_heldout_plan_m, coverage95_heldout_plan: no floor plan "
    "beside the recording"
)


@pytest.fixture(scope="module")
def data(walk: Walk, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two walks that can be scored, the second without enough waypoints for all metrics, and two that cannot."""
    folder = tmp_path_factory.mktemp("benchmark")
    floor = folder / "ilc20" / "site1" / "F1"
    floor.mkdir(parents=True)
    for name, text in {
        "a.txt": ilc20_log(walk, 7),
        "b.txt": ilc20_log(walk, 3),
        "c.txt": ilc20_log(walk, 0),
        "d.txt": "hello\n",
    }.items():
        (floor / name).write_text(text, encoding="utf-8")
    return folder


def scored(tmp_path: Path, *arguments: object) -> tuple[dict[str, Any], str]:
    """The JSON document and the tables of a benchmark."""
    result = run("benchmark", *arguments, "--json", tmp_path / "result.json")
    assert (result.exit_code, result.stderr) == (0, ""), result.output
    assert [path.name for path in tmp_path.iterdir()] == ["result.json"]
    return json.loads((tmp_path / "result.json").read_text(encoding="utf-8")), result.stdout


def without_seconds(document: dict[str, Any]) -> dict[str, Any]:
    return {
        **document,
        "walks": [{key: value for key, value in row.items() if key != "seconds"} for row in document["walks"]],
    }


def test_json_document(data: Path, tmp_path: Path) -> None:
    document, text = scored(tmp_path, "ilc20", "--data", data)
    assert (document["suite"], document["estimator"]) == ("ilc20", "factor-graph")
    assert document["summary"].keys() == METRICS
    assert document["summary"]["ate_rigid_m"].keys() == {"mean", "median", "p90", "n"}
    assert (document["summary"]["ate_rigid_m"]["n"], document["summary"]["coverage95"]["n"]) == (2, 1)
    rows = document["walks"]
    assert [row["walk"] for row in rows] == ["site1/F1/a", "site1/F1/b"]
    assert all(row.keys() >= METRICS | {"walk", "track", "mode", "seconds"} for row in rows)
    assert {(row["track"], row["mode"]) for row in rows} == {("device", "HOLDING")}
    assert all(row["ate_rigid_m"] < 1.5 for row in rows)
    assert (rows[1]["error_heldout_m"], rows[1]["coverage95"]) == (None, None)
    reasons = {
        walk["walk"]: walk["reason"] for walk in document["skipped"] if walk["reason"] not in (NO_NORTH, NO_PLAN)
    }
    assert "fewer than 5 truth points" in reasons["site1/F1/b"]
    assert "no true positions" in reasons["site1/F1/c"]
    assert "unknown format" in reasons["site1/F1/d"]
    assert f"{document['summary']['ate_rigid_m']['mean']:.3f}" in text
    assert "skipped site1/F1/d: " in text


@pytest.mark.slow
def test_turned_devices_score_as_those_that_are_not(data: Path, tmp_path: Path) -> None:
    plain, _ = scored(tmp_path, "ilc20", "--data", data)
    for turn in ("x90", "random:3"):
        turned, _ = scored(tmp_path, "ilc20", "--data", data, "--turn-device", turn)
        for before, after in zip(plain["walks"], turned["walks"], strict=True):
            assert after["mode"] == before["mode"]
            assert after["ate_rigid_m"] == pytest.approx(before["ate_rigid_m"], rel=1e-6)
    assert "is unknown: give x90" in refused("benchmark", "ilc20", "--data", data, "--turn-device", "w90")


def test_every_estimator_in_one_document(data: Path, tmp_path: Path) -> None:
    document, text = scored(tmp_path, "ilc20", "--data", data, "--estimator", "all", "--limit", 1)
    assert document["estimator"] == "all"
    assert list(document["estimators"]) == ESTIMATORS
    assert [row["estimator"] for row in document["walks"]] == ESTIMATORS
    assert document["summary"] == document["estimators"]["factor-graph"]
    assert all(name in text for name in ESTIMATORS)


def test_every_detector_in_one_document(data: Path, tmp_path: Path) -> None:
    options = ("--detector", "all", "--estimator", "ekf", "--limit", 1)
    document, text = scored(tmp_path, "ilc20", "--data", data, *options)
    assert (document["detector"], document["estimator"]) == ("all", "ekf")
    assert list(document["detectors"]) == DETECTORS
    assert [row["detector"] for row in document["walks"]] == DETECTORS
    assert {row["estimator"] for row in document["walks"]} == {"ekf"}
    assert document["summary"] == document["detectors"]["auto"]
    assert all(name in text for name in DETECTORS)


def test_one_detector(data: Path, tmp_path: Path) -> None:
    document, text = scored(tmp_path, "ilc20", "--data", data, "--detector", "zero-crossing", "--limit", 1)
    assert (document["detector"], document["estimator"]) == ("zero-crossing", "factor-graph")
    assert [row["detector"] for row in document["walks"]] == ["zero-crossing"]
    assert "zero-crossing" in text


@pytest.mark.slow
def test_every_length_model_in_one_document(data: Path, tmp_path: Path) -> None:
    options = ("--length-model", "all", "--estimator", "ekf", "--limit", 1)
    document, text = scored(tmp_path, "ilc20", "--data", data, *options)
    assert [row["length-model"] for row in document["walks"]] == LENGTH_MODELS
    assert len({row["length_ratio"] for row in document["walks"]}) >= len(LENGTH_MODELS) - 2  # auto is harmonic
    assert all(name in text for name in LENGTH_MODELS)


def test_one_estimator_and_a_limit(data: Path, tmp_path: Path) -> None:
    document, _ = scored(tmp_path, "ilc20", "--data", data / "ilc20", "--estimator", "ekf", "--limit", 1)
    assert document["estimator"] == "ekf"
    assert [row["walk"] for row in document["walks"]] == ["site1/F1/a"]
    alone = (
        "ate_rigid_profile_m, length_ratio_profile, scale_coverage68_profile: no other walk of site1 to learn from"
    )
    assert document["skipped"] == [{"walk": "site1/F1/a", "reason": reason} for reason in (NO_NORTH, NO_PLAN, alone)]


def test_a_configuration_changes_the_numbers(data: Path, tmp_path: Path) -> None:
    config = tmp_path / "config.yaml"
    config.write_text("step_length: {model: static}\nestimator: {name: dead-reckoning}\n", encoding="utf-8")
    (tmp_path / "results").mkdir()
    document, _ = scored(tmp_path / "results", "ilc20", "--data", data, "--limit", 1, "--config", config)
    (tmp_path / "results" / "result.json").unlink()
    usual, _ = scored(tmp_path / "results", "ilc20", "--data", data, "--limit", 1)
    assert document["estimator"] == "dead-reckoning"
    assert document["walks"][0]["length_ratio"] != usual["walks"][0]["length_ratio"]


@pytest.mark.slow
def test_processes_give_the_same_document(data: Path, tmp_path: Path) -> None:
    alone, _ = scored(tmp_path, "ilc20", "--data", data)
    (tmp_path / "result.json").unlink()
    together, _ = scored(tmp_path, "ilc20", "--data", data, "--jobs", 2)
    assert without_seconds(together) == without_seconds(alone)


@pytest.mark.slow
def test_ctrl_c_ends_all_processes(data: Path, tmp_path: Path) -> None:
    options = ("--data", str(data), "--jobs", "2", "--json", str(tmp_path / "result.json"))
    interrupt((*PROGRAM, "benchmark", "ilc20", *options), tmp_path, delay_s=0.5)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "pattern"),
    [
        (("ilc21",), r"'ilc21' is not one of .*'ilc20', .* see pdr-est benchmark --help"),
        (
            ("ilc20", "--estimator", "kalman"),
            r"'kalman' is not one of 'dead-reckoning', 'map-closed-form', .* 'fixed-lag', 'particle', 'all'",
        ),
        (("ilc20", "--detector", "ear"), r"'ear' is not one of 'auto', .* 'magnitude-peaks', 'all'"),
        (
            ("ilc20", "--detector", "all", "--estimator", "all"),
            r"--estimator all and --detector all: only one setting is compared at a time: name one value",
        ),
        (("ilc20", "--jobs", "0"), r"'--jobs': 0 is not in the range x>=1"),
        (("ilc20", "--limit", "0"), r"'--limit': 0 is not in the range x>=1"),
        (("oxiod",), r": no walk of the suite oxiod: give the folder that holds oxiod/"),
    ],
)
def test_arguments_out_of_range(arguments: tuple[str, ...], pattern: str, data: Path) -> None:
    assert re.search(pattern, refused("benchmark", *arguments, "--data", data))


def test_folders_without_a_walk(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    (tmp_path / "empty").mkdir()
    for name, pattern in {
        "nowhere": r"nowhere: no such folder: give the folder that holds ilc20/",
        "file": r"file: no such folder: give the folder that holds ilc20/",
        "empty": r"empty: no walk of the suite ilc20: give the folder that holds ilc20/",
    }.items():
        line = refused("benchmark", "ilc20", "--data", tmp_path / name, "--json", tmp_path / "result.json")
        assert line.startswith(str(tmp_path))
        assert re.search(pattern, line)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["empty", "file"]
    assert "Missing option '--data'; see pdr-est benchmark --help" in refused("benchmark", "ilc20")


def test_a_place_for_json_that_cannot_be_is_told_before_the_work(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def work(*_: object, **__: object) -> None:
        pytest.fail("the work had begun")

    monkeypatch.setattr(importlib.import_module("pdr_est.cli.work.benchmark"), "run_benchmark", work)
    for place, pattern in (
        (
            tmp_path / "no" / "result.json",
            r"result\.json: cannot be written \(No such file or directory\): check that the folder",
        ),
        (tmp_path, r": not a regular file: choose another file name"),
        (Path("/dev/null"), r"/dev/null: not a regular file: choose another file name"),
        ("", r"\.: not a regular file: choose another file name"),
    ):
        assert re.search(pattern, refused("benchmark", "ilc20", "--data", data, "--json", place))
    assert list(tmp_path.iterdir()) == []


def test_a_failed_benchmark_keeps_the_earlier_document(data: Path, tmp_path: Path) -> None:
    path = tmp_path / "result.json"
    path.write_text("earlier")
    refused("benchmark", "oxiod", "--data", data, "--json", path)
    assert path.read_text() == "earlier"
    assert [entry.name for entry in tmp_path.iterdir()] == ["result.json"]


def test_json_replaces_an_earlier_result_and_nothing_else(data: Path, tmp_path: Path) -> None:
    options = ("ilc20", "--data", data, "--limit", 1, "--estimator", "ekf")
    scored(tmp_path, *options)
    scored(tmp_path, *options)
    other = tmp_path / "result.json"
    for text in ('{"mine": 1}', "[]", "no JSON"):
        other.write_text(text)
        assert "is no result of an earlier benchmark" in refused("benchmark", *options, "--json", other)
        assert other.read_text() == text
    line = refused("benchmark", *options, "--json", data / "ilc20" / "new.json")
    assert "lies inside it: choose a file elsewhere" in line
    assert not (data / "ilc20" / "new.json").exists()


def test_nothing_scored_is_refused_with_the_first_reasons(tmp_path: Path) -> None:
    floor = tmp_path / "data" / "ilc20" / "site1" / "F1"
    floor.mkdir(parents=True)
    for name in "abcde":
        (floor / f"{name}.txt").write_text("hello\n", encoding="utf-8")
    line = refused("benchmark", "ilc20", "--data", tmp_path / "data", "--json", tmp_path / "result.json")
    assert "no walk of the suite ilc20 could be scored: site1/F1/a: " in line
    assert line.endswith("; and 2 more")
    assert [path.name for path in tmp_path.iterdir()] == ["data"]


def test_walks_without_any_number_are_refused_with_the_reasons(tmp_path: Path, lines: list[str]) -> None:
    folder = tmp_path / "data" / "walks"
    folder.mkdir(parents=True)
    save(folder / "a.csv", lines)
    (folder / "a.truth.csv").write_text("time_s,x_m,y_m\n900,0,0\n901,1,0\n902,2,0\n", encoding="utf-8")
    line = refused("benchmark", "walks", "--data", tmp_path / "data", "--json", tmp_path / "result.json")
    assert "no walk of the suite walks could be scored: a: " in line
    assert [path.name for path in tmp_path.iterdir()] == ["data"]


def test_settings_that_contradict_a_choice_are_told_with_their_file(data: Path, tmp_path: Path) -> None:
    config = tmp_path / "bad.yaml"
    config.write_text("resample: {rate_hz: 10.0}\nsteps: {mmpdr: {cutoff_hz: 20.0}}\n", encoding="utf-8")
    line = refused("benchmark", "ilc20", "--data", data, "--detector", "all", "--config", config)
    assert line.startswith(f"{config}: --detector: steps.")
