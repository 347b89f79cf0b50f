"""Runs of experiments: the same numbers in whatever way, and nothing lost."""

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from experiment_files import SMALL, experiment_file

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.errors import ConfigError, OutputError
from pdr_est.experiment import load_experiment, run_experiment
from pdr_est.experiment.results.walk_result import decode, encode, result_file
from pdr_est.experiment.runners.processes import run_in_processes
from pdr_est.experiment.runners.scoring_job import experiment_job
from pdr_est.experiment.suite import Suite
from pdr_est.experiment.walks import Walk
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.pipeline import DeviceWalk
from pdr_est.simulate import preset, simulate_walk
from pdr_est.types.recording import Recording

TABLES = ("results.parquet", "failed.csv", "config.yaml", "report.html")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of an uninterrupted run in one process."""
    folder = tmp_path_factory.mktemp("whole")
    run_experiment(load_experiment(experiment_file(folder)), folder / "out")
    return folder


def same_tables(a: Path, b: Path) -> bool:
    return all((a / name).read_bytes() == (b / name).read_bytes() for name in TABLES)


def test_the_table_is_long_and_complete(whole: Path) -> None:
    table = pl.read_parquet(whole / "out" / "results.parquet")
    assert table.columns == ["walk", "track", "variant", "person", "carrying", "mode", "metric", "value"]
    assert table["walk"].unique(maintain_order=True).to_list() == [f"walk_{i:04d}" for i in (1, 2, 3)]
    assert table["variant"].unique(maintain_order=True).to_list() == ["dead-reckoning", "ekf"]
    assert table.filter(pl.col("metric") == "count_error")["value"].max() < 0.1
    assert len(table) == 3 * 2 * table["metric"].n_unique()
    assert table["value"].null_count() == 0
    assert (whole / "out" / "failed.csv").read_text(encoding="utf-8") == "walk,what,reason\n"


def test_provenance_holds_what_is_needed_to_repeat_it(whole: Path) -> None:
    document = json.loads((whole / "out" / "provenance.json").read_text(encoding="utf-8"))
    assert {"version", "commit", "packages", "seed", "seeds", "data", "fingerprint"} <= set(document)
    assert document["seed"] == 7
    assert set(document["seeds"]) == {f"walk_{i:04d}" for i in (1, 2, 3)}
    assert set(document["fingerprint"]) == {"config", "data", "code", "packages"}


@pytest.mark.slow
def test_processes_give_the_same_bytes(whole: Path, tmp_path: Path) -> None:
    run_experiment(load_experiment(whole / "small.yaml"), tmp_path / "out", workers=2)
    assert same_tables(whole / "out", tmp_path / "out")


@pytest.mark.slow
def test_another_seed_gives_other_numbers(whole: Path, tmp_path: Path) -> None:
    path = experiment_file(tmp_path, SMALL.replace("seed: 7", "seed: 8"))
    run_experiment(load_experiment(path), tmp_path / "out")
    first, second = (pl.read_parquet(folder / "out" / "results.parquet") for folder in (whole, tmp_path))
    assert not first.equals(second)


@pytest.mark.slow
def test_a_killed_run_goes_on_where_it_was(whole: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = (sys.executable, "-c", "from pdr_est.cli import main; main()", "experiment", whole / "small.yaml")
    running = subprocess.Popen([*command, "-o", out, "--workers", "2", "-q"], start_new_session=True)
    parts = out / "parts"
    deadline = time.monotonic() + 60.0
    while not list(parts.glob("*.gz")) and running.poll() is None and time.monotonic() < deadline:
        time.sleep(0.005)
    running.send_signal(signal.SIGKILL)
    running.wait()
    there = {path: path.stat().st_mtime_ns for path in parts.glob("*.gz")}
    assert there
    all_ended(running.pid)
    finished = run_experiment(load_experiment(whole / "small.yaml"), out)
    assert finished.resumed == len(there)
    assert {path: path.stat().st_mtime_ns for path in there} == there
    assert same_tables(whole / "out", out)


def all_ended(group: int) -> None:
    """The processes of a killed run do not outlive it for long."""
    deadline = time.monotonic() + 30.0
    while time.monotonic() < deadline:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        time.sleep(0.05)
    os.killpg(group, signal.SIGKILL)
    pytest.fail("processes outlive the killed run")


def test_damaged_and_missing_parts_are_done_again(whole: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole / "out", out)
    first, second = result_file(out / "parts", "walk_0001"), result_file(out / "parts", "walk_0002")
    first.write_bytes(first.read_bytes()[:100])
    second.unlink()
    (out / "results.parquet").unlink()
    assert run_experiment(load_experiment(whole / "small.yaml"), out).resumed == 1
    assert same_tables(whole / "out", out)


def test_every_damage_of_a_part_counts_as_missing(whole: Path) -> None:
    content = result_file(whole / "out" / "parts", "walk_0001").read_bytes()
    good, rng = decode(content), np.random.default_rng(5)
    kept = 0
    for _ in range(400):
        damaged = bytearray(content)
        at = int(rng.integers(len(damaged)))
        match rng.integers(4):
            case 0:
                damaged[at] ^= int(rng.integers(1, 256))
            case 1:
                del damaged[at:]
            case 2:
                damaged[at:at] = rng.bytes(5)
            case _:
                del damaged[at : at + 7]
        try:
            again = decode(bytes(damaged))
        except ValueError:
            continue
        kept += 1  # a change in the header of gzip, such as its time
        assert encode(again) == encode(good)
    assert kept < 10


def test_foreign_files_survive(whole: Path, tmp_path: Path) -> None:
    """Also a foreign provenance.json, and results of other walks in the same folder."""
    out, experiment = tmp_path / "out", load_experiment(whole / "small.yaml")
    (out / "parts").mkdir(parents=True)
    foreign = {"provenance.json": '{"fingerprint": {}}', "report.html": "mine", "parts/mine.json.gz": "mine"}
    for name, text in foreign.items():
        (out / name).write_text(text, encoding="utf-8")
    for overwrite in (False, True):
        with pytest.raises(OutputError, match="holds files of other origin"):
            run_experiment(experiment, out, overwrite=overwrite)
    assert {name: (out / name).read_text(encoding="utf-8") for name in foreign} == foreign
    again = tmp_path / "again"
    shutil.copytree(whole / "out", again)
    for name in ("notes.txt", "parts/mine.json.gz"):
        (again / name).write_text("mine", encoding="utf-8")
    run_experiment(experiment, again, overwrite=True)
    assert same_tables(whole / "out", again)
    for name in ("notes.txt", "parts/mine.json.gz"):
        assert (again / name).read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(SMALL.replace("seed: 7", "seed: 8"), marks=pytest.mark.slow),
        SMALL.replace("number: 3", "number: 1"),
    ],
)
def test_results_of_something_else_are_not_mixed(whole: Path, tmp_path: Path, text: str) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole / "out", out)
    other = load_experiment(experiment_file(tmp_path, text))
    with pytest.raises(OutputError, match="holds results of another configuration: allow overwriting"):
        run_experiment(other, out)
    assert same_tables(whole / "out", out)
    assert run_experiment(other, out, overwrite=True).resumed == 0


def test_other_code_is_noticed(whole: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole / "out", out)
    document = json.loads((out / "provenance.json").read_text(encoding="utf-8"))
    document["fingerprint"]["code"] = "0"
    (out / "provenance.json").write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(OutputError, match="holds results of another version of the code: allow"):
        run_experiment(load_experiment(whole / "small.yaml"), out)


def test_folders_with_other_files_are_left_alone(whole: Path, tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("x", encoding="utf-8")
    for overwrite in (False, True):
        with pytest.raises(OutputError, match=r"files of other origin \(thesis.tex\)"):
            run_experiment(load_experiment(whole / "small.yaml"), tmp_path, overwrite=overwrite)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


@pytest.mark.parametrize("moment", [2, *(pytest.param(moment, marks=pytest.mark.slow) for moment in (1, 3, 4, 5, 6))])
def test_a_run_that_dies_while_it_writes_goes_on(
    whole: Path, tmp_path: Path, moment: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At whichever file: configuration, provenance, a part, and the tables and the report at the end."""
    out = tmp_path / "out"
    begins = moment <= 2
    if not begins:
        shutil.copytree(whole / "out", out)
        result_file(out / "parts", "walk_0002").unlink()
    intact, calls = Path.replace, []

    def deadly(path: Path, target: Path) -> Path:
        calls.append(path)
        if len(calls) == (moment if begins else moment - 2):
            raise SystemExit
        return intact(path, target)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", deadly)
        with pytest.raises(SystemExit):
            run_experiment(load_experiment(whole / "small.yaml"), out)
    run_experiment(load_experiment(whole / "small.yaml"), out)
    assert same_tables(whole / "out", out)
    assert [path.name for path in out.rglob("*.partial")] == []


@pytest.mark.slow
def test_parts_without_provenance_are_of_unknown_origin(whole: Path, tmp_path: Path) -> None:
    """What a killed --overwrite may leave is not taken for the walks of another configuration."""
    out = tmp_path / "out"
    shutil.copytree(whole / "out" / "parts", out / "parts")
    other = load_experiment(experiment_file(tmp_path, SMALL.replace("[dead-reckoning, ekf]", "[ekf]")))
    assert run_experiment(other, out).resumed == 0


def test_overwriting_removes_the_provenance_last(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole / "out", out)
    removed: list[str] = []
    intact = Path.unlink

    def noted(path: Path, missing_ok: bool = False) -> None:
        removed.append(path.name)
        if len(removed) == 2:
            raise SystemExit
        intact(path, missing_ok)

    other = load_experiment(experiment_file(tmp_path, SMALL.replace("seed: 7", "seed: 8")))
    with monkeypatch.context() as patch:
        patch.setattr(Path, "unlink", noted)
        with pytest.raises(SystemExit):
            run_experiment(other, out, overwrite=True)
    with pytest.raises(OutputError, match="another configuration: allow overwriting"):
        run_experiment(other, out)


def test_a_folder_of_that_name_with_other_files_is_left_alone(whole: Path, tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "wing.step").write_text("x", encoding="utf-8")
    for overwrite in (False, True):
        with pytest.raises(OutputError, match=r"files of other origin \(parts/wing.step\)"):
            run_experiment(load_experiment(whole / "small.yaml"), tmp_path, overwrite=overwrite)
    assert (tmp_path / "parts" / "wing.step").is_file()


RECORDINGS = """\
data:
  recordings: ["*.csv"]
  folder: walks
sweep:
  estimator.name: [dead-reckoning, ekf]
"""


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """An experiment on two good recordings and a damaged one."""
    (tmp_path / "walks").mkdir()
    recording = simulate_walk(preset("l_shape")).recording
    for name in ("a", "c"):
        write_plain_csv(recording, tmp_path / "walks" / f"{name}.csv")
    (tmp_path / "walks" / "b.csv").write_text("time_s,acc_x_mps2\n1,2\n", encoding="utf-8")
    return experiment_file(tmp_path, RECORDINGS)


def failures(out: Path) -> list[dict[str, str]]:
    with (out / "failed.csv").open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_a_walk_that_fails_is_recorded_and_does_not_stop_the_rest(recorded: Path, tmp_path: Path) -> None:
    finished = run_experiment(load_experiment(recorded), tmp_path / "out")
    assert finished.failed == 1
    whole = [row for row in failures(tmp_path / "out") if row["what"] == "walk"]
    assert [row["walk"] for row in whole] == ["b"]
    assert "b.csv" in whole[0]["reason"]
    table = pl.read_parquet(tmp_path / "out" / "results.parquet")
    assert table["walk"].unique(maintain_order=True).to_list() == ["a", "c"]
    hashes = json.loads((tmp_path / "out" / "provenance.json").read_text(encoding="utf-8"))["data"]
    assert set(hashes) == {"a.csv", "b.csv", "c.csv"}


def test_changed_data_are_noticed(recorded: Path, tmp_path: Path) -> None:
    run_experiment(load_experiment(recorded), tmp_path / "out")
    shutil.copy(tmp_path / "walks" / "a.csv", tmp_path / "walks" / "b.csv")
    with pytest.raises(OutputError, match="holds results of other data: allow"):
        run_experiment(load_experiment(recorded), tmp_path / "out")


@pytest.mark.slow
def test_a_fault_of_ours_costs_one_walk_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    intact = pipeline.analyse_recording

    def faulty(recording: Recording, config: Config) -> tuple[DeviceWalk, ...]:
        if recording.name == "walk_0002":
            raise ZeroDivisionError("a fault")
        return intact(recording, config)

    monkeypatch.setattr(pipeline, "analyse_recording", faulty)
    finished = run_experiment(load_experiment(experiment_file(tmp_path)), tmp_path / "out")
    assert finished.failed == 1
    assert failures(tmp_path / "out") == [
        {"walk": "walk_0002", "what": "walk", "reason": "ZeroDivisionError: a fault"}
    ]


@dataclass(frozen=True)
class Deadly(Walk):
    """A walk that kills the process that works on it."""

    def recording(self, suite: Suite) -> Recording:
        os._exit(1)


@pytest.mark.slow
def test_a_process_that_dies_costs_one_walk_and_is_not_final(tmp_path: Path) -> None:
    experiment = load_experiment(experiment_file(tmp_path))
    first, second, third = experiment.walks
    deadly = Deadly(second.name, second.labels, second.source)
    done = {
        one.walk.name: one for one in run_in_processes(experiment_job(experiment), [first, deadly, third], workers=2)
    }
    assert {name: one.final for name, one in done.items()} == {
        "walk_0001": True,
        "walk_0002": False,
        "walk_0003": True,
    }
    lost = done["walk_0002"].result
    assert (lost.tracks, lost.failures[0].whole) == ((), True)
    assert "died" in lost.failures[0].reason


def test_at_least_one_worker(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="workers = 0"):
        run_experiment(load_experiment(experiment_file(tmp_path)), tmp_path / "out", workers=0)
