"""Tables of poses say the same as the track, to the programs that read them."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import OutputError
from pdr_est.io.writers.trajectories import write_iso21134, write_tum, write_tum_covariance, write_tum_truth
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.track import Track
from tests.support.walked_tracks import make_track


def test_tum_file_is_read_by_evo_with_position_heading_and_unix_time(tmp_path: Path) -> None:
    file_interface = pytest.importorskip("evo.tools.file_interface")
    track = make_track()
    (written,) = write_tum(track, tmp_path / "track.tum", epoch_s=1_700_000_000.0)

    trajectory = file_interface.read_tum_trajectory_file(str(written))

    valid, details = trajectory.check()
    assert valid, details
    np.testing.assert_allclose(trajectory.timestamps, 1_700_000_010.0 + 0.5 * np.arange(4), atol=1e-6)
    np.testing.assert_allclose(trajectory.positions_xyz[:, :2], track.position_m, atol=1e-4)
    yaw = trajectory.get_orientations_euler(axes="sxyz")[:, 2]
    np.testing.assert_allclose(yaw, track.heading_rad, atol=1e-6)


def test_tum_without_epoch_keeps_the_recordings_time(tmp_path: Path) -> None:
    write_tum(make_track(), tmp_path / "track.tum")
    first = (tmp_path / "track.tum").read_text().splitlines()[0]
    assert first == "10.000000 0.0000 0.0000 0 0 0 0.000000000 1.000000000"


def test_tum_quaternions_are_unit_and_keep_a_heading_beyond_one_turn(tmp_path: Path) -> None:
    track = make_track()
    turned = Track(**{**track.__dict__, "heading_rad": track.heading_rad + 6 * math.pi})
    write_tum(turned, tmp_path / "track.tum")
    qz, qw = np.loadtxt(tmp_path / "track.tum")[:, 6:].T
    np.testing.assert_allclose(qz**2 + qw**2, 1.0, atol=1e-8)
    np.testing.assert_allclose(2 * np.arctan2(qz, qw), track.heading_rad, atol=1e-8)


def test_tum_has_a_file_for_each_device_and_never_leaves_its_folder(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    files = write_tum(make_track(("1L", "../2R", "..:2R")), folder / "track.tum")
    assert [file.name for file in files] == ["track.tum", "track-.._2R.tum", "track-.._2R-3.tum"]
    assert sorted(folder.iterdir()) == sorted(files)
    assert [np.loadtxt(file)[0, 2] for file in files] == [0.0, 1.0, 2.0]


def test_the_truth_opens_with_evo_in_order_of_time(tmp_path: Path) -> None:
    file_interface = pytest.importorskip("evo.tools.file_interface")
    truth = TruePositions(np.array([2.0, 1.0]), np.array([[3.0, 4.0], [-1.0, 0.5]]), 0.1, "waypoints")
    write_tum_truth(truth, tmp_path / "truth.tum", epoch_s=1_700_000_000.0)
    trajectory = file_interface.read_tum_trajectory_file(str(tmp_path / "truth.tum"))
    assert trajectory.check()[0]
    np.testing.assert_array_equal(trajectory.timestamps, [1_700_000_001.0, 1_700_000_002.0])
    np.testing.assert_array_equal(trajectory.positions_xyz, [[-1.0, 0.5, 0.0], [3.0, 4.0, 0.0]])


def test_the_covariance_follows_the_tum_columns_as_upper_triangles(tmp_path: Path) -> None:
    track = make_track()
    covariance = np.array([[0.09, 0.02], [0.02, 0.04]])
    track = replace(track, covariance_m2=np.tile(covariance, (4, 1, 1)))
    write_tum_covariance(track, tmp_path / "c.txt", epoch_s=1000.0)
    write_tum(track, tmp_path / "t.tum", epoch_s=1000.0)
    rows = np.loadtxt(tmp_path / "c.txt")
    np.testing.assert_array_equal(rows[:, :8], np.loadtxt(tmp_path / "t.tum"))
    orientation, position = np.zeros((3, 3)), np.zeros((3, 3))
    upper = np.triu_indices(3)
    orientation[upper], position[upper] = rows[2, 8:14], rows[2, 14:]
    np.testing.assert_allclose(orientation, np.diag([0.0, 0.0, 0.01]), atol=1e-9)
    np.testing.assert_allclose(position[:2, :2], np.triu(covariance), atol=1e-9)
    assert position[:, 2].tolist() == [0.0, 0.0, 0.0]


def test_the_iso_table_has_its_columns_and_no_invented_floor(tmp_path: Path) -> None:
    track = make_track()
    turned = replace(track, heading_rad=track.heading_rad + 4.0 * math.pi)
    write_iso21134(turned, tmp_path / "i.csv", epoch_s=1_700_000_000.0)
    with (tmp_path / "i.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert list(rows[0]) == ["timestamp", "x", "y", "yaw", "floor"]
    assert [float(row["timestamp"]) for row in rows] == [1_700_000_010.0 + 0.5 * i for i in range(4)]
    np.testing.assert_allclose([float(row["x"]) for row in rows], track.position_m[:, 0], atol=1e-4)
    np.testing.assert_allclose([float(row["yaw"]) for row in rows], track.heading_rad, atol=1e-6)
    assert {row["floor"] for row in rows} == {""}


@pytest.mark.parametrize("write", [write_tum, write_tum_covariance, write_iso21134])
def test_a_file_that_cannot_be_written_is_an_output_error_with_its_place(write, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"nowhere.track: cannot be written"):
        write(make_track(), tmp_path / "nowhere" / "track")
