"""Without a plan the particle filter and smoother are those of a linear-Gaussian walk, within Monte-Carlo error."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import (
    DEVICE,
    SIGMA_SCALE,
    STEP_S,
    fix,
    heading_prior,
    run,
    simulate,
    smooth_as_given,
    step,
    straight,
    winding,
    with_near_fixes,
)

from pdr_est.estimators import estimate_walk, estimator_named
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.frames import Array
from pdr_est.testing import check_estimator
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether, PositionFix, StartPose, TurnHypothesis
from pdr_est.types.track import Track

START = StartPose((3.0, -2.0), 0.5, sigma_position_m=0.3, sigma_heading_rad=0.05)
MANY = ParticleParams(least_particles=4000, most_particles=4000, paths=1000)


def particles(measurements: list[object], start: StartPose, parameters: ParticleParams = MANY) -> Track:
    devices = [DeviceMeasurements(DEVICE, 0.0, tuple(measurements))]  # type: ignore[arg-type]
    return estimate_walk("particle", devices, start, SIGMA_SCALE, particle=parameters)


def off_in_sigmas(track: Track, other: Track) -> Array:
    """Distance of poses over the standard deviation of the other track."""
    spread = np.sqrt(np.trace(other.covariance_m2, axis1=1, axis2=2))
    return np.asarray(np.linalg.norm(track.position_m - other.position_m, axis=1) / spread)


def test_the_contract_of_an_estimator() -> None:
    check_estimator(estimator_named("particle"))


def test_the_smoother_is_the_factor_graph() -> None:
    rng = np.random.default_rng(5)
    walk = with_near_fixes(simulate(rng, winding(60, rng), (3.0, -2.0, 0.5), 1.05, fix_every=15, first_fix=15))
    track, graph = particles(walk.measurements, START), smooth_as_given(walk.measurements, START)
    assert off_in_sigmas(track, graph).max() < 0.35
    assert off_in_sigmas(track, graph).mean() < 0.15
    spread, exact = (np.trace(one.covariance_m2, axis1=1, axis2=2) for one in (track, graph))
    assert np.sqrt(spread / exact) == pytest.approx(np.ones(len(track)), abs=0.25)
    assert np.abs(track.heading_rad - graph.heading_rad).max() < 0.5 * graph.sigma_heading_rad.max()
    assert track.length_scale == pytest.approx(graph.length_scale, abs=0.5 * graph.sigma_length_scale)
    assert track.kind == "smoothed"


def test_a_fix_with_a_wandering_error_moves_as_little_as_in_the_graph() -> None:
    wandering = PositionFix(
        30 * STEP_S, np.array([24.0, 3.0]), 0.1 * np.eye(2), "gps", sigma_wander_m=2.0, clock_known=True
    )
    walk = [*straight(30), wandering]
    start = StartPose((3.0, 0.0), 0.0, sigma_position_m=0.3, sigma_heading_rad=0.05)
    track, graph = particles(walk, start), smooth_as_given(walk, start)
    assert np.linalg.norm(track.position_m[-1] - graph.position_m[-1]) < 0.2
    assert 0.2 < track.position_m[-1, 1] < 2.0


def test_the_online_filter_is_the_kalman_filter() -> None:
    rng = np.random.default_rng(6)
    walk = with_near_fixes(simulate(rng, winding(40, rng), (3.0, -2.0, 0.5), fix_every=10, first_fix=10))
    own = estimator_named("particle", particle=MANY).begin([DEVICE], START, SIGMA_SCALE)  # type: ignore[attr-defined]
    poses = {}
    for one in sorted(walk.measurements, key=lambda m: m.time_s):  # type: ignore[union-attr]
        poses.update({pose.time_s: pose for pose in own.push(one)})
    poses.update({pose.time_s: pose for pose in own.flush()})
    filtered = run("ekf", walk.measurements, START)
    position = np.array([poses[time_s].position_m for time_s in filtered.time_s])
    spread = np.sqrt(np.trace(filtered.covariance_m2, axis1=1, axis2=2))
    assert (np.linalg.norm(position - filtered.position_m, axis=1) / spread).max() < 0.4


def test_an_unknown_direction_is_found_by_a_fix_and_by_north() -> None:
    start = StartPose((0.0, 0.0), None, sigma_position_m=0.3)
    by_fix = particles([*straight(30), fix(30, 0.0, 21.0)], start)
    by_north = particles([*straight(30), heading_prior(1, np.pi / 2.0)], start)
    for track in (by_fix, by_north):
        assert track.position_m[-1] == pytest.approx([0.0, 21.0], abs=1.0)
        assert track.heading_rad[-1] == pytest.approx(np.pi / 2.0, abs=0.1)


def test_a_start_is_found_from_fixes_on_the_way() -> None:
    track = particles([*straight(40), fix(10, 7.0, 5.0), fix(30, 21.0, 5.0)], StartPose())
    assert track.position_m[0] == pytest.approx([0.0, 5.0], abs=1.0)
    assert track.position_m[-1] == pytest.approx([28.0, 5.0], abs=1.0)


def test_of_two_turns_a_later_fix_chooses_one() -> None:
    turns = (TurnHypothesis(0.7, 0.0, 0.05, "straight"), TurnHypothesis(0.3, np.pi / 2.0, 0.05, "corner"))
    steps = [step(k) for k in range(1, 41)]
    mean, variance = 0.3 * np.pi / 2.0, 0.05**2 + 0.21 * (np.pi / 2.0) ** 2
    covariance = steps[20].covariance.copy()
    covariance[2, 2] = variance
    unsure = DeviceMeasurements(
        DEVICE, 0.0, (*steps[:20], _with_turns(steps[20], mean, covariance, turns), *steps[21:], fix(40, 14.0, 14.0))
    )
    track = estimate_walk("particle", [unsure], StartPose((0.0, 0.0), 0.0, 0.1, 0.02), SIGMA_SCALE)
    assert track.heading_rad[-1] == pytest.approx(np.pi / 2.0, abs=0.2)
    assert track.position_m[20] == pytest.approx([14.0, 0.0], abs=1.0)


def test_of_a_narrow_and_a_wide_turn_the_smoother_weighs_the_densities() -> None:
    """The heading after the turn is 0, and the heading before it follows from the two densities of the turn."""
    before_rad, narrow_rad, wide_rad = 0.3, 0.05, 0.6
    turns = (TurnHypothesis(0.5, 0.0, narrow_rad, "straight"), TurnHypothesis(0.5, 0.0, wide_rad, "any"))
    steps = [step(k) for k in range(1, 5)]
    covariance = steps[1].covariance.copy()
    covariance[2, 2] = 0.5 * (narrow_rad**2 + wide_rad**2)
    steps[1] = _with_turns(steps[1], 0.0, covariance, turns)
    start = StartPose((0.0, 0.0), 0.0, sigma_position_m=0.1, sigma_heading_rad=before_rad)
    track = particles([*steps, heading_prior(2, 0.0, 0.01)], start)
    variances = np.array([narrow_rad, wide_rad]) ** 2
    shares = 1.0 / np.sqrt(before_rad**2 + variances)
    expected = (shares / shares.sum()) @ (before_rad**2 * variances / (before_rad**2 + variances))
    assert track.sigma_heading_rad[1] == pytest.approx(np.sqrt(expected), rel=0.15)


def _with_turns(one: object, mean_rad: float, covariance: Array, turns: tuple[TurnHypothesis, ...]) -> object:
    return replace(one, heading_change_rad=mean_rad, covariance=covariance, turn_hypotheses=turns)  # type: ignore[type-var]


def test_tethered_devices_stay_together() -> None:
    devices = [
        DeviceMeasurements(name, 0.0, tuple(_named(name, k, drift) for k in range(1, 41)))
        for name, drift in (("left", 0.01), ("right", -0.01))
    ]
    tethers = [DeviceTether("left", "right", float(time_s), 0.5, 0.02) for time_s in range(1, 21)]
    start = StartPose((0.0, 0.0), 0.0, 0.1, 0.02)
    track = estimate_walk("particle", devices, start, SIGMA_SCALE, tethers)
    ends = [track.of_device(name).position_m[-1] for name in ("left", "right")]
    assert np.linalg.norm(ends[0] - ends[1]) < 0.6
    assert abs(ends[0][1]) < 1.5  # alone it would be 5 m to the left


def _named(name: str, k: int, drift_rad: float) -> object:
    return replace(step(k, turn_rad=drift_rad), device=name)


def test_equal_seeds_give_equal_tracks_and_other_seeds_others() -> None:
    walk = [*straight(20), fix(20, 13.0, 1.0)]
    one, same, other = (particles(walk, START, ParticleParams(seed=seed, most_particles=500)) for seed in (1, 1, 2))
    assert (one.position_m == same.position_m).all()
    assert (one.position_m != other.position_m).any()
