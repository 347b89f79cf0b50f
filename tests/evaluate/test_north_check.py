"""A phone whose north contradicts the fixes is named, one that agrees is not."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est import estimate
from pdr_est.evaluate.walk_findings.north_check import north_findings
from pdr_est.types.findings import FindingKind
from pdr_est.types.measurements import DeviceMeasurements, HeadingPrior, PositionFix, StepOdometry


def straight_east(north_off_rad: float) -> DeviceMeasurements:
    """Forty steps to the east between good fixes, with a north that is off."""
    covariance = np.diag([0.01, 0.01, 1e-4])
    steps = [StepOdometry("phone", 0.5 * (k + 1), 0.5 * k, 0.7, 0.0, covariance) for k in range(40)]
    fixes = [PositionFix(t, np.array([1.4 * t, 0.0]), 0.01 * np.eye(2)) for t in (0.0, 10.0, 20.0)]
    priors = [HeadingPrior("phone", t, north_off_rad, 0.3) for t in (0.5, 5.0, 10.0, 15.0)]
    return DeviceMeasurements("phone", 0.0, (*steps, *fixes, *priors))


@pytest.mark.parametrize("off_rad", [0.9, -0.9])
def test_a_north_that_contradicts_the_fixes_is_named(off_rad: float) -> None:
    measured = straight_east(off_rad)
    track = estimate([measured])
    (found,) = north_findings(track, [measured])
    assert found.kind is FindingKind.NORTH
    assert found.value == pytest.approx(off_rad, abs=0.05)
    assert found.sigma == pytest.approx(0.15)
    assert ("to the left" in found.message) == (off_rad > 0.0)


def test_a_north_that_agrees_and_relative_directions_are_not() -> None:
    measured = straight_east(0.2)
    assert north_findings(estimate([measured]), [measured]) == []
    askew = straight_east(0.9)
    relative = tuple(
        replace(one, relative=True) if isinstance(one, HeadingPrior) else one for one in askew.measurements
    )
    assert north_findings(estimate([askew]), [replace(askew, measurements=relative)]) == []
