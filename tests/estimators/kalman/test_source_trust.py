"""Hypotheses about the error of a fix: weights by Bayes' rule, moments of the mixture, what is kept of a source."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import fix
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import multivariate_normal

from pdr_est.estimators.common.measurement_checks import is_repeated
from pdr_est.estimators.common.motion_model import STATES, GaussianState
from pdr_est.estimators.kalman.filterpy_ekf import MultiDeviceEkf
from pdr_est.estimators.kalman.source_trust import (
    hypotheses_about,
    mixture_of,
    trust_in,
    with_trust,
)
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix


def standing(sigma_m: float = 0.6) -> GaussianState:
    return GaussianState(np.zeros(STATES), np.diag([sigma_m**2, sigma_m**2, 0.01, 0.004, 1.0]))


def filtered(fixes: Sequence[PositionFix], state: GaussianState | None = None) -> GaussianState:
    ekf = MultiDeviceEkf()
    ekf.load(state or standing())
    for one in fixes:
        ekf.update_position(one)
    return ekf.state_of()


def in_turn(*offsets_m: float) -> list[PositionFix]:
    """Fixes four steps apart that lie so far to the east, and a little apart to the north."""
    return [fix(4 * k, off_m, 0.01 * k, 0.6) for k, off_m in enumerate(offsets_m)]


def accuracy(state: GaussianState) -> Array:
    """Probabilities of the hypotheses about the accuracy of the only source."""
    (trust,) = state.trusts
    return np.array(trust.probabilities)


def test_the_probabilities_of_an_accuracy_are_those_of_bayes_rule() -> None:
    """Of the first fix of a source: as good as stated, worse, grossly wrong, or the track is lost."""
    at = fix(4, 2.5, -1.0, 0.6)
    some = hypotheses_about(at, trust_in((), at, 0), float(np.hypot(2.5, 1.0)))
    known = standing().covariance[:2, :2]
    added = (0.36 * some.jump + some.lost_m2)[:, None, None] * np.eye(2)
    density = [multivariate_normal.pdf(at.position_m, np.zeros(2), one) for one in known + some.noise + added]
    exact = some.weights * density / (some.weights @ density)
    assert accuracy(filtered([at])) == pytest.approx(exact[:-1] / exact[:-1].sum(), abs=1e-6)


def test_a_smoother_gets_the_error_that_the_filter_believed() -> None:
    usual = filtered([fix(4, 0.2, 0.0, 0.6)]).taken[0]
    gross = filtered([fix(4, 50.0, 0.0, 0.6)]).taken[0]
    assert np.sqrt(usual.covariance_m2[0, 0]) < 0.75
    assert np.sqrt(gross.covariance_m2[0, 0]) > 10.0
    assert gross.position_m == pytest.approx([50.0, 0.0])


@pytest.mark.slow
def test_the_mixture_has_the_moments_of_its_samples() -> None:
    weights, means = np.array([0.2, 0.8]), np.array([[0.0, 1.0], [5.0, -1.0]])
    covariances = np.array([np.eye(2), [[2.0, 0.5], [0.5, 1.0]]])
    rng = np.random.default_rng(3)
    drawn = [rng.multivariate_normal(means[i], covariances[i]) for i in rng.choice(2, 20_000, p=weights)]
    mean, covariance = mixture_of(weights, means, covariances)
    assert mean == pytest.approx(np.mean(drawn, axis=0), abs=0.05)
    assert covariance == pytest.approx(np.cov(np.transpose(drawn)), abs=0.15)


@pytest.mark.parametrize("robust", [False, True])
def test_consistent_fixes_count_as_in_a_kalman_filter(robust: bool) -> None:
    fixes = [replace(one, robust=robust) for one in in_turn(0.5, -0.8, 0.3, 0.9, -0.6)]
    found = filtered(fixes)
    information = 1.0 / 0.36 * (1 + len(fixes))
    assert found.covariance[:2, :2] == pytest.approx(np.eye(2) / information, rel=1e-3, abs=1e-9)
    assert found.mean[0] == pytest.approx(sum(one.position_m[0] for one in fixes) / 6.0, abs=1e-3)
    assert accuracy(found)[0] > 0.9


def test_a_gross_fix_is_told_by_the_covariance_and_the_next_one_decides() -> None:
    good, bad = in_turn(0.2, -0.3, 0.1), in_turn(0.2, -0.3, 0.1, 40.0)
    doubtful = filtered(bad)
    assert doubtful.mean[0] < 20.0
    assert np.sqrt(doubtful.covariance[0, 0]) > 0.3 * (40.0 - doubtful.mean[0])  # it may be right all the same
    back, beyond = filtered(in_turn(0.2, -0.3, 0.1, 40.0, 0.3)), filtered(in_turn(0.2, -0.3, 0.1, 40.0, 39.5, 40.2))
    assert abs(back.mean[0] - filtered(good).mean[0]) < 1.0
    assert abs(beyond.mean[0] - 40.0) < 3.0 * np.sqrt(beyond.covariance[0, 0])


def test_a_source_that_may_be_grossly_wrong_does_not_move_a_sure_track() -> None:
    found = filtered([replace(one, robust=True) for one in in_turn(0.2, -0.3, 0.1, 40.0)])
    assert abs(found.mean[0]) < 1.0


def test_a_source_of_too_good_an_accuracy_is_found_out() -> None:
    """Its errors are five times those that it states."""
    rng = np.random.default_rng(8)
    found = filtered(in_turn(*(3.0 * rng.standard_normal(30))))
    assert accuracy(found)[1:4].sum() > 0.8
    assert np.sqrt(found.covariance[0, 0]) > 2.0 * 0.6 / np.sqrt(31.0)
    assert abs(found.mean[0]) < 2.5 * np.sqrt(found.covariance[0, 0])


def test_what_is_known_of_a_source_fades() -> None:
    found = filtered(in_turn(*(3.0 * np.random.default_rng(8).standard_normal(30))))
    (trust,) = found.trusts
    soon, late = (
        np.array(trust_in((trust,), fix(2.0 * seconds, 0.0, 0.0), 0).probabilities) for seconds in (60.0, 6e4)
    )
    assert soon.sum() == pytest.approx(1.0)
    assert late[0] > 0.9 > 0.5 > soon[0]


def test_a_repeated_position_tells_nothing_new() -> None:
    once, again = fix(4, 0.3, 0.1, 0.6), fix(6, 0.3, 0.1, 0.6)
    assert np.array_equal(filtered([once, again]).covariance, filtered([once]).covariance)
    assert filtered([once, replace(again, source="other")]).covariance[0, 0] < filtered([once]).covariance[0, 0]
    later = replace(again, time_s=once.time_s + 60.0)  # the walker came back to this point
    assert filtered([once, later]).covariance[0, 0] < filtered([once]).covariance[0, 0]


def test_each_device_has_its_own_view_of_a_fix() -> None:
    """A fix that all devices of a walker get is no repetition."""
    at = fix(4, 0.3, 0.1, 0.6)
    first = trust_in((), at, 0)
    trusts = with_trust((), first, at, np.array([0.9, 0.0, 0.0, 0.0, 0.0, 0.08, 0.02]))
    assert is_repeated(trust_in(trusts, at, 0).given, at)
    assert not is_repeated(trust_in(trusts, at, 1).given, at)


def test_the_end_of_a_closed_walk_is_not_doubted() -> None:
    closure = replace(fix(4, 25.0, 0.0, 0.6), source="start")
    found = filtered([closure])
    assert found.mean[0] == pytest.approx(25.0, abs=0.5)
    weights = hypotheses_about(closure, trust_in((), closure, 0), 25.0).weights
    assert weights[0] > 0.99


@settings(deadline=None)
@given(st.lists(st.tuples(st.floats(-1e4, 1e4), st.floats(1e-2, 1e3), st.booleans()), max_size=12))
def test_no_series_of_fixes_breaks_the_mixture(series: list[tuple[float, float, bool]]) -> None:
    fixes = [fix(2 * k, off_m, 1.0 * k, sigma_m, robust) for k, (off_m, sigma_m, robust) in enumerate(series)]
    found = filtered(fixes)
    assert np.isfinite(found.mean).all()
    assert np.linalg.eigvalsh(found.covariance)[0] > -1e-9 * np.trace(found.covariance)
    assert all(np.sum(one.probabilities) == pytest.approx(1.0) for one in found.trusts)
