"""The table of walks of known length."""

import gzip
from pathlib import Path

import pytest

from pdr_est.errors import RecordingError
from pdr_est.io import read
from pdr_est.io.side_tables.known_distances import KnownDistance, read_known_distances

HEADER = "file,distance_m,steps\n"


def test_walks_by_the_name_of_their_recording(tmp_path: Path) -> None:
    content = f"{HEADER}A.csv,31.91,42\nlong walk.txt.gz,120,168\n"
    (tmp_path / "truth.csv").write_text(content)
    (tmp_path / "packed.csv.gz").write_bytes(gzip.compress(content.encode()))
    for name in ("truth.csv", "packed.csv.gz"):
        walks = read_known_distances(tmp_path / name)
        assert walks == {"A": KnownDistance(31.91, 42), "long walk": KnownDistance(120.0, 168)}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (f"{HEADER}A.csv,0,42\n", r"line 2: distance_m = 0 is not above zero"),
        (f"{HEADER}A.csv,nan,42\n", r"line 2: distance_m = nan is not above zero"),
        (f"{HEADER}A.csv,30,42\nB.csv,30,\n", r"line 3: steps = nan is not a whole number of steps"),
        (f"{HEADER}A.csv,30,41.5\n", r"line 2: steps = 41\.5 is not a whole number of steps"),
        (f"{HEADER}A.csv,30,0\n", r"line 2: steps = 0 is not a whole number of steps"),
        (f"{HEADER}A.csv,30,42\nA.csv.gz,30,42\n", r"line 3: A\.csv\.gz is listed twice"),
        (f"{HEADER},30,42\n", r"line 2: the file name is missing"),
        (f"{HEADER}A.csv,far,42\n", r"line 2, column 'distance_m': 'far' is not a number"),
        ("file,steps\nA.csv,42\n", "no column 'distance_m'"),
    ],
)
def test_errors_name_the_line_and_the_value(tmp_path: Path, content: str, message: str) -> None:
    path = tmp_path / "truth.csv"
    path.write_text(content)
    with pytest.raises(RecordingError, match=rf"^{path}.*{message}"):
        read_known_distances(path)


def test_a_folder_is_no_table(tmp_path: Path) -> None:
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text(HEADER)
    with pytest.raises(RecordingError, match="contains 2 files; give the truth table itself"):
        read_known_distances(tmp_path)


@pytest.mark.slow
def test_every_walk_of_the_real_table_is_read(shared_data: Path) -> None:
    walks = read_known_distances(shared_data / "known-distance" / "truth.csv")
    assert list(walks) == list("ABCDEFG")
    for name, known in walks.items():
        (device,) = read(shared_data / "known-distance" / f"{name}.csv.gz").devices
        assert device.specific_force is not None
        assert device.rotation_rate is not None
        duration_s = float(device.specific_force.time_s[-1])
        assert 0.5 < known.distance_m / duration_s < 1.6


@pytest.mark.parametrize(("separator", "name"), [(";", "semicolons"), ("\t", "tabs")])
def test_another_separator_is_named(tmp_path: Path, separator: str, name: str) -> None:
    (tmp_path / "truth.csv").write_text(f"{HEADER}A.csv,31.91,42\n".replace(",", separator))
    with pytest.raises(
        RecordingError, match=rf"truth\.csv: the columns are separated by {name}; save it with commas"
    ):
        read_known_distances(tmp_path / "truth.csv")
