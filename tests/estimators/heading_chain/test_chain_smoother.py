"""Walks whose positions nothing measures: the chain of headings has the optimum of the factor graph."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import DEVICE, SIGMA_SCALE, heading_prior, simulate, winding

from pdr_est.errors import EstimationError
from pdr_est.estimators import estimate_walk
from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.estimators.factor_graph import smoother
from pdr_est.estimators.heading_chain import chain_smoother
from pdr_est.frames import wrap_angle
from pdr_est.types.measurements import DeviceMeasurements, Measurement, PositionFix, StartPose

KNOWN = StartPose((3.0, -2.0), 0.4, sigma_position_m=0.2, sigma_heading_rad=0.15)
NORTH_ONLY = StartPose((3.0, -2.0), sigma_position_m=0.2)


def walk(priors: str, seed: int = 3, steps: int = 60) -> list[Measurement]:
    """A winding walk with correlated noise of its steps, heading priors and one gross outlier among them."""
    rng = np.random.default_rng(seed)
    simulated = simulate(rng, 2.0 * winding(steps, rng), (3.0, -2.0, 0.4))
    skewed = np.array([[0.02, 0.004, 0.001], [0.004, 0.03, 0.006], [0.001, 0.006, 0.01]])
    measured: list[Measurement] = [replace(one, covariance=skewed) for one in simulated.measurements]  # type: ignore[type-var]
    for k in range(2, steps, 3):
        off_rad = 1.2 if k == 20 else 0.05 * float(rng.standard_normal())
        one = heading_prior(k, float(simulated.truth[k, 2]) + off_rad, 0.08, True)
        if "absolute" in priors:
            measured.append(one)
        if "relative" in priors:
            measured.append(replace(one, heading_rad=one.heading_rad - 0.9, relative=True))
    return measured


@pytest.mark.parametrize("start", [KNOWN, NORTH_ONLY, StartPose()], ids=["known", "north", "unknown"])
@pytest.mark.parametrize("priors", ["none", "absolute", "relative", "absolute and relative"])
def test_it_is_the_factor_graph(priors: str, start: StartPose) -> None:
    timeline = build_timeline(DEVICE, 0.0, walk(priors))
    headings = (0.5,) if start.heading_rad is None and "absolute" in priors else ()
    track = chain_smoother.estimate([timeline], start, SIGMA_SCALE, headings)
    graph = smoother.estimate([timeline], (), start, SIGMA_SCALE, headings)
    assert track.position_m == pytest.approx(graph.position_m, abs=2e-5)
    assert wrap_angle(track.heading_rad - graph.heading_rad) == pytest.approx(np.zeros(len(graph)), abs=2e-6)
    assert track.covariance_m2 == pytest.approx(graph.covariance_m2, rel=1e-4, abs=1e-7)
    assert track.sigma_heading_rad == pytest.approx(graph.sigma_heading_rad, rel=1e-5)
    assert (track.length_scale, track.sigma_length_scale) == (graph.length_scale, graph.sigma_length_scale)


def test_the_estimator_uses_it() -> None:
    measurements = tuple(walk("absolute"))
    track = estimate_walk("factor-graph", [DeviceMeasurements(DEVICE, 0.0, measurements)], KNOWN, SIGMA_SCALE)
    own = chain_smoother.estimate([build_timeline(DEVICE, 0.0, measurements)], KNOWN, SIGMA_SCALE)
    assert np.array_equal(track.position_m, own.position_m)


def test_headings_that_do_not_settle_are_refused_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pdr_est.estimators.heading_chain.chain.MAX_STEPS", 1)
    with pytest.raises(EstimationError, match=r"headings of 61 poses do not settle: step 1 .* or use ekf"):
        chain_smoother.estimate([build_timeline(DEVICE, 0.0, walk("absolute"))], KNOWN, SIGMA_SCALE)


def test_what_measures_positions_needs_the_graph() -> None:
    rng = np.random.default_rng(1)
    plain = simulate(rng, winding(5, rng)).measurements
    fixed = [*plain, PositionFix(2.0, np.zeros(2), np.eye(2))]
    assert chain_smoother.positions_follow([build_timeline(DEVICE, 0.0, plain)], ())
    assert not chain_smoother.positions_follow([build_timeline(DEVICE, 0.0, fixed)], ())
