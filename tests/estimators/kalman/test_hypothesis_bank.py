"""Bank of hypotheses: Bayes' rule, moments, mergers, and walks with several possible headings."""

import pickle
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import DEVICE, fix, heading_prior, simulate, straight
from heading_grid import posterior_of
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import multivariate_normal, norm

from pdr_est.estimators.common.motion_model import SOURCE_STATES, STATES, GaussianState
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.estimators.kalman.filterpy_ekf import MultiDeviceEkf
from pdr_est.estimators.kalman.hypothesis_bank import MOST_HYPOTHESES, HypothesisBank
from pdr_est.estimators.kalman.offline_filter import FilteredSegment, run_filter
from pdr_est.frames import SIGMA_UNIFORM_RAD, Array, wrap_angle
from pdr_est.types.measurements import HeadingPrior, Measurement, PositionFix, StartPose, TurnHypothesis
from pdr_est.types.steps import CarryingMode

EXACT = np.diag([0.01, 0.01, 0.0])  # isotropic noise, exact turns
KNOWN = StartPose((0.0, 0.0), 0.0, 0.1, 0.05)
CORNER = (TurnHypothesis(0.6, 0.0, 0.05, "straight on"), TurnHypothesis(0.4, np.pi / 2, 0.05, "corner"))


def node(
    fixes: Sequence[PositionFix] = (),
    priors: Sequence[HeadingPrior] = (),
    turns: Sequence[TurnHypothesis] = (),
    turn_rad: float = 0.1,
    covariance: Array = EXACT,
) -> Node:
    return Node(
        0.5,
        0.0,
        0.7,
        turn_rad,
        covariance,
        True,
        0.7,
        CarryingMode.UNKNOWN,
        tuple(fixes),
        tuple(priors),
        tuple(turns),
    )


def state(
    east_m: float = 0.0, heading_rad: float = 0.3, sigma_rad: float = 0.05, sigma_scale: float = 0.05
) -> GaussianState:
    sigma = np.array([0.5, 0.8, sigma_rad, sigma_scale, 0.3])
    return GaussianState(np.array([east_m, -1.0, heading_rad, 0.02, 0.1]), np.diag(sigma**2))


def bank_of(states: Sequence[GaussianState], weights: Sequence[float]) -> HypothesisBank:
    means = np.array([one.mean for one in states])
    lineages = tuple(((3, i),) for i in range(len(states)))
    return HypothesisBank(np.array(weights), means, np.array([one.covariance for one in states]), (), lineages)


def mixture_moments(weights: Array, means: Array, covariances: Array) -> tuple[Array, Array]:
    """Mean and covariance by the definition, of states whose headings are far from the cut at half a turn."""
    mean = sum(w * m for w, m in zip(weights, means, strict=True))
    second = sum(w * (c + np.outer(m, m)) for w, m, c in zip(weights, means, covariances, strict=True))
    return np.asarray(mean), np.asarray(second - np.outer(mean, mean))


def test_one_hypothesis_is_the_extended_kalman_filter() -> None:
    """But for fixes, whose update knows that tracks turn; a track of a known heading and scale is linear."""
    known = state(sigma_rad=1e-6, sigma_scale=1e-6)
    bank, ekf = HypothesisBank.of_state(known), MultiDeviceEkf()
    ekf.load(known)
    nodes = [
        node(turn_rad=0.2),
        node([fix(1, 2.0, 0.0), fix(1, 1.0, -1.0, robust=True)]),
        node(priors=[heading_prior(1, 0.4, 1e-6), replace(heading_prior(1, 0.2, 1e-6), relative=True)]),
    ]
    for number, one in enumerate(nodes):
        bank = bank.predicted(one, number).updated(one)
        ekf.predict_node(one)
        ekf.update_node(one)
    expected = ekf.state_of()
    assert bank.moments().mean == pytest.approx(expected.mean, abs=1e-6)
    assert bank.moments().covariance == pytest.approx(expected.covariance, abs=1e-6)


@pytest.mark.parametrize("relative", [False, True])
@pytest.mark.parametrize("robust", [False, True])
def test_a_heading_prior_updates_each_hypothesis_like_the_filter(relative: bool, robust: bool) -> None:
    """The states are as wide as a corner."""
    prior = replace(heading_prior(1, 0.9, 0.1, robust), relative=relative)
    ekf = MultiDeviceEkf()
    ekf.load(state(sigma_rad=0.5))
    ekf.update_heading(prior)
    found = HypothesisBank.of_state(state(sigma_rad=0.5)).updated(node(priors=[prior])).moments()
    assert found.mean == pytest.approx(ekf.state_of().mean, abs=1e-12)
    assert found.covariance == pytest.approx(ekf.state_of().covariance, abs=1e-12)


def test_weights_follow_bayes_rule() -> None:
    """Three hypotheses that are far from each other; a heading, then a position."""
    states = [state(0.0, -0.5, 0.2), state(3.0, 0.3, 0.2), state(0.0, 1.2, 0.2)]
    weights = np.array([0.5, 0.2, 0.3])
    after_heading = bank_of(states, list(weights)).updated(node(priors=[heading_prior(1, 0.4, 0.4)]))
    density = [norm.pdf(0.4, one.mean[2], np.hypot(0.2, 0.4)) for one in states]
    assert after_heading.weights == pytest.approx(weights * density / (weights @ density), rel=1e-9)
    exact = [replace(one, covariance=np.diag([0.25, 0.64, 1e-12, 1e-12, 0.1])) for one in states]
    position = PositionFix(0.5, np.array([1.2, -0.7]), np.array([[0.5, 0.2], [0.2, 0.4]]))
    after_fix = bank_of(exact, list(weights)).updated(node([position]))
    density = [
        multivariate_normal.pdf(position.position_m, one.mean[:2], one.covariance[:2, :2] + position.covariance_m2)
        for one in exact
    ]
    assert after_fix.weights == pytest.approx(weights * density / (weights @ density), rel=1e-5)


def test_moments_are_those_of_the_mixture() -> None:
    states = [state(0.0, -0.5), state(3.0, 0.3), state(-1.0, 1.2)]
    found = bank_of(states, [0.5, 0.2, 0.3]).moments()
    mean, covariance = mixture_moments(
        np.array([0.5, 0.2, 0.3]), np.array([s.mean for s in states]), np.array([s.covariance for s in states])
    )
    # The mean of angles is taken about their mean direction, where nothing is cut off.
    assert found.mean == pytest.approx(mean, abs=1e-12)
    assert found.covariance == pytest.approx(covariance, abs=1e-12)


@given(st.floats(-20.0, 20.0))
def test_moments_turn_with_the_map(turn_rad: float) -> None:
    """Where headings are cut makes no difference."""
    states = [state(0.0, -0.5), state(3.0, 0.3), state(-1.0, 1.2)]
    turned = [replace(one, mean=one.mean.copy()) for one in states]
    for one in turned:
        one.mean[2] = wrap_angle(one.mean[2] + turn_rad)
    one, other = (bank_of(some, [0.5, 0.2, 0.3]).moments() for some in (states, turned))
    assert wrap_angle(other.mean[2] - one.mean[2] - turn_rad) == pytest.approx(0.0, abs=1e-9)
    assert other.covariance == pytest.approx(one.covariance, abs=1e-9)


def test_an_unknown_heading_is_uniform() -> None:
    bank = HypothesisBank.of_unknown_heading(state())
    moments = bank.moments()
    assert np.sqrt(moments.covariance[2, 2]) == pytest.approx(SIGMA_UNIFORM_RAD, rel=0.01)
    assert moments.covariance[2, [0, 1, 3, 4]] == pytest.approx(np.zeros(4), abs=1e-12)
    assert moments.mean[[0, 1, 3, 4]] == pytest.approx(state().mean[[0, 1, 3, 4]], abs=1e-12)
    at = np.linspace(-np.pi, np.pi, 1000)
    off = wrap_angle(at[:, None] - bank.means[:, 2])
    density = norm.pdf(off, scale=np.sqrt(bank.covariances[:, 2, 2])) @ bank.weights
    assert density == pytest.approx(1.0 / (2.0 * np.pi), rel=2e-3)


def test_a_walk_in_an_unknown_direction_ends_anywhere_on_a_circle() -> None:
    bank = HypothesisBank.of_unknown_heading(replace(state(), covariance=np.diag([0.25, 0.25, 1.0, 0.0, 0.0])))
    for number in range(30):
        bank = bank.predicted(node(turn_rad=0.0), number)
    radius_m = 30 * 0.7 * np.exp(0.02)
    moments = bank.moments()
    assert moments.mean[:2] == pytest.approx([0.0, -1.0], abs=0.02 * radius_m)
    # A hypothesis covers a sector of 8° by the tangent of its arc, which adds 2 %.
    expected = (0.25 + 30 * 0.01 + 0.5 * radius_m**2) * np.eye(2)
    assert moments.covariance[:2, :2] == pytest.approx(expected, rel=0.03, abs=0.02 * radius_m**2)


def test_a_turn_splits_each_hypothesis() -> None:
    bank = bank_of([state(0.0, 0.0), state(20.0, 2.0)], [0.7, 0.3])
    after = bank.predicted(node(turns=CORNER), 9)
    assert sorted(after.weights) == pytest.approx(sorted([0.42, 0.28, 0.18, 0.12]))
    assert sorted(after.lineages) == [((3, i), (9, j)) for i in (0, 1) for j in (0, 1)]
    for mean, lineage in zip(after.means, after.lineages, strict=True):
        (_, parent), (_, chosen) = lineage
        assert mean[2] == pytest.approx(2.0 * parent + chosen * np.pi / 2)


def test_a_turn_with_hypotheses_has_the_covariance_of_their_mixture() -> None:
    before = state(0.0, 0.0)
    after = HypothesisBank.of_state(before).predicted(node(turns=CORNER), 1).moments()
    each = []
    for turn in CORNER:
        ekf = MultiDeviceEkf()
        ekf.load(before)
        ekf.predict_node(node(turn_rad=turn.heading_change_rad, covariance=np.diag([0.01, 0.01, turn.sigma_rad**2])))
        each.append(ekf.state_of())
    mean, covariance = mixture_moments(
        np.array([0.6, 0.4]), np.array([s.mean for s in each]), np.array([s.covariance for s in each])
    )
    assert after.mean == pytest.approx(mean, abs=1e-12)
    assert after.covariance == pytest.approx(covariance, abs=1e-12)


@pytest.mark.parametrize("apart_rad", [0.0, 0.005])
def test_hypotheses_that_are_alike_are_merged_without_loss(apart_rad: float) -> None:
    bank = bank_of([state(0.0, 3.1), state(0.02, 3.1 + apart_rad - 2.0 * np.pi), state(30.0, 1.0)], [0.4, 0.1, 0.5])
    before, merged = bank.moments(), bank.updated(node(priors=[heading_prior(1, 0.0, 1e4)]))
    assert len(merged) == 2
    assert sorted(merged.lineages) == [((3, 0),), ((3, 2),)]  # of the more probable part
    assert merged.moments().mean == pytest.approx(before.mean, abs=1e-6)
    assert merged.moments().covariance == pytest.approx(before.covariance, abs=1e-6)


def test_improbable_hypotheses_are_dropped() -> None:
    bank = bank_of([state(0.0, 0.0), state(0.0, 3.0)], [0.5, 0.5]).updated(node(priors=[heading_prior(1, 0.0, 0.1)]))
    assert len(bank) == 1
    assert bank.lineages == (((3, 0),),)
    assert bank.weights == pytest.approx([1.0])


def last(measurements: Sequence[Measurement], start: StartPose, sigma_scale: float = 0.1) -> FilteredSegment:
    return run_filter(build_timeline(DEVICE, 0.0, measurements), start, sigma_scale)[-1]


def around_a_corner(*fixes: PositionFix) -> list[Measurement]:
    """Twenty steps; before the eleventh the phone was put elsewhere."""
    steps = straight(20, 0.7, np.diag([0.005, 0.005, 1e-4]))
    steps[10] = replace(steps[10], turn_hypotheses=CORNER, covariance=np.diag([0.005, 0.005, 0.6]))
    return [*steps, *fixes]


def test_until_a_turn_is_decided_the_covariance_covers_its_hypotheses() -> None:
    end = last(around_a_corner(), KNOWN)
    assert end.bank is not None
    assert sorted(end.bank.weights) == pytest.approx([0.4, 0.6])
    for place in ((14.0, 0.0), (7.0, 7.0)):
        off = np.array(place) - end.end.mean[:2]
        assert off @ np.linalg.solve(end.end.covariance[:2, :2], off) < 5.99
    assert end.end.mean[:2] == pytest.approx(0.6 * np.array([14.0, 0.0]) + 0.4 * np.array([7.0, 7.0]), abs=0.1)


@pytest.mark.parametrize("truth", [(14.0, 0.0), (7.0, 7.0)])
def test_a_fix_decides_for_the_right_turn(truth: tuple[float, float]) -> None:
    end = last(around_a_corner(fix(20, *truth, sigma_m=0.5)), KNOWN)
    assert end.bank is None
    assert np.hypot(*(end.end.mean[:2] - truth)) < 0.3
    assert end.end.mean[2] == pytest.approx(0.0 if truth[1] == 0.0 else np.pi / 2, abs=0.05)
    assert np.sqrt(end.end.covariance[2, 2]) < 0.1


def test_a_vague_fix_weighs_the_turns_by_its_likelihood() -> None:
    place, sigma_m = np.array([11.0, 3.5]), 6.0
    end = last(around_a_corner(fix(20, *place, sigma_m=sigma_m)), KNOWN)
    assert end.bank is not None
    chosen = {lineage[0][1]: weight for lineage, weight in zip(end.bank.lineages, end.bank.weights, strict=True)}
    spread = (sigma_m**2 + 0.3) * np.eye(2)  # and that of the walk, nearly
    likelihood = [multivariate_normal.pdf(place, at, spread) for at in ((14.0, 0.0), (7.0, 7.0))]
    odds = 0.6 * likelihood[0] / (0.4 * likelihood[1])
    assert chosen[0] / chosen[1] == pytest.approx(odds, rel=0.15)


def beside_a_grid(seed: int) -> tuple[float, Array]:
    """Distance of the filter's last position from the exact mean, in sigmas, and the ratios of the variances."""
    rng = np.random.default_rng(seed)
    off_m, turns = 0.5 * rng.standard_normal(2), rng.normal(0.0, 0.3, 30)
    begin = (1.0 + off_m[0], 2.0 + off_m[1], rng.uniform(-np.pi, np.pi))
    walk = simulate(rng, turns, begin, float(np.exp(0.1 * rng.standard_normal())), covariance=EXACT)
    sigma_m = rng.uniform(0.3, 4.0)
    fixes = [
        fix(int(k), *(walk.truth[k, :2] + 0.5 * sigma_m * rng.standard_normal(2)), sigma_m)
        for k in np.sort(rng.choice(np.arange(3, 31), rng.integers(1, 4), replace=False))
    ]
    start = StartPose((1.0, 2.0), None, sigma_position_m=0.5)
    timeline = build_timeline(DEVICE, 0.0, [*walk.odometry, *fixes])
    exact, found = posterior_of(timeline, start, 0.1), run_filter(timeline, start, 0.1)[-1].end
    half = np.linalg.cholesky(exact.covariance_m2)
    off = float(np.linalg.norm(np.linalg.solve(half, found.mean[:2] - exact.mean_m)))
    return off, np.linalg.eigvalsh(np.linalg.solve(half, np.linalg.solve(half, found.covariance[:2, :2]).T))


@pytest.mark.slow
def test_an_unknown_start_heading_is_found_as_by_a_fine_grid() -> None:
    """Random walks with one to three fixes, which are so near that no error larger than stated is probable."""
    offs, ratios = zip(*(beside_a_grid(seed) for seed in range(60)), strict=True)
    assert np.quantile(offs, 0.5) < 0.1
    assert np.quantile(offs, 0.9) < 0.2
    assert max(offs) < 0.6
    assert np.quantile(ratios, 0.1) > 0.9
    assert np.quantile(ratios, 0.9) < 1.1
    assert 0.7 < np.min(ratios) <= np.max(ratios) < 1.5


def test_a_fix_that_fits_two_headings_leaves_both() -> None:
    """It is accurate to the north only: the walker went 14 m, and 7 m of them to the north."""
    north = PositionFix(10.0, np.array([0.0, 7.0]), np.diag([50.0, 0.5]) ** 2)
    begin = StartPose((0.0, 0.0), None, sigma_position_m=0.1)
    end = last([*straight(20, 0.7, np.diag([1e-4, 1e-4, 0.0])), north], begin, 0.02)
    assert end.bank is not None
    for heading_rad in (np.pi / 6, np.pi * 5 / 6):
        near = np.abs(wrap_angle(end.bank.means[:, 2] - heading_rad)) < 0.3
        assert end.bank.weights[near].sum() == pytest.approx(0.5, abs=0.01)
    assert end.end.mean[:2] == pytest.approx([0.0, 7.0], abs=0.4)
    assert np.sqrt(end.end.covariance[0, 0]) == pytest.approx(14.0 * np.cos(np.pi / 6), rel=0.03)


TURN = st.tuples(st.floats(0.05, 1.0), st.floats(-np.pi, np.pi), st.sampled_from([0.0, 0.03, 0.4]))
TURNS = st.lists(TURN, min_size=1, max_size=6)
PLACES = st.tuples(st.floats(-60.0, 60.0), st.floats(-60.0, 60.0), st.floats(0.1, 30.0), st.booleans(), st.booleans())


def measured(east_m: float, north_m: float, sigma_m: float, robust: bool, wanders: bool) -> PositionFix:
    one = fix(1, east_m, north_m, sigma_m, robust)
    return replace(one, source="gps", sigma_wander_m=sigma_m, wander_time_s=20.0) if wanders else one


@settings(max_examples=30, deadline=None)
@given(st.booleans(), st.lists(st.one_of(TURNS, PLACES, st.floats(-4.0, 4.0)), max_size=8))
def test_whatever_comes_a_bank_stays_a_bounded_mixture(unknown: bool, events: list[object]) -> None:
    start = state(sigma_rad=0.0, sigma_scale=0.05)
    bank = HypothesisBank.of_unknown_heading(start) if unknown else HypothesisBank.of_state(start)
    for number, event in enumerate(events):
        if isinstance(event, list):
            total = sum(probability for probability, _, _ in event)
            one = node(turns=[TurnHypothesis(p / total, turn, sigma, "") for p, turn, sigma in event])
        elif isinstance(event, tuple):
            one = replace(node([replace(measured(*event), time_s=0.5 * number)]), time_s=0.5 * number)
        else:
            one = node(priors=[heading_prior(1, float(event), 0.1)])  # type: ignore[arg-type]
        bank = bank.predicted(one, number).updated(one)
        assert 1 <= len(bank) <= MOST_HYPOTHESES
        assert bank.weights.sum() == pytest.approx(1.0)
        assert (bank.weights >= 0.0).all()
        for covariance in (*bank.covariances, bank.moments().covariance):
            assert np.isfinite(covariance).all()
            assert np.linalg.eigvalsh(covariance)[0] > -1e-9 * np.trace(covariance)
        assert np.isfinite(bank.moments().mean).all()
        assert np.exp(bank.means[:, 3]).max() < 10.0
        assert len(bank.means[0]) == STATES + SOURCE_STATES * len(bank.sources)


def test_a_bank_is_pickled_whole() -> None:
    bank = HypothesisBank.of_unknown_heading(state()).updated(node([measured(3.0, 4.0, 1.0, True, True)]))
    again: HypothesisBank = pickle.loads(pickle.dumps(bank))
    for name in ("weights", "means", "covariances"):
        assert np.array_equal(getattr(bank, name), getattr(again, name))
    assert (again.sources, again.lineages) == (bank.sources, bank.lineages)
