"""Figure 7 of UPTIME: errors along a trip, on made-up numbers with a known answer and on a short simulated trip."""

import json
import sys
from importlib import util
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

SCRIPT = Path(__file__).resolve().parents[2] / "experiments" / "uptime_figure7.py"


@pytest.fixture(scope="module")
def figure7():
    spec = util.spec_from_file_location("uptime_figure7", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = util.module_from_spec(spec)
    sys.modules["uptime_figure7"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def test_errors_add_up_and_scaling_rights_the_first_walk(figure7) -> None:
    def walk(true_m, model_m):
        return figure7.Walk(np.array(true_m), dict.fromkeys(figure7.MODELS, np.array(model_m)))

    trip = [walk([10.0, 10.0], [8.0, 8.0]), walk([20.0], [20.0])]
    plain, scaled = (figure7.errors(trip, "auto", way) for way in (False, True))
    assert_allclose(plain.along_m, [10.0, 20.0, 40.0])
    assert_allclose(plain.error_m, [-2.0, -4.0, -4.0])
    assert_allclose(scaled.error_m, [0.0, 0.0, 5.0], atol=1e-12)
    assert plain.numbers() == {
        "distance_m": 40.0,
        "final_m": -4.0,
        "final_percent": -10.0,
        "mean_m": 3.33,
        "largest_m": 4.0,
    }


@pytest.mark.slow
def test_the_script_on_a_simulated_trip(figure7, tmp_path) -> None:
    trips = {"simulated": figure7.simulated_trip(0, paces=(1.0, 0.7))}
    (first, second) = trips["simulated"]
    assert first.true_m.sum() == pytest.approx(figure7.WALK_M, abs=0.5)
    assert len(second.true_m) > len(first.true_m)  # slower
    for model in figure7.MODELS:
        assert abs(figure7.errors(trips["simulated"], model, True).numbers()["final_percent"]) < 30.0
    # A fixed length is too long for slow steps, a variable one less so.
    fixed, variable = (figure7.errors(trips["simulated"], model, True).error_m[-1] for model in ("static", "auto"))
    assert fixed > abs(variable)
    figure7.draw(trips, tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 5000
    assert len(figure7.as_text(trips).splitlines()) == 4 + 2 * len(figure7.MODELS)


@pytest.mark.slow
def test_the_trip_of_the_paper_is_cut_at_its_stops_and_fixed_lengths_lose_where_somebody_runs(figure7) -> None:
    trip = figure7.gaits_trip(0)
    assert [round(walk.true_m.sum() / 10.0) for walk in trip] == [8, 16, 18, 5]
    fixed, by_gait = (figure7.errors(trip, model, True).numbers() for model in ("static", "gait-table"))
    assert by_gait["mean_m"] < 0.5 * fixed["mean_m"]
    assert fixed["final_percent"] < -8.0


def test_the_recorded_table_is_that_of_the_recorded_numbers(figure7) -> None:
    document = json.loads((SCRIPT.parent / "results/uptime_figure7.json").read_text(encoding="utf-8"))
    assert list(document) == ["gaits", "simulated", "known-distance", "stride-length"]
    assert figure7.as_markdown(document) in (SCRIPT.parent / "paper-details.md").read_text(encoding="utf-8")
