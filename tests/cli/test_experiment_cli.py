"""`experiment`, `compare` and `config` from the command line."""

import csv
import json
from itertools import product
from pathlib import Path
from typing import Any

import pytest
import yaml
from cli_runs import refused, run

SMALL = """\
title: Small
data:
  simulated: {number: 2, duration_s: 30.0}
sweep:
  estimator.name: [dead-reckoning, ekf]
fixes: {protocol: every, every: 2, sigma_m: 1.0}
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a small experiment beside its results in `out`."""
    path = tmp_path_factory.mktemp("experiment") / "small.yaml"
    path.write_text(SMALL, encoding="utf-8")
    result = run("experiment", path, "-o", path.parent / "out")
    assert result.exit_code == 0, result.output
    assert "2 walks x 2 variants" in result.stdout
    return path


def test_all_files_are_written(small: Path) -> None:
    names = {path.name for path in (small.parent / "out").iterdir()}
    assert names >= {
        "results.parquet",
        "timings.parquet",
        "config.yaml",
        "provenance.json",
        "failed.csv",
        "report.html",
        "parts",
    }


def test_a_second_run_has_nothing_to_do(small: Path) -> None:
    result = run("experiment", small, "-o", small.parent / "out")
    assert "2 of 2 walks were there from an earlier run" in result.stdout


def test_compare_prints_and_writes_who_is_better(small: Path, tmp_path: Path) -> None:
    result = run("compare", small.parent / "out", "--metric", "error_heldout_m", "-o", tmp_path)
    assert result.exit_code == 0
    assert "dead-reckoning" in result.stdout
    lines = (tmp_path / "compare.csv").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 2
    assert lines[1].startswith("error_heldout_m,m,dead-reckoning,ekf,2,")
    assert (tmp_path / "compare.md").read_text(encoding="utf-8").startswith("| metric | unit | A | B |")


def test_an_estimator_that_is_aligned_with_the_fixes_has_a_footnote_where_fixes_matter(
    small: Path, tmp_path: Path
) -> None:
    result = run("compare", small.parent / "out", "--metric", "error_heldout_m", "-o", tmp_path)
    text = (tmp_path / "compare.md").read_text(encoding="utf-8")
    for shown in (result.stdout, text):
        assert "dead-reckoning *" in shown
        assert "ekf *" not in shown
        assert "* This estimator takes no measurement from the position fixes" in shown
    assert "\n\n\\* This estimator" in text  # no bullet
    other = run("compare", small.parent / "out", "--metric", "length_ratio", "-o", tmp_path)
    assert "position fixes" not in other.stdout + (tmp_path / "compare.md").read_text(encoding="utf-8")
    page = (small.parent / "out" / "report.html").read_text(encoding="utf-8")
    assert "<strong>dead-reckoning:</strong> This estimator takes no measurement" in page


@pytest.mark.parametrize("columns", [60, 100, 160])
def test_compare_is_readable_in_a_terminal(small: Path, tmp_path: Path, columns: int, monkeypatch: Any) -> None:
    """No line is wider than it, or than 100 columns; units stand in the headings, and numbers are whole."""
    monkeypatch.setenv("COLUMNS", str(columns))
    result = run("compare", small.parent / "out", "-o", tmp_path)
    lines = result.stdout.splitlines()
    assert max(len(line) for line in lines) <= max(columns, 100)
    assert lines[0].startswith("error_heldout_m (m), ideal value 0")
    assert "(m)" in lines[3]
    assert any(line.startswith("The same with all variants on every walk: error_open_m, ") for line in lines)
    with (tmp_path / "compare.csv").open(encoding="utf-8") as stream:
        row = next(row for row in csv.DictReader(stream) if row["metric"] == "error_heldout_m")
    shown = {f"{float(row['mean A']) + off:.3f}" for off in (-1e-4, 0.0, 1e-4)}  # the file rounds to other digits
    assert any(one in result.stdout for one in shown)
    intervals = {
        f"{float(row['low']) + low:+.3f} … {float(row['high']) + high:+.3f}"
        for low, high in product((-1e-4, 0.0, 1e-4), repeat=2)
    }
    assert any(one in result.stdout for one in intervals)


def test_compare_of_one_track(small: Path, tmp_path: Path) -> None:
    assert run("compare", small.parent / "out", "--track", "device", "-o", tmp_path).exit_code == 0
    line = refused("compare", small.parent / "out", "--track", "fused", "-o", tmp_path)
    assert line == "unknown track 'fused': known are device"


def test_what_is_wrong_in_a_file_is_one_line_with_its_line_number(tmp_path: Path) -> None:
    path = tmp_path / "wrong.yaml"
    path.write_text(SMALL.replace("every: 2", "evry: 2"), encoding="utf-8")
    line = refused("experiment", path, "-o", tmp_path / "out")
    assert "wrong.yaml: line 6: unknown key 'fixes.evry': did you mean 'every'?" in line
    assert not (tmp_path / "out").exists()


def test_results_of_another_file_are_refused(small: Path, tmp_path: Path) -> None:
    path = tmp_path / "other.yaml"
    path.write_text(SMALL.replace("sigma_m: 1.0", "sigma_m: 2.0"), encoding="utf-8")
    line = refused("experiment", path, "-o", small.parent / "out")
    assert "holds results of another configuration: allow overwriting (--overwrite)" in line


def test_walks_that_all_fail_are_an_error_with_the_reasons(tmp_path: Path) -> None:
    (tmp_path / "broken.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    path = tmp_path / "broken.yaml"
    path.write_text("data:\n  recordings: ['*.csv']\n", encoding="utf-8")
    line = refused("experiment", path, "-o", tmp_path / "out", "-q")
    assert "no walk could be scored: broken: " in line


def test_schemas_are_json() -> None:
    assert "data" in json.loads(run("config", "schema").stdout)["properties"]
    assert "resample" in json.loads(run("config", "schema", "--settings").stdout)["properties"]


def test_show_resolves_both_kinds_of_files(small: Path, tmp_path: Path) -> None:
    shown = yaml.safe_load(run("config", "show", small).stdout)
    assert set(shown["variants"]) == {"dead-reckoning", "ekf"}
    assert shown["seed"] == 0
    path = tmp_path / "settings.yaml"
    path.write_text("steps: {detector: mmpdr}\n", encoding="utf-8")
    settings = yaml.safe_load(run("config", "show", path).stdout)
    assert (settings["steps"]["detector"], settings["resample"]["rate_hz"]) == ("mmpdr", 50.0)
    path.write_text("stepz: {}\n", encoding="utf-8")
    assert "settings.yaml: line 1: unknown key 'stepz': did you mean 'steps'?" in refused("config", "show", path)
