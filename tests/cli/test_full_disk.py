"""A disk or a standard output that is full or closed: one line, an exit code, and nothing half-written."""

import errno
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from cli_runs import PROGRAM, refused
from experiment_files import experiment_file
from gait_people import three_people

FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
CALLS = {
    "smooth": ("smooth", "{walk}", "-q", "-o", "{out}/result"),
    "smooth, many": ("smooth", "{walk}", "--each", "-q", "-o", "{out}/result"),
    "steps": ("steps", "{walk}", "-o", "{out}/steps.csv"),
    "track": ("track", "{walk}", "-o", "{out}/track.jsonl"),
    "calibrate": ("calibrate", "{walk}", "--distance", "20", "-o", "{out}/profile.yaml"),
    "csv": ("convert", "{walk}", "-o", "{out}/walk.csv"),
    "parquet": ("convert", "{walk}", "-o", "{out}/walk.parquet"),
    "npz": ("convert", "{walk}", "-o", "{out}/walk.npz"),
    "folder": ("convert", "{walk}", "-o", "{out}/walk"),
    "map": ("inspect", "{walk}", "--write-map", "{out}/map.yaml"),
    "demo": ("demo", "-q", "-o", "{out}/demo"),
}


def contents(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if not path.is_dir())


@pytest.fixture(scope="module")
def gait_data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return three_people(tmp_path_factory.mktemp("gaits"))


@pytest.fixture
def full_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk on which a file can be made and no byte be written; what is read, and the null device, work."""
    usual = Path.open

    class FullFile:
        def __init__(self, stream: Any) -> None:
            self._stream = stream

        def __enter__(self) -> "FullFile":
            return self

        def __exit__(self, *_: object) -> None:
            self._stream.close()

        def __getattr__(self, name: str) -> Any:
            return getattr(self._stream, name)

        def write(self, _: object) -> None:
            raise FULL

    def opened(self: Path, mode: str = "r", *args: Any, **kwargs: Any) -> Any:
        stream = usual(self, mode, *args, **kwargs)
        return FullFile(stream) if set(mode) & set("wax") else stream

    def no_csv(self: object, *_: object, **__: object) -> None:
        raise FULL

    monkeypatch.setattr(Path, "open", opened)
    monkeypatch.setattr("polars.DataFrame.write_csv", no_csv)


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.usefixtures("full_disk")
def test_a_full_disk_is_told_in_a_line(call: str, good: Path, tmp_path: Path) -> None:
    words = [word.format(walk=good, out=tmp_path) for word in CALLS[call]]
    line = refused(*words) if call != "smooth, many" else refused_at_last(*words)
    assert "the disk is full: free some space or choose another place" in line
    assert ".partial" not in line
    assert str(tmp_path) in line
    assert contents(tmp_path) == []


@pytest.mark.parametrize("call", ["experiment", "compare"])
def test_results_of_experiments_alike(call: str, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    out, config = tmp_path / "out", experiment_file(tmp_path)
    if call == "compare":
        from cli_runs import run

        assert run("experiment", config, "-o", out, "-q").exit_code == 0
    before = contents(tmp_path)
    request.getfixturevalue("full_disk")
    line = refused("compare", out) if call == "compare" else refused("experiment", config, "-o", out, "-q")
    assert "the disk is full" in line
    assert contents(tmp_path) == before


@pytest.mark.usefixtures("full_disk")
def test_a_model_that_finds_no_place_leaves_nothing(tmp_path: Path, gait_data: Path) -> None:
    out = tmp_path / "model"
    line = refused("train-gait", "--data", gait_data, "-o", out, "-q")
    assert f"{out}" in line
    assert "the disk is full: free some space or choose another place" in line
    assert contents(tmp_path) == []


def refused_at_last(*words: str) -> str:
    from cli_runs import run

    result = run(*words)
    assert result.exit_code == 2
    return result.stderr.splitlines()[-1]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize(
    "words",
    [["--help"], ["steps", "--help"], ["steps", "{walk}"], pytest.param(["track", "{walk}"], marks=pytest.mark.slow)],
)
def test_a_full_standard_output_is_told_in_a_line(words: list[str], good: Path) -> None:
    command = (*PROGRAM, *(word.format(walk=good) for word in words))
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == (
        "Error: standard output: No space left on device: check whether there is space, and the right to use it\n"
    )


@pytest.mark.skipif(sys.platform == "win32", reason="needs a shell")
@pytest.mark.parametrize("redirection", ["| head -c 1 > {null}", ">&-"])
def test_a_closed_standard_output_is_no_error(redirection: str, good: Path) -> None:
    command = f"{sys.executable} -c 'from pdr_est.cli import main; main()' track {good} {redirection}"
    done = subprocess.run(command.format(null=os.devnull), shell=True, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
