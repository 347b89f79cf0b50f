"""Stride length: blanks between the fields, Unix milliseconds, and strides that end where their number goes up."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from pdr_est.errors import RecordingError
from pdr_est.io import read
from pdr_est.io.formats.datasets.stride_length import sniff
from pdr_est.io.text.container import Source

START_MS = 1_540_481_684_988
BOUNDS = "is not above 0 and at most 10 m"
SENSORS = "-0.25 0.5 9.75 0.1 -0.2 0.3 -22.5 -1.75 -30.125"


def lines(strides: Sequence[tuple[int, float]], every: int = 10) -> list[str]:
    """Rows at 100 Hz, so many for each number and length."""
    rows, walked = [], 0.0
    for number, length in strides:
        walked += length
        for _ in range(every):
            rows.append(f"test {SENSORS} {START_MS + 10 * len(rows)} {length} {number} {walked}")
    return rows


def written(folder: Path, rows: Sequence[str]) -> Path:
    path = folder / "walk.txt"
    path.write_text("\n".join(rows) + "\n")
    return path


def test_units_signs_clock_and_name(tmp_path: Path) -> None:
    recording = read(written(tmp_path, lines([(0, 0.0), (1, 1.2), (2, 1.3)])))
    (device,) = recording.devices
    assert (recording.format, recording.name, recording.epoch_s) == ("stride length", "walk", START_MS / 1e3)
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.magnetic_field is not None
    assert_allclose(device.specific_force.time_s, np.arange(30) / 100.0, atol=1e-9)
    assert_array_equal(device.specific_force.values, np.tile([-0.25, 0.5, 9.75], (30, 1)))
    assert_array_equal(device.rotation_rate.values, np.tile([0.1, -0.2, 0.3], (30, 1)))
    assert_array_equal(device.magnetic_field.values, np.tile([-22.5, -1.75, -30.125], (30, 1)))
    assert device.warnings == ()


def test_a_stride_lasts_from_the_end_of_the_one_before_to_its_own(tmp_path: Path) -> None:
    recording = read(written(tmp_path, lines([(0, 0.0), (1, 1.2), (2, 1.3), (3, 1.4)])))
    strides = recording.truth.strides
    assert strides is not None
    assert_allclose(strides.start_s, [0.1, 0.2], atol=1e-9)
    assert_allclose(strides.end_s, [0.2, 0.3], atol=1e-9)
    assert_array_equal(strides.length_m, [1.3, 1.4])
    assert recording.notes == ("true strides: 2; left out because their beginning is unknown: 1",)


def test_a_stride_behind_a_missing_one_has_no_beginning(tmp_path: Path) -> None:
    recording = read(written(tmp_path, lines([(4, 1.0), (5, 1.1), (6, 1.2), (8, 1.3), (9, 1.4)])))
    strides = recording.truth.strides
    assert strides is not None
    assert_array_equal(strides.length_m, [1.2, 1.4])
    assert recording.notes == ("true strides: 2; left out because their beginning is unknown: 2",)


def test_somebody_who_stands_has_no_strides(tmp_path: Path) -> None:
    strides = read(written(tmp_path, lines([(0, 0.0)]))).truth.strides
    assert strides is not None
    assert len(strides.length_m) == 0


@pytest.mark.parametrize(
    ("strides", "message"),
    [
        ([(0, 0.0), (1, 1.2), (2, 0.0)], f"line 21: the stride length 0 m {BOUNDS}; restore the file"),
        ([(0, 0.0), (1, 1.2), (2, 1.4e9)], f"line 21: the stride length 1.4e+09 m {BOUNDS}; restore the file"),
        ([(0, 0.0), (1, 1.2), (2, 10.1)], f"line 21: the stride length 10.1 m {BOUNDS}; restore the file"),
        ([(0, 0.0), (2, 1.2), (1, 1.2)], "line 21: stride number 1 after 2; restore the file"),
    ],
)
def test_wrong_truth_is_refused(strides: Sequence[tuple[int, float]], message: str, tmp_path: Path) -> None:
    path = written(tmp_path, lines(strides))
    with pytest.raises(RecordingError) as caught:
        read(path)
    assert str(caught.value) == f"{path}, {message}"


def test_a_damaged_row_is_named(tmp_path: Path) -> None:
    rows = lines([(0, 0.0), (1, 1.2)], every=20)
    rows[30] = rows[30].replace("9.75", "9,75")
    with pytest.raises(RecordingError, match=r"walk\.txt, line 31, column 'acc_z': '9,75' is not a number"):
        read(written(tmp_path, rows))
    rows[30] = "test 1.0 2.0"
    with pytest.raises(RecordingError, match=r"walk\.txt, line 31: 2 fields instead of 13"):
        read(written(tmp_path, rows))


@pytest.mark.parametrize(
    "row", ["1.0 " * 13, f"test {SENSORS} 12.5 0.0 0 0.0", f"test,{SENSORS},{START_MS},0.0,0,0.0", ""]
)
def test_other_tables_are_not_taken_for_this_format(row: str, tmp_path: Path) -> None:
    assert not sniff(Source.open(written(tmp_path, [row] * 30)))
    assert sniff(Source.open(written(tmp_path, lines([(0, 0.0)]))))


def test_real_walks(shared_data: Path) -> None:
    path = shared_data / "stride-length" / "PDR_Raw_2018-10-25-11-34-35.txt.gz"
    strides = read(path).truth.strides
    assert strides is not None
    assert_array_equal(strides.end_s[:-1], strides.start_s[1:])
    assert strides.length_m.sum() == pytest.approx(8.498, abs=1e-3)
