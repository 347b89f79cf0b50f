"""Robust DR's figure 4 runs on fewer trials, and its recorded results say what they are cited for."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_mmpdr_tables import experiment

from pdr_est.frames import wrap_angle
from pdr_est.pipeline import analyse_recording
from pdr_est.simulate import (
    PocketPhone,
    WalkingPath,
    robust_dr_trials,
    simulate_walk,
    waypoint_passes,
    with_compass_orientation,
)

RESULTS = Path(__file__).resolve().parents[2] / "experiments" / "results"


def test_the_trials_are_those_of_the_paper() -> None:
    scenario, other = robust_dr_trials(seed=3, trials=2)
    assert robust_dr_trials(seed=3, trials=1) == (scenario,)
    assert scenario != other
    path = WalkingPath(scenario.path)
    assert path.length_m == pytest.approx(90.0, abs=0.2)
    assert path.turn_rad.min() < -1.5
    assert path.turn_rad.max() > 1.5
    assert [device.name for device in scenario.devices] == ["left", "right"]
    assert all(24.0 <= device.sensors.rate_hz < 25.0 for device in scenario.devices)
    walk = simulate_walk(replace(scenario, irons=()))
    time_s, position_m = waypoint_passes(walk)
    assert len(time_s) == 22
    assert np.all(np.diff(time_s) > 1.0)
    places = {
        tuple(np.round(place / 3.7).astype(int)) for place in position_m.tolist() for place in [np.array(place)]
    }
    assert len(places) == 10
    assert 80.0 < walk.truth_time_s[-1] < 160.0


def test_opposed_compasses_are_disturbed_in_opposite_senses() -> None:
    """In axes of the body, whose forward is that of the walker, the fields point away from each other."""
    angles = []
    for plain, trial in zip(robust_dr_trials(3, 40), robust_dr_trials(3, 40, opposed_compasses=True), strict=True):
        assert replace(trial, name=plain.name, devices=plain.devices) == plain
        fields = []
        for device in trial.devices:
            assert isinstance(device.carry, PocketPhone)
            assert device.sensors.magnetometer is not None
            forward, left, up = device.carry.mount().apply(device.sensors.magnetometer.bias)
            assert up == pytest.approx(0.0, abs=1e-9)
            fields.append(complex(forward, left))
        angles.append(float(np.angle(-fields[1] / fields[0])))
    assert np.sqrt(np.mean(np.square(angles))) == pytest.approx(0.5, rel=0.3)


def test_the_published_headings_count_from_north() -> None:
    """A first direction that is wrong stays so, while a pointing phone begins as the walker does."""
    figure = experiment("robust_dr_figure4")
    (scenario,) = robust_dr_trials(seed=0, trials=1)
    walk = simulate_walk(scenario)
    config = figure.settings(walk, "published")
    assert 0.6 < config.walker.length_scale < 1.3
    devices = analyse_recording(with_compass_orientation(walk.recording), config)
    north = figure.against_north(devices[0], walk, config)
    heading_rad = config.start.heading_rad + north.odometry[0].heading_change_rad
    expected = devices[0].steps[0].heading_rad - scenario.earth.declination_rad
    assert float(wrap_angle(heading_rad - expected)) == pytest.approx(0.0, abs=1e-9)
    assert figure.against_north(devices[0], walk, figure.settings(walk, "pointing")) is devices[0]


@pytest.mark.slow
def test_figure_4_of_one_trial(tmp_path: Path) -> None:
    figure = experiment("robust_dr_figure4")
    scenarios = robust_dr_trials(seed=0, trials=5)[4:]
    table = figure.measured(scenarios)
    assert set(table) == {"published", "published, pointing", "pointing", "gyro"}
    (trial,) = table["gyro"]
    left, right = (
        trial.tracks["map-closed-form"].of_device(phone).at(trial.time_s)[0] for phone in ("left", "right")
    )
    assert np.linalg.norm(left - right, axis=1).max() <= 0.2  # a little more than 2R between the steps
    clocks = figure.of_clock_errors(scenarios, errors_s=(0.0,))
    assert clocks[0.0]["map-closed-form"] == pytest.approx(np.mean(trial.mean_m("map-closed-form")), abs=0.05)
    text = figure.as_text({"trials": table}, clocks)
    assert "greatest one (paper 73.7)" in text
    document = figure.as_document({"trials": table}, clocks, 0)
    assert len(document["sets"]["trials"]["pointing"]["trials"]) == 1
    figure.plot(table["pointing"] * 2, tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 10_000


def test_figure_4_as_recorded() -> None:
    """Compasses that err in opposite senses gain more by fusion; headings of section III-E tell nothing here."""
    sets = json.loads((RESULTS / "robust_dr_figure4.json").read_text(encoding="utf-8"))["sets"]
    plain, opposed = (sets[words]["pointing"]["fusions"] for words in ("trials", "opposed compasses"))
    assert 0 < plain["map-closed-form"]["both_better"] < 10
    assert opposed["map-closed-form"]["reduction_of_means"] > plain["map-closed-form"]["reduction_of_means"]
    published = sets["trials"]["published"]["fusions"]["map-closed-form"]
    assert published["before_m"] > plain["map-closed-form"]["before_m"]
    gyro = sets["trials"]["gyro"]["fusions"]
    assert gyro["factor-graph"]["after_m"] < gyro["map-closed-form"]["after_m"]
