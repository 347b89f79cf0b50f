"""SisFall: integers of a sensor box at the belt, their units, and the activity in the file's name."""

import gzip
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.io import read

N = 400
ROW = (0, 256, -128, 0, 16, -32, 0, 1024, -512)  # 1 g along y, -0.5 g along z; the third sensor has other bits


def write(path: Path, rows: list[str]) -> Path:
    path.write_text("\r\n".join(rows) + "\r\n")
    return path


def rows() -> list[str]:
    """Numbers padded to a width as in the data set; the first one counts, so that no two rows are equal."""
    return [",".join(f"{value:4d}" for value in (i, *ROW[1:])) + ";" for i in range(N)]


def test_units_clock_and_what_is_not_used(tmp_path: Path) -> None:
    recording = read(write(tmp_path / "D03_SA07_R01.txt", rows()))
    (device,) = recording.devices
    force, rate = device.specific_force, device.rotation_rate
    assert force is not None
    assert rate is not None
    assert (recording.format, recording.name) == ("SisFall", "D03_SA07_R01")
    assert_allclose(force.time_s, np.arange(N) / 200.0)
    assert_allclose(force.values[256], np.array([1.0, 1.0, -0.5]) * STANDARD_GRAVITY_MPS2)
    assert_allclose(rate.values[-1], np.deg2rad([0.0, 0.9765625, -1.953125]))
    assert device.warnings == ()
    assert all(any(word in text for text in device.decisions) for word in ("200 Hz", "1/256 g", "deg/s", "sign"))


@pytest.mark.parametrize(
    ("name", "activity"),
    [
        ("D01_SA01_R01", "walking"),
        ("D02_SE15_R01", "walking"),
        ("D03_SA01_R01", "jogging"),
        ("D04_SA01_R01", "running"),
        ("D06_SA01_R05", "stairs"),
        ("F05_SA01_R04", "fall"),
        ("D07_SA01_R01", None),
        ("mine", None),
    ],
)
def test_the_activity_is_in_the_name(tmp_path: Path, name: str, activity: str | None) -> None:
    path = tmp_path / f"{name}.txt.gz"
    path.write_bytes(gzip.compress("\n".join(rows()).encode()))
    assert read(path).truth.activity == activity


def test_blank_lines_and_rows_without_their_semicolon_are_harmless(tmp_path: Path) -> None:
    odd = rows()
    odd[300] = odd[300].rstrip(";")
    whole = read(write(tmp_path / "a.txt", rows())).devices[0].specific_force
    path = write(tmp_path / "b.txt", [*odd[:350], "", *odd[350:], "", ""])
    force = read(path).devices[0].specific_force
    assert whole is not None
    assert force is not None
    assert_allclose(force.time_s, whole.time_s)
    assert_allclose(force.values, whole.values)


def test_the_ends_of_a_range_are_no_damage(tmp_path: Path) -> None:
    edge = rows()
    edge[300] = "4095,-4096,0,32767,-32768,0,8191,-8192,0;"
    force = read(write(tmp_path / "a.txt", edge)).devices[0].specific_force
    assert force is not None
    assert_allclose(force.values[300], np.array([4095.0, -4096.0, 0.0]) / 256.0 * STANDARD_GRAVITY_MPS2)


def test_a_file_that_ends_within_a_row_has_a_warning(tmp_path: Path) -> None:
    cut = rows()
    cut[-1] = cut[-1][:-2]
    (warning,) = read(write(tmp_path / "a.txt", cut)).devices[0].warnings
    assert "the file is cut off there" in warning
    cut[-1] = cut[-1][:20]
    with pytest.raises(RecordingError, match=f"line {N}: . fields instead of 9"):
        read(write(tmp_path / "b.txt", cut))


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda row: row.replace("1024", "much"), r"line 301, column 'MMA8451Q y': 'much' is not a number"),
        (lambda row: row[:20], r"line 301: \d fields instead of 9"),
        (lambda row: row.replace(",  16", ";  16"), r"line 301: 8 fields instead of 9"),
        (
            lambda row: row.replace(" 256", "4096"),
            r"line 301, column 'ADXL345 y': 4096 does not fit .* 13 bits",
        ),
        (lambda row: row.replace(" -32", "-32769"), r"line 301, column 'ITG3200 z': -32769 does not fit .* 16 bits"),
        (
            lambda row: row.replace("1024", "8192"),
            r"line 301, column 'MMA8451Q y': 8192 does not fit .* 14 bits",
        ),
    ],
    ids=["text", "cut row", "semicolon within", "13 bits", "16 bits", "14 bits"],
)
def test_a_damaged_row_is_named(tmp_path: Path, damage: object, message: str) -> None:
    damaged = rows()
    damaged[300] = damage(damaged[300])  # type: ignore[operator]
    with pytest.raises(RecordingError, match=message):
        read(write(tmp_path / "D01_SA01_R01.txt", damaged))


@pytest.mark.parametrize(
    "row",
    ["1,2,3,4,5,6,7,8,9", "1,2,3,4,5,6,7,8;", "1,2;3,4;5,6;7,8;9,0;1,2;3,4;5,6;7,8;", "1.0,2,3,4,5,6,7,8,9;"],
    ids=["no semicolon", "eight", "decimal commas", "not integers"],
)
def test_other_numbers_are_not_sisfall(tmp_path: Path, row: str) -> None:
    with pytest.raises(RecordingError, match="unknown format"):
        read(write(tmp_path / "D01_SA01_R01.txt", [row] * 50))


def test_several_recordings_are_named(tmp_path: Path) -> None:
    for code in ("D01", "D02"):
        write(tmp_path / f"{code}_SA01_R01.txt", rows())
    with pytest.raises(RecordingError, match=r"contains 2 SisFall recordings \(D01_SA01_R01\.txt, D02"):
        read(tmp_path)


def test_real_belts(shared_data: Path) -> None:
    """Gravity is about 1 g against the box's y axis, which hangs upside down, and a person turns, not the world."""
    for path in sorted((shared_data / "sisfall").glob("SA*/D01_*.txt*"))[::4]:
        recording = read(path)
        (device,) = recording.devices
        assert recording.truth.activity == "walking"
        assert device.specific_force is not None
        assert device.rotation_rate is not None
        mean = device.specific_force.values.mean(axis=0)
        assert np.linalg.norm(mean) == pytest.approx(STANDARD_GRAVITY_MPS2, rel=0.1)
        assert mean[1] / np.linalg.norm(mean) < -0.85
        assert 0.1 < np.sqrt((device.rotation_rate.values**2).mean()) < 1.5
        assert len(device.specific_force) in (19_999, 20_000)
