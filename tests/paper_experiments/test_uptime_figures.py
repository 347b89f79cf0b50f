"""Figures 6, 8 and 9 of UPTIME: their arithmetic on known answers, on short simulations, and as recorded."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest

from pdr_est.simulate import StepSchedule, simulate_walk, uptime_trip
from pdr_est.types.steps import Gait

EXPERIMENTS = Path(__file__).resolve().parents[2] / "experiments"
DETAILS = (EXPERIMENTS / "paper-details.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def scripts():
    """Both scripts, which import others of their folder."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(EXPERIMENTS))
        yield {name: runpy.run_path(str(EXPERIMENTS / f"uptime_{name}.py")) for name in ("figure6", "figures8_9")}


def test_the_state_machine_counts_a_runner_in_the_hand_and_the_foot_method_does_not(scripts) -> None:
    walk = scripts["figure6"]["simulated"](0, "in hand", "running")
    machine, foot = (
        scripts["figure6"]["count_error_percent"](walk.recording, name)
        for name in ("uptime-fsm", "local-variance, untuned")
    )
    assert machine < 3.0
    assert foot > 50.0


def test_figure_6_as_recorded(scripts) -> None:
    document = json.loads((EXPERIMENTS / "results/uptime_figure6.json").read_text(encoding="utf-8"))
    errors = {
        group: {name: float("nan") if number is None else number for name, number in row.items()}
        for group, row in document.items()
    }
    text = (EXPERIMENTS / "results/uptime_figure6.txt").read_text(encoding="utf-8")
    assert scripts["figure6"]["as_text"](errors) == text
    assert scripts["figure6"]["as_markdown"](errors) in DETAILS
    for row in errors.values():
        assert row.keys() == {"step_m", *scripts["figure6"]["SHOWN"]}
    assert errors["simulated, in hand, running"]["uptime-fsm"] < 3.0


def test_the_error_of_a_trip_and_its_gaits(scripts) -> None:
    figures = scripts["figures8_9"]
    trip = figures["as_trip"](simulate_walk(uptime_trip("stairs")))
    assert trip.true_m == pytest.approx(53.3, abs=0.1)
    error, right = figures["error_of"](trip, figures["CHAINS"]["default"])
    assert abs(error) < 0.4
    assert right > 0.93


def test_right_gaits_by_the_true_step_that_a_step_lies_in(scripts) -> None:
    time_s, zero = np.array([1.0, 2.0, 3.0]), np.zeros(3)
    gaits = np.array([Gait.WALKING, Gait.JOGGING, Gait.RUNNING], dtype=np.int8)
    true = StepSchedule(time_s - 1.0, time_s, zero, np.array(["L", "R", "L"]), 3.0, gaits, zero, zero)

    class Event:
        def __init__(self, time_s: float) -> None:
            self.time_s = time_s

    class Found:
        def __init__(self, start_s: float, end_s: float, gait: Gait) -> None:
            self.start_s, self.event, self.gait = start_s, Event(end_s), gait

    found = [Found(0.1, 1.1, Gait.WALKING), Found(1.1, 2.1, Gait.WALKING), Found(2.1, 3.1, Gait.JOGGING)]
    assert scripts["figures8_9"]["right_gaits"](true, found) == pytest.approx(2.0 / 3.0)


def test_figures_8_and_9_as_recorded(scripts) -> None:
    document = json.loads((EXPERIMENTS / "results/uptime_figures8_9.json").read_text(encoding="utf-8"))
    rights, figures = document["right_gaits_percent"], scripts["figures8_9"]
    errors = {
        group: {
            name: [
                (error / 100.0, share / 100.0)
                for error, share in zip(
                    each, rights.get(group, {}).get(name, [float("nan")] * len(each)), strict=True
                )
            ]
            for name, each in row.items()
        }
        for group, row in document["error_percent"].items()
    }
    assert figures["as_markdown"](errors) in DETAILS
    assert np.mean(np.abs(document["error_percent"]["compound, in hand"]["default"])) < 8.0
    assert min(rights["compound, in hand"]["default"]) > 98.5
