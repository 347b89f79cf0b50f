"""Fixes that may be outliers, against the exact mixture of right and wrong ones."""

from itertools import product

import numpy as np
import pytest
from estimator_walks import fix, simulate

from pdr_est.estimators.fix_checks.dead_reckoned_path import DeadReckonedPath
from pdr_est.estimators.fix_checks.outlier_weights import outliers, weigh, widened
from pdr_est.estimators.fix_checks.position_regression import log_evidence
from pdr_est.estimators.fix_checks.section import FixTable, table_of
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose

SIGMAS, SHARES = (0.0, 3.0, 10.0, 40.0, 200.0), (1.0, 0.45, 0.3, 0.2, 0.05)  # right, and the kinds of outliers
SIGMA_SCALE = 0.1


def walk_with_last_fix_off(off_m: float) -> tuple[FixTable, Array, Array]:
    """Fixes of 0.7 m on a walk along a bend, the last of which is off to the side; path and covariance there."""
    walk = simulate(np.random.default_rng(1), np.full(160, 0.05))
    fixes = [fix(k, *walk.truth[k, :2], sigma_m=0.7) for k in (0, 40, 80, 120)]
    aside = np.array([np.sin(walk.truth[160, 2]), -np.cos(walk.truth[160, 2])])
    fixes.append(fix(160, *(walk.truth[160, :2] + off_m * aside), sigma_m=0.7))
    table, path = table_of(fixes, StartPose(), 0.0), DeadReckonedPath(0.0, walk.odometry)
    points = path.at(table.time_s)
    return table, points.position_m, path.covariance(points, points, points.first_pose)


@pytest.mark.parametrize(("off_m", "within"), [(2.0, 0.1), (4.0, 1.0), (5.0, 2.5), (8.0, 1.0), (20.0, 2.0)])
def test_evidence_and_probability_are_nearly_those_of_the_mixture(off_m: float, within: float) -> None:
    """The mixture is summed over all kinds of at most two wrong fixes."""
    table, path_m, common_m2 = walk_with_last_fix_off(off_m)
    found = weigh(table, path_m, common_m2, None, SIGMA_SCALE)
    solved = found.regression
    logarithm, is_wrong = [], []
    for kinds in product(range(5), repeat=len(table)):
        if np.count_nonzero(kinds) <= 2:
            prior = [p * SHARES[k] if k else 1.0 - p for k, p in zip(kinds, table.outlier_prior, strict=True)]
            white_m2 = widened(table.white_m2, (table.sigma_m * np.take(SIGMAS, kinds)) ** 2)
            evidence = log_evidence(table.position_m, path_m, common_m2, white_m2, solved.prior, solved.heading_rad)
            logarithm.append(evidence + np.log(prior).sum())
            is_wrong.append(kinds[-1] > 0)
    exact = np.logaddexp.reduce(logarithm)
    wrong = np.exp(np.logaddexp.reduce(np.array(logarithm)[is_wrong]) - exact)
    assert found.score == pytest.approx(exact, abs=within)
    assert found.outlier[-1] == pytest.approx(wrong, abs=0.1)


@pytest.mark.parametrize("off_m", [6.0, 9.0, 10.0, 11.0, 20.0])
def test_a_fix_moves_the_prediction_by_the_mean_of_both_cases(off_m: float) -> None:
    """A fix that is probably right is not ignored because it would be far off if it were wrong."""
    table, predicted_m2 = walk_with_last_fix_off(0.0)[0].rows(np.array([4])), 9.0
    (wrong,), (more_m2,) = outliers(table, np.array([[off_m, 0.0]]), predicted_m2 * np.eye(2)[None])
    right_m2 = predicted_m2 + 0.7**2
    gains = predicted_m2 / right_m2, predicted_m2 / (right_m2 + off_m**2)
    mean = (1.0 - wrong) * gains[0] + wrong * gains[1]
    assert predicted_m2 / (right_m2 + more_m2) == pytest.approx(mean, abs=0.01)
