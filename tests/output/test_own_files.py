"""A folder that others use too: what they put there is neither replaced nor removed."""

import json
from pathlib import Path

import pytest

from pdr_est.errors import OutputError
from pdr_est.output.atomic_output import MANIFEST
from pdr_est.output.own_files import OwnFiles


def test_own_files_are_replaced_and_foreign_ones_are_not(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "out"
    own = OwnFiles(folder)
    own.write("table.csv", "1")
    OwnFiles(folder).write("table.csv", "2")  # by a later run
    assert (folder / "table.csv").read_text(encoding="utf-8") == "2"
    (folder / "notes.md").write_text("mine", encoding="utf-8")
    with pytest.raises(OutputError, match=r"notes\.md: exists and was not written by pdr-est: .*--overwrite"):
        own.write("notes.md", "3")
    assert (folder / "notes.md").read_text(encoding="utf-8") == "mine"
    own.remove(["notes.md", "table.csv", "nothing.txt"])
    assert sorted(path.name for path in folder.iterdir()) == [MANIFEST, "notes.md"]
    own.write("notes.md", "3", overwrite=True)
    own.write("notes.md", "4")
    assert (folder / "notes.md").read_text(encoding="utf-8") == "4"
    assert json.loads((folder / MANIFEST).read_text(encoding="utf-8"))["files"] == ["notes.md", "table.csv"]


def test_a_failure_leaves_what_was_there(tmp_path: Path) -> None:
    own = OwnFiles(tmp_path)
    own.write("table.csv", "1")

    def fail() -> None:
        with own.staged("table.csv") as staging:
            staging.write_text("half", encoding="utf-8")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert (tmp_path / "table.csv").read_text(encoding="utf-8") == "1"
    assert sorted(path.name for path in tmp_path.iterdir()) == [MANIFEST, "table.csv"]


def test_a_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(OutputError, match=r"out: cannot be written \(Not a directory\)"):
        OwnFiles(tmp_path / "file" / "out").write("a", "1")
