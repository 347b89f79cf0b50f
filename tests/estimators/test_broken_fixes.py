"""Fixes that contradict each other, are repeated, late, gross, biased or of a wrong accuracy cannot ruin a walk."""

from collections import defaultdict
from functools import cache

import numpy as np
import pytest
from broken_fixes import BrokenWalk, broken_walk
from estimator_walks import run

from pdr_est.estimators import EstimatorName
from pdr_est.evaluate.consistency import coverage95
from pdr_est.types.track import Track

CASES = 500
SAMPLE = 5


@cache
def case_of(number: int) -> BrokenWalk:
    return broken_walk(number)


@cache
def estimated(name: EstimatorName, number: int) -> Track:
    case = case_of(number)
    track = run(name, case.walk.measurements, case.start)
    values = (track.position_m, track.heading_rad, track.covariance_m2, track.sigma_heading_rad, track.step_length_m)
    assert all(np.isfinite(value).all() for value in values)
    assert np.linalg.eigvalsh(track.covariance_m2)[:, 0].min() >= -1e-9
    assert track.length_scale > 0.0
    assert track.step_length_m.min() >= 0.0
    return track


def covered(track: Track, case: BrokenWalk) -> float:
    """Share of the true positions inside the 95 % ellipses of the track."""
    return coverage95(track.position_m - case.walk.truth[:, :2], track.covariance_m2, 1e-6)


@pytest.mark.parametrize("cases", [SAMPLE, pytest.param(CASES, marks=pytest.mark.slow)])
def test_no_number_is_negative_or_infinite_and_wrong_fixes_are_told(cases: int) -> None:
    warned = []
    for number in range(cases):
        case, track = case_of(number), estimated("factor-graph", number)
        if case.wrong_share > 0.1:
            warned.append(any(finding.doubtful for finding in track.findings))
    assert len(warned) > cases / 3
    assert np.mean(warned) >= 0.98


@pytest.mark.slow
@pytest.mark.parametrize("name", ["factor-graph", "ekf"])
def test_the_truth_is_covered_whatever_the_fault(name: EstimatorName) -> None:
    shares = defaultdict(list)
    for number in range(CASES):
        case = case_of(number)
        shares[case.fault].append(covered(estimated(name, number), case))
    # A filter learns of a stretch when it is there, and of a shifted clock where the walker turns.
    least_of = {"shifted": 0.8, "stretch": 0.84} if name == "ekf" else {}
    found = {fault: float(np.mean(own)) for fault, own in shares.items()}
    assert {fault: share for fault, share in found.items() if share < least_of.get(fault, 0.9)} == {}
    assert np.mean(list(found.values())) >= 0.9
