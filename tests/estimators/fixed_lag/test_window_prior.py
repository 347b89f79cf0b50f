"""The prior of a window is the filter's state, with the wandering errors of sources."""

import gtsam
import numpy as np
import pytest

from pdr_est.estimators.fixed_lag.window_prior import ConditionalPrior, log_scales, prior_factors
from pdr_est.frames import Array, rotation_matrix

SIZES = [(1, 0), (1, 1), (1, 2), (2, 1)]


def filter_state(devices: int, sources: int) -> tuple[Array, Array]:
    size = 5 * devices + 2 * sources
    rng = np.random.default_rng(size)
    root = rng.standard_normal((size, size + 2))
    return rng.standard_normal(size), 0.01 * root @ root.T


@pytest.mark.parametrize(("devices", "sources"), SIZES)
def test_factors_have_the_covariance_of_the_filter_given_the_length_scales(devices: int, sources: int) -> None:
    mean, covariance = filter_state(devices, sources)
    scale = np.exp(mean[3 : 5 * devices : 5])
    known = ConditionalPrior.of_filter(mean, covariance, scale, range(devices))
    poses, errors = list(range(devices)), list(range(devices, devices + sources))
    graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    for factor in prior_factors(known, poses, [None] * devices, errors):
        graph.add(factor)
    kept = [np.delete(np.arange(5), 3) + 5 * device for device in range(devices)]
    rows = [own[:3] for own in kept] + [5 * devices + 2 * i + np.arange(2) for i in range(sources)]
    turns = []
    for key, own in zip(poses, rows, strict=False):
        values.insert(key, gtsam.Pose2(*mean[own]))
        turn = np.eye(3)
        turn[:2, :2] = rotation_matrix(mean[own][2])
        turns.append(turn)
    for key, own in zip(errors, rows[devices:], strict=True):
        values.insert(key, mean[own])
        turns.append(np.eye(2))
    found = gtsam.Marginals(graph, values)
    fixed = np.arange(3, 5 * devices, 5)
    given = covariance - covariance[:, fixed] @ np.linalg.solve(covariance[fixed][:, fixed], covariance[fixed])
    for i, (key, own) in enumerate(zip([*poses, *errors], rows, strict=True)):
        marginal = turns[i] @ found.marginalCovariance(key) @ turns[i].T
        assert marginal == pytest.approx(given[np.ix_(own, own)], abs=1e-6)
        for j, (other, its) in enumerate(zip([*poses, *errors][:i], rows, strict=False)):
            across = found.jointMarginalCovariance(gtsam.KeyVector([key, other])).at(key, other)
            assert turns[i] @ across @ turns[j].T == pytest.approx(given[np.ix_(own, its)], abs=1e-6)


def test_scales_are_those_of_the_devices_only() -> None:
    mean, covariance = filter_state(2, 2)
    logarithms, sigma = log_scales(mean, covariance, 2)
    assert logarithms.tolist() == mean[[3, 8]].tolist()
    assert sigma == pytest.approx(np.sqrt(np.diag(covariance)[[3, 8]]))
