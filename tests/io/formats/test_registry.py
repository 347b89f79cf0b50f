"""Recognition by content, and what is said of inputs that cannot be read at all."""

import gzip
import re
import zipfile
from pathlib import Path

import pytest

from pdr_est.errors import RecordingError
from pdr_est.io import read
from pdr_est.io.formats.registry import FORMATS

START_MS = 1_574_560_118_902


def ilc20_walk() -> bytes:
    return "".join(f"{START_MS + 20 * i}\tTYPE_ACCELEROMETER\t0.1\t0.2\t9.8\t2\n" for i in range(20)).encode()


def test_the_name_of_a_file_does_not_matter(tmp_path: Path) -> None:
    for name, content in (("imu1.csv", ilc20_walk()), ("Accelerometer.json.gz", gzip.compress(ilc20_walk()))):
        (tmp_path / name).write_bytes(content)
        assert read(tmp_path / name).format == "ILC20"


def test_file_folder_and_zip_give_the_same(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "walk.txt").write_bytes(ilc20_walk())
    (folder / "floor_info.json").write_text("{}")
    with zipfile.ZipFile(tmp_path / "walk.zip", "w") as archive:
        archive.writestr("wrapped/walk.txt", ilc20_walk())
    recordings = [read(path) for path in (folder / "walk.txt", folder, str(tmp_path / "walk.zip"))]
    assert {recording.name for recording in recordings} == {"walk"}
    assert len({len(recording.devices[0].specific_force or ()) for recording in recordings}) == 1


def test_several_walks_in_a_folder_are_named(tmp_path: Path) -> None:
    for i in range(5):
        (tmp_path / f"walk{i}.txt").write_bytes(ilc20_walk())
    message = r"contains 5 ILC20 recordings \(walk0\.txt, walk1\.txt, walk2\.txt, …\); choose one of them"
    with pytest.raises(RecordingError, match=message):
        read(tmp_path)


@pytest.mark.parametrize(
    "content",
    [b"hello\n", b"\x00\x01\x02\xff" * 100, b"a,b\nx,y\n", b"<html></html>", b"1,2,3\n4,5,6\n", b"{}", b"\n"],
    ids=["text", "binary", "table of text", "html", "numbers", "json", "blank"],
)
def test_an_unknown_format_lists_the_known_ones(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "walk.dat"
    path.write_bytes(content)
    with pytest.raises(RecordingError, match=re.escape(str(path))) as caught:
        read(path)
    assert "unknown format" in str(caught.value)
    assert all(known.NAME in str(caught.value) for known in FORMATS)


def write_empty(folder: Path) -> Path:
    (folder / "walk.txt").touch()
    return folder / "walk.txt"


def write_empty_gzip(folder: Path) -> Path:
    (folder / "walk.txt.gz").write_bytes(gzip.compress(b""))
    return folder / "walk.txt.gz"


def write_truncated_gzip(folder: Path) -> Path:
    packed = gzip.compress(ilc20_walk() * 50)
    (folder / "walk.txt.gz").write_bytes(packed[: len(packed) - 10])
    return folder / "walk.txt.gz"


def write_escaping_zip(folder: Path) -> Path:
    with zipfile.ZipFile(folder / "walk.zip", "w") as archive:
        archive.writestr("../walk.txt", ilc20_walk())
    return folder / "walk.zip"


@pytest.mark.parametrize(
    ("write", "message"),
    [
        (write_empty, "the file is empty"),
        (write_empty_gzip, "empty"),
        (write_truncated_gzip, "truncated gzip data; copy or download it again"),
        (write_escaping_zip, "points outside the archive; pack"),
        (lambda folder: folder / "nowhere.txt", "no such file or folder; check the path"),
        (lambda folder: folder, "contains no files"),
    ],
    ids=["empty", "empty gzip", "truncated gzip", "path traversal", "missing", "empty folder"],
)
def test_bad_input_is_one_line_with_place_and_remedy(tmp_path: Path, write: object, message: str) -> None:
    path = write(tmp_path)  # type: ignore[operator]
    with pytest.raises(RecordingError, match=message) as caught:
        read(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_every_real_recording_is_recognised(shared_data: Path) -> None:
    expected = {
        "ilc20/*/*/5*.txt*": "ILC20",
        "ipin2023/*.txt*": "GetSensorData (IPIN)",
        "oxiod/*/*/*/imu*.csv*": "OxIOD",
        "weallwalk/sensor/*.csv*": "WeAllWalk",
        "motionsense/*_*/sub_*.csv*": "MotionSense",
        "oxford-steps/*/accelerometer.csv*": "Oxford steps",
        "sisfall/*/D*.txt*": "SisFall",
        "stride-length/*.txt*": "stride length",
        "known-distance/?.csv*": "plain CSV",
    }
    for pattern, name in expected.items():
        paths = sorted(shared_data.glob(pattern))
        assert paths, pattern
        assert {read(path).format for path in paths[:: max(1, len(paths) // 4)]} == {name}
