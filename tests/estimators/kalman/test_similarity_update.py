"""Update of a wide heading by a fix: against summation over heading and scale, and where the EKF is exact."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import fix
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import multivariate_normal

from pdr_est.estimators.common.motion_model import STATES, GaussianState
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.kalman.filterpy_ekf import MultiDeviceEkf
from pdr_est.estimators.kalman.fix_sources import fix_rows, with_source_at
from pdr_est.estimators.kalman.hypothesis_bank import HypothesisBank
from pdr_est.estimators.kalman.similarity_update import similarity_update
from pdr_est.frames import Array, rotation_matrix
from pdr_est.types.measurements import PositionFix
from pdr_est.types.steps import CarryingMode


def reckoned(length_m: float, sigma_rad: float, sigma_scale: float, noise_m: float = 0.2) -> GaussianState:
    """State after a walk to the east from a known start, with isotropic noise on the way."""
    mean = np.array([length_m, 0.0, 0.0, 0.0, 0.0])
    sigma = np.array([0.3, 0.3, sigma_rad, sigma_scale, 1.0])
    jacobian = np.eye(STATES)
    jacobian[1, 2] = jacobian[0, 3] = length_m
    covariance = jacobian @ np.diag(sigma**2) @ jacobian.T
    covariance[:2, :2] += noise_m**2 * np.eye(2)
    return GaussianState(mean, covariance)


def updated(state: GaussianState, at: PositionFix) -> tuple[Array, Array, float]:
    rows = fix_rows(state, 1, at) if state.sources else np.eye(2, len(state.mean))
    means, covariances, log_likelihood = similarity_update(
        state.mean[None],
        state.covariance[None],
        np.asarray(at.position_m)[None],
        rows[None],
        np.asarray(at.covariance_m2)[None],
    )
    return means[0], covariances[0], float(log_likelihood[0])


def summed(
    length_m: float, sigma_rad: float, sigma_scale: float, noise_m: float, at: PositionFix
) -> tuple[Array, Array, float]:
    """Moments of (east, north, heading, log scale), and the evidence, by a sum over heading and logarithm."""
    heading, log_scale = np.meshgrid(
        sigma_rad * np.linspace(-6, 6, 601), sigma_scale * np.linspace(-5, 5, 101), indexing="ij"
    )
    place = length_m * np.exp(log_scale + 1j * heading)
    place = np.stack([place.real, place.imag], axis=-1).reshape(-1, 2)
    within = (0.3**2 + noise_m**2) * np.eye(2)
    log_prior = -0.5 * ((heading / sigma_rad) ** 2 + (log_scale / sigma_scale) ** 2).ravel()
    prior = np.exp(log_prior) / np.exp(log_prior).sum()
    likelihood = multivariate_normal.pdf(np.asarray(at.position_m) - place, np.zeros(2), within + at.covariance_m2)
    evidence = float(prior @ likelihood)
    gain = within @ np.linalg.inv(within + at.covariance_m2)
    weight = prior * likelihood / evidence
    each = np.column_stack([place + (np.asarray(at.position_m) - place) @ gain.T, heading.ravel(), log_scale.ravel()])
    mean = weight @ each
    covariance = (each - mean).T @ (weight[:, None] * (each - mean))
    covariance[:2, :2] += within - gain @ within
    return mean, covariance, np.log(evidence)


@settings(max_examples=30, deadline=None)
@given(
    length_m=st.floats(10.0, 80.0),
    sigma_rad=st.floats(0.05, 0.2),
    sigma_scale=st.floats(0.02, 0.08),
    sigma_m=st.floats(0.3, 5.0),
    off=st.tuples(st.floats(-2.0, 2.0), st.floats(-1.5, 1.5)),
)
def test_a_wide_heading_has_the_posterior_of_the_arc(
    length_m: float, sigma_rad: float, sigma_scale: float, sigma_m: float, off: tuple[float, float]
) -> None:
    """Fixes up to two standard deviations of the heading away, and sectors as wide as those of a bank."""
    place = length_m * np.exp(complex(off[1] * sigma_scale, off[0] * sigma_rad))
    at = fix(1, place.real, place.imag, sigma_m)
    mean, covariance, _ = updated(reckoned(length_m, sigma_rad, sigma_scale), at)
    exact_mean, exact_covariance, _ = summed(length_m, sigma_rad, sigma_scale, 0.2, at)
    sigma = np.sqrt(np.diag(exact_covariance))
    assert np.abs((mean[:4] - exact_mean) / sigma).max() < 0.35
    assert np.sqrt(np.diag(covariance)[:4]) / sigma == pytest.approx(np.ones(4), rel=0.2)


@pytest.mark.parametrize("heading_rad", [-0.3, 0.0, 0.25])
def test_the_likelihood_is_the_evidence(heading_rad: float) -> None:
    """Up to a factor that all fixes of a covariance have in common."""

    def log_ratio(some: PositionFix) -> float:
        return updated(reckoned(40.0, 0.15, 0.05), some)[2] - summed(40.0, 0.15, 0.05, 0.2, some)[2]

    at, ahead = fix(1, 40.0 * np.cos(heading_rad), 40.0 * np.sin(heading_rad), 1.0), fix(1, 41.0, 0.0, 1.0)
    assert log_ratio(at) == pytest.approx(log_ratio(ahead), abs=0.05)


def test_where_heading_and_scale_are_known_it_is_the_kalman_filter() -> None:
    state, at = (
        reckoned(40.0, 1e-7, 1e-7),
        PositionFix(1.0, np.array([41.0, 1.0]), np.array([[1.0, 0.3], [0.3, 0.5]])),
    )
    ekf = MultiDeviceEkf()
    ekf.load(state)
    ekf.update_position(at)
    mean, covariance, log_likelihood = updated(state, at)
    assert mean == pytest.approx(ekf.state_of().mean[:STATES], abs=1e-6)
    assert covariance == pytest.approx(ekf.state_of().covariance[:STATES, :STATES], abs=1e-6)
    density = multivariate_normal.logpdf(
        np.asarray(at.position_m), state.mean[:2], state.covariance[:2, :2] + at.covariance_m2
    )
    assert log_likelihood == pytest.approx(density + np.log(2.0 * np.pi), abs=1e-6)


@given(st.floats(-np.pi, np.pi), st.floats(-50.0, 50.0))
def test_it_turns_and_moves_with_the_map(turn_rad: float, east_m: float) -> None:
    at = fix(1, 36.0, 12.0, 2.0)
    state = reckoned(40.0, 0.2, 0.05)
    whole = np.eye(STATES)
    whole[:2, :2] = rotation_matrix(turn_rad)
    moved = GaussianState(whole @ state.mean + [east_m, 0.0, turn_rad, 0.0, 0.0], whole @ state.covariance @ whole.T)
    mean, covariance, log_likelihood = updated(state, at)
    place = rotation_matrix(turn_rad) @ at.position_m + [east_m, 0.0]
    other_mean, other_covariance, other_log_likelihood = updated(moved, replace(at, position_m=place))
    assert other_mean == pytest.approx(whole @ mean + [east_m, 0.0, turn_rad, 0.0, 0.0], abs=1e-6)
    assert other_covariance == pytest.approx(whole @ covariance @ whole.T, abs=1e-6)
    assert other_log_likelihood == pytest.approx(log_likelihood, abs=1e-6)


def test_a_wandering_error_shares_the_innovation() -> None:
    """Linear, so that it is dense conditioning."""
    at = replace(fix(1, 41.0, 1.0, 0.5), source="gps", sigma_wander_m=3.0)
    state = with_source_at(reckoned(40.0, 1e-7, 1e-7), 1, at)
    mean, covariance, _ = updated(state, at)
    rows = fix_rows(state, 1, at)
    gain = state.covariance @ rows.T @ np.linalg.inv(rows @ state.covariance @ rows.T + at.covariance_m2)
    assert mean == pytest.approx(state.mean + gain @ (at.position_m - rows @ state.mean), abs=1e-6)
    assert covariance == pytest.approx(state.covariance - gain @ rows @ state.covariance, abs=1e-6)


@settings(deadline=None)
@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(1e-3, 1e2), st.floats(1e-6, 1.0))
def test_no_fix_breaks_a_state(east_m: float, north_m: float, sigma_m: float, sigma_rad: float) -> None:
    mean, covariance, log_likelihood = updated(reckoned(40.0, sigma_rad, 0.06), fix(1, east_m, north_m, sigma_m))
    assert np.isfinite([*mean, log_likelihood]).all()
    assert np.linalg.eigvalsh(covariance)[0] > -1e-9 * np.trace(covariance)


def in_a_bank(state: GaussianState, at: PositionFix) -> GaussianState:
    node = Node(at.time_s, 0.0, 0.7, 0.0, np.zeros((3, 3)), True, 0.7, CarryingMode.UNKNOWN, (at,))
    return HypothesisBank.of_state(state).updated(node).moments()


@pytest.mark.parametrize("off_m", [1.0, 3.0, 7.0, 60.0])
def test_a_bank_of_one_hypothesis_doubts_a_fix_as_the_filter_does(off_m: float) -> None:
    state, at = reckoned(40.0, 1e-7, 1e-7), fix(1, 40.0 + off_m, 0.0, 0.5)
    ekf = MultiDeviceEkf()
    ekf.load(state)
    ekf.update_position(at)
    found = in_a_bank(state, at)
    assert found.mean == pytest.approx(ekf.state_of().mean, abs=1e-5)
    assert found.covariance == pytest.approx(ekf.state_of().covariance, rel=1e-4, abs=1e-5)
    assert found.trusts[0].probabilities == pytest.approx(ekf.state_of().trusts[0].probabilities, abs=1e-6)


def test_a_gross_fix_hardly_moves_the_scale() -> None:
    found = in_a_bank(reckoned(40.0, 0.15, 0.06), fix(1, 887.0, 1.0, 1.0))
    assert abs(found.mean[3]) < 6.0 * 0.06
