"""Errors of many simulated walks against the covariances claimed for them."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from estimator_walks import SIGMA_SCALE, run, simulate, step, winding
from scipy.stats import chi2

from pdr_est.estimators import EstimatorName
from pdr_est.evaluate.consistency import coverage95, nees_mean
from pdr_est.frames import Array, wrap_angle
from pdr_est.types.measurements import StartPose
from pdr_est.types.track import Track

STEPS = 45
SAMPLE, TRIALS = 18, 80
sizes = pytest.mark.parametrize(
    "trials", [SAMPLE, pytest.param(TRIALS, marks=pytest.mark.slow)], ids=["sample", "all"]
)


def nees_bounds(trials: int) -> tuple[float, float]:
    """Of the mean of so many chi-squared variables with two degrees of freedom. Some fifty such means are tested."""
    least, most = chi2.ppf([0.0005, 0.9995], 2 * trials) / trials
    return float(least), float(most)


@cache
def outcomes(name: EstimatorName, known: bool, trials: int, first_fix: int = 0) -> list[tuple[Track, Array]]:
    """Tracks and true poses of walks with fixes every 15 steps. Scale and start are drawn from what is claimed."""
    rng = np.random.default_rng(21)
    results = []
    for _ in range(trials):
        pose = (3.0 * rng.standard_normal(), 3.0 * rng.standard_normal(), rng.uniform(-np.pi, np.pi))
        scale = 1.0 + SIGMA_SCALE * rng.standard_normal()
        walk = simulate(rng, winding(STEPS, rng), pose, scale, fix_every=15, first_fix=first_fix)
        guess = np.array(pose) + [0.3, 0.3, 0.1] * rng.standard_normal(3)
        start = StartPose((guess[0], guess[1]), guess[2], 0.3, 0.1) if known else StartPose()
        results.append((run(name, walk.measurements, start), walk.truth))
    return results


def nees_at(results: list[tuple[Track, Array]], step: int) -> float:
    error = np.array([track.position_m[step] - truth[step, :2] for track, truth in results])
    covariance = np.array([track.covariance_m2[step] for track, _ in results])
    return nees_mean(error, covariance, 0.0)


def coverage(results: list[tuple[Track, Array]], steps: slice) -> float:
    error = np.concatenate([(track.position_m - truth[:, :2])[steps] for track, truth in results])
    covariance = np.concatenate([track.covariance_m2[steps] for track, _ in results])
    return coverage95(error, covariance, 0.0)


CASES = [
    ("ekf", True, range(0, STEPS + 1, 10)),
    ("ekf", False, range(25, STEPS + 1, 5)),  # the direction is known from step 15 on
    ("factor-graph", True, range(0, STEPS + 1, 10)),
    ("factor-graph", False, range(0, STEPS + 1, 10)),
    ("fixed-lag", True, range(0, STEPS + 1, 10)),
    ("fixed-lag", False, range(10, STEPS + 1, 10)),  # before, directions are traced back without the fixes there
    ("dead-reckoning", True, range(0, STEPS + 1, 10)),
    ("dead-reckoning", False, range(15, STEPS + 1, 10)),
]
cases = pytest.mark.parametrize(
    ("name", "known", "steps"),
    [
        pytest.param(
            name,
            known,
            steps,
            id=f"{name}-{'known' if known else 'unknown'}",
            marks=[pytest.mark.slow] if (name, known) == ("fixed-lag", False) else [],
        )
        for name, known, steps in CASES
    ],
)


@sizes
@cases
def test_normalised_errors_are_chi_squared(name: EstimatorName, known: bool, steps: range, trials: int) -> None:
    results = outcomes(name, known, trials)
    nees = {step: nees_at(results, step) for step in steps}
    least, most = nees_bounds(trials)
    assert all(least < value < most for value in nees.values()), nees


@sizes
@pytest.mark.parametrize(
    ("name", "known"),
    [
        ("ekf", True),
        ("ekf", False),
        ("fixed-lag", True),
        pytest.param("fixed-lag", False, marks=pytest.mark.slow),
        ("factor-graph", True),
        ("factor-graph", False),
    ],
)
def test_the_95_percent_regions_hold_95_percent(name: EstimatorName, known: bool, trials: int) -> None:
    assert 0.92 <= coverage(outcomes(name, known, trials), slice(None)) <= 0.98


@sizes
@cases
def test_heading_errors_are_as_large_as_claimed(name: EstimatorName, known: bool, steps: range, trials: int) -> None:
    normalised = [
        wrap_angle(track.heading_rad - truth[:, 2])[steps.start :] / track.sigma_heading_rad[steps.start :]
        for track, truth in outcomes(name, known, trials)
    ]
    assert 0.7 < np.mean(np.square(normalised)) < 1.35


@sizes
@pytest.mark.parametrize("first_fix", [0, 10])
def test_the_filter_is_honest_while_the_direction_is_unknown(first_fix: int, trials: int) -> None:
    results = outcomes("ekf", False, trials, first_fix)
    assert coverage(results, slice(0, 15)) >= 0.9
    assert np.mean([track.sigma_heading_rad[5] for track, _ in results]) > 1.0


@sizes
@pytest.mark.parametrize("name", ["factor-graph", "dead-reckoning"])
def test_poses_before_the_first_fix_are_covered(name: EstimatorName, trials: int) -> None:
    assert coverage(outcomes(name, False, trials, 10), slice(0, 10)) >= 0.9


GAP_STEPS, REACH_M = 40, 10.0


@cache
def outcomes_with_gap(name: EstimatorName, trials: int) -> list[tuple[Track, Array]]:
    """Walks from a known start, with a gap in which the walker went anywhere and turned anyhow."""
    rng = np.random.default_rng(22)
    bridge = step(30 + GAP_STEPS, 0.0, 0.0, np.diag([REACH_M**2, REACH_M**2, np.pi**2 / 3.0]), observed=False)
    results = []
    for _ in range(trials):
        before = simulate(rng, winding(30, rng), fix_every=10)
        there = before.truth[-1, :2] + REACH_M * rng.standard_normal(2)
        after = simulate(rng, winding(30, rng), (*there, rng.uniform(-np.pi, np.pi)), fix_every=10, first_fix=5)
        shift_s = bridge.time_s
        later = [replace(m, time_s=m.time_s + shift_s) for m in after.fixes]
        later += [replace(m, time_s=m.time_s + shift_s, start_s=m.start_s + shift_s) for m in after.odometry]
        track = run(name, [*before.measurements, bridge, *later], StartPose((0.0, 0.0), 0.0), 0.03)
        results.append((track, np.concatenate([before.truth, after.truth])))
    return results


@sizes
@pytest.mark.parametrize(
    "name", ["ekf", *(pytest.param(name, marks=pytest.mark.slow) for name in ("fixed-lag", "factor-graph"))]
)
def test_a_gap_in_which_the_direction_was_lost_leaves_an_honest_track(name: EstimatorName, trials: int) -> None:
    results = outcomes_with_gap(name, trials)
    assert coverage(results, slice(31, None)) >= 0.9
    assert coverage(results, slice(50, None)) >= 0.92
    for number in (31, 50, 61):
        assert nees_at(results, number) < nees_bounds(trials)[1]
    heading = np.array([wrap_angle(track.heading_rad - truth[:, 2])[50:] for track, truth in results])
    sigma = np.array([track.sigma_heading_rad[50:] for track, _ in results])
    assert np.mean((heading / sigma) ** 2) < chi2.ppf(0.995, trials) / trials  # one heading a walk, so correlated
