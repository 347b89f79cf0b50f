"""`map-closed-form` and `map-general` on whole walks: distances, variants, pairing in time, honest covariances."""

from collections.abc import Callable, Sequence
from functools import cache
from itertools import combinations

import numpy as np
import pytest

from pdr_est.errors import EstimationError
from pdr_est.estimators import dead_reckoning
from pdr_est.estimators.common.timeline import Timeline, build_timeline
from pdr_est.estimators.robust_dr.fusion import estimate_closed_form, estimate_general
from pdr_est.estimators.robust_dr.params import MapFusionParams
from pdr_est.evaluate.consistency import coverage95, nees_mean
from pdr_est.frames import Array
from pdr_est.types.measurements import DeviceTether, PositionFix, StartPose, StepOdometry
from pdr_est.types.track import Track

LIMIT_M = 0.15
STEP_S, STEP_M = 0.5, 0.7
ORIGIN = StartPose((0.0, 0.0), 0.0)
ESTIMATORS = [estimate_closed_form, estimate_general]
Estimate = Callable[[Sequence[Timeline], Sequence[DeviceTether], StartPose, float, MapFusionParams], Track]

both = pytest.mark.parametrize("estimate", ESTIMATORS)
variants = pytest.mark.parametrize("feedback", [False, True])


def tethers(*devices: str, limit_m: float = LIMIT_M) -> list[DeviceTether]:
    return [DeviceTether(a, b, 0.0, limit_m, 0.05) for a, b in combinations(devices, 2)]


def odometry(
    device: str,
    headings: Array,
    rng: np.random.Generator,
    sigma_rad: float,
    scale: float = 1.0,
    late_s: float = 0.0,
    bias_rad: float = 0.0,
    claimed_rad: float | None = None,
) -> list[StepOdometry]:
    """What a device measures of a walk with true directions headings (k,), its first pose towards the east.

    Directions are wrong by a random walk of sigma_rad a step and turn by bias_rad a step, lengths by 0.05 m; the
    walker's steps are `scale` times what is measured. claimed_rad: what the device says of sigma_rad.
    """
    turns = np.diff(headings, prepend=0.0)
    covariance = np.diag([0.05**2, 0.0, 0.0])
    claimed = sigma_rad if claimed_rad is None else claimed_rad
    covariance[1:, 1:] = claimed**2 * np.outer([STEP_M, 1.0], [STEP_M, 1.0]) + 1e-8 * np.eye(2)
    steps = []
    for k, turn in enumerate(turns, 1):
        error = sigma_rad * rng.standard_normal()
        length = (STEP_M * np.cos(error) - 0.05 * rng.standard_normal()) / scale
        times = STEP_S * k + late_s, STEP_S * (k - 1) + late_s
        steps.append(StepOdometry(device, *times, float(length), float(turn - error + bias_rad), covariance))
    return steps


def winding(count: int) -> Array:
    return np.asarray(0.8 * np.sin(np.arange(1, count + 1) / 12.0))


def truth(headings: Array) -> Array:
    legs = STEP_M * np.stack([np.cos(headings), np.sin(headings)], axis=1)
    return np.concatenate([np.zeros((1, 2)), np.cumsum(legs, axis=0)])


def phones(
    seed: int, count: int = 40, late_s: float = 0.0, sigmas: tuple[float, ...] = (0.02, 0.06)
) -> list[Timeline]:
    rng = np.random.default_rng(seed)
    return [
        build_timeline(f"phone{i}", 0.0, odometry(f"phone{i}", winding(count), rng, sigma, late_s=i * late_s))
        for i, sigma in enumerate(sigmas)
    ]


def distances(track: Track, one: str, other: str) -> Array:
    """At the times of both devices' poses, for devices that step at once."""
    a, b = track.of_device(one), track.of_device(other)
    np.testing.assert_array_equal(a.time_s, b.time_s)
    return np.asarray(np.hypot(*(a.position_m - b.position_m).T))


@both
@variants
@pytest.mark.parametrize("sigmas", [(0.02, 0.06), (0.02, 0.04, 0.08), (0.02, 0.02, 0.05, 0.1)])
def test_devices_are_never_farther_apart_than_the_tether(
    estimate: Estimate, feedback: bool, sigmas: tuple[float, ...]
) -> None:
    lines = phones(1, sigmas=sigmas)
    names = [line.device for line in lines]
    track = estimate(lines, tethers(*names), ORIGIN, 0.1, MapFusionParams(feedback=feedback))
    assert track.devices == tuple(names)
    assert track.kind == "filtered"
    apart = [distances(track, one, other).max() for one, other in combinations(names, 2)]
    assert max(apart) == pytest.approx(LIMIT_M, rel=1e-9)  # taut somewhere, and nowhere torn


@both
@variants
def test_devices_that_agree_are_left_alone(estimate: Estimate, feedback: bool) -> None:
    lines = phones(2)
    track = estimate(lines, tethers("phone0", "phone1", limit_m=1e3), ORIGIN, 0.1, MapFusionParams(feedback=feedback))
    for line in lines:
        alone = dead_reckoning.estimate(line, ORIGIN, 0.1)
        np.testing.assert_array_equal(track.of_device(line.device).position_m, alone.position_m)
        np.testing.assert_array_equal(track.of_device(line.device).heading_rad, alone.heading_rad)


@both
def test_without_a_tether_every_device_dead_reckons(estimate: Estimate) -> None:
    lines = phones(2)
    track = estimate(lines, [], ORIGIN, 0.1, MapFusionParams(feedback=True))
    alone = dead_reckoning.estimate(lines[1], ORIGIN, 0.1)
    np.testing.assert_array_equal(track.of_device("phone1").position_m, alone.position_m)
    np.testing.assert_array_equal(track.of_device("phone1").covariance_m2, alone.covariance_m2)


def test_opposite_biases_cancel() -> None:
    """The first regime of the paper's section V-D: both phones gain."""
    headings, rng = np.zeros(60), np.random.default_rng(0)
    lines = [
        build_timeline(name, 0.0, odometry(name, headings, rng, 1e-3, bias_rad=bias, claimed_rad=0.03))
        for name, bias in (("left", 0.004), ("right", -0.004))
    ]
    for estimate in ESTIMATORS:
        track = estimate(lines, tethers("left", "right"), ORIGIN, 0.05, MapFusionParams())
        for line in lines:
            fused, alone = track.of_device(line.device), dead_reckoning.estimate(line, ORIGIN, 0.05)
            before, after = (np.hypot(*(t.position_m - truth(headings)).T).mean() for t in (alone, fused))
            assert after < 0.3 * before


def test_closed_form_keeps_the_middle_whether_fed_back_or_not() -> None:
    lines = phones(3)
    middles = []
    for feedback in (False, True):
        track = estimate_closed_form(
            lines, tethers("phone0", "phone1"), ORIGIN, 0.1, MapFusionParams(feedback=feedback)
        )
        middles.append(0.5 * (track.of_device("phone0").position_m + track.of_device("phone1").position_m))
    np.testing.assert_allclose(middles[0], middles[1], atol=1e-9)
    alone = [dead_reckoning.estimate(line, ORIGIN, 0.1).position_m for line in lines]
    np.testing.assert_allclose(middles[0], 0.5 * (alone[0] + alone[1]), atol=1e-9)


@both
def test_feedback_changes_where_reckoning_goes_on(estimate: Estimate) -> None:
    """Biases that come and go: without feedback the devices part for good, with it they may come close again."""
    rng, headings = np.random.default_rng(0), np.zeros(40)
    lines = []
    for name, sign in (("left", 1.0), ("right", -1.0)):
        steps = odometry(name, headings + sign * 0.3 * (np.arange(40) < 15), rng, 1e-3, claimed_rad=0.05)
        lines.append(build_timeline(name, 0.0, steps))
    apart = {}
    for feedback in (False, True):
        track = estimate(lines, tethers("left", "right"), ORIGIN, 0.05, MapFusionParams(feedback=feedback))
        left, right = track.of_device("left").position_m, track.of_device("right").position_m
        apart[feedback] = right - left
        assert np.hypot(*(left + right).T / 2.0 - truth(headings * 0.0).T)[-1] < 2.0
    # Without feedback every pose is fused from the devices' own reckoning, metres apart to the north.
    np.testing.assert_allclose(apart[False][-1], [0.0, -LIMIT_M], atol=0.1)
    assert np.hypot(*apart[True][-1]) <= LIMIT_M * (1.0 + 1e-9)
    assert not np.allclose(apart[True][-1], apart[False][-1], atol=1e-6)


def test_general_trusts_the_better_phone() -> None:
    lines = phones(4, sigmas=(0.005, 0.15))
    track = estimate_general(lines, tethers("phone0", "phone1"), ORIGIN, 0.0, MapFusionParams())
    good = dead_reckoning.estimate(lines[0], ORIGIN, 0.0).position_m
    assert np.hypot(*(track.of_device("phone0").position_m - good).T).max() < 0.3
    bad = dead_reckoning.estimate(lines[1], ORIGIN, 0.0).position_m
    assert np.hypot(*(track.of_device("phone1").position_m - bad).T).max() > 1.0


@both
@variants
def test_steps_at_different_times_are_not_taken_for_a_distance(estimate: Estimate, feedback: bool) -> None:
    """Perfect phones, one of which notices each step 0.1 s later: 0.14 m apart on a walk that is 28 m long."""
    rng = np.random.default_rng(0)
    lines = [
        build_timeline(name, 0.0, odometry(name, np.zeros(40), rng, 1e-6, late_s=late))
        for name, late in (("prompt", 0.0), ("late", 0.1))
    ]
    track = estimate(lines, tethers("prompt", "late", limit_m=0.5), ORIGIN, 0.05, MapFusionParams(feedback=feedback))
    for line in lines:
        alone = dead_reckoning.estimate(line, ORIGIN, 0.05)
        np.testing.assert_allclose(track.of_device(line.device).position_m, alone.position_m, atol=1e-9)


@both
@variants
def test_a_device_that_stopped_recording_does_not_hold_the_other(estimate: Estimate, feedback: bool) -> None:
    rng = np.random.default_rng(0)
    lines = [
        build_timeline(name, 0.0, odometry(name, np.zeros(count), rng, 1e-3))
        for name, count in (("all", 60), ("half", 30))
    ]
    track = estimate(lines, tethers("all", "half"), ORIGIN, 0.05, MapFusionParams(feedback=feedback))
    assert track.of_device("all").position_m[-1, 0] == pytest.approx(60 * STEP_M, abs=2.0)
    assert len(track.of_device("half")) == 31


@both
def test_the_start_may_be_found_by_fixes(estimate: Estimate) -> None:
    rng, headings = np.random.default_rng(5), winding(40)
    places = truth(headings)
    fixes = [PositionFix(STEP_S * k, places[k], 0.01 * np.eye(2)) for k in (0, 20, 40)]
    lines = [build_timeline(name, 0.0, [*odometry(name, headings, rng, 0.02), *fixes]) for name in ("a", "b")]
    track = estimate(lines, tethers("a", "b"), StartPose(), 0.1, MapFusionParams())
    assert distances(track, "a", "b").max() <= LIMIT_M * (1.0 + 1e-9)
    for name in ("a", "b"):
        fused = track.of_device(name)
        assert coverage95(fused.position_m - places, fused.covariance_m2, 0.0) > 0.9


@cache
def errors(estimate: Estimate, feedback: bool, sigmas: tuple[float, ...], trials: int) -> tuple[Array, Array]:
    """Errors (trials, steps, 2) and covariances of the first device; the walker's scale is common to all."""
    rng, headings = np.random.default_rng(6), winding(40)
    names = [f"phone{i}" for i in range(len(sigmas))]
    error, covariance = [], []
    for _ in range(trials):
        scale = 1.0 + 0.1 * rng.standard_normal()
        lines = [
            build_timeline(name, 0.0, odometry(name, headings, rng, sigma, scale))
            for name, sigma in zip(names, sigmas, strict=True)
        ]
        track = estimate(lines, tethers(*names), ORIGIN, 0.1, MapFusionParams(feedback=feedback)).of_device(names[0])
        error.append(track.position_m - truth(headings))
        covariance.append(track.covariance_m2)
    return np.array(error), np.array(covariance)


@both
@variants
@pytest.mark.parametrize(
    ("sigmas", "trials"),
    [
        ((0.06, 0.02), 30),
        pytest.param((0.03, 0.03), 60, marks=pytest.mark.slow),
        pytest.param((0.02, 0.06), 60, marks=pytest.mark.slow),
        pytest.param((0.06, 0.02), 60, marks=pytest.mark.slow),
        pytest.param((0.03, 0.03, 0.06), 60, marks=pytest.mark.slow),
    ],
)
def test_covariances_are_honest(estimate: Estimate, feedback: bool, sigmas: tuple[float, ...], trials: int) -> None:
    error, covariance = errors(estimate, feedback, sigmas, trials)
    assert coverage95(error[:, 10:].reshape(-1, 2), covariance[:, 10:].reshape(-1, 2, 2), 0.0) >= 0.91
    for step in (20, 40):  # neither too small nor far too large: two degrees of freedom
        assert 1.2 < nees_mean(error[:, step], covariance[:, step], 0.0) < 2.8


def test_fusion_of_equal_phones_gains_only_what_is_independent() -> None:
    lines = phones(7, sigmas=(0.01, 0.01))
    for scale_sigma, least, most in ((0.0, 0.45, 0.6), (0.5, 0.8, 1.0)):
        track = estimate_general(lines, tethers("phone0", "phone1"), ORIGIN, scale_sigma, MapFusionParams())
        fused = np.trace(track.of_device("phone0").covariance_m2[-1])
        alone = np.trace(dead_reckoning.estimate(lines[0], ORIGIN, scale_sigma).covariance_m2[-1])
        assert least < fused / alone < most


@both
def test_unusable_devices_and_tethers_are_refused(estimate: Estimate) -> None:
    lines, parameters = phones(0, count=3), MapFusionParams()
    with pytest.raises(EstimationError, match="at least one"):
        estimate([], [], ORIGIN, 0.1, parameters)
    with pytest.raises(EstimationError, match="name of its own"):
        estimate([lines[0], lines[0]], [], ORIGIN, 0.1, parameters)
    with pytest.raises(EstimationError, match="'watch'"):
        estimate(lines, tethers("phone0", "watch"), ORIGIN, 0.1, parameters)
    with pytest.raises(EstimationError, match="'phone0' and 'phone0'"):
        estimate(lines, tethers("phone0", "phone0"), ORIGIN, 0.1, parameters)
