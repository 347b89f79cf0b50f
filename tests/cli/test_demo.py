"""`pdr-est demo`: a report without any recording."""

import re
from pathlib import Path

import pytest
from cli_runs import RESULT_FILES, refused, run, smoothed


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The folder of a demo and what it printed."""
    out = tmp_path_factory.mktemp("demo") / "out"
    result = run("demo", "-o", out, "--preset", "straight")
    assert (result.exit_code, result.stderr) == (0, "")
    return out, result.stdout


def test_it_prints_the_errors_the_report_and_what_to_do_next(demo: tuple[Path, str]) -> None:
    out, text = demo
    steps = re.search(r"Simulated walk straight: (\d+\.\d) m in (\d+) steps", text)
    truth = re.search(r"true steps (\d+), true distance (\d+\.\d) m", text)
    assert steps is not None
    assert truth is not None
    assert int(steps[2]) == pytest.approx(int(truth[1]), abs=2)
    assert float(steps[1]) == pytest.approx(float(truth[2]), rel=0.15)
    assert re.search(r"root mean square error \d+\.\d\d m after", text)
    assert f"Report: {out / 'report.html'}\n" in text
    assert "pdr-est smooth RECORDING -o OUT" in text


@pytest.mark.slow
def test_its_recording_can_be_smoothed(demo: tuple[Path, str], tmp_path: Path) -> None:
    out, _ = demo
    assert {path.name for path in out.iterdir() if path.suffix} - {".json"} >= RESULT_FILES
    smoothed(out / "simulated-walk.csv", tmp_path / "file")
    smoothed(out, tmp_path / "folder")
    assert (tmp_path / "file" / "track.csv").read_bytes() == (tmp_path / "folder" / "track.csv").read_bytes()
    assert (tmp_path / "file" / "track.csv").read_bytes() == (out / "track.csv").read_bytes()


def test_it_replaces_its_own_results_silently_and_nothing_else(demo: tuple[Path, str], tmp_path: Path) -> None:
    for _ in range(2):
        result = run("demo", "-o", tmp_path / "out", "--preset", "straight", "--quiet")
        assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")
    (tmp_path / "out" / "notes.txt").write_text("mine")
    assert "other origin (notes.txt)" in refused("demo", "-o", tmp_path / "out")


def test_an_unknown_walk(tmp_path: Path) -> None:
    line = refused("demo", "-o", tmp_path / "out", "--preset", "strait")
    assert line == "no simulated walk is called 'strait': did you mean straight?"
    assert list(tmp_path.iterdir()) == []
