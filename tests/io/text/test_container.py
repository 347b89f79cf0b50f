"""Files, folders and archives as sources: names, bytes and everything that must be refused."""

import gzip
import struct
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.io.text.container import Source, SourceKind

TEXT = b"time,x\n0.0,1.0\n"
METHODS = (zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)


def zip_of(path: Path, members: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return path


def with_claimed_size(path: Path, n_bytes: int) -> Path:
    """Rewrite the unpacked sizes in an archive's directory and in its local headers."""
    raw = bytearray(path.read_bytes())
    for magic, offset in ((b"PK\x01\x02", 24), (b"PK\x03\x04", 22)):
        at = raw.find(magic)
        while at >= 0:
            raw[at + offset : at + offset + 4] = struct.pack("<I", n_bytes)
            at = raw.find(magic, at + 4)
    path.write_bytes(raw)
    return path


def test_a_plain_file_has_one_member(tmp_path: Path) -> None:
    path = tmp_path / "walk.csv"
    path.write_bytes(TEXT)
    source = Source.open(path)
    assert (source.kind, source.name, source.members) == (SourceKind.FILE, "walk.csv", ("walk.csv",))
    assert source.read("walk.csv") == TEXT
    assert source.head("walk.csv", 4) == b"time"


def test_a_gzipped_file_is_found_by_its_content(tmp_path: Path) -> None:
    for name in ("walk.csv.gz", "walk.csv"):
        (tmp_path / name).write_bytes(gzip.compress(TEXT))
        source = Source.open(tmp_path / name)
        assert source.members == ("walk.csv",)
        assert source.read("walk.csv") == TEXT


def test_gzip_of_several_parts_is_joined(tmp_path: Path) -> None:
    path = tmp_path / "walk.gz"
    path.write_bytes(gzip.compress(b"first ") + gzip.compress(b"second"))
    assert Source.open(path).read("walk") == b"first second"


def test_the_head_of_a_large_file_needs_no_whole_unpacking(tmp_path: Path) -> None:
    path = tmp_path / "large.csv.gz"
    whole = gzip.compress(b"0123456789" * 1_000_000)
    path.write_bytes(whole[: len(whole) // 2])
    assert Source.open(path).head("large.csv", 20) == b"01234567890123456789"


def test_folder_members_are_relative_without_hidden_files(tmp_path: Path) -> None:
    for name in ("a.csv", "meta/b.csv.gz", ".hidden", ".git/c.csv", "__MACOSX/a.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(gzip.compress(TEXT) if name.endswith(".gz") else TEXT)
    source = Source.open(tmp_path)
    assert source.kind is SourceKind.FOLDER
    assert source.members == ("a.csv", "meta/b.csv")
    assert source.read("meta/b.csv") == TEXT


@pytest.mark.parametrize("prefix", ["", "Walk 1/", "out\\"])
def test_a_zip_may_be_wrapped_in_one_folder(tmp_path: Path, prefix: str) -> None:
    members = {
        f"{prefix}a.csv": TEXT,
        f"{prefix}meta/b.csv.gz": gzip.compress(TEXT),
        "__MACOSX/x": b"",
        ".DS_Store": b"",
    }
    source = Source.open(zip_of(tmp_path / "walk.bin", members))
    assert source.kind is SourceKind.ZIP
    assert source.members == ("a.csv", "meta/b.csv")
    assert source.read("a.csv") == TEXT
    assert source.read("meta/b.csv") == TEXT
    assert source.head("meta/b.csv", 4) == b"time"


def test_two_names_for_one_member_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(TEXT)
    (tmp_path / "a.csv.gz").write_bytes(gzip.compress(TEXT))
    with pytest.raises(RecordingError, match=r"both a\.csv.* and a\.csv.*remove one"):
        Source.open(tmp_path)


def test_siblings_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "sensor").mkdir()
    (tmp_path / "xml").mkdir()
    (tmp_path / "sensor/imu1.csv").write_bytes(TEXT)
    (tmp_path / "sensor/tango1.csv.gz").write_bytes(gzip.compress(b"poses"))
    (tmp_path / "xml/walk.xml").write_bytes(b"<root/>")
    source = Source.open(tmp_path / "sensor/imu1.csv")
    poses, notes = source.sibling("imu1.csv", "tango1.csv"), source.sibling("imu1.csv", "../xml/walk.xml")
    assert poses is not None
    assert notes is not None
    assert poses.read("tango1.csv") == b"poses"
    assert notes.read("walk.xml") == b"<root/>"
    assert source.sibling("imu1.csv", "vi1.csv") is None
    assert source.folder_name("imu1.csv") == "sensor"


def test_siblings_in_a_zip_stay_inside_it(tmp_path: Path) -> None:
    (tmp_path / "outside.xml").write_bytes(b"<root/>")
    source = Source.open(zip_of(tmp_path / "walk.zip", {"w/sensor/imu1.csv": TEXT, "w/xml/walk.xml.gz": b"<root/>"}))
    beside = source.sibling("sensor/imu1.csv", "../xml/walk.xml")
    assert beside is not None
    assert beside.members == ("xml/walk.xml",)
    assert beside.read("xml/walk.xml") == b"<root/>"
    assert source.sibling("sensor/imu1.csv", "../../outside.xml") is None
    assert source.folder_name("sensor/imu1.csv") == "sensor"


def test_a_missing_path(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"nowhere\.csv: no such file"):
        Source.open(tmp_path / "nowhere.csv")


def test_an_empty_file_and_an_empty_folder(tmp_path: Path) -> None:
    (tmp_path / "empty.csv").touch()
    with pytest.raises(RecordingError, match=r"empty\.csv: the file is empty \(0 bytes\)"):
        Source.open(tmp_path / "empty.csv")
    (tmp_path / "folder").mkdir()
    with pytest.raises(RecordingError, match="contains no files"):
        Source.open(tmp_path / "folder")


def test_an_unreadable_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "walk.csv"
    path.write_bytes(TEXT)

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(RecordingError, match=r"walk\.csv: cannot be read \(Permission denied\)"):
        Source.open(path)


@pytest.mark.parametrize("keep", [5, 12, 30])
def test_truncated_gzip(tmp_path: Path, keep: int) -> None:
    path = tmp_path / "walk.csv.gz"
    path.write_bytes(gzip.compress(TEXT * 10)[:keep])
    with pytest.raises(RecordingError, match=r"walk\.csv\.gz: truncated gzip"):
        Source.open(path).read("walk.csv")


def test_damaged_gzip(tmp_path: Path) -> None:
    raw = bytearray(gzip.compress(bytes(range(256)) * 4))
    raw[-6] ^= 0xFF  # in the checksum
    (tmp_path / "walk.gz").write_bytes(raw)
    with pytest.raises(RecordingError, match="damaged gzip"):
        Source.open(tmp_path / "walk.gz").read("walk")


@pytest.mark.parametrize("parts", [1, 2])
def test_gzip_is_never_inflated_beyond_the_limit(tmp_path: Path, parts: int) -> None:
    path = tmp_path / "bomb.gz"
    path.write_bytes(gzip.compress(b"\0" * 600) * parts)
    source = Source.open(path, limit_bytes=599 * parts)
    with pytest.raises(RecordingError, match=r"bomb\.gz: unpacks to more than the limit"):
        source.read("bomb")
    assert len(Source.open(path, limit_bytes=600 * parts).read("bomb")) == 600 * parts


def test_a_plain_file_beyond_the_limit(tmp_path: Path) -> None:
    (tmp_path / "walk.csv").write_bytes(TEXT)
    with pytest.raises(RecordingError, match="larger than the limit"):
        Source.open(tmp_path / "walk.csv", limit_bytes=5).read("walk.csv")


def test_a_zip_that_claims_ten_gigabytes_is_refused_unopened(tmp_path: Path) -> None:
    path = zip_of(tmp_path / "bomb.zip", {f"{i}.csv": TEXT for i in range(3)})
    with_claimed_size(path, 0xD0000000)
    with pytest.raises(RecordingError, match=r"bomb\.zip: claims to unpack to 9\.8 GiB, the limit is 2\.0 GiB"):
        Source.open(path)


@pytest.mark.parametrize("method", METHODS)
def test_a_zip_member_that_holds_more_than_it_claims_is_not_unpacked(tmp_path: Path, method: int) -> None:
    path = tmp_path / "liar.zip"
    with zipfile.ZipFile(path, "w", method) as archive:
        archive.writestr("a.csv", b"\0" * (1 << 26))
    source = Source.open(with_claimed_size(path, 500), limit_bytes=1 << 30)
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError, match=r"liar\.zip, member a\.csv: .* holds more than the 500"):
            source.read("a.csv")
        assert tracemalloc.get_traced_memory()[1] < 1 << 23
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("method", [zipfile.ZIP_STORED, *METHODS])
@pytest.mark.parametrize("size", [0, 1, 5000, 200_000])
def test_every_method_of_compression_gives_back_what_was_packed(tmp_path: Path, method: int, size: int) -> None:
    content = bytes(np.random.default_rng(size).integers(0, 20, size, dtype=np.uint8))
    path = tmp_path / "walk.zip"
    with zipfile.ZipFile(path, "w", method) as archive:
        archive.writestr("first.csv", TEXT)
        archive.writestr("a.csv", content)
    source = Source.open(path)
    assert source.read("a.csv") == content
    assert source.head("a.csv", 100) == content[:100]


def test_a_zip_that_is_packed_tighter_than_any_recording_is_refused_unopened(tmp_path: Path) -> None:
    path = zip_of(tmp_path / "bomb.zip", {"a.csv": b"1,2,3\n" * (1 << 24)})
    with pytest.raises(RecordingError, match=r"bomb\.zip: unpacks to more than 100 times its size"):
        Source.open(path)


@pytest.mark.parametrize("head", [b"", TEXT * 10_000])
def test_a_gzip_bomb_is_refused_before_it_fills_the_memory(tmp_path: Path, head: bytes) -> None:
    path = tmp_path / "bomb.csv.gz"
    path.write_bytes(gzip.compress(head) + gzip.compress(b"1,2,3\n" * (1 << 24)))
    source = Source.open(path)
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError, match="unpacks to more than 100 times its size"):
            source.read("bomb.csv")
        assert tracemalloc.get_traced_memory()[1] < 1 << 27
    finally:
        tracemalloc.stop()


def test_two_members_of_one_name_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "walk.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("a.csv", TEXT)
        with pytest.warns(UserWarning, match="Duplicate name"):
            archive.writestr("a.csv", b"other")
    with pytest.raises(RecordingError, match=r"contains 2 members of the name 'a\.csv'"):
        Source.open(path)


def test_the_directory_of_an_archive_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = Source.open(zip_of(tmp_path / "walk.zip", {f"{i}.csv": TEXT for i in range(50)}))
    monkeypatch.setattr(zipfile, "ZipFile", None)
    assert all(source.head(member) == source.read(member) == TEXT for member in source.members)


@pytest.mark.parametrize(
    "name", ["../evil.csv", "ok/../../evil.csv", "/etc/evil.csv", "C:\\evil.csv", "..\\evil.csv"]
)
def test_members_that_point_outside_are_refused(tmp_path: Path, name: str) -> None:
    path = zip_of(tmp_path / "walk.zip", {"a.csv": TEXT, name: b"evil"})
    with pytest.raises(RecordingError, match=r"walk\.zip: member '.*evil\.csv' points outside the archive"):
        Source.open(path)


def test_encrypted_members_are_refused(tmp_path: Path) -> None:
    path = zip_of(tmp_path / "walk.zip", {"a.csv": TEXT})
    raw = bytearray(path.read_bytes())
    raw[raw.find(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(raw)
    with pytest.raises(RecordingError, match=r"'a\.csv' is encrypted"):
        Source.open(path)


@pytest.mark.parametrize("keep", [10, 60, -30])
def test_truncated_zip(tmp_path: Path, keep: int) -> None:
    path = zip_of(tmp_path / "walk.zip", {"a.csv": TEXT * 100})
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(RecordingError, match=r"walk\.zip: damaged or truncated zip"):
        Source.open(path)


def test_a_zip_with_damaged_content(tmp_path: Path) -> None:
    path = zip_of(tmp_path / "walk.zip", {"a.csv": bytes(range(256)) * 20})
    raw = bytearray(path.read_bytes())
    raw[60:90] = bytes(30)
    path.write_bytes(raw)
    with pytest.raises(RecordingError, match=r"member a\.csv: damaged archive"):
        Source.open(path).read("a.csv")


def test_a_zip_inside_gzip_is_refused(tmp_path: Path) -> None:
    inner = zip_of(tmp_path / "inner.zip", {"a.csv": TEXT})
    (tmp_path / "walk.zip.gz").write_bytes(gzip.compress(inner.read_bytes()))
    with pytest.raises(RecordingError, match="a zip archive inside gzip"):
        Source.open(tmp_path / "walk.zip.gz").read("walk.zip")
