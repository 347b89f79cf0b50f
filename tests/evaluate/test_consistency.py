import numpy as np
import pytest

from pdr_est.evaluate.consistency import CHI2_95_2D, coverage95, nees_mean, squared_mahalanobis
from pdr_est.evaluate.held_out_fixes import WAYPOINT_SIGMA_M, fixes_at, given_points


def test_truths_own_sigma_is_added_to_the_tracks_covariance():
    # P = diag(0.51, 3.51), sigma^2 = 0.49: sum diag(1, 4). Error (1, 2): 1/1 + 4/4 = 2.
    covariance = np.array([np.diag([0.51, 3.51])])
    assert squared_mahalanobis(np.array([[1.0, 2.0]]), covariance, 0.7)[0] == pytest.approx(2.0)


def test_correlation_of_the_covariance_counts():
    # P + sigma^2 I = [[2, 1], [1, 2]], inverse [[2, -1], [-1, 2]] / 3. Along (1, 1): 2/3. Across (1, -1): 6/3 = 2.
    covariance = np.array([[[1.0, 1.0], [1.0, 1.0]]] * 2)
    squares = squared_mahalanobis(np.array([[1.0, 1.0], [1.0, -1.0]]), covariance, 1.0)
    np.testing.assert_allclose(squares, [2.0 / 3.0, 2.0])


def test_region_ends_at_the_chi_squared_quantile():
    # Unit covariance: the 95 % region is the disk of radius sqrt(5.991) = 2.4477.
    assert pytest.approx(5.991464547, abs=1e-9) == CHI2_95_2D
    errors = np.array([[2.4477, 0.0], [0.0, 2.4478]])
    assert coverage95(errors, np.tile(np.eye(2), (2, 1, 1)), 0.0) == 0.5


def test_gaussian_errors_with_their_own_covariance_are_covered_95_percent():
    rng = np.random.default_rng(7)
    n = 20_000
    factors = rng.normal(size=(n, 2, 2))
    covariance = factors @ factors.transpose(0, 2, 1) + 0.1 * np.eye(2)
    of_track = (np.linalg.cholesky(covariance) @ rng.normal(size=(n, 2, 1)))[:, :, 0]
    errors = of_track + rng.normal(0.0, 0.7, (n, 2))
    # Standard deviation of the share sqrt(0.95 * 0.05 / n) = 0.0015; of the mean square 2 / sqrt(n) = 0.014.
    assert coverage95(errors, covariance, 0.7) == pytest.approx(0.95, abs=0.006)
    assert nees_mean(errors, covariance, 0.7) == pytest.approx(2.0, abs=0.06)


@pytest.mark.parametrize(
    ("count", "numbers"),
    [(5, [1, 4, 5]), (6, [1, 4, 6]), (7, [1, 4, 7]), (8, [1, 4, 7, 8]), (10, [1, 4, 7, 10]), (1, [1])],
)
def test_points_1_4_7_and_the_last_are_given(count, numbers):
    assert (np.flatnonzero(given_points(count)) + 1).tolist() == numbers


def test_fixes_have_the_sigma_of_a_waypoint():
    (fix,) = fixes_at(np.array([3.0]), np.array([[1.0, 2.0]]))
    assert (fix.time_s, fix.position_m.tolist()) == (3.0, [1.0, 2.0])
    np.testing.assert_allclose(fix.covariance_m2, 0.49 * np.eye(2))
    assert WAYPOINT_SIGMA_M == 0.7
    assert not fix.robust
