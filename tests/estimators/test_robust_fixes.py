"""One gross fix among good ones."""

import numpy as np
import pytest
from estimator_walks import fix, run, straight

from pdr_est.estimators import EstimatorName
from pdr_est.estimators.common.huber import HUBER, huber_inflation
from pdr_est.types.measurements import PositionFix, StartPose

KNOWN = StartPose((0.0, 0.0), 0.0, 0.1, 0.05)


def fixes(robust: bool, first: int = 0) -> list[PositionFix]:
    """Every four steps along the way east, the one at step 28 is 40 m off."""
    return [fix(k, 0.7 * k, 40.0 if k == 28 else 0.0, 0.5, robust) for k in range(first, 57, 4)]


@pytest.mark.parametrize("name", ["ekf", "factor-graph"])
@pytest.mark.parametrize("start", [KNOWN, StartPose()], ids=["known start", "unknown start"])
def test_a_robust_estimator_resists_a_gross_fix(name: EstimatorName, start: StartPose) -> None:
    robust = run(name, [*straight(56), *fixes(robust=True)], start)
    assert np.max(np.abs(robust.position_m[:, 1])) < 1.5
    assert robust.position_m[-1] == pytest.approx([39.2, 0.0], abs=0.5)


def test_a_gross_fix_while_the_direction_is_sought_does_not_turn_the_smoothed_walk() -> None:
    """The second fix settles a wrong direction for the filter, from which the graph starts."""
    gross = fix(8, 0.0, 30.0, 0.5, robust=True)
    good = [fix(k, 0.7 * k, 0.0, 0.5, robust=True) for k in (0, 12, 16, 20, 24, 28, 32, 36, 40)]
    track = run("factor-graph", [*straight(40), gross, *good], StartPose())
    assert track.position_m[-1] == pytest.approx([28.0, 0.0], abs=1.0)
    assert abs(track.heading_rad[-1]) < 0.2


@pytest.mark.parametrize("name", ["ekf", "factor-graph"])
def test_good_fixes_count_the_same_whether_robust_or_not(name: EstimatorName) -> None:
    good = [0, 8, 16, 24]
    robust, plain = (
        run(name, [*straight(24), *(fix(k, 0.71 * k, 0.1, 0.5, robust) for k in good)], KNOWN)
        for robust in (True, False)
    )
    assert robust.position_m == pytest.approx(plain.position_m, abs=1e-6)
    assert robust.covariance_m2 == pytest.approx(plain.covariance_m2, abs=1e-6)


def test_inflation_follows_huber() -> None:
    covariance = np.diag([4.0, 1.0])
    assert huber_inflation(np.array([2.0, 0.5]), covariance) == 1.0
    assert huber_inflation(np.array([20.0, 0.0]), covariance) == pytest.approx(10.0 / HUBER)
    assert huber_inflation(np.array([0.0, -10.0]), covariance) == pytest.approx(10.0 / HUBER)
