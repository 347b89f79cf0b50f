"""Fixes that contradict each other, are repeated, late, gross, biased or of a wrong accuracy cannot ruin a walk."""

import numpy as np
import pytest
from broken_fixes import BrokenWalk, broken_walk
from estimator_walks import run

from pdr_est.estimators import EstimatorName
from pdr_est.types.track import Track

CASES = 500
SAMPLE = 60


def estimated(name: EstimatorName, case: BrokenWalk) -> Track:
    track = run(name, case.walk.measurements, case.start)
    values = (track.position_m, track.heading_rad, track.covariance_m2, track.sigma_heading_rad, track.step_length_m)
    assert all(np.isfinite(value).all() for value in values)
    assert np.linalg.eigvalsh(track.covariance_m2)[:, 0].min() >= -1e-9
    assert track.length_scale > 0.0
    assert track.step_length_m.min() >= 0.0
    return track


@pytest.mark.parametrize("name", ["factor-graph", "ekf"])
@pytest.mark.parametrize("cases", [SAMPLE, pytest.param(CASES, marks=pytest.mark.slow)])
def test_no_number_is_negative_or_infinite(name: EstimatorName, cases: int) -> None:
    for number in range(cases):
        estimated(name, broken_walk(number))
