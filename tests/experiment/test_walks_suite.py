"""Suite `walks`: surveyed walks of anybody, with the ground truth in files beside the recordings."""

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_sets import DURATION_S, STEP_HZ, bouncing, crests_s

from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.experiment import BenchmarkResult, comparison_on_axis, run_benchmark
from pdr_est.experiment.suites import suite_named
from pdr_est.frames import Array
from pdr_est.front_end.mode import ModeParams
from pdr_est.io.side_tables.surveyed_walks import read_truth_beside
from pdr_est.types.outcome import TrackOutcome
from pdr_est.types.steps import CarryingMode

HELD = Config(mode=ModeParams(method="fixed"))
SPEED_MPS = 1.2
POSITIONS = {"ate_rigid_m", "length_ratio", "final_drift", "error_open_m"}


def walk_ahead(path: Path, gyroscope: bool = True, **described: Any) -> Path:
    """Somebody who walks straight ahead for 20 s with 40 steps, and what the description beside it says."""
    time_s, up = bouncing()
    columns = [time_s, 0.0 * time_s, 0.0 * time_s, up, *([0.0 * time_s] * 3 if gyroscope else [])]
    names = ["time_s", *(f"acc_{axis}_mps2" for axis in "xyz")]
    names += [f"gyr_{axis}_radps" for axis in "xyz"] if gyroscope else []
    rows = [",".join(f"{value:.5f}" for value in row) for row in zip(*columns, strict=True)]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress("\n".join([",".join(names), *rows]).encode()))
    if described:
        stem(path).with_suffix(".json").write_text(json.dumps(described), encoding="utf-8")
    return path


def truth_of(path: Path, time_s: Array, turned_rad: float = 0.7) -> None:
    """True positions in a frame that is turned against east."""
    x_m, y_m = SPEED_MPS * time_s * np.cos(turned_rad), SPEED_MPS * time_s * np.sin(turned_rad)
    rows = [f"{t:.3f},{x:.4f},{y:.4f}" for t, x, y in zip(time_s, x_m, y_m, strict=True)]
    stem(path).with_suffix(".truth.csv").write_text("\n".join(["time_s,x_m,y_m", *rows]), encoding="utf-8")


def stem(path: Path) -> Path:
    return path.with_suffix("").with_suffix("")


def benchmark(folder: Path, config: Config = HELD) -> BenchmarkResult:
    return run_benchmark("walks", folder, comparison_on_axis(config))


def row_of(result: BenchmarkResult, walk: str) -> TrackOutcome:
    return next(row for row in result.rows if row.walk == walk)


def reasons_of(result: BenchmarkResult, walk: str) -> str:
    return "; ".join(failure.reason for failure in result.failures if failure.walk == walk)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Walks with every kind of truth, and some that cannot be scored."""
    data = tmp_path_factory.mktemp("data")
    walks = data / "walks"
    dense = walk_ahead(walks / "lab/dense.csv.gz", mode_true="HOLDING", carrying="handheld", person="ann")
    truth_of(dense, np.arange(0.0, DURATION_S, 0.1))
    truth_of(walk_ahead(walks / "lab/sparse.csv.gz"), np.arange(0.0, DURATION_S, 2.5))
    truth_of(walk_ahead(walks / "lab/outside.csv.gz", steps_true=40), 100.0 + np.arange(5.0))
    counted = np.delete(crests_s(), [7, 20, 21, 22, 23, 24, 25, 26])  # one missing, and a pause
    walk_ahead(walks / "counts/annotated.csv.gz", step_ends_s=[*counted[1::2], *counted[::2]])
    walk_ahead(walks / "counts/elsewhen.csv.gz", step_ends_s=[*(counted + 300.0)])
    walk_ahead(walks / "counts/counted.csv.gz", steps_true=50, mode_true="POCKET")
    walk_ahead(walks / "counts/blind.csv.gz", gyroscope=False, steps_true=40, mode_true="HOLDING", speed_mps=1.0)
    walk_ahead(walks / "belt/belt.csv.gz", speed_mps=SPEED_MPS)
    walk_ahead(walks / "nothing.csv.gz")
    walk_ahead(walks / "damaged.csv.gz", steps_true="many")
    return data


@pytest.fixture(scope="module")
def result(folder: Path) -> BenchmarkResult:
    return benchmark(folder)


def test_the_folder_of_the_suite_is_inside_the_data_folder_or_is_it(folder: Path) -> None:
    names = [walk.name for walk in suite_named("walks").find(folder / "walks")]
    assert names == sorted(names)
    assert "lab/dense" in names
    assert not [name for name in names if "truth" in name]
    direct = benchmark(folder / "walks/lab")
    assert [row.walk for row in direct.rows] == ["dense", "outside", "sparse"]
    assert direct.groups(direct.comparison.main.name) == {}


def test_dense_positions_give_every_metric_of_a_track(result: BenchmarkResult) -> None:
    row = row_of(result, "lab/dense")
    metrics = row.metrics
    assert metrics["ate_rigid_m"] < 1.5
    assert metrics["heading_rms_deg"] == pytest.approx(0.0, abs=1.0)
    assert metrics["error_heldout_m"] < 1.5
    assert 0.5 <= metrics["coverage95"] <= 1.0
    assert metrics["mode_accuracy"] == 1.0
    assert {"carrying": "handheld", "person": "ann"}.items() <= row.labels.items()
    assert metrics["count_error"] is None
    assert "count_error" not in reasons_of(result, "lab/dense")


def test_sparse_positions_are_used_as_waypoints(result: BenchmarkResult) -> None:
    metrics = row_of(result, "lab/sparse").metrics
    assert all(metrics[name] is not None for name in (*POSITIONS, "error_heldout_m", "heading_rms_deg"))
    assert metrics["mode_accuracy"] is None


def test_positions_outside_the_recording_leave_the_steps(result: BenchmarkResult) -> None:
    metrics = row_of(result, "lab/outside").metrics
    assert metrics["ate_rigid_m"] is None
    assert metrics["count_error"] <= 0.05
    assert "0 of 5 truth points within the recording" in reasons_of(result, "lab/outside")


def test_annotated_steps_count_only_where_they_are_annotated(result: BenchmarkResult) -> None:
    row = row_of(result, "counts/annotated")
    assert row.counts["true_steps"] == 32
    assert row.metrics["steps_extra"] == pytest.approx(1 / 32)
    assert row.metrics["steps_missed"] <= 2 / 32


def test_steps_on_another_clock_are_not_compared(result: BenchmarkResult) -> None:
    metrics = row_of(result, "counts/elsewhen").metrics
    assert [metrics[name] for name in ("count_error", "steps_missed", "steps_extra")] == [None] * 3
    assert "0 of 32 times in step_ends_s lie within the recording" in reasons_of(result, "counts/elsewhen")


@pytest.mark.parametrize("described", ['{"steps_true": %s}', '{"step_ends_s": [%s]}', '{"speed_mps": %s}'])
def test_a_number_beyond_floats_is_refused(described: str, tmp_path: Path) -> None:
    path = walk_ahead(tmp_path / "walk.csv.gz")
    stem(path).with_suffix(".json").write_text(described % ("9" * 400), encoding="utf-8")
    with pytest.raises(RecordingError, match="correct it or remove it"):
        read_truth_beside(path)


def test_a_number_of_steps_is_compared_with_all_of_them(result: BenchmarkResult) -> None:
    metrics = row_of(result, "counts/counted").metrics
    assert metrics["count_error"] == pytest.approx(0.2, abs=0.03)
    assert metrics["mode_accuracy"] == 0.0
    assert metrics["steps_missed"] is None


def test_a_phone_without_gyroscope_has_steps_only(result: BenchmarkResult) -> None:
    metrics = row_of(result, "counts/blind").metrics
    assert metrics["count_error"] <= 0.05
    assert metrics["speed_ratio"] is None
    assert "speed_ratio: no gyroscope" in reasons_of(result, "counts/blind")


def test_speed_of_a_treadmill(result: BenchmarkResult) -> None:
    row = row_of(result, "belt/belt")
    assert row.metrics["speed_ratio"] == pytest.approx(row.steps * 0.69 / DURATION_S / SPEED_MPS, rel=0.15)
    assert all(row.metrics[name] is None for name in POSITIONS)


def test_what_cannot_be_scored_is_told(result: BenchmarkResult) -> None:
    assert "no ground truth beside it: put NAME.truth.csv" in reasons_of(result, "nothing")
    assert "damaged.json: steps_true = 'many' is not a number above zero" in reasons_of(result, "damaged")


def test_averages_over_all_and_by_subfolder(result: BenchmarkResult) -> None:
    name = result.comparison.main.name
    assert result.summary(name)["ate_rigid_m"].n == 2
    groups = result.groups(name)
    assert set(groups) == {"lab", "counts", "belt"}
    assert (groups["lab"]["ate_rigid_m"].n, groups["counts"]["count_error"].n) == (2, 3)


def test_truth_of_gps_and_its_sigma(tmp_path: Path) -> None:
    path = walk_ahead(tmp_path / "lap.csv.gz", truth_kind="phone GPS 1 Hz", sigma_m=3.0, mode_true=None)
    truth_of(path, np.arange(0.0, DURATION_S, 1.0))
    truth = read_truth_beside(path)
    assert truth.positions is not None
    assert (truth.positions.source, truth.positions.sigma_m) == ("gps", 3.0)
    assert (truth.modes, truth.steps, truth.step_count) == (None, None, None)


def test_steps_are_sorted_and_the_mode_is_that_of_all_the_time(tmp_path: Path) -> None:
    path = walk_ahead(tmp_path / "w.csv.gz", step_ends_s=[3.0, 5.0, 2.0], mode_true="POCKET")
    truth = read_truth_beside(path)
    assert truth.steps is not None
    assert truth.steps.time_s.tolist() == [2.0, 3.0, 5.0]
    assert truth.modes is not None
    assert truth.modes.at(np.array([0.0, 9.0])).tolist() == [CarryingMode.POCKET] * 2


@pytest.mark.parametrize(
    ("described", "message"),
    [
        ({"mode_true": "EAR"}, "mode_true = 'EAR' is not one of HOLDING, SWING, POCKET, OTHER"),
        ({"steps_true": 3.5}, "steps_true = 3.5 is not a whole number"),
        ({"speed_mps": -1.0}, "speed_mps = -1.0 is not a number above zero"),
        ({"step_ends_s": ["a"]}, "step_ends_s is no list of times in seconds"),
    ],
)
def test_values_that_cannot_be_right_are_refused(tmp_path: Path, described: dict[str, Any], message: str) -> None:
    path = walk_ahead(tmp_path / "w.csv.gz", **described)
    with pytest.raises(RecordingError, match=message):
        read_truth_beside(path)


def test_damaged_files_are_refused(tmp_path: Path) -> None:
    path = walk_ahead(tmp_path / "w.csv.gz")
    (tmp_path / "w.json").write_text("[1", encoding="utf-8")
    with pytest.raises(RecordingError, match=r"w\.json: is no JSON"):
        read_truth_beside(path)
    (tmp_path / "w.json").unlink()
    (tmp_path / "w.truth.csv").write_text("time_s,x_m,y_m\n0,1,\n", encoding="utf-8")
    with pytest.raises(RecordingError, match="line 2: a number is missing"):
        read_truth_beside(path)


def test_steps_per_second_of_the_made_up_walk_are_those_of_the_annotation() -> None:
    assert np.diff(crests_s()).mean() == pytest.approx(1.0 / STEP_HZ)


def test_a_walker_has_the_height_that_is_given_beside_the_recording(tmp_path: Path) -> None:
    names = ("usual", "tall")
    for name, height in zip(names, ({}, {"height_m": 1.9}), strict=True):
        truth_of(walk_ahead(tmp_path / f"{name}.csv.gz", person="p1", **height), np.arange(1.0, 19.0))
    usual, tall = (row_of(benchmark(tmp_path), name).metrics["length_ratio"] for name in names)
    assert tall == pytest.approx(usual * 1.9 / 1.73, rel=1e-3)


def test_a_height_in_other_units_is_refused(tmp_path: Path) -> None:
    truth_of(walk_ahead(tmp_path / "walk.csv.gz", height_m=186), np.arange(1.0, 19.0))
    (failure,) = benchmark(tmp_path).failures
    assert "walk.json: height_m = 186 is no height of a person in metres" in failure.reason
