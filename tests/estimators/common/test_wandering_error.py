"""The wandering error of a source in metres: it grows at once with what is stated, and shrinks by fading."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import fix
from hypothesis import given
from hypothesis import strategies as st
from least_squares import fix_covariance

from pdr_est.estimators.common.motion_model import SourceState
from pdr_est.estimators.common.wandering_error import wander_chain, wander_to
from pdr_est.types.measurements import PositionFix

SIGMAS = st.floats(0.01, 100.0)
TIMES = st.floats(0.1, 300.0)


def stated(sigma_m: float, time_s: float = 15.0, k: float = 0.0) -> PositionFix:
    return replace(fix(k, 0.0, 0.0), source="gps", sigma_wander_m=sigma_m, wander_time_s=time_s)


@given(SIGMAS, TIMES, st.floats(0.0, 1e4))
def test_a_constant_accuracy_is_a_stationary_process(sigma_m: float, time_s: float, elapsed_s: float) -> None:
    correlation, after_m = wander_to(stated(sigma_m, time_s), sigma_m, elapsed_s)
    assert after_m == pytest.approx(sigma_m)
    assert correlation == pytest.approx(np.exp(-elapsed_s / time_s), abs=1e-12)


@given(SIGMAS, SIGMAS, TIMES, st.floats(0.0, 1e4))
def test_what_is_kept_of_an_error_does_not_depend_on_what_is_stated(
    before_m: float, sigma_m: float, time_s: float, elapsed_s: float
) -> None:
    """The error in metres is that before, faded, and something new: a change of sigma reveals nothing of it."""
    correlation, after_m = wander_to(stated(sigma_m, time_s), before_m, elapsed_s)
    assert correlation * after_m == pytest.approx(np.exp(-elapsed_s / time_s) * before_m)
    assert after_m >= sigma_m * (1.0 - 1e-12)
    assert after_m <= max(before_m, sigma_m) * (1.0 + 1e-12)
    assert 0.0 <= correlation <= 1.0 + 1e-12


def test_an_error_grows_at_once_and_fades_slowly() -> None:
    assert wander_to(stated(10.0), 2.0, 0.0) == pytest.approx((0.2, 10.0))
    assert wander_to(stated(2.0), 10.0, 0.0) == pytest.approx((1.0, 10.0))
    assert wander_to(stated(2.0), 10.0, 15.0)[1] == pytest.approx(np.sqrt(4.0 + np.exp(-2.0) * 96.0))
    assert wander_to(stated(2.0), 10.0, 1e4) == pytest.approx((0.0, 2.0))


def test_time_that_goes_back_counts_as_none() -> None:
    assert wander_to(stated(3.0), 3.0, -5.0) == pytest.approx((1.0, 3.0))


def test_a_source_without_wandering_error_has_no_correlation() -> None:
    assert wander_to(stated(0.0), 0.0, 1.0) == (0.0, 0.0)


@given(st.lists(st.tuples(st.floats(0.01, 40.0), SIGMAS), min_size=1, max_size=8), TIMES)
def test_a_chain_has_the_covariance_of_the_process(series: list[tuple[float, float]], time_s: float) -> None:
    times = np.cumsum([pause for pause, _ in series])
    fixes = [stated(sigma_m, time_s, k) for k, (_, sigma_m) in zip(times, series, strict=True)]
    correlation, sigma_m = wander_chain(fixes)
    assert correlation[0] == 0.0
    expected = fix_covariance(fixes)[::2, ::2] - 0.25 * np.eye(len(fixes))
    for i in range(len(fixes)):
        for j in range(i + 1):
            common = sigma_m[i] * sigma_m[j] * np.prod(correlation[j + 1 : i + 1])
            assert common == pytest.approx(expected[i, j], rel=1e-6, abs=1e-9)


@given(SIGMAS, SIGMAS, st.floats(0.0, 1e3))
def test_the_filter_has_the_same_correlation(before_m: float, sigma_m: float, elapsed_s: float) -> None:
    correlation, after_m = wander_to(stated(sigma_m), before_m, elapsed_s)
    earlier, later = SourceState("gps", 0.0, before_m, 15.0), SourceState("gps", elapsed_s, after_m, 15.0)
    assert later.correlation_with(earlier) == pytest.approx(min(correlation, 1.0), abs=1e-12)
