"""`pdr-est smooth`: its files, what each option does to them, what it says, and how it ends early."""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_recordings import Walk, columns_of, lines_of, save
from cli_runs import PROGRAM, RESULT_FILES, interrupt, refused, run, smoothed

from pdr_est.front_end.gait import shipped_model
from pdr_est.front_end.gait.model import model_digest
from pdr_est.front_end.step_length.equations import MMPDR_K
from pdr_est.types.track_output.table import TRACK_COLUMNS

SUMMARY_KEYS = {
    *(
        "inputs",
        "config",
        "versions",
        "counts",
        "distance_m",
        "gaps",
        "timings_s",
        "findings",
        "warnings",
        "estimator",
    )
}

not_drawn = pytest.mark.usefixtures("without_report")


def table(out: Path) -> list[dict[str, str]]:
    with (out / "track.csv").open(newline="", encoding="utf-8") as stream:
        reader = csv.DictReader(stream)
        assert tuple(reader.fieldnames or ()) == TRACK_COLUMNS
        return list(reader)


def column(out: Path, name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array([float(row[name]) for row in table(out)])


def document(out: Path, name: str = "summary.json") -> Any:
    return json.loads((out / name).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def plain(good: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results without any option."""
    out = tmp_path_factory.mktemp("plain") / "out"
    smoothed(good, out)
    return out


# --- the files -------------------------------------------------------------------------------------------------


def test_the_summary_names_the_gait_model(plain: Path) -> None:
    assert document(plain)["gait_model_sha256"] == model_digest(shipped_model("auto"))


def test_a_row_a_step_with_the_start_first(plain: Path) -> None:
    rows = table(plain)
    with (plain / "steps.csv").open(newline="", encoding="utf-8") as stream:
        steps = list(csv.DictReader(stream))
    assert len(rows) == len(steps) + 1 == document(plain)["counts"]["steps"]["device"] + 1
    assert 15 <= len(steps) <= 20
    assert [float(rows[0][name]) for name in ("x_m", "y_m", "heading_rad", "step_length_m")] == [0.0] * 4
    assert [row["time_s"] for row in rows[1:]] == [step["time_s"] for step in steps]
    assert {row["mode"] for row in rows} == {"HOLDING"}
    end = float(rows[-1]["x_m"]), float(rows[-1]["y_m"])
    assert end == pytest.approx((12.0, 0.0), abs=1.8)


def test_the_summary_says_what_was_done(plain: Path, good: Path) -> None:
    summary = document(plain)
    assert summary.keys() >= SUMMARY_KEYS
    (source,) = summary["inputs"]
    assert (source["name"], len(source["sha256"])) == (good.name, 64)
    assert summary["config"]["walker"]["height_m"] == 1.73
    assert summary["estimator"] == "factor-graph"
    assert summary["distance_m"] == pytest.approx(12.0, rel=0.15)
    assert summary["warnings"] == []


def test_what_does_not_fit_is_in_the_summary_and_on_the_terminal(good: Path, tmp_path: Path) -> None:
    result = run("smooth", good, "-o", tmp_path / "out", "--start", 3, 4)
    summary = document(tmp_path / "out")
    (finding,) = summary["findings"]
    assert (finding["kind"], finding["doubtful"], summary["frame"]) == ("start-heading", True, "own")
    assert "the direction of the track is unknown" in finding["message"]
    assert summary["warnings"] == [finding["message"]]
    assert result.stderr.splitlines().count(f"warning: {finding['message']}") == 1
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "<h2>What does not fit</h2>" in page
    assert "<h2>Warnings</h2>" not in page
    with_heading = run("smooth", good, "-o", tmp_path / "known", "--start", 3, 4, "--heading", 90)
    assert "direction" not in with_heading.stderr
    assert document(tmp_path / "known")["findings"] == []


def test_the_tum_file_opens_with_evo(plain: Path) -> None:
    file_interface = pytest.importorskip("evo.tools.file_interface")
    trajectory = file_interface.read_tum_trajectory_file(plain / "track.tum")
    valid, details = trajectory.check()
    assert valid, details
    expected = np.column_stack([column(plain, "x_m"), column(plain, "y_m")])
    is_pose = np.isin(np.round(trajectory.timestamps, 6), np.round(column(plain, "time_s"), 6))
    np.testing.assert_allclose(trajectory.positions_xyz[is_pose, :2], expected, atol=1e-4)
    assert not is_pose.all()  # where the walker stands, a line more says until when


def test_the_geojson_has_a_line_through_all_poses(plain: Path) -> None:
    collection = document(plain, "track.geojson")
    assert collection["type"] == "FeatureCollection"
    line, *others = collection["features"]
    kinds = [one["properties"]["feature"] for one in others]
    assert kinds.count("pose") == len(table(plain))
    assert kinds.count("ellipse") > 0.9 * len(table(plain))  # at the start, which is certain, there is none
    assert line["geometry"]["type"] == "LineString"
    assert len(line["geometry"]["coordinates"]) == len(table(plain))
    assert collection["coordinate_unit"] == "metre"
    assert "NOT longitude and latitude" in collection["crs_note"]


def test_the_report_needs_no_network(plain: Path) -> None:
    report = (plain / "report.html").read_text(encoding="utf-8")
    assert "<svg" in report
    assert 'src="http' not in report
    assert "<link" not in report


def test_the_same_input_gives_the_same_track_bit_by_bit(plain: Path, good: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONHASHSEED": "4242"}
    command = (*PROGRAM, "smooth", str(good), "-o", str(tmp_path / "out"), "--quiet", "--no-report")
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == done.stderr == ""
    for name in ("track.csv", "steps.csv", "track.tum", "track.geojson"):
        assert (tmp_path / "out" / name).read_bytes() == (plain / name).read_bytes(), name


# --- what every option does ------------------------------------------------------------------------------------


@not_drawn
def test_start_and_heading_place_the_track(good: Path, plain: Path, tmp_path: Path) -> None:
    smoothed(good, tmp_path / "out", "--start", "-10", "20.5", "--heading", "90")
    first = table(tmp_path / "out")[0]
    assert [float(first[name]) for name in ("x_m", "y_m")] == [-10.0, 20.5]
    assert float(first["heading_rad"]) == pytest.approx(np.pi / 2.0, abs=1e-6)
    np.testing.assert_allclose(column(tmp_path / "out", "y_m") - 20.5, column(plain, "x_m"), atol=2e-3)
    np.testing.assert_allclose(column(tmp_path / "out", "x_m") + 10.0, -column(plain, "y_m"), atol=2e-3)
    assert document(tmp_path / "out")["frame"] == "map"


@not_drawn
def test_a_start_in_utm(good: Path, plain: Path, tmp_path: Path) -> None:
    smoothed(good, tmp_path / "out", "--start", "691000", "5335000", "--heading", "0")
    np.testing.assert_allclose(column(tmp_path / "out", "x_m") - 691000.0, column(plain, "x_m"), atol=2e-3)


@pytest.mark.parametrize(
    ("name", "kind"), [("dead-reckoning", "filtered"), ("ekf", "filtered"), ("factor-graph", "smoothed")]
)
def test_estimator(name: str, kind: str, good: Path, tmp_path: Path) -> None:
    smoothed(good, tmp_path / "out", "--estimator", name)
    summary = document(tmp_path / "out")
    assert (summary["estimator"], summary["kind"], summary["config"]["estimator"]["name"]) == (name, kind, name)


@not_drawn
def test_height_and_gender_scale_the_models_that_use_them(good: Path, tmp_path: Path) -> None:
    config = tmp_path / "mmpdr.yaml"
    config.write_text("step_length:\n  model: mmpdr\nestimator:\n  name: dead-reckoning\n", encoding="utf-8")
    runs = {"usual": (), "tall": ("--height", "2.0"), "female": ("--gender", "Female")}
    for name, options in runs.items():
        smoothed(good, tmp_path / name, "--config", config, *options)
    lengths = {name: column(tmp_path / name, "step_length_m")[2:] for name in runs}
    np.testing.assert_allclose(lengths["tall"], lengths["usual"] * 2.0 / 1.73, atol=2e-4)
    ratio = MMPDR_K["female"] / MMPDR_K["male"]
    np.testing.assert_allclose(lengths["female"], lengths["usual"] * ratio, atol=2e-4)


@not_drawn
def test_length_model(good: Path, tmp_path: Path) -> None:
    smoothed(good, tmp_path / "out", "--length-model", "static", "--estimator", "dead-reckoning")
    assert document(tmp_path / "out")["config"]["step_length"]["model"] == "static"
    np.testing.assert_allclose(column(tmp_path / "out", "step_length_m")[1:], 0.415 * 1.73, atol=1e-4)


@not_drawn
def test_attitude_of_the_device(good: Path, plain: Path, tmp_path: Path) -> None:
    smoothed(good, tmp_path / "out", "--attitude", "device")
    assert document(tmp_path / "out")["config"]["attitude"]["source"] == "device"
    assert (tmp_path / "out" / "steps.csv").read_text() != (plain / "steps.csv").read_text()
    assert column(tmp_path / "out", "x_m")[-1] == pytest.approx(12.0, abs=1.8)


@not_drawn
def test_fixes_of_a_file_draw_the_track(good: Path, tmp_path: Path, walk: Walk) -> None:
    end_s = float(walk.time_s[-1])
    fixes = save(tmp_path / "fixes.csv", ["time_s,x_m,y_m,sigma_m", "0,100,50,0.1", f"{end_s},100,61,0.1"])
    smoothed(good, tmp_path / "out", "--fixes", fixes)
    last = table(tmp_path / "out")[-1]
    assert (float(last["x_m"]), float(last["y_m"])) == pytest.approx((100.0, 61.0), abs=0.3)
    assert document(tmp_path / "out")["fixes"] == {"given": 2, "used": 2, "aligned_with": 0, "sources": {"file": 2}}
    features = document(tmp_path / "out", "track.geojson")["features"]
    assert [feature["properties"]["feature"] for feature in features[:4]] == ["track", "fix", "fix", "pose"]


@not_drawn
def test_fixes_that_only_align_are_told(good: Path, tmp_path: Path) -> None:
    fixes = save(tmp_path / "fixes.csv", ["time_s,x_m,y_m", "1,100,50", "8,100,55"])
    result = smoothed(good, tmp_path / "out", "--fixes", fixes, "--estimator", "dead-reckoning")
    assert "warning: dead-reckoning only aligns the track with the position fixes: choose" in result.stderr
    assert document(tmp_path / "out")["fixes"]["aligned_with"] == 2


@pytest.mark.parametrize("method", ["gyro", "hde", "psp"])
@not_drawn
def test_a_heading_method_for_pockets_warns_of_a_held_phone(method: str, good: Path, tmp_path: Path) -> None:
    stderr = smoothed(good, tmp_path / "out", "--heading-method", method).stderr
    assert f"the heading method {method} is for a phone upright in a trouser pocket, but it was HOLDING for" in stderr


@not_drawn
def test_fixes_of_the_recording_place_the_track_on_the_globe(export_zip: Path, tmp_path: Path) -> None:
    smoothed(export_zip, tmp_path / "out", "--fixes", "recording")
    summary = document(tmp_path / "out")
    assert summary["fixes"]["sources"] == {"gps": summary["fixes"]["used"]}
    collection = document(tmp_path / "out", "track.geojson")
    assert collection["coordinate_unit"] == "degree"
    coordinates = np.array(collection["features"][0]["geometry"]["coordinates"])
    np.testing.assert_allclose(coordinates, np.tile([11.0, 48.0], (len(coordinates), 1)), atol=5e-4)
    smoothed(export_zip, tmp_path / "without")
    assert document(tmp_path / "without")["fixes"]["used"] == 0


@not_drawn
def test_the_options_go_before_the_file(good: Path, tmp_path: Path) -> None:
    config = tmp_path / "config.yaml"
    config.write_text("estimator: {name: ekf}\nwalker: {height_m: 1.6}\n", encoding="utf-8")
    smoothed(good, tmp_path / "out", "--config", config, "--height", "1.9")
    resolved = document(tmp_path / "out")["config"]
    assert resolved["estimator"]["name"] == "ekf"
    assert resolved["walker"]["height_m"] == 1.9


def test_help_tells_every_option() -> None:
    text = run("smooth", "--help").stdout
    for option in (
        *("--output", "--fixes", "--config", "--estimator", "--height", "--gender", "--start", "--heading"),
        *("--attitude", "--overwrite", "--quiet"),
    ):
        assert option in text
    assert "factor-graph" in text


# --- what it says and how it ends ------------------------------------------------------------------------------


def test_it_says_the_distance_and_where_the_report_is(good: Path, tmp_path: Path) -> None:
    result = smoothed(good, tmp_path / "out")
    assert result.stderr == ""
    assert result.stdout == f"{document(tmp_path / 'out')['distance_m']:.1f} m in 17 steps -> " + (
        f"{tmp_path / 'out' / 'report.html'}\n"
    )


@not_drawn
def test_quiet_is_silent_but_for_warnings(good: Path, walk: Walk, tmp_path: Path) -> None:
    result = smoothed(good, tmp_path / "out", "--quiet")
    assert (result.stdout, result.stderr) == ("", "")
    zeros = save(tmp_path / "zeros.csv", lines_of(columns_of(walk, rate=np.zeros_like(walk.rate))))
    result = smoothed(zeros, tmp_path / "zeros", "-q")
    assert result.stdout == ""
    assert result.stderr.startswith("warning: ")
    assert result.stderr.count("\n") == 1


def test_no_step_gives_a_track_of_one_point_and_a_warning(walk: Walk, tmp_path: Path) -> None:
    lying = np.tile([0.0, 0.0, 9.81], (len(walk.time_s), 1))
    path = save(tmp_path / "walk.csv", lines_of(columns_of(walk, force=lying, rate=np.zeros_like(lying) + 1e-4)))
    result = smoothed(path, tmp_path / "out", "--start", "3", "4", "--heading", "0")
    assert result.stderr == "warning: device: no step found\n"
    assert result.stdout.startswith("0.0 m in 0 steps")
    (row,) = table(tmp_path / "out")
    assert [float(row[name]) for name in ("x_m", "y_m")] == [3.0, 4.0]
    assert (tmp_path / "out" / "steps.csv").read_text().count("\n") == 1
    assert document(tmp_path / "out", "track.geojson")["features"][0]["geometry"]["type"] == "Point"
    assert document(tmp_path / "out")["counts"]["steps"] == {"device": 0}


@not_drawn
def test_an_earlier_result_is_replaced_on_demand_only(good: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    smoothed(good, out, "--estimator", "ekf")
    line = refused("smooth", good, "-o", out)
    assert (
        line
        == f"{out}: contains the results of an earlier run: allow overwriting (--overwrite) or choose another folder"
    )
    assert document(out)["estimator"] == "ekf"
    smoothed(good, out, "--overwrite", "--estimator", "dead-reckoning")
    assert document(out)["estimator"] == "dead-reckoning"


@not_drawn
def test_a_refused_run_keeps_the_earlier_result(good: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    smoothed(good, out)
    before = (out / "summary.json").read_bytes()
    refused("smooth", tmp_path / "nowhere.csv", "-o", out, "--overwrite")
    assert (out / "summary.json").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@not_drawn
def test_a_name_that_is_no_text(tmp_path: Path, lines: list[str]) -> None:
    folder = tmp_path / os.fsdecode(b"caf\xe9")
    try:
        folder.mkdir()
    except OSError:
        pytest.skip("this file system takes text only")
    path = save(folder / os.fsdecode(b"caf\xe9.csv"), lines)
    assert "caf\\udce9" in smoothed(path, folder / "out").stdout
    assert "caf\\udce9" in run("inspect", path, "--json").stdout
    assert "caf\\udce9" in refused("inspect", folder / "nowhere.csv")


@not_drawn
def test_the_output_may_lie_in_the_folder_of_the_recording(lines: list[str], tmp_path: Path) -> None:
    save(tmp_path / "walk.csv", lines)
    smoothed(tmp_path, tmp_path / "out")
    smoothed(tmp_path, tmp_path / "out", "--overwrite")


@pytest.mark.slow
@pytest.mark.parametrize("overwrite", [False, True])
def test_ctrl_c_leaves_everything_as_it_was(overwrite: bool, good: Path, tmp_path: Path) -> None:
    if overwrite:
        smoothed(good, tmp_path / "out")
    before = sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*"))
    command = (*PROGRAM, "smooth", str(good), "-o", str(tmp_path / "out"), *(("--overwrite",) if overwrite else ()))
    interrupt(command, tmp_path)
    assert sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*")) == before


def test_the_program_answers_before_its_libraries_are_loaded() -> None:
    code = "import sys, pdr_est.cli; print({'numpy', 'polars', 'scipy', 'matplotlib'} & set(sys.modules))"
    done = subprocess.run((sys.executable, "-c", code), capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def test_result_files_are_those_documented() -> None:
    root = Path(__file__).parents[2]
    for page in (root / "README.md", root / "docs" / "own-recording.md"):
        assert [name for name in RESULT_FILES if f"`{name}`" not in page.read_text(encoding="utf-8")] == [], page
