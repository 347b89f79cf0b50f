"""Heading priors: angles wrap, far ones count less."""

import numpy as np
import pytest
from estimator_walks import fix, heading_prior, run, step, straight

from pdr_est.estimators import EstimatorName
from pdr_est.frames import wrap_angle
from pdr_est.types.measurements import StartPose

with_priors = pytest.mark.parametrize("name", ["ekf", "factor-graph"])


def start(heading_rad: float) -> StartPose:
    return StartPose((0.0, 0.0), heading_rad, 0.01, 0.1)


@with_priors
@pytest.mark.parametrize("turns", [-1, 0, 3])
@pytest.mark.parametrize(("walked", "prior", "expected"), [(3.1, -3.1, np.pi), (-3.1, 3.1, np.pi), (0.1, -0.1, 0.0)])
def test_a_prior_across_the_wrap_meets_in_the_middle(
    name: EstimatorName, walked: float, prior: float, expected: float, turns: int
) -> None:
    track = run(name, [heading_prior(0, prior + turns * 2.0 * np.pi, 0.1)], start(walked))
    assert wrap_angle(track.heading_rad[0] - expected) == pytest.approx(0.0, abs=1e-4)
    assert track.sigma_heading_rad[0] == pytest.approx(0.1 / np.sqrt(2.0), rel=1e-3)


@with_priors
def test_a_prior_counts_by_its_sigma_after_many_turns(name: EstimatorName) -> None:
    circling = [step(k, turn_rad=0.9) for k in range(1, 51)]
    track = run(name, [*circling, heading_prior(50, 45.0 + 0.2, 1e-3)], start(0.0))
    assert wrap_angle(track.heading_rad[-1] - 45.2) == pytest.approx(0.0, abs=1e-3)
    assert track.sigma_heading_rad[-1] == pytest.approx(1e-3, rel=0.01)


@with_priors
def test_headings_of_a_track_are_wrapped(name: EstimatorName) -> None:
    track = run(name, [step(k, turn_rad=0.9) for k in range(1, 21)], start(0.0))
    assert np.max(np.abs(track.heading_rad)) <= np.pi


@with_priors
def test_a_gross_prior_counts_little_if_it_is_robust(name: EstimatorName) -> None:
    priors = [heading_prior(k, 0.0, 0.05, robust=True) for k in (2, 4, 6, 8, 12, 14)]
    at_end = {
        robust: abs(
            float(run(name, [*straight(16), *priors, heading_prior(10, 1.5, 0.05, robust)], start(0)).heading_rad[10])
        )
        for robust in (True, False)
    }
    assert at_end[True] < 0.1
    assert at_end[False] > 0.2


@with_priors
def test_a_prior_also_turns_the_position(name: EstimatorName) -> None:
    vague = StartPose((0.0, 0.0), 0.0, 0.01, 0.5)
    track = run(name, [*straight(20), heading_prior(0, 0.4, 0.01)], vague)
    assert np.arctan2(*track.position_m[-1, ::-1]) == pytest.approx(0.4, abs=2e-3)


@pytest.mark.parametrize("robust", [True, False])
def test_priors_count_while_the_direction_is_still_open(robust: bool) -> None:
    walk = [*straight(40), fix(0, 0.0, 0.0, 0.3), heading_prior(5, 2.0, 0.1, robust)]
    track = run("ekf", walk, StartPose())
    assert track.sigma_heading_rad[4] > 1.0
    assert track.sigma_heading_rad[5] < 0.2
    assert wrap_angle(track.heading_rad[-1] - 2.0) == pytest.approx(0.0, abs=0.01)
