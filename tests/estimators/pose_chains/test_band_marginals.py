"""Covariances from a banded factor against those of a walk whose errors add up in a known way."""

import numpy as np
import pytest

from pdr_est.estimators.pose_chains.band_marginals import covariances_in_time


@pytest.mark.parametrize("count", [1, 7, 8, 29, 9001])
def test_errors_add_up_over_any_number_of_poses(count: int) -> None:
    """Headings are a random walk, each step east has the heading error before it; all noise has the variance 1."""
    factor = np.zeros((6, 3 * count), order="F")
    factor[0] = 1.0
    factor[5, 0:-3:3] = factor[3, 2:-3:3] = -1.0  # of a step and of a heading to the heading before
    found = covariances_in_time(factor)
    k = np.arange(count, dtype=np.float64)
    expected = np.zeros((count, 3, 3))
    expected[:, 0, 0] = k * (k + 1.0) * (2.0 * k + 1.0) / 6.0 + k + 1.0
    expected[:, 1, 1] = expected[:, 2, 2] = k + 1.0
    expected[:, 0, 2] = expected[:, 2, 0] = 0.5 * k * (k + 1.0)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * count)
