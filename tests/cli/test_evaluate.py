"""`pdr-est evaluate` and `smooth --truth`: the same numbers either way, what is written, and what is refused."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_recordings import Walk
from cli_runs import refused, run, smoothed

METRICS = ("error_open_m", "final_drift", "ate_rigid_m", "length_ratio")


def written(folder: Path, name: str = "evaluation.json") -> dict[str, Any]:
    document: dict[str, Any] = json.loads((folder / name).read_text(encoding="utf-8"))
    return document


@pytest.fixture(scope="module")
def truth(walk: Walk, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Waypoints every two seconds, on the clock of the recording."""
    path = tmp_path_factory.mktemp("truth") / "points.csv"
    times_s = np.arange(0.5, walk.true_time_s[-1], 2.0)
    rows = [f"{t},{np.interp(t, walk.true_time_s, walk.true_m[:, 0]):.4f},0.0" for t in times_s]
    path.write_text("\n".join(["time_s,x_m,y_m", *rows, ""]), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def out(good: Path, truth: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of the good recording with the truth."""
    folder = tmp_path_factory.mktemp("smooth") / "out"
    smoothed(good, folder, "--truth", truth)
    return folder


def test_our_own_track_has_the_numbers_of_the_summary(out: Path, truth: Path, tmp_path: Path) -> None:
    expected = written(out, "summary.json")["errors_against_truth"]
    result = run("evaluate", out / "track.tum", "--truth", truth, "--standing", 5, "-o", tmp_path / "o")
    assert result.exit_code == 0, result.output
    (device,) = written(tmp_path / "o")["devices"]
    assert device["truth_points_not_scored"] == 0
    for metric in METRICS:
        assert device["metrics"][metric] == pytest.approx(expected[metric], abs=2e-4)  # the file rounds to 0.1 mm


def test_smooth_names_the_truth_and_its_checksum(out: Path, truth: Path) -> None:
    summary = written(out, "summary.json")
    assert str(truth) in {one["name"] for one in summary["inputs"]}
    assert summary["recording"]["truth"]["positions"]["source"] == "waypoints"
    assert any("true positions (waypoints) from" in note for note in summary["recording"]["notes"])
    assert "truth (waypoints)" in (out / "report.html").read_text(encoding="utf-8")


def test_the_truth_changes_no_track(good: Path, out: Path, tmp_path: Path) -> None:
    smoothed(good, tmp_path / "without")
    assert (tmp_path / "without" / "track.csv").read_bytes() == (out / "track.csv").read_bytes()


def test_what_is_written_and_printed(out: Path, truth: Path, tmp_path: Path) -> None:
    folder = tmp_path / "result"
    result = run("evaluate", out / "track.tum", "--truth", truth, "-o", folder)
    assert {path.name for path in folder.iterdir()} == {"report.html", "evaluation.json", ".pdr_est-files.json"}
    assert "alignment rigid: best rotation and translation" in result.stdout
    assert "no value: coverage95, nees_mean: the file of the track states no covariance" in result.stdout
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.count("<svg role") == 2
    assert "Track against truth" in page
    assert "default-src &#39;none&#39;; script-src &#39;sha256-" in page
    document = written(folder)
    assert document["alignment"]["name"] == "rigid"
    assert "coverage95" not in document["devices"][0]["metrics"]
    assert set(document["inputs"]) == {str(out / "track.tum"), str(truth)}
    line = refused("evaluate", out / "track.tum", "--truth", truth, "-o", folder)
    assert "allow overwriting (--overwrite)" in line
    assert run("evaluate", out / "track.tum", "--truth", truth, "-o", folder, "--overwrite", "-q").stdout == ""


def test_nothing_is_written_without_a_folder(out: Path, truth: Path, tmp_path: Path) -> None:
    result = run("evaluate", out / "track.csv", "--truth", truth, "--align", "none")
    assert result.exit_code == 0
    assert "coverage95" in result.stdout
    assert "no alignment: the track as it is" in result.stdout


def test_several_devices_are_scored_each(truth: Path, tmp_path: Path) -> None:
    rows = [line.split(",") for line in truth.read_text(encoding="utf-8").splitlines()[1:]]
    lines = [f"{t},{name},{float(x) + shift},{y}" for name, shift in (("<a>", 1.0), ("b", 2.0)) for t, x, y in rows]
    track = tmp_path / "two.csv"
    track.write_text("\n".join(["timestamp,device,x,y", *lines, ""]), encoding="utf-8")
    assert run("evaluate", track, "--truth", truth, "--align", "none", "-o", tmp_path / "o").exit_code == 0
    found = written(tmp_path / "o")["devices"]
    assert [(one["device"], one["metrics"]["error_map_m"]) for one in found] == [
        ("<a>", pytest.approx(1.0)),
        ("b", pytest.approx(2.0)),
    ]
    page = (tmp_path / "o" / "report.html").read_text(encoding="utf-8")
    assert "&lt;a&gt;" in page
    assert "<a>" not in page


def test_few_scored_points_are_a_warning(truth: Path, tmp_path: Path) -> None:
    track = tmp_path / "short.tum"
    track.write_text("0 0 0 0\n3 3 0 0\n", encoding="utf-8")
    result = run("evaluate", track, "--truth", truth)
    assert result.exit_code == 0
    assert "check that both files have the same clock and unit of time" in result.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--time-offset", "1000"), "the clocks differ, or the files are of different walks"),
        (("--time-offset", "nan"), "nan is not a number of seconds"),
        (("--origin", "100", "0"), "is no latitude and longitude in degrees"),
        (("--truth-sigma", "-1"), "--truth-sigma"),
        (("--align", "best"), "--align"),
    ],
)
def test_bad_options(out: Path, truth: Path, options: tuple[str, ...], words: str) -> None:
    assert words in refused("evaluate", out / "track.tum", "--truth", truth, *options)


def test_bad_files(out: Path, truth: Path, good: Path, tmp_path: Path) -> None:
    assert "no such file" in refused("evaluate", tmp_path / "none.tum", "--truth", truth)
    assert "needs the columns x_m and y_m" in refused("evaluate", good, "--truth", truth)
    unix = tmp_path / "unix.tum"
    unix.write_text("1718030736 0 0 0\n1718030740 3 0 0\n", encoding="utf-8")
    assert "Unix time" in refused("evaluate", unix, "--truth", truth)
    assert "Unix time, but the date of" in refused("smooth", good, "-o", tmp_path / "o", "--truth", unix)
    assert "--truth belongs to one walk" in refused(
        "smooth", good, good, "--each", "-o", tmp_path / "o", "--truth", truth
    )
    assert not (tmp_path / "o").exists()


def test_the_truth_is_never_overwritten(out: Path, tmp_path: Path) -> None:
    folder = tmp_path / "own"
    run("evaluate", out / "track.tum", "--truth", out / "track.csv", "-o", folder)
    before = (folder / "evaluation.json").read_bytes()
    inside = folder / "evaluation.json"
    line = refused("evaluate", out / "track.tum", "--truth", inside, "-o", folder, "--overwrite")
    assert "Error" not in line
    assert inside.read_bytes() == before
