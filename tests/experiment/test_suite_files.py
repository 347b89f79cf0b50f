from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import ConfigError, RecordingError
from pdr_est.experiment.recording_files import recordings, suite_folder
from pdr_est.experiment.suite import WalkFile
from pdr_est.experiment.suites import SUITES, oxiod, suite_named
from pdr_est.types.steps import CarryingMode


def mode_of(walk: WalkFile) -> CarryingMode | None:
    """The mode that the data set tells of a walk."""
    modes = walk.truth.modes
    return None if modes is None else CarryingMode(int(modes.at(np.array([5.0]))[0]))


def touch(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()


def test_folder_of_the_suite_is_found_inside_the_data_folder_or_is_it(tmp_path):
    touch(tmp_path, "ilc20/site1/F1/a.txt")
    assert suite_folder(tmp_path, "ilc20") == tmp_path / "ilc20"
    assert suite_folder(tmp_path / "ilc20", "ilc20") == tmp_path / "ilc20"


def test_missing_folder_is_an_error(tmp_path):
    with pytest.raises(RecordingError, match=r"nowhere: no such folder: give the folder that holds ilc20/"):
        suite_folder(tmp_path / "nowhere", "ilc20")


def test_names_are_relative_without_extensions_and_in_natural_order(tmp_path):
    touch(tmp_path, "b/imu10.csv.gz", "b/imu2.csv", "a/imu1.csv", "b/vi2.csv")
    assert [name for name, _ in recordings(tmp_path, "imu*.csv")] == ["a/imu1", "b/imu2", "b/imu10"]


def test_plain_and_gzipped_file_of_a_walk_are_one(tmp_path):
    touch(tmp_path, "walk.txt", "walk.txt.gz")
    assert recordings(tmp_path, "*.txt") == [("walk", tmp_path / "walk.txt")]


def test_ilc20_takes_the_logs_and_not_the_maps(tmp_path):
    touch(tmp_path, "site1/F1/5dda.txt.gz", "site1/F1/floor_info.json.gz", "site1/F1/geojson_map.json")
    assert [walk.name for walk in suite_named("ilc20").find(tmp_path)] == ["site1/F1/5dda"]


def test_oxiod_takes_sensor_tables_with_paired_rows(tmp_path):
    touch(tmp_path, "large-scale/floor1/syn/imu4.csv.gz", "large-scale/floor1/syn/tango4.csv.gz")
    touch(tmp_path, "handheld/data1/syn/imu1.csv", "handheld/data1/raw/imu1.csv")
    walks = {walk.name: walk for walk in suite_named("oxiod").find(tmp_path)}
    assert list(walks) == ["handheld/data1/syn/imu1", "large-scale/floor1/syn/imu4"]
    loop, vicon = walks["large-scale/floor1/syn/imu4"], walks["handheld/data1/syn/imu1"]
    assert (loop.headline, loop.group, loop.labels) == (True, "large-scale/pocket", {"position": "pocket"})
    assert (vicon.headline, vicon.group, vicon.labels) == (False, "vicon/hand", {"position": "hand"})
    assert (mode_of(loop), mode_of(vicon)) == (CarryingMode.POCKET, CarryingMode.HOLDING)


def test_oxiod_bags_have_no_mode_with_a_name(tmp_path):
    touch(tmp_path, "large-scale/floor1/syn/imu7.csv", "large-scale/floor1/syn/imu2.csv")
    assert [mode_of(walk) for walk in suite_named("oxiod").find(tmp_path)] == [None, None]


@pytest.mark.parametrize(
    ("name", "position"),
    [
        ("large-scale/floor1/syn/imu1", "hand"),
        ("large-scale/floor1/syn/imu10", "bag"),
        ("large-scale/floor1/syn/imu2", None),
        ("large-scale/floor2/syn/imu1", None),
        ("multi-users/user5/syn/imu5", "pocket"),
        ("multi-users/user50/syn/imu5", None),
        ("handbag/data2/syn/imu3", "bag"),
        ("running/data1/syn/imu1", None),
    ],
)
def test_position_of_the_phone_is_told_by_the_folder_or_known_or_null(name, position):
    assert oxiod.position_of(name) == position


def test_unknown_suite_is_an_error_that_lists_the_known_ones():
    with pytest.raises(ConfigError, match="'ilc21': choose one of ilc20, oxiod, ipin2023"):
        suite_named("ilc21")


def test_names_of_suites_are_unique_and_metrics_are_declared_once():
    assert len({suite.name for suite in SUITES}) == len(SUITES)
    for suite in SUITES:
        assert len(set(suite.metrics)) == len(suite.metrics) > 0
