"""`--fixes waypoints`, one file of a pair, and what is said of the frame."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_recordings import Walk, as_folder, ilc20_log, save, sensor_logger
from cli_runs import refused, run, smoothed

from pdr_est.cli import recording_part
from pdr_est.io import read

pytestmark = pytest.mark.usefixtures("without_report")


@pytest.fixture(scope="module")
def tapped(walk: Walk, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("tapped") / "walk.txt"
    path.write_text(ilc20_log(walk, 5), encoding="utf-8")
    return path


def summary_of(folder: Path) -> dict[str, Any]:
    document: dict[str, Any] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return document


def test_taps_are_fixes_and_then_no_reference(tapped: Path, tmp_path: Path) -> None:
    smoothed(tapped, tmp_path / "without")
    assert summary_of(tmp_path / "without")["errors_against_truth"] is not None
    smoothed(tapped, tmp_path / "with", "--fixes", "waypoints")
    summary = summary_of(tmp_path / "with")
    assert summary["frame"] == "map"
    assert summary["fixes"]["given"] == 5
    assert summary["errors_against_truth"] is None
    rows = [json.loads(line) for line in run("track", tapped, "--fixes", "waypoints").stdout.splitlines()]
    assert np.hypot(rows[-1]["x_m"] - 12.0, rows[-1]["y_m"]) < 2.0
    assert run("calibrate", tapped, "--fixes", "waypoints", "-o", tmp_path / "me.yaml").exit_code == 0


def test_typed_annotations_are_fixes(walk: Walk, tmp_path: Path) -> None:
    files = sensor_logger(walk)
    start_ns = 1_718_030_736_000_000_000
    rows = [
        f'{start_ns + round(1e9 * at_s)},{at_s},"{np.interp(at_s, walk.true_time_s, walk.true_m[:, 0]):.2f}, 0"'
        for at_s in (0.5, 6.0, 13.0)
    ]
    files["Annotation.csv"] = "\n".join(["time,seconds_elapsed,text", *rows, ""]).encode()
    out = smoothed(as_folder(tmp_path / "export", files), tmp_path / "out", "--fixes", "waypoints")
    assert out.exit_code == 0
    assert summary_of(tmp_path / "out")["fixes"]["given"] == 3


def test_a_recording_without_waypoints(good: Path, tmp_path: Path) -> None:
    assert "no waypoints: nobody marked positions" in refused(
        "smooth", good, "-o", tmp_path / "out", "--fixes", "waypoints"
    )


def test_a_start_without_heading_says_what_the_frame_is(good: Path, tmp_path: Path) -> None:
    alone = run("smooth", good, "-o", tmp_path / "a", "--start", 3, 4).stdout
    assert (
        "frame: own: through the given position on the map, but turned arbitrarily about it; give --heading" in alone
    )
    both = run("smooth", good, "-o", tmp_path / "b", "--start", 3, 4, "--heading", 0).stdout
    assert "frame" not in both
    assert "note: --start without --heading" in run("track", good, "--start", 3, 4).stderr
    assert run("track", good, "--start", 3, 4, "--heading", 0).stderr == ""


def test_one_file_means_one_phone(lines: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A data set in which the table of either phone brings the other one along."""
    path = save(tmp_path / "walk_1L_x.csv", lines)
    pair = read(path)
    (device,) = pair.devices
    pair = replace(pair, devices=(replace(device, name="1L"), replace(device, name="2R")))
    monkeypatch.setattr(recording_part, "read", lambda *_: pair)
    result = run("steps", path)
    assert [line.split(": ")[1] for line in result.stdout.splitlines()] == ["1L"]
    assert "warning: " in result.stderr
    assert "the file is of this device only; 2R of the same walk is left out: give its file, too" in result.stderr
    both = run("steps", path, "--device", "1L", "--device", "2R")
    assert [line.split(": ")[1] for line in both.stdout.splitlines()] == ["1L", "2R"]


def test_a_phone_that_another_file_brings_is_not_missing(
    lines: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With several files, too, it is told if a phone of the same walk is left out."""
    left, right, third = (save(tmp_path / f"{name}.csv", lines) for name in ("walk_1L", "walk_2R", "other"))
    alone = read(third)
    (device,) = alone.devices
    pair = replace(alone, name="pair", devices=(replace(device, name="1L"), replace(device, name="2R")))
    monkeypatch.setattr(recording_part, "read", lambda path, *_: alone if path == third else pair)
    both = recording_part.WHOLE.read_files([left, right])
    assert [[one.name for one in recording.devices] for recording in both] == [["1L"], ["2R"]]
    assert all(one.warnings == device.warnings for recording in both for one in recording.devices)
    one, _ = recording_part.WHOLE.read_files([left, third])
    assert [phone.name for phone in one.devices] == ["1L"]
    assert "2R of the same walk is left out" in one.devices[0].warnings[-1]
