"""The data that the comparison page explores are those of its tables."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.report.comparison.comparison_data import comparison_data
from pdr_est.report.comparison.plots import plot_tracks
from pdr_est.report.inline_assets import inline_json
from pdr_est.types.floor_plan import FloorPlan, WalkableArea
from pdr_est.types.outcome import TrackOutcome

METRICS = ("leg_length_mae_m", "own_metric")


def outcome(walk: str, variant: str, value: float | None, points: int = 30) -> TrackOutcome:
    position_m = np.column_stack([np.arange(points, dtype=float), np.zeros(points)])
    return TrackOutcome(
        walk=walk,
        track="phone",
        variant=variant,
        labels={"place": "hall" if walk == "a" else "yard", "same": "x"},
        mode="HOLDING",
        metrics={"leg_length_mae_m": value, "own_metric": 0.1234567},
        steps=points,
        true_steps=None,
        mode_shares={},
        with_fixes=False,
        position_m=position_m,
        truth_m=position_m[::10],
        way_m=np.arange(200.0),
        error_m=np.linspace(0.1, 1.0, 200),
        squared=np.empty(0),
        counts={"legs": 7},
    )


def described(outcomes: list[TrackOutcome]) -> dict:
    return comparison_data(outcomes, ("v", "w"), METRICS, ("place",), "own_metric")


def test_columns_have_one_value_for_each_walk_and_variant() -> None:
    data = described([outcome("a", "v", 1.0), outcome("a", "w", None), outcome("b", "v", 3.0)])
    assert data["walks"] == ["a", "b"]
    assert data["values"]["leg_length_mae_m"] == [[1.0, 3.0], [None, None]]
    assert data["values"]["own_metric"] == [[0.12346, 0.12346], [0.12346, None]]
    legs, own = data["metrics"]
    assert legs["unit"] == "m"
    assert legs["weights"] == [[7, 7], [7, None]]
    assert own == {"name": "own_metric", "unit": "", "text": "", "ideal": None, "with_fixes": False}
    assert [len(column) for column in data["lines"]["tracks"]] == [2, 2]
    assert data["lines"]["tracks"][1][1] == ""


def test_a_plan_stands_once_for_all_its_walks_and_the_tracks_are_those_that_know_it() -> None:
    corners = np.array([(0.0, -1.0), (30.0, -1.0), (30.0, 1.0), (0.0, 1.0)])
    hall, yard = (FloorPlan("p", (WalkableArea(size * corners),), np.zeros((0, 2, 2)), 0.2) for size in (1.0, 2.0))
    on_plan = replace(outcome("a", "v", 1.0), on_plan_m=np.array([(0.0, 0.0), (12.0, 0.5)]))
    outcomes = [on_plan, outcome("b", "v", 1.0), outcome("c", "v", 1.0), outcome("d", "v", 1.0)]
    plans = {"a": hall, "b": yard, "d": replace(hall)}
    data = comparison_data(outcomes, ("v",), METRICS, (), "own_metric", plans=plans)
    assert data["plan_of"] == [0, 1, None, 0]
    assert [one["kind"] for one in data["plans"]] == ["lines", "lines"]
    drawn = plot_tracks([on_plan], ("v",), hall).axes[0]
    assert len(drawn.patches) == 2  # shade and edge of the plan
    assert drawn.lines[-1].get_xydata()[-1].tolist() == [12.0, 0.5]
    assert described(outcomes)["plans"] == []


def test_walks_can_be_filtered_by_every_property_that_differs() -> None:
    data = described([outcome("a", "v", 1.0), outcome("b", "v", 3.0)])
    assert data["keys"] == [{"name": "place", "values": ["hall", "yard"], "of": [0, 1]}]


def test_few_errors_are_left_to_the_still_picture_which_shows_each_of_them() -> None:
    many = [outcome("a", "v", 1.0), outcome("a", "w", 1.0)]
    few = [replace(one, way_m=one.way_m[:20], error_m=one.error_m[:20]) for one in many]
    assert list(described(many)["curves"]) == ["cdf", "growth"]
    assert list(described(few)["curves"]) == ["cdf"]
    assert described([])["curves"] == {}


def test_a_large_comparison_stays_small() -> None:
    """A thousand walks of ten minutes by twelve variants would have 90 million digits."""
    rng = np.random.default_rng(0)
    wild = [
        replace(outcome(f"{number}", "v", 1.0), position_m=np.cumsum(rng.standard_normal((1000, 2)), axis=0))
        for number in range(60)
    ]
    data = described(wild)
    assert len(inline_json(data["lines"])) < 60 * 1000 * 7


@pytest.mark.slow
def test_thousands_of_tracks_stay_small() -> None:
    rng = np.random.default_rng(0)
    wild = [replace(outcome("0", "v", 1.0), position_m=np.cumsum(rng.standard_normal((1000, 2)), axis=0))]
    tracks = [replace(wild[0], walk=f"{number}") for number in range(4000)]
    assert len(inline_json(described(tracks)["lines"])) < 7_000_000
