"""Findings about a walk that goes on."""

from dataclasses import dataclass, replace

import numpy as np

from pdr_est.evaluate.walk_findings import FindingsSoFar
from pdr_est.evaluate.walk_findings.so_far import QUIET_S
from pdr_est.types.findings import FindingKind
from pdr_est.types.measurements import PositionFix


@dataclass(frozen=True)
class Pose:
    time_s: float
    position_m: np.ndarray
    device: str = "phone"
    heading_rad: float = 0.0
    step_length_m: float = 0.7

    @property
    def moving_from_s(self) -> float:
        return self.time_s - 0.5

    @property
    def covariance_m2(self) -> np.ndarray:
        return 0.04 * np.eye(2)


def pose(number, device="phone", north_m=0.0):
    """The end of a step to the east; there are two steps a second."""
    return Pose(0.5 * number, np.array([0.7 * number, north_m]), device)


def fix(number, north_m, source="waypoint"):
    return PositionFix(0.5 * number - 0.1, np.array([0.7 * number - 0.14, north_m]), 0.25 * np.eye(2), source)


def test_a_fix_is_told_once_when_a_pose_after_it_has_come():
    findings = FindingsSoFar(0.1)
    assert findings.add([pose(k) for k in range(10)], 1.0) == []
    findings.add_fix(fix(10, 5.0))
    assert findings.add([pose(8)], 1.0) == []
    (found,) = findings.add([pose(10)], 1.0)
    assert (found.kind, found.begin_s, found.end_s) == (FindingKind.FIXES, 4.9, 4.9)
    assert found.value == 5.0
    assert findings.add([pose(10), pose(11)], 1.0) == []


def test_a_fix_that_fits_is_no_finding_and_a_changed_pose_counts():
    findings = FindingsSoFar(0.1)
    findings.add([pose(k) for k in range(10)], 1.0)
    findings.add([pose(k, north_m=5.0) for k in range(10)], 1.0)  # filtered again
    findings.add_fix(fix(10, 5.2))
    assert findings.add([pose(10, north_m=5.0)], 1.0) == []


def test_a_source_that_goes_on_to_disagree_is_told_again_after_a_while():
    findings = FindingsSoFar(0.1)
    told = []
    for k in range(1, 200):
        findings.add_fix(fix(k, 9.0, "gps"))
        told += findings.add([pose(k - 1), pose(k)], 1.0)
    times_s = np.array([found.begin_s for found in told])
    assert len(times_s) == 4
    assert (np.diff(times_s) > QUIET_S).all()


def test_several_devices_must_all_disagree():
    findings = FindingsSoFar(0.1)
    findings.add([pose(k, device) for k in range(10) for device in ("1L", "2R")], 1.0)
    findings.add_fix(fix(9, 5.0))
    assert len(findings.add([pose(9, "1L"), pose(9, "2R")], 1.0)) == 1
    findings = FindingsSoFar(0.1)
    findings.add([pose(k, "1L") for k in range(10)] + [pose(k, "2R", 5.0) for k in range(10)], 1.0)
    findings.add_fix(fix(9, 5.0))
    assert findings.add([pose(9, "1L")], 1.0) == []


def test_more_fixes_need_a_larger_disagreement():
    """An error with a probability of 1 in 1000 is no finding among hundreds, and one in 1e9 is."""
    sigma_m = np.sqrt(0.25 + 0.04 + 0.0025 + (0.1 * 0.8 * 0.7) ** 2)
    for share, count in ((1e-3, 0), (1e-9, 1)):
        findings = FindingsSoFar(0.1)
        for k in range(1, 100):
            findings.add_fix(fix(k, 0.0))
            assert findings.add([pose(k - 1), pose(k)], 1.0) == []
        findings.add_fix(fix(100, sigma_m * np.sqrt(-2.0 * np.log(share))))
        assert len(findings.add([pose(99), pose(100)], 1.0)) == count


def test_an_unusual_length_scale_is_told_once():
    findings = FindingsSoFar(0.1)
    assert findings.add([pose(1)], 1.2) == []
    (found,) = findings.add([pose(2)], 0.7)
    assert found.kind is FindingKind.LENGTH_SCALE
    assert findings.add([pose(3)], 0.6) == []


def test_memory_is_bounded():
    findings = FindingsSoFar(0.1)
    for k in range(1500):
        findings.add_fix(replace(fix(k, 0.0), time_s=1e6 + k))
        findings.add([pose(k)], 1.0)
    kept = [value for value in vars(findings).values() if isinstance(value, list | dict)]
    assert sum(len(own) for one in kept for own in (one.values() if isinstance(one, dict) else [one])) < 700
