"""A folder that holds nothing but one archive is that archive."""

from pathlib import Path

import pytest
from fabricated import as_folder, as_zip

from pdr_est.errors import RecordingError, SeveralWalksError
from pdr_est.io.text.container import SourceKind
from pdr_est.io.text.single_archive import open_recording


def test_a_folder_with_one_archive_is_opened_as_the_archive(tmp_path: Path) -> None:
    as_zip(tmp_path / "walk.zip", {"a.csv": b"1\n", "b.csv": b"2\n"})
    (tmp_path / ".DS_Store").write_bytes(b"x")
    source = open_recording(tmp_path)
    assert (source.kind, source.members) == (SourceKind.ZIP, ("a.csv", "b.csv"))
    assert source.read("b.csv") == b"2\n"


def test_a_folder_of_several_archives_names_them(tmp_path: Path) -> None:
    for i in range(5):
        as_zip(tmp_path / f"walk{i}.zip", {"a.csv": b"1\n"})
    message = r"5 zip archives \(walk0\.zip, walk1\.zip, walk2\.zip, …\); choose one"
    with pytest.raises(SeveralWalksError, match=message) as raised:
        open_recording(tmp_path)
    assert raised.value.walks == tuple(f"walk{i}.zip" for i in range(5))


def test_notes_beside_the_archive_do_no_harm(tmp_path: Path) -> None:
    as_folder(tmp_path, {"notes.txt": b"a walk in the park\n", "photo.jpg": b"\xff\xd8\xff"})
    as_zip(tmp_path / "walk.zip", {"a.csv": b"1\n"})
    assert open_recording(tmp_path).members == ("a.csv",)


def test_an_archive_of_archives_must_be_unpacked(tmp_path: Path) -> None:
    inner = as_zip(tmp_path / "walk.zip", {"a.csv": b"1\n"}).read_bytes()
    outer = as_zip(tmp_path / "outer.zip", {"walk.zip": inner})
    with pytest.raises(RecordingError, match=r"contains zip archives \(walk\.zip\); unpack it and give one"):
        open_recording(outer)


def test_an_archive_beside_tables_is_one_file_of_the_folder(tmp_path: Path) -> None:
    as_folder(tmp_path, {"a.csv": b"1\n"})
    as_zip(tmp_path / "walk.zip", {"b.csv": b"1\n"})
    assert open_recording(tmp_path).kind is SourceKind.FOLDER
