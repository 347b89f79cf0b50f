"""The prior of a window is the filter's state at known length scales, with the wandering errors of sources."""

import numpy as np
import pytest

from pdr_est.estimators.fixed_lag.window_prior import ConditionalPrior, log_scales, whitening_of
from pdr_est.frames import Array

SIZES = [(1, 0), (1, 1), (1, 2), (2, 1), (3, 2)]


def filter_state(devices: int, sources: int) -> tuple[Array, Array]:
    size = 5 * devices + 2 * sources
    rng = np.random.default_rng(size)
    root = rng.standard_normal((size, size + 2))
    return rng.standard_normal(size), 0.01 * root @ root.T


@pytest.mark.parametrize(("devices", "sources"), SIZES)
def test_whitening_has_the_covariance_of_the_filter_given_the_length_scales(devices: int, sources: int) -> None:
    """References that are left out are marginalised."""
    mean, covariance = filter_state(devices, sources)
    scale = np.exp(mean[3 : 5 * devices : 5])
    known = ConditionalPrior.of_filter(mean, covariance, scale, range(devices))
    kept = [4 * device + i for device in range(devices) for i in range(3)]
    kept += list(range(4 * devices, 4 * devices + 2 * sources))
    whitening = whitening_of(known, kept)
    fixed = np.arange(3, 5 * devices, 5)
    given = covariance - covariance[:, fixed] @ np.linalg.solve(covariance[fixed][:, fixed], covariance[fixed])
    own = [5 * device + i for device in range(devices) for i in range(3)]
    own += list(range(5 * devices, 5 * devices + 2 * sources))
    assert np.linalg.inv(whitening.T @ whitening) == pytest.approx(given[np.ix_(own, own)], abs=1e-6)
    assert known.mean[kept] == pytest.approx(mean[own])


def test_scales_are_those_of_the_devices_only() -> None:
    mean, covariance = filter_state(2, 2)
    logarithms, sigma = log_scales(mean, covariance, 2)
    assert logarithms.tolist() == mean[[3, 8]].tolist()
    assert sigma == pytest.approx(np.sqrt(np.diag(covariance)[[3, 8]]))
