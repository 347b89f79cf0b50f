"""What killed programs leave beside a result is removed by the next run, and what living ones work in is not."""

import subprocess
import sys
from pathlib import Path

import pytest

from pdr_est.errors import OutputError
from pdr_est.output.atomic_output import staged_file, staged_folder
from pdr_est.output.own_files import OwnFiles
from pdr_est.output.staging import remove_leftovers

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="a folder cannot be locked")

WORKER = """
import os, sys, time
from pathlib import Path
from pdr_est.output import atomic_output
from pdr_est.output.atomic_output import staged_file, staged_folder
kind, target = sys.argv[1], Path(sys.argv[2])
if kind == "swap":  # dies when the earlier result has been moved away
    rename = Path.rename
    def dying(self, to):
        if self.suffix == ".partial":
            os._exit(9)
        return rename(self, to)
    Path.rename = dying
    with staged_folder(target, True, ()) as folder:
        (folder / "a.txt").write_text("new")
with (staged_folder if kind == "folder" else staged_file)(target, True, ()) as staging:
    (staging / "a.txt" if kind == "folder" else staging).write_text("new")
    print("ready", flush=True)
    time.sleep(60)
"""


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def worker(kind: str, target: Path) -> "subprocess.Popen[str]":
    process = subprocess.Popen((sys.executable, "-c", WORKER, kind, str(target)), stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    return process


def write(kind: str, target: Path) -> None:
    if kind == "folder":
        with staged_folder(target, overwrite=True, inputs=()) as folder:
            (folder / "a.txt").write_text("mine")
    else:
        with staged_file(target, overwrite=True) as file:
            file.write_text("mine")


@pytest.mark.parametrize("kind", ["file", "folder"])
def test_the_next_run_removes_what_a_killed_one_left_and_only_that(kind: str, tmp_path: Path) -> None:
    target = tmp_path / ("long-" * 30 + "name")  # a hidden name beside it still fits
    with worker(kind, target) as living:
        with worker(kind, target) as killed:
            assert len(names(tmp_path)) == 2
            killed.kill()
        write(kind, target)
        assert len(names(tmp_path)) == 2  # the result, and what the living one works in
        living.kill()
    write(kind, target)
    assert names(tmp_path) == [target.name]


def test_a_result_that_a_killed_run_had_moved_away_comes_back(tmp_path: Path) -> None:
    target = tmp_path / "out"
    write("folder", target)
    done = subprocess.run((sys.executable, "-c", WORKER, "swap", str(target)), check=False)
    assert done.returncode == 9
    assert not target.exists()
    with pytest.raises(OutputError, match="earlier run: allow overwriting"), staged_folder(target, False, ()):
        pass
    assert (target / "a.txt").read_text() == "mine"
    assert names(tmp_path) == ["out"]


def test_files_of_a_shared_folder_are_swept_alike(tmp_path: Path) -> None:
    with worker("file", tmp_path / "one") as living:
        with worker("file", tmp_path / "two") as killed:
            killed.kill()
        OwnFiles(tmp_path).write("table.csv", "x")
        remove_leftovers(tmp_path)
        assert [name.split(".")[1] for name in names(tmp_path) if name.endswith(".partial")] == ["one"]
        living.kill()
    remove_leftovers(tmp_path)
    assert [name for name in names(tmp_path) if name.endswith(".partial")] == []


def test_files_that_only_look_alike_stay(tmp_path: Path) -> None:
    for name in (".out.partial", ".out.12345678.partially", "out.12345678.partial", ".other.12345678.partial"):
        (tmp_path / name).write_text("mine")
    write("folder", tmp_path / "out")
    assert len(names(tmp_path)) == 5
