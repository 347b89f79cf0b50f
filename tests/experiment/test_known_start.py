"""Metrics of a track that knows its start, and its direction from the phone's own knowledge of north."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.evaluate.held_out_fixes import fixes_at
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.scoring.known_start import START_METRICS
from pdr_est.experiment.suites import ilc20, ipin2023
from pdr_est.front_end.mode import ModeParams
from pdr_est.io import read

HELD = Config(mode=ModeParams(method="fixed"))


def scored(recording, suite=ilc20.SUITE):
    walk = AnalysedWalk(recording, pipeline.analyse_recording(recording, HELD), HELD)
    (scores,) = suite.score(walk)
    return walk, scores


@pytest.mark.parametrize("yaw_deg", [0.0, 20.0, -35.0])
def test_the_direction_is_the_phones_and_nothing_is_aligned(tmp_path, write_ilc20, yaw_deg):
    recording = read(write_ilc20(tmp_path / "log.txt", yaw_deg=yaw_deg))
    walk, scores = scored(recording)
    assert scores.values["heading_start_error_deg"] == pytest.approx(abs(yaw_deg), abs=1.0)
    truth = recording.truth.positions
    track = walk.track(fixes_at(truth.time_s[:1], truth.position_m[:1]))
    position_m, _ = track.at(truth.time_s[1:])
    expected_m = np.linalg.norm(position_m - truth.position_m[1:], axis=1).mean()
    assert scores.values["error_start_m"] == pytest.approx(expected_m)
    assert 0.0 <= scores.values["coverage95_start"] <= 1.0
    assert track.sigma_heading_rad[0] > 0.1  # from the first row on


def test_both_suites_have_them(tmp_path, write_ilc20):
    assert set(START_METRICS) <= set(ilc20.SUITE.metrics) & set(ipin2023.SUITE.metrics)
    recording = read(write_ilc20(tmp_path / "log.txt", yaw_deg=0.0))
    _, scores = scored(recording, ipin2023.SUITE)
    assert set(START_METRICS) <= set(scores.values)


def test_a_walk_whose_phone_does_not_know_north_has_none(tmp_path, write_ilc20):
    recording = read(write_ilc20(tmp_path / "log.txt", yaw_deg=0.0))
    device = replace(recording.devices[0], attitude=None)
    _, scores = scored(replace(recording, devices=(device,)))
    assert not set(START_METRICS) & set(scores.values)
    assert {scores.missing[metric] for metric in START_METRICS} == {"no device of the walk knows north"}
