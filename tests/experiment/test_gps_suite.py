"""Metrics of the suite `ipin2023` with the GPS positions in the recording as the only fixes."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.experiment import comparison_on_axis, run_benchmark
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.scoring.gps_positions import GPS_METRICS, interpolated_fixes
from pdr_est.experiment.suites import ipin2023
from pdr_est.front_end.mode import ModeParams
from pdr_est.io import read
from pdr_est.types.measurements import PositionFix

EKF = Config(mode=ModeParams(method="fixed")).with_estimator("ekf")


def gps(time_s, east_m, north_m, sigma_m=1.0):
    """A position of a source whose errors are independent, as its accuracy states."""
    return PositionFix(time_s, np.array([east_m, north_m]), sigma_m**2 * np.eye(2), source="beacon")


@pytest.fixture
def recording(tmp_path, write_ilc20):
    """A walk to the north, 1.3 m/s, with surveyed points at 1, 4, … 19 s."""
    return read(write_ilc20(tmp_path / "log.txt"))


def scored(recording):
    walk = AnalysedWalk(recording, pipeline.analyse_recording(recording, EKF), EKF)
    (scores,) = ipin2023.SUITE.score(walk)
    return walk, scores


def gps_beside(recording, sigma_m):
    """GPS positions 3 m east and 4 m north of where the walker is, one a second."""
    return replace(recording, fixes=tuple(gps(t, 8.0, 1.3 * t + 4.0, sigma_m) for t in np.arange(0.5, 20.0)))


def test_positions_between_fixes_are_on_the_line_and_those_outside_take_the_nearest():
    fixes = [gps(4.0, 10.0, -2.0), gps(2.0, 0.0, 6.0)]
    found = interpolated_fixes(fixes, np.array([0.0, 2.0, 2.5, 4.0, 9.0]))
    np.testing.assert_allclose(found, [[0.0, 6.0], [0.0, 6.0], [2.5, 4.0], [10.0, -2.0], [10.0, -2.0]])


def test_gps_is_the_only_fix_and_nothing_is_aligned(recording):
    walk, scores = scored(gps_beside(recording, 0.1))
    track = pipeline.estimate_tracks(walk.devices, EKF, walk.recording.fixes)
    truth = recording.truth.positions
    position_m, _ = track.at(truth.time_s)
    expected_m = np.linalg.norm(position_m - truth.position_m, axis=1).mean()
    assert scores.values["error_gps_m"] == pytest.approx(expected_m)
    assert scores.values["error_gps_m"] == pytest.approx(5.0, abs=1.0)
    assert scores.values["error_gps_raw_m"] == pytest.approx(5.0, abs=1e-6)
    assert scores.values["scale_gps"] == track.length_scale != 1.0
    assert scores.counts["gps_positions"] == 20


@pytest.mark.parametrize(("sigma_m", "share"), [(0.1, 0.0), (30.0, 1.0)])
def test_coverage_follows_the_stated_accuracy_of_gps(recording, sigma_m, share):
    _, scores = scored(gps_beside(recording, sigma_m))
    assert scores.values["coverage95_gps"] == share


def test_a_walk_without_gps_has_no_such_value_and_is_scored_otherwise(tmp_path, write_ilc20):
    write_ilc20(tmp_path / "ipin2023/log.txt")
    document = run_benchmark("ipin2023", tmp_path, comparison_on_axis(EKF, values=("ekf",))).to_dict()
    (row,) = document["walks"]
    assert {row[metric] for metric in GPS_METRICS} == {None}
    assert row["error_heldout_m"] is not None
    assert document["skipped"] == [
        {"walk": "log", "reason": f"{', '.join(GPS_METRICS)}: no GPS position in the recording"},
    ]


def test_other_wandering_of_a_fix_is_another_track(recording):
    walk, _ = scored(gps_beside(recording, 1.0))
    before = len(walk.tracks)
    walk.track([replace(fix, sigma_wander_m=5.0) for fix in walk.recording.fixes])
    assert len(walk.tracks) == before + 1
