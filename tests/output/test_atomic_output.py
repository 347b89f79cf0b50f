"""A result folder appears complete or not at all, and nobody else's files are lost."""

import errno
from pathlib import Path

import pytest

from pdr_est.errors import OutputError
from pdr_est.output import atomic_output as output
from pdr_est.output.atomic_output import MANIFEST, staged_folder


def write_results(target: Path, text: str, overwrite: bool = True) -> None:
    with staged_folder(target, overwrite, ()) as folder:
        (folder / "track.csv").write_text(text)
        (folder / "plots").mkdir()
        (folder / "plots" / "a.svg").write_text(text)


def fail_halfway(target: Path, error: type[BaseException]) -> None:
    with staged_folder(target, overwrite=True, inputs=()) as folder:
        (folder / "track.csv").write_text("half")
        raise error


def content(folder: Path) -> dict[str, str]:
    """Every file below a folder but the manifest."""
    return {
        path.relative_to(folder).as_posix(): path.read_text()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != MANIFEST
    }


def both(text: str) -> dict[str, str]:
    return {"plots/a.svg": text, "track.csv": text}


def test_folder_appears_only_when_complete(tmp_path: Path) -> None:
    target = tmp_path / "out"
    with staged_folder(target, overwrite=False, inputs=()) as folder:
        (folder / "track.csv").write_text("x")
        assert not target.exists()
        assert folder.parent == tmp_path
    assert content(target) == {"track.csv": "x"}
    assert list(tmp_path.iterdir()) == [target]


def test_new_folder_has_ordinary_permissions(tmp_path: Path) -> None:
    (tmp_path / "plain").mkdir()
    write_results(tmp_path / "out", "x")
    assert (tmp_path / "out").stat().st_mode == (tmp_path / "plain").stat().st_mode


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit])
def test_failure_leaves_nothing_behind(tmp_path: Path, error: type[BaseException]) -> None:
    with pytest.raises(error):
        fail_halfway(tmp_path / "out", error)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_failure_leaves_an_existing_result_untouched(tmp_path: Path, error: type[BaseException]) -> None:
    target = tmp_path / "out"
    write_results(target, "old")
    with pytest.raises(error):
        fail_halfway(target, error)
    assert content(target) == both("old")
    assert list(tmp_path.iterdir()) == [target]


def test_earlier_results_are_replaced_as_a_whole(tmp_path: Path) -> None:
    target = tmp_path / "out"
    write_results(target, "old")
    with staged_folder(target, overwrite=True, inputs=()) as folder:
        (folder / "report.html").write_text("new")
    assert content(target) == {"report.html": "new"}
    write_results(target, "again")
    assert content(target) == both("again")
    assert list(tmp_path.iterdir()) == [target]


def test_earlier_results_stay_without_overwrite(tmp_path: Path) -> None:
    target = tmp_path / "out"
    write_results(target, "old")
    with pytest.raises(OutputError, match="earlier run: allow overwriting"):
        write_results(target, "new", overwrite=False)
    assert content(target) == both("old")


def test_empty_folder_is_filled(tmp_path: Path) -> None:
    target = tmp_path / "out"
    target.mkdir(mode=0o750)
    write_results(target, "x", overwrite=False)
    assert content(target) == both("x")
    assert target.stat().st_mode & 0o777 == 0o750


@pytest.mark.parametrize("place", ["notes.txt", "plots/notes.txt", "empty/"])
def test_foreign_files_are_never_replaced(tmp_path: Path, place: str) -> None:
    target = tmp_path / "out"
    write_results(target, "old")
    foreign = target / place
    if place.endswith("/"):
        foreign.mkdir()
    else:
        foreign.write_text("mine")
    with pytest.raises(OutputError, match=r"other origin \(.*\): choose a new or an empty folder"):
        write_results(target, "new")
    assert foreign.exists()
    assert (target / "track.csv").read_text() == "old"


def test_file_that_arrives_during_the_run_is_not_lost(tmp_path: Path) -> None:
    target = tmp_path / "out"

    def run_while_someone_else_writes() -> None:
        with staged_folder(target, overwrite=True, inputs=()):
            target.mkdir()
            (target / "notes.txt").write_text("mine")

    with pytest.raises(OutputError, match=r"other origin \(notes.txt\)"):
        run_while_someone_else_writes()
    assert content(target) == {"notes.txt": "mine"}
    assert list(tmp_path.iterdir()) == [target]


def test_folder_without_manifest_or_with_a_damaged_one_is_foreign(tmp_path: Path) -> None:
    for name, manifest in [("none", None), ("damaged", "{"), ("other", '{"files": 3}')]:
        target = tmp_path / name
        target.mkdir()
        (target / "track.csv").write_text("mine")
        if manifest is not None:
            (target / MANIFEST).write_text(manifest)
        with pytest.raises(OutputError, match="other origin"):
            write_results(target, "new")
        assert (target / "track.csv").read_text() == "mine"


def test_bad_places_are_refused_before_anything_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("x")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    cases = {
        tmp_path / "file": "is a file, not a folder",
        tmp_path / "no" / "out": "does not exist: create it",
        tmp_path / "file" / "out": "does not exist",
        Path(): "is the current folder",
    }
    for target, message in cases.items():
        with pytest.raises(OutputError, match=message):
            write_results(target, "x")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "here"]


def test_parent_that_is_not_writable_is_an_output_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(self: Path) -> None:  # the tests may run as root, whom no permission stops
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(OutputError, match=r"out: cannot be written \(Permission denied\): check that"):
        write_results(tmp_path / "out", "x")


def test_full_disk_is_an_output_error_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="the disk is full"), staged_folder(tmp_path / "out", False, ()):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert list(tmp_path.iterdir()) == []


def test_interrupt_between_the_two_renames_puts_the_old_result_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "out"
    write_results(target, "old")
    rename = Path.rename

    def interrupted(self: Path, to: Path) -> Path:
        if self.suffix == ".partial":
            raise KeyboardInterrupt
        return rename(self, to)

    monkeypatch.setattr(output.Path, "rename", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_results(target, "new")
    assert content(target) == both("old")
    assert list(tmp_path.iterdir()) == [target]


def test_linked_target_replaces_the_folder_behind_the_link(tmp_path: Path) -> None:
    write_results(tmp_path / "real", "old")
    (tmp_path / "link").symlink_to("real")
    write_results(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert content(tmp_path / "real") == both("new")
