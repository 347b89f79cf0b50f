"""Fixes with a wandering error: graph and fixed-lag smoother against least squares with the correlated errors."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import (
    DEVICE,
    SIGMA_SCALE,
    STEP_S,
    SimulatedWalk,
    fix,
    heading_prior,
    run,
    simulate,
    straight,
    winding,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from least_squares import fix_covariance, solve, solve_linear

from pdr_est.estimators import estimate_walk
from pdr_est.estimators.common.timeline import build_timeline, timelines_of
from pdr_est.estimators.factor_graph.build import build_graph
from pdr_est.estimators.factor_graph.smoother import estimate
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.frames import Array
from pdr_est.types.measurements import DeviceMeasurements, Measurement, PositionFix, StartPose
from pdr_est.types.track import Track

EAST = StartPose((3.0, -2.0), 0.0, sigma_position_m=2.0)
STEPS = 40
ANISOTROPIC = np.array([[1.0, 0.4], [0.4, 0.5]])


def wandering(
    k: float, x_m: float, y_m: float, source: str = "gps", sigma_m: float = 3.0, time_s: float = 8.0
) -> PositionFix:
    return replace(fix(k, x_m, y_m, 0.7), source=source, sigma_wander_m=sigma_m, wander_time_s=time_s)


def walk_east(seed: int = 4) -> SimulatedWalk:
    covariance = np.diag([0.005, 0.004, 1e-8])
    return simulate(np.random.default_rng(seed), np.zeros(STEPS), (3.5, -2.5, 0.0), 1.1, covariance=covariance)


def many_fixes(walk: SimulatedWalk) -> list[PositionFix]:
    """Two wandering sources and surveyed points, before the walk, within steps, at the same time and after it."""
    places = np.concatenate([np.arange(-3.0, 0.0), np.arange(0.35, STEPS, 1.7), [STEPS, STEPS + 2.0, STEPS + 2.0]])
    near = [walk.truth[int(np.clip(k, 0, STEPS)), :2] for k in places]
    gps = [
        wandering(k, *(at + np.array([2.0, 1.0 + 1e-3 * i])), sigma_m=3.0 + 0.1 * k)  # no position comes twice
        for i, (k, at) in enumerate(zip(places, near, strict=True))
    ]
    gps[7] = replace(gps[7], covariance_m2=ANISOTROPIC)
    beacon = [wandering(k, 3.0 + 0.75 * k, -1.0, "beacon", 1.0, 30.0) for k in (4.0, 9.5, 30.0)]
    return [*gps, *beacon, fix(20.2, 17.0, -3.0, 0.4), fix(31.0, 25.0, -2.0, 0.5)]


def alone(measurements: Sequence[Measurement]) -> list[DeviceMeasurements]:
    return [DeviceMeasurements(DEVICE, 0.0, tuple(measurements))]


def smoothed(devices: Sequence[DeviceMeasurements], start: StartPose, sigma_scale: float) -> Track:
    """Smooth a walk with its fixes as they are, without a comparison with the steps."""
    return estimate(timelines_of(devices), [], start, sigma_scale)


@pytest.mark.parametrize("sigma_scale", [0.0, SIGMA_SCALE])
def test_the_graph_is_least_squares_with_correlated_errors(sigma_scale: float) -> None:
    walk = walk_east()
    measurements = [*walk.odometry, *many_fixes(walk)]
    timeline = build_timeline(DEVICE, 0.0, measurements)
    (position,), (covariance,), (log_scale,), of_scale = solve_linear([timeline], EAST, sigma_scale)
    track = smoothed(alone(measurements), EAST, sigma_scale)
    steps = [node.is_step for node in timeline.nodes]
    assert track.position_m == pytest.approx(position[steps], abs=2e-4)
    assert track.covariance_m2 == pytest.approx(covariance[steps], rel=1e-3, abs=2e-5)
    assert track.length_scale == pytest.approx(np.exp(log_scale), abs=1e-5)
    assert track.sigma_length_scale == pytest.approx(np.exp(log_scale) * np.sqrt(of_scale[0, 0]), abs=1e-5)


def test_with_turns_the_graph_is_dense_least_squares() -> None:
    rng = np.random.default_rng(7)
    start = StartPose((3.0, -2.0), 2.5, sigma_position_m=2.0, sigma_heading_rad=0.1)
    walk = simulate(rng, 2.0 * winding(24, rng), (3.0, -2.0, 2.6), 1.1)
    fixes = [
        wandering(k, *(walk.truth[k, :2] + np.array([1.5, -1.0]) + rng.normal(0, 0.5, 2))) for k in range(0, 25, 2)
    ]
    fixes[3] = replace(fixes[3], covariance_m2=ANISOTROPIC)
    measurements = [*walk.odometry, *fixes, heading_prior(20, walk.truth[20, 2] + 0.02)]
    track = smoothed(alone(measurements), start, SIGMA_SCALE)
    timeline = build_timeline(DEVICE, 0.0, measurements)
    guess = np.column_stack([track.position_m, track.heading_rad])
    mean, covariance = solve(timeline, start, SIGMA_SCALE, guess)
    poses = mean[:-1].reshape(-1, 3)
    assert track.position_m == pytest.approx(poses[:, :2], abs=2e-3)
    assert np.sin(track.heading_rad - poses[:, 2]) == pytest.approx(np.zeros(25), abs=2e-4)
    assert track.length_scale == pytest.approx(np.exp(mean[-1]), abs=1e-4)
    for k in range(25):
        expected = covariance[3 * k : 3 * k + 2, 3 * k : 3 * k + 2]
        assert np.linalg.norm(track.covariance_m2[k] - expected) < 0.01 * np.linalg.norm(expected)
        assert track.sigma_heading_rad[k] == pytest.approx(np.sqrt(covariance[3 * k + 2, 3 * k + 2]), rel=0.01)


def two_devices() -> list[DeviceMeasurements]:
    """Two phones of one walker, whose steps end at other times, with the same fixes."""
    first, second = walk_east(), walk_east(5)
    fixes = many_fixes(first)
    later = [replace(one, device="b", time_s=one.time_s + 0.2, start_s=one.start_s + 0.2) for one in second.odometry]
    return [
        DeviceMeasurements(DEVICE, 0.0, (*first.odometry, *fixes)),
        DeviceMeasurements("b", 0.0, (*later, *fixes)),
    ]


def test_a_wandering_error_is_common_to_two_devices() -> None:
    devices = two_devices()
    timelines = timelines_of(devices)
    positions, covariances, log_scales, _ = solve_linear(timelines, EAST, SIGMA_SCALE)
    track = smoothed(devices, EAST, SIGMA_SCALE)
    for timeline, position, covariance in zip(timelines, positions, covariances, strict=True):
        own, steps = track.of_device(timeline.device), [node.is_step for node in timeline.nodes]
        assert own.position_m == pytest.approx(position[steps], abs=5e-4)
        assert own.covariance_m2 == pytest.approx(covariance[steps], rel=1e-3, abs=5e-5)
    alone = run("factor-graph", devices[0].measurements, EAST)
    assert np.exp(log_scales[0]) != pytest.approx(alone.length_scale, abs=1e-4)


def lagged(devices: Sequence[DeviceMeasurements], lag_s: float, sigma_scale: float = 0.0) -> Track:
    return estimate_walk("fixed-lag", devices, EAST, sigma_scale, fixed_lag=FixedLagParams(lag_s=lag_s))


def test_a_lag_longer_than_the_walk_gives_the_batch_graph() -> None:
    walk = walk_east()
    devices = [DeviceMeasurements(DEVICE, 0.0, (*walk.odometry, *many_fixes(walk)[3:]))]
    late, whole = lagged(devices, 60.0), smoothed(devices, EAST, 0.0)
    assert late.position_m == pytest.approx(whole.position_m, abs=1e-3)
    assert late.covariance_m2 == pytest.approx(whole.covariance_m2, rel=1e-3, abs=1e-4)


CORNERS = st.tuples(st.floats(-60.0, 60.0), st.floats(-60.0, 60.0))


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(st.lists(st.tuples(st.floats(0.0, 30.0), CORNERS), min_size=2, max_size=12), st.sampled_from([0.0, 4.0, 15.0]))
def test_contradicting_fixes_leave_a_positive_finite_scale(
    given_fixes: list[tuple[float, tuple[float, float]]], sigma_wander_m: float
) -> None:
    fixes: list[Measurement] = [
        replace(wandering(k, *at, sigma_m=sigma_wander_m), robust=True) for k, at in given_fixes
    ]
    track = run("factor-graph", [*straight(30), *fixes], StartPose(), 0.06)
    assert 0.0 < track.length_scale < 5.0
    assert 0.0 < track.sigma_length_scale < np.inf
    for values in (track.position_m, track.covariance_m2, track.sigma_heading_rad):
        assert np.isfinite(values).all()


def wandering_walk(
    rng: np.random.Generator, count: int, sigma_m: float, time_s: float
) -> tuple[SimulatedWalk, Array]:
    """A walk, and the wandering errors (n, 2) of fixes at every other step."""
    walk = simulate(rng, winding(count, rng), (0.0, 0.0, 0.0))
    kept = np.exp(-2.0 * STEP_S / time_s)
    errors = [rng.standard_normal(2)]
    for _ in range(2, count, 2):
        errors.append(kept * errors[-1] + np.sqrt(1.0 - kept**2) * rng.standard_normal(2))
    return walk, sigma_m * np.array(errors)


@pytest.mark.parametrize(
    ("walks", "steps"), [(2, 120), pytest.param(8, 300, marks=pytest.mark.slow)], ids=["sample", "all"]
)
def test_covariances_are_true_where_fixes_wander(walks: int, steps: int) -> None:
    """And far too small if the errors are taken for independent ones."""
    rng = np.random.default_rng(8)
    squared: dict[float, list[float]] = {4.0: [], 0.0: []}
    for _ in range(walks):
        walk, errors = wandering_walk(rng, steps, 4.0, 30.0)
        places = [walk.truth[2 * i, :2] + off for i, off in enumerate(errors + rng.standard_normal(errors.shape))]
        for sigma_m, found in squared.items():
            fixes = [
                replace(wandering(2 * i, *at, sigma_m=sigma_m, time_s=30.0), covariance_m2=np.eye(2))
                for i, at in enumerate(places)
            ]
            track = run("factor-graph", [*walk.odometry, *fixes], StartPose(), 0.05)
            error = track.position_m - walk.truth[:, :2]
            found += np.einsum(
                "ni,ni->n", error, np.linalg.solve(track.covariance_m2, error[..., None])[..., 0]
            ).tolist()
    assert 0.4 < np.mean(squared[4.0]) / 2.0 < 2.0
    assert np.mean(squared[0.0]) / 2.0 > 5.0


def test_what_leaves_the_window_is_remembered_by_what_stays() -> None:
    """On a linear walk the last pose is that of the batch graph, however short the lag."""
    walk = walk_east()
    devices = [DeviceMeasurements(DEVICE, 0.0, (*walk.odometry, *many_fixes(walk)[3:]))]
    late, whole = lagged(devices, 3.0), smoothed(devices, EAST, 0.0)
    assert late.position_m[-1] == pytest.approx(whole.position_m[-1], abs=1e-3)
    assert late.covariance_m2[-1] == pytest.approx(whole.covariance_m2[-1], rel=1e-3, abs=1e-4)
    assert np.abs(late.position_m[10] - whole.position_m[10]).max() > 0.02  # not there: later fixes are unknown


def test_a_window_that_is_built_anew_knows_the_wandering_errors_of_the_filter() -> None:
    """The window is built anew whenever the filter learns the length scale; the filter itself is linear nearly."""
    walk = walk_east()
    devices = [DeviceMeasurements(DEVICE, 0.0, (*walk.odometry, *many_fixes(walk)[3:]))]
    late, filtered = lagged(devices, 3.0, 0.05), estimate_walk("ekf", devices, EAST, 0.05)
    assert late.position_m[-1] == pytest.approx(filtered.position_m[-1], abs=0.1)
    assert late.covariance_m2[-1] == pytest.approx(filtered.covariance_m2[-1], rel=0.05, abs=0.01)


def test_two_devices_share_the_wandering_error_in_the_window() -> None:
    before = {one.time_s for one in many_fixes(walk_east())[:4]}  # with which the devices enter one by one
    devices = [
        replace(one, measurements=tuple(m for m in one.measurements if m.time_s not in before))  # type: ignore[union-attr]
        for one in two_devices()
    ]
    late, whole = lagged(devices, 60.0), smoothed(devices, EAST, 0.0)
    for name in (DEVICE, "b"):
        one, other = late.of_device(name), whole.of_device(name)
        assert one.position_m == pytest.approx(other.position_m, abs=0.02)
        assert one.covariance_m2 == pytest.approx(other.covariance_m2, rel=0.02, abs=1e-3)


@pytest.mark.parametrize("sigma_scale", [0.0, SIGMA_SCALE])
def test_leave_one_out_residuals_are_those_of_the_other_measurements(sigma_scale: float) -> None:
    """Dense: the fixes are jointly normal, and each is conditioned on all others."""
    walk = walk_east()
    fixes = many_fixes(walk)
    built = build_graph([*walk.odometry, *fixes], start=EAST, sigma_length_scale=sigma_scale, optimised=True)
    found = built.left_out_fixes()
    assert sorted(one.fix.time_s for one in found) == sorted(one.time_s for one in fixes)
    nodes = build_timeline(DEVICE, 0.0, [*walk.odometry, *fixes]).nodes
    length_m = np.cumsum([node.length_m for node in nodes])
    scale = built.length_scales[0]
    spread = np.cumsum([node.covariance[:2, :2] for node in nodes], axis=0) + 4.0 * np.eye(2)
    known = [one.fix for one in found]
    rows = [one.key for one in found]
    # Linear about the scale that was found: the prior of its logarithm is log_scale below its value.
    expected = np.array([[3.0 + scale * (1.0 - np.log(scale)) * length_m[i], -2.0] for i in rows])
    covariance = fix_covariance(known)
    for a, i in enumerate(rows):
        for b, j in enumerate(rows):
            block = spread[min(i, j)].copy()
            block[0, 0] += (sigma_scale * scale) ** 2 * length_m[i] * length_m[j]
            covariance[2 * a : 2 * a + 2, 2 * b : 2 * b + 2] += block
    off = np.concatenate([one.position_m for one in known]) - expected.ravel()
    for a, one in enumerate(found):
        own = np.array([2 * a, 2 * a + 1])
        others = np.delete(np.arange(len(off)), own)
        gain = np.linalg.solve(covariance[np.ix_(others, others)], covariance[np.ix_(others, own)]).T
        assert one.residual_m == pytest.approx(off[own] - gain @ off[others], abs=2e-3)
        conditional = covariance[np.ix_(own, own)] - gain @ covariance[np.ix_(others, own)]
        assert one.covariance_m2 == pytest.approx(conditional, rel=2e-3, abs=1e-3)


def test_a_gross_outlier_stands_out_among_wandering_fixes() -> None:
    rng = np.random.default_rng(3)
    walk, errors = wandering_walk(rng, 100, 4.0, 60.0)
    places = [walk.truth[2 * i, :2] + off + 0.5 * rng.standard_normal(2) for i, off in enumerate(errors)]
    places[20] = places[20] + 6.0
    fixes = [replace(wandering(2 * i, *at, sigma_m=4.0, time_s=60.0), robust=True) for i, at in enumerate(places)]
    found = build_graph([*walk.odometry, *fixes], sigma_length_scale=0.05, optimised=True).left_out_fixes()
    squared = [one.residual_m @ np.linalg.solve(one.covariance_m2, one.residual_m) for one in found]
    assert np.argmax(squared) == 20
    assert squared[20] > 25.0
    assert np.mean(np.delete(squared, 20)) == pytest.approx(2.0, abs=0.8)
