"""The walker's own step length: learnt from fixes, uncertain without them, fixed where its sigma is zero."""

import numpy as np
import pytest
from estimator_walks import SIGMA_SCALE, fix, run, simulate, straight, winding
from hypothesis import given
from hypothesis import strategies as st

from pdr_est.estimators import ESTIMATORS, SPECS, EstimatorName
from pdr_est.estimators.factor_graph.length_scale import ScaleError, most_probable_scales
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose

ORIGIN = StartPose((0.0, 0.0), 0.0, 0.1, 0.05)
with_fixes = pytest.mark.parametrize("name", ["ekf", "factor-graph"])
TRIALS = 20


def estimated_scales(name: EstimatorName, true_scale: float, start: StartPose) -> tuple[Array, Array]:
    """Estimates and their sigmas in many walks of 100 steps with five fixes."""
    rng = np.random.default_rng(11)
    tracks = []
    for _ in range(TRIALS):
        walk = simulate(rng, winding(100, rng), (0, 0, 0), true_scale, fix_every=25, sigma_fix_m=0.3)
        tracks.append(run(name, walk.measurements, start))
    return np.array([track.length_scale for track in tracks]), np.array(
        [track.sigma_length_scale for track in tracks]
    )


@with_fixes
@pytest.mark.parametrize(
    "start",
    [pytest.param(ORIGIN, id="known start"), pytest.param(StartPose(), id="unknown start", marks=pytest.mark.slow)],
)
def test_fixes_tell_the_scale_within_its_sigma(name: EstimatorName, start: StartPose) -> None:
    scale, sigma = estimated_scales(name, 1.1, start)
    deviations = (scale - 1.1) / sigma
    assert np.max(sigma) < 0.05  # a walk whose steps disagree with the fixes by chance knows less
    assert np.max(np.abs(deviations)) < 3.5
    assert 0.35 < np.mean(deviations**2) < 2.2  # chi squared of 20, 99.5 %
    # A first-order filter takes the walk between fixes for a little straighter than it is; the graph does not.
    assert np.abs(np.mean(deviations)) < (0.6 if name == "factor-graph" else 0.9)


@pytest.mark.parametrize("name", [name for name in ESTIMATORS if not SPECS[name].sampled])
def test_without_fixes_the_scale_stays_1_with_the_prior_s_sigma(name: EstimatorName) -> None:
    uncertain = run(name, straight(40), StartPose((0.0, 0.0), 0.5))
    certain = run(name, straight(40), StartPose((0.0, 0.0), 0.5), 0.0)
    assert uncertain.length_scale == pytest.approx(1.0, abs=1e-9)
    assert uncertain.sigma_length_scale == pytest.approx(SIGMA_SCALE, rel=1e-6)
    assert uncertain.position_m == pytest.approx(certain.position_m, abs=1e-6)
    for k in (10, 40):
        position = uncertain.position_m[k]
        share = uncertain.covariance_m2[k] - certain.covariance_m2[k]
        assert share == pytest.approx(SIGMA_SCALE**2 * np.outer(position, position), rel=1e-3)


@pytest.mark.parametrize("name", [name for name in ESTIMATORS if not SPECS[name].sampled])
def test_a_scale_without_uncertainty_is_fixed(name: EstimatorName) -> None:
    rng = np.random.default_rng(12)
    walk = simulate(rng, winding(60, rng), (0, 0, 0), 1.3, fix_every=15)
    for start in (ORIGIN, StartPose()):
        track = run(name, walk.measurements, start, 0.0)
        assert track.length_scale == pytest.approx(1.0, abs=1e-9)
        assert track.sigma_length_scale == 0.0


@with_fixes
def test_steps_of_the_track_have_the_scaled_length(name: EstimatorName) -> None:
    rng = np.random.default_rng(13)
    walk = simulate(rng, winding(60, rng), (0, 0, 0), 1.2, fix_every=15)
    track = run(name, walk.measurements, ORIGIN)
    assert track.step_length_m[1:] == pytest.approx(np.full(60, 0.7 * track.length_scale))
    assert track.step_length_m[0] == 0.0


LINEAR = st.floats(-1e3, 1e3), st.floats(0.0, 1e5), st.floats(0.2, 3.0), st.floats(0.005, 0.3)


@given(*LINEAR)
def test_the_most_probable_scale_is_positive_and_where_the_slope_is_zero(
    slope: float, curvature: float, at: float, sigma: float
) -> None:
    error = ScaleError(np.array([at]), np.array([slope]), np.array([[curvature]]))
    scale = most_probable_scales(error, sigma)
    assert 0.6 * at < scale[0] < 1.7 * at
    probe = 1e-4 * min(sigma, 0.1)
    costs = [error.with_prior(np.log(scale) + by, sigma) for by in (-probe, 0.0, probe)]
    reached_the_end_of_the_step = abs(np.log(scale[0] / at)) > 0.4999
    assert reached_the_end_of_the_step or costs[1] <= min(costs) + 1e-9 * max(1.0, np.abs(costs).max())


def test_scales_that_fixes_want_negative_stay_positive() -> None:
    """The fixes have the walk go backwards; heading known."""
    fixes = [fix(0, 0.0, 0.0, 0.1), fix(40, -20.0, 0.0, 0.1)]
    track = run("factor-graph", [*straight(40), *fixes], StartPose((0.0, 0.0), 0.0, 0.1, 1e-3))
    assert 0.0 < track.length_scale < 1.0
    assert np.isfinite(track.covariance_m2).all()
    assert track.sigma_length_scale > 0.0
