"""`pdr-est steps`: its lines, its JSON, its table, and recordings that have steps but no track."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
from cli_recordings import ACC, Walk, columns_of, lines_of, save, with_cell
from cli_runs import refused, run, smooth_refused, smoothed

from pdr_est.front_end.steps import DETECTORS
from pdr_est.io.writers.steps_table import STEP_COLUMNS


@pytest.fixture(scope="session")
def accelerometer_only(walk: Walk, tmp_path_factory: pytest.TempPathFactory) -> Path:
    columns = columns_of(walk)
    lines = lines_of({name: columns[name] for name in ("time_s", *ACC)})
    return save(tmp_path_factory.mktemp("bare") / "walk.csv", lines)


def documents(*arguments: object) -> list[dict[str, object]]:
    result = run("steps", *arguments, "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    found: list[dict[str, object]] = json.loads(result.stdout)
    return found


def rows_of(table: Path) -> list[dict[str, str]]:
    with table.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_one_line_a_device(good: Path, accelerometer_only: Path) -> None:
    result = run("steps", good, accelerometer_only)
    assert (result.exit_code, result.stderr) == (0, "")
    held, bare = result.stdout.splitlines()
    (one,) = documents(good)
    assert held == (
        f"{good}: device: {one['steps']} steps in {one['duration_s']:.1f} s, "
        f"{one['cadence_per_min']:.1f} steps per minute, HOLDING 100 %"
    )
    assert bare.startswith(f"{accelerometer_only}: device: ")
    assert bare.endswith("UNKNOWN 100 %")


def test_json_is_a_list_and_agrees_with_the_walk(good: Path, accelerometer_only: Path, walk: Walk) -> None:
    both = documents(good, accelerometer_only)
    assert [document["recording"] for document in both] == [str(good), str(accelerometer_only)]
    for document in both:
        assert document["duration_s"] == pytest.approx(np.ptp(walk.time_s), abs=0.1)
        assert document["cadence_per_min"] == pytest.approx(108.0, rel=0.1)
    counts = [int(str(document["steps"])) for document in both]
    assert counts[0] > 10
    assert counts[1] == pytest.approx(counts[0], abs=1)
    assert [document["modes"] for document in both] == [{"HOLDING": 1.0}, {"UNKNOWN": 1.0}]


def test_the_table_has_a_row_a_step_and_no_heading_without_gyroscope(
    accelerometer_only: Path, tmp_path: Path
) -> None:
    (document,) = documents(accelerometer_only, "-o", tmp_path / "steps.csv")
    rows = rows_of(tmp_path / "steps.csv")
    assert tuple(rows[0]) == STEP_COLUMNS
    assert len(rows) == document["steps"]
    assert {row["heading_rad"] for row in rows} == {""}
    assert all(0.2 < float(row["length_m"]) < 1.2 for row in rows)
    assert [path.name for path in tmp_path.iterdir()] == ["steps.csv"]


@pytest.mark.parametrize("name", DETECTORS)
def test_every_detector_finds_steps_without_gyroscope(name: str, accelerometer_only: Path) -> None:
    (document,) = documents(accelerometer_only, "--detector", name)
    assert int(str(document["steps"])) >= 10


@pytest.mark.usefixtures("without_report")
def test_the_detector_is_chosen_for_steps_and_for_smooth_alike(good: Path, tmp_path: Path) -> None:
    smoothed(good, tmp_path / "out", "--detector", "uptime-fsm")
    documents(good, "--detector", "uptime-fsm", "-o", tmp_path / "steps.csv")
    assert (tmp_path / "out" / "steps.csv").read_text() == (tmp_path / "steps.csv").read_text()
    settings = json.loads((tmp_path / "out" / "summary.json").read_text())["config"]
    assert settings["steps"]["detector"] == "uptime-fsm"


def test_a_configuration_counts_and_the_option_overrules_it(good: Path, tmp_path: Path) -> None:
    config = tmp_path / "config.yaml"
    config.write_text("steps:\n  detector: auto\n  auto:\n    threshold_mps2: 50.0\n")
    result = run("steps", good, "--config", config, "--json")
    assert result.stderr == f"warning: {good}: device: no step found\n"
    (none,) = json.loads(result.stdout)
    assert (none["steps"], none["cadence_per_min"], none["modes"]) == (0, None, {})
    assert documents(good, "--config", config, "--detector", "mmpdr")[0]["steps"] != 0


def test_smooth_refuses_what_has_steps_only_and_points_here(accelerometer_only: Path, tmp_path: Path) -> None:
    line = smooth_refused(accelerometer_only, tmp_path / "outs")
    assert "no gyroscope" in line
    assert "`pdr-est steps` still finds the steps" in line


def test_the_table_of_steps_and_the_table_of_walks_together(good: Path, tmp_path: Path) -> None:
    (document,) = documents(good, "-o", tmp_path / "steps.csv", "--summary", tmp_path / "walks.csv")
    (row,) = rows_of(tmp_path / "walks.csv")
    assert row["walk"] == "walk"
    assert int(row["steps"]) == len(rows_of(tmp_path / "steps.csv")) == document["steps"]


def test_refusals(good: Path, accelerometer_only: Path, walk: Walk, tmp_path: Path) -> None:
    table = tmp_path / "steps.csv"
    assert refused("steps", good, accelerometer_only, "-o", table) == (
        "-o takes the steps of one RECORDING, but 2 are given: run the command once for each; "
        "see pdr-est steps --help"
    )
    assert refused("steps", tmp_path / "nowhere.csv").startswith(str(tmp_path / "nowhere.csv"))
    assert "'magic' is not one of 'auto', 'mmpdr'" in refused("steps", good, "--detector", "magic")
    columns = columns_of(walk)
    rates = save(tmp_path / "rates.csv", lines_of({key: columns[key] for key in columns if key not in ACC}))
    line = refused("steps", rates, "-o", table)
    assert line.startswith(f"{rates}: ")
    assert "no accelerometer" in line
    assert [path.name for path in tmp_path.iterdir()] == ["rates.csv"]


def test_what_makes_steps_doubtful_is_a_warning(walk: Walk, tmp_path: Path) -> None:
    lines = lines_of(columns_of(walk))
    del lines[200:300]
    path = save(tmp_path / "walk.csv", lines)
    result = run("steps", path)
    assert result.exit_code == 0
    assert result.stderr.startswith(f"warning: {path}: device: 1 gap or clock jump, 2.0 s in all")


def test_what_the_reader_and_the_gyroscope_leave_open_is_a_warning(walk: Walk, tmp_path: Path) -> None:
    lines = with_cell(lines_of(columns_of(walk)), 7, 1, "nan")
    half = len(lines) // 2
    lines[half:] = [",".join([*line.split(",")[:4], "nan", "nan", "nan"]) for line in lines[half:]]
    result = run("steps", save(tmp_path / "walk.csv", lines))
    assert result.exit_code == 0
    assert "1 of" in result.stderr
    assert "rows are left out: NaN" in result.stderr
    assert "the gyroscope covers only" in result.stderr


def test_a_table_of_steps_replaces_nothing_unasked_and_never_an_input(
    good: Path, lines: list[str], tmp_path: Path
) -> None:
    recording, table = save(tmp_path / "walk.csv", lines), tmp_path / "steps.csv"
    table.write_text("mine")
    config = tmp_path / "config.yaml"
    config.write_text("{}")
    (tmp_path / "hard.csv").hardlink_to(recording)
    assert "exists already: allow overwriting (--overwrite)" in refused("steps", recording, "-o", table)
    for target in (recording, config, tmp_path / "hard.csv"):
        line = refused("steps", recording, "--config", config, "-o", target, "--overwrite")
        assert re.search(r"is the input .* or lies inside it: choose a file elsewhere", line)
    assert (table.read_text(), config.read_text()) == ("mine", "{}")
    assert recording.read_text().splitlines() == lines
    assert run("steps", good, "-o", table, "--overwrite").exit_code == 0
    assert tuple(rows_of(table)[0]) == STEP_COLUMNS
