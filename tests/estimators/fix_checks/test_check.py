"""What the comparison of fixes and steps finds, and what it does about it."""

from dataclasses import replace

import numpy as np
import pytest
from broken_fixes import corridor_turns, gps_fixes, surveyed_points
from estimator_walks import DEVICE, SIGMA_SCALE, SimulatedWalk, fix, run, simulate, straight, usual_covariance

from pdr_est.estimators.fix_checks.check import CheckedWalk, check_fixes
from pdr_est.types.findings import FindingKind
from pdr_est.types.measurements import DeviceMeasurements, PositionFix, StartPose

UNKNOWN = StartPose()


def walk_and_fixes(number: int, gps: bool = False) -> tuple[SimulatedWalk, list[PositionFix]]:
    rng = np.random.default_rng([number, 5])
    walk = simulate(rng, corridor_turns(rng))
    return walk, gps_fixes(rng, walk.truth) if gps else surveyed_points(rng, walk.truth)


def checked(walk: SimulatedWalk, fixes: list[PositionFix], start: StartPose = UNKNOWN) -> CheckedWalk:
    device = DeviceMeasurements(DEVICE, 0.0, (*walk.odometry, *fixes))
    return check_fixes([device], start, SIGMA_SCALE)


def fixes_of(walk: CheckedWalk) -> list[PositionFix]:
    return [m for m in walk.devices[0].measurements if isinstance(m, PositionFix)]


def test_good_fixes_stay_as_they_are() -> None:
    told = 0
    for number in range(20):
        walk, fixes = walk_and_fixes(number, gps=number % 2 == 0)
        found = checked(walk, fixes, StartPose((0.0, 0.0), 0.0, 0.5, 0.1))
        told += len(found.findings) > 0
        if not found.findings:
            assert [one.position_m[0] for one in fixes_of(found)] == [one.position_m[0] for one in fixes]
    assert told <= 3


def test_a_walk_that_fits_is_the_same_object() -> None:
    device = DeviceMeasurements(DEVICE, 0.0, (*straight(40), *(fix(k, 0.7 * k, 0.0) for k in range(0, 41, 8))))
    found = check_fixes([device], UNKNOWN, SIGMA_SCALE)
    assert found.devices[0] is device
    assert found.findings == ()


def test_an_outlier_is_named_and_weighed_down() -> None:
    walk, fixes = walk_and_fixes(1)
    wrong = replace(fixes[2], position_m=fixes[2].position_m + np.array([0.0, 30.0]))
    found = checked(walk, [*fixes[:2], wrong, *fixes[3:]])
    (finding,) = found.findings
    assert finding.kind is FindingKind.FIXES
    assert finding.doubtful
    assert finding.value == pytest.approx(30.0, abs=4.0)
    assert f"1 of {len(fixes)} position fixes, at {wrong.time_s:.1f} s, disagree" in finding.message
    after = fixes_of(found)
    assert np.sqrt(after[2].covariance_m2[0, 0]) > 10.0
    assert np.sqrt(after[1].covariance_m2[0, 0]) < 1.5


def test_a_stretch_of_bad_gps_gets_an_error_of_its_own() -> None:
    walk, fixes = walk_and_fixes(12, gps=True)
    inside = [len(fixes) // 3 < i < len(fixes) // 2 for i in range(len(fixes))]
    bad = [
        replace(one, position_m=one.position_m + np.array([35.0, 10.0])) if there else one
        for one, there in zip(fixes, inside, strict=True)
    ]
    found = checked(walk, bad)
    assert any(
        "GPS between" in one.message and "disagrees with the steps by" in one.message for one in found.findings
    )
    after = fixes_of(found)
    of_bad = {one.source for one, there in zip(after, inside, strict=True) if there}
    assert all(name.startswith("gps from") for name in of_bad)
    of_good = [one.sigma_wander_m for one, there in zip(after, inside, strict=True) if not there]
    of_stretch = [one.sigma_wander_m for one, there in zip(after, inside, strict=True) if there]
    assert min(of_stretch) > max(15.0, 2.0 * np.median(of_good))


@pytest.mark.parametrize("shift_s", [-4.0, 3.0, -15.0, 11.0])
def test_a_shifted_clock_is_found(shift_s: float) -> None:
    rng = np.random.default_rng(6)
    walk = simulate(rng, corridor_turns(rng))
    fixes = [fix(k, *walk.truth[k, :2]) for k in range(0, len(walk.truth), 5)]
    late = [replace(one, time_s=one.time_s + shift_s) for one in fixes]
    found = checked(walk, [replace(one, clock_known=False) for one in late])
    (finding,) = [one for one in found.findings if one.kind is FindingKind.FIX_CLOCK]
    assert finding.value == pytest.approx(-shift_s, abs=0.6)
    assert ("late" in finding.message) == (shift_s > 0.0)
    assert fixes_of(found)[3].time_s == pytest.approx(fixes[3].time_s, abs=0.6)


def test_a_clock_that_is_known_is_not_corrected() -> None:
    rng = np.random.default_rng(6)
    walk = simulate(rng, corridor_turns(rng))
    fixes = [fix(k, *walk.truth[k, :2]) for k in range(0, len(walk.truth), 5)]
    found = checked(walk, [replace(one, time_s=one.time_s - 4.0, clock_known=True) for one in fixes])
    assert FindingKind.FIX_CLOCK not in [one.kind for one in found.findings]


def test_a_wrong_accuracy_is_found() -> None:
    walk, fixes = walk_and_fixes(12, gps=True)
    too_good = [
        replace(one, covariance_m2=one.covariance_m2 / 16.0, sigma_wander_m=one.sigma_wander_m / 4.0) for one in fixes
    ]
    found = checked(walk, too_good)
    (finding,) = [one for one in found.findings if one.kind is FindingKind.FIX_ACCURACY]
    assert finding.value is not None
    assert 2.0 < finding.value < 8.0
    assert fixes_of(found)[0].sigma_wander_m > 2.0 * too_good[0].sigma_wander_m


def test_a_start_heading_that_contradicts_the_fixes_is_taken_away() -> None:
    walk, fixes = walk_and_fixes(6)
    found = checked(walk, fixes, StartPose((0.0, 0.0), np.radians(170.0), 0.5, np.radians(5.0)))
    (finding,) = [one for one in found.findings if one.kind is FindingKind.START_HEADING]
    assert finding.message.startswith("start heading 170° ± 5° contradicts the fixes by 1")
    assert found.start.heading_rad is None
    assert found.start.position_m == (0.0, 0.0)


@pytest.mark.slow
def test_a_walker_of_unusual_steps_is_believed_and_told() -> None:
    rng = np.random.default_rng(8)
    walk = simulate(rng, corridor_turns(rng), scale=1.5)
    found = checked(walk, surveyed_points(rng, walk.truth), StartPose((0.0, 0.0), 0.0, 0.1, 0.05))
    assert found.sigma_length_scale > SIGMA_SCALE
    fixes = fixes_of(found)
    track = run("factor-graph", [*walk.odometry, *fixes], StartPose((0.0, 0.0), 0.0, 0.1, 0.05))
    (finding,) = [one for one in track.findings if one.kind is FindingKind.LENGTH_SCALE]
    assert finding.value == track.length_scale == pytest.approx(1.5, abs=0.15)
    assert finding.sigma == track.sigma_length_scale
    assert "sigma from usual" in finding.message


def test_a_start_position_that_contradicts_the_fixes_is_weighed_down() -> None:
    walk, fixes = walk_and_fixes(6)
    found = checked(walk, fixes, StartPose((30.0, -20.0), None, 0.5))
    assert any(one.message.startswith("the start position disagrees with the steps") for one in found.findings)
    assert found.start.sigma_position_m > 15.0


@pytest.mark.parametrize("way_m", [40.0, 30.0, -20.0])
def test_two_contradicting_fixes_leave_the_length_scale_alone(way_m: float) -> None:
    """Straight on for 70 m; the fixes are 30 m apart, or behind each other."""
    device = DeviceMeasurements(DEVICE, 0.0, (*straight(100), fix(0, 0.0, 0.0), fix(100, way_m, 0.0)))
    found = check_fixes([device], StartPose(None, 0.0, 0.0, 0.1), SIGMA_SCALE)
    assert any(one.doubtful for one in found.findings)
    assert all(np.sqrt(one.covariance_m2[0, 0]) > 0.3 * abs(70.0 - way_m) for one in fixes_of(found))


def test_repeated_fixes_count_once_and_are_told_unless_the_walker_stands() -> None:
    walk = [fix(k, 0.7 * k, 0.0) for k in (0, 20, 40)]
    repeated = [replace(walk[1], time_s=walk[1].time_s + late_s) for late_s in (0.0, 1.0, 2.0)]
    standing = [replace(walk[2], time_s=walk[2].time_s + late_s) for late_s in (1.0, 2.0)]
    device = DeviceMeasurements(DEVICE, 0.0, (*straight(40), *walk, *repeated, *standing))
    found = check_fixes([device], UNKNOWN, SIGMA_SCALE)
    assert len(fixes_of(found)) == 3
    assert found.findings[0].message == "3 of 8 position fixes repeat the one before: each counts once"


@pytest.mark.slow
def test_long_walks_are_compared_section_by_section() -> None:
    rng = np.random.default_rng(2)
    walk = simulate(rng, np.concatenate([corridor_turns(rng) for _ in range(12)]))
    fixes = surveyed_points(rng, walk.truth)
    wrong = len(fixes) - 5
    fixes[wrong] = replace(fixes[wrong], position_m=fixes[wrong].position_m + np.array([0.0, 40.0]))
    found = checked(walk, fixes, StartPose((0.0, 0.0), 0.0, 0.1, 0.1))
    assert len(fixes) > 100
    assert np.sqrt(fixes_of(found)[wrong].covariance_m2[0, 0]) > 10.0
    assert any(one.begin_s == fixes[wrong].time_s for one in found.findings)


def test_nothing_to_compare() -> None:
    device = DeviceMeasurements(DEVICE, 0.0, (*straight(10), fix(3, 1.0, 2.0)))
    assert check_fixes([device], UNKNOWN, SIGMA_SCALE).devices == (device,)
    assert check_fixes([], UNKNOWN, SIGMA_SCALE).devices == ()
    standing = DeviceMeasurements(DEVICE, 0.0, (fix(0, 0.0, 0.0), fix(2, 9.0, 0.0)))
    assert check_fixes([standing], UNKNOWN, SIGMA_SCALE).devices == (standing,)


def test_a_misfit_of_which_nothing_tells_the_cause_is_one_statement() -> None:
    """Every other fix lies 1.5 m to the left, the rest 1.5 m to the right: neither outliers nor steps explain it."""
    walk = straight(60)
    fixes = [fix(k, 0.7 * k, 1.5 * (-1.0) ** number, 0.7) for number, k in enumerate(range(0, 61, 6))]
    found = check_fixes([DeviceMeasurements(DEVICE, 0.0, (*walk, *fixes))], UNKNOWN, SIGMA_SCALE).findings
    (finding,) = found
    assert finding.kind in (FindingKind.FIXES, FindingKind.FIX_ACCURACY)


@pytest.mark.slow
def test_steps_are_blamed_only_where_the_evidence_tells_it() -> None:
    """With steps as they are stated hardly a walk is told that its steps disagree; with far worse ones most are."""
    blamed = {1.0: 0, 6.0: 0}
    for factor in blamed:
        for number in range(12):
            rng = np.random.default_rng([number, 9])
            walk = simulate(rng, corridor_turns(rng), covariance=factor**2 * usual_covariance(0.7))
            steps = [replace(one, covariance=usual_covariance(0.7)) for one in walk.odometry]
            near = [(k, *walk.truth[k, :2] + rng.normal(0.0, 0.3, 2)) for k in range(0, len(walk.truth), 4)]
            device = DeviceMeasurements(DEVICE, 0.0, (*steps, *(fix(k, x_m, y_m, 0.3) for k, x_m, y_m in near)))
            found = check_fixes([device], UNKNOWN, SIGMA_SCALE).findings
            assert len([one for one in found if one.kind in (FindingKind.STEPS, FindingKind.FIXES)]) <= 2
            blamed[factor] += any(one.kind is FindingKind.STEPS for one in found)
    assert blamed[1.0] <= 1
    assert blamed[6.0] >= 5
