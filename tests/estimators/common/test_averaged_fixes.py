"""Fixes that come faster than ten times a second are averaged, others are left alone."""

import numpy as np
import pytest
from estimator_walks import DEVICE, straight

from pdr_est.estimators.common.measurement_checks import averaged_fixes
from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.types.measurements import PositionFix


def fix(time_s: float, east_m: float, sigma_m: float = 2.0, source: str = "gps") -> PositionFix:
    return PositionFix(time_s, np.array([east_m, 1.0]), sigma_m**2 * np.eye(2), source=source)


def test_ten_fixes_a_second_stay_as_they_are() -> None:
    fixes = tuple(fix(0.1 * k + 0.05, float(k)) for k in range(30))
    assert averaged_fixes(fixes) == fixes


def test_faster_fixes_are_their_weighted_mean_with_the_information_of_all() -> None:
    (one,) = averaged_fixes([fix(1.01, 4.0, 1.0), fix(1.03, 7.0, 2.0)])
    assert one.time_s == pytest.approx((1.01 + 1.03 / 4.0) / 1.25)
    assert one.position_m == pytest.approx([(4.0 + 7.0 / 4.0) / 1.25, 1.0])
    assert one.covariance_m2 == pytest.approx(np.eye(2) / 1.25)


def test_the_average_of_a_walk_at_constant_speed_lies_on_it() -> None:
    (one,) = averaged_fixes([fix(1.01, 1.4 * 1.01, 0.01), fix(1.05, 1.4 * 1.05, 0.05), fix(1.09, 1.4 * 1.09, 0.02)])
    assert one.position_m[0] == pytest.approx(1.4 * one.time_s, abs=1e-9)


def test_a_position_that_is_repeated_counts_once() -> None:
    (one,) = averaged_fixes([fix(1.00001, 4.1, 3.0), fix(1.02, 4.1, 3.0), fix(1.04, 4.1, 3.0)])
    assert one.position_m.tolist() == [4.1, 1.0]
    assert one.covariance_m2 == pytest.approx(9.0 * np.eye(2))


def test_sources_and_fixes_for_one_time_stay_apart() -> None:
    assert len(averaged_fixes([fix(1.01, 4.0), fix(1.02, 5.0, source="beacon")])) == 2
    assert len(averaged_fixes([fix(1.01, 4.0), fix(1.01, 9.0)])) == 2


def test_thousands_of_fixes_make_few_nodes() -> None:
    times_s = np.linspace(0.0, 20.0, 2000)
    timeline = build_timeline(DEVICE, 0.0, [*straight(40), *(fix(float(t), 0.7 * float(t)) for t in times_s)])
    assert len(timeline.nodes) < 300
    assert sum(len(node.fixes) for node in timeline.nodes) < 300
