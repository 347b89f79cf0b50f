"""The walker's own step length: learnt from fixes, uncertain without them, fixed where its sigma is zero."""

import numpy as np
import pytest
from estimator_walks import SIGMA_SCALE, run, simulate, straight, winding

from pdr_est.estimators import ESTIMATORS, EstimatorName
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
@pytest.mark.parametrize("start", [ORIGIN, StartPose()], ids=["known start", "unknown start"])
def test_fixes_tell_the_scale_within_its_sigma(name: EstimatorName, start: StartPose) -> None:
    scale, sigma = estimated_scales(name, 1.1, start)
    deviations = (scale - 1.1) / sigma
    assert np.max(sigma) < 0.03
    assert np.max(np.abs(deviations)) < 3.5
    assert 0.35 < np.mean(deviations**2) < 2.2  # chi squared of 20, 99.5 %
    # A first-order filter takes the walk between fixes for a little straighter than it is; the graph does not.
    assert np.abs(np.mean(deviations)) < (0.6 if name == "factor-graph" else 0.9)


@pytest.mark.parametrize("name", ESTIMATORS)
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


@pytest.mark.parametrize("name", ESTIMATORS)
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
