"""What does not fit in a walk: fixes against the rest, the length scale, tethers, and an unknown direction."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from estimator_walks import (
    DEVICE,
    SIGMA_SCALE,
    fix,
    heading_prior,
    run,
    simulate,
    smooth_as_given,
    step,
    straight,
    winding,
)

from pdr_est.estimators import SPECS
from pdr_est.estimators.common.length_scale_check import length_scale_finding, track_scale_finding
from pdr_est.evaluate.walk_findings import findings_of
from pdr_est.evaluate.walk_findings.closure_check import closure_findings
from pdr_est.evaluate.walk_findings.fix_residuals import FALSE_ALARMS, fix_findings, fix_residual
from pdr_est.evaluate.walk_findings.prior_checks import unknown_direction_finding
from pdr_est.evaluate.walk_findings.tether_slack import tether_findings
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether, LoopClosure, PositionFix, StartPose
from pdr_est.types.track import concatenate

KNOWN = StartPose((0.0, 0.0), 0.0, 0.3, 0.05)


def walk_with_fixes(seed, every=15):
    """60 steps with errors as modelled, and fixes every so many steps."""
    rng = np.random.default_rng(seed)
    return simulate(rng, winding(60, rng), fix_every=every, first_fix=every)


@pytest.mark.parametrize("name", ["ekf", "factor-graph"])
@pytest.mark.parametrize("robust", [False, True])
def test_a_fix_is_compared_with_the_track_that_was_not_given_it(name, robust):
    walk = walk_with_fixes(3)
    moved = replace(walk.fixes[2], position_m=walk.fixes[2].position_m + np.array([4.0, -3.0]), robust=robust)
    others = [one for one in walk.fixes if one is not walk.fixes[2]]
    if name == "ekf":  # a filtered pose knows no later fix
        others = [one for one in others if one.time_s < moved.time_s]
    estimate = partial(run, name) if name == "ekf" else smooth_as_given
    track = estimate([*walk.odometry, *others, moved], KNOWN)
    (position_m,), (covariance_m2,) = estimate([*walk.odometry, *others], KNOWN).at([moved.time_s])
    found = fix_residual(moved, track)
    error_m = moved.position_m - position_m
    squared = error_m @ np.linalg.solve(covariance_m2 + moved.covariance_m2, error_m)
    if (
        robust and name == "factor-graph"
    ):  # it was given less weight, which is not known here: it pulls the track a little
        assert found.distance_m < np.hypot(*error_m)
        assert 0.4 * squared < found.squared < squared
    else:
        assert found.error_m == pytest.approx(error_m, abs=0.2)
        assert found.squared == pytest.approx(squared, rel=0.1)
        assert found.sigma_m == pytest.approx(found.distance_m / math.sqrt(found.squared))


def test_a_fix_within_a_step_is_compared_with_the_innovation_of_the_filter():
    within = fix(20.5, 14.0, 3.0)
    before = run("ekf", straight(30), KNOWN)
    track = run("ekf", [*straight(30), within], KNOWN)
    found = fix_residual(within, track)
    (position_m,), (covariance_m2,) = before.at([within.time_s])
    error_m = within.position_m - position_m
    assert found.error_m == pytest.approx(error_m, abs=0.1)  # the heading of the step has learnt from the fix
    assert found.squared == pytest.approx(
        error_m @ np.linalg.solve(covariance_m2 + within.covariance_m2, error_m), rel=0.1
    )


def test_a_filtered_track_that_begins_with_a_fix_cannot_judge_it():
    first = fix(0, 3.0, 4.0)
    assert fix_residual(first, run("ekf", [*straight(5), first], StartPose(None, 0.0))) is None


def test_a_fix_that_alone_tells_the_position_cannot_disagree():
    alone = fix(20, 100.0, -50.0)
    track = run("factor-graph", [*straight(30), alone], StartPose(None, 0.0))
    assert fix_residual(alone, track).squared < 1.0


@pytest.mark.parametrize("name", ["ekf", pytest.param("factor-graph", marks=pytest.mark.slow)])
def test_right_fixes_are_findings_as_seldom_as_stated(name):
    walks = [walk_with_fixes(seed) for seed in range(40)]
    alarms = [bool(fix_findings(run(name, walk.measurements, KNOWN), walk.fixes)) for walk in walks]
    assert FALSE_ALARMS == 0.01
    assert sum(alarms) <= 3  # with 0.4 expected, more than 3 have a probability of 0.1 %


def test_a_wrong_fix_is_named_with_time_distance_and_sigma():
    walk = walk_with_fixes(5)
    fixes = [*walk.fixes[:2], replace(walk.fixes[2], position_m=walk.fixes[2].position_m + np.array([0.0, 12.0]))]
    (found,) = fix_findings(run("ekf", [*walk.odometry, *fixes], KNOWN), fixes)
    assert (found.kind, found.begin_s, found.end_s, found.doubtful) == (FindingKind.FIXES, 22.5, 22.5, True)
    assert found.value == pytest.approx(12.0, abs=2.0)
    assert 0.5 < found.sigma < 2.5
    sigmas = found.value / found.sigma
    words = f"(waypoint) at 22.5 s disagrees with the rest of the walk by {found.value:.1f} m, {sigmas:.1f} times its"
    assert words in found.message


def test_the_smoother_names_the_worst_of_the_fixes_that_a_wrong_one_lets_disagree():
    walk = walk_with_fixes(5)
    fixes = [*walk.fixes[:2], replace(walk.fixes[2], position_m=walk.fixes[2].position_m + np.array([0.0, 12.0]))]
    (found,) = fix_findings(smooth_as_given([*walk.odometry, *fixes], KNOWN), fixes)
    assert found.message.startswith(
        "2 of 3 position fixes (waypoint) between 15.0 s and 22.5 s disagree with the rest of the walk, most the one "
        f"at 22.5 s: {found.value:.1f} m"
    )


def test_many_wrong_fixes_of_a_source_are_one_finding_and_a_told_span_is_not_told_again(make_track):
    track = make_track(range(20), [(float(x), 0.0) for x in range(20)], 0.01)
    wrong = [PositionFix(t, np.array([t, 9.0]), np.eye(2), "gps", True, 1.0) for t in np.arange(5.0, 9.0)]
    right = [PositionFix(t, np.array([t, 0.5]), np.eye(2), "gps", True, 1.0) for t in (1.0, 15.0)]
    (found,) = fix_findings(track, [*wrong, *right])
    assert (found.begin_s, found.end_s) == (5.0, 8.0)
    assert found.message.startswith("4 of 6 position fixes (gps) between 5.0 s and 8.0 s disagree")
    # 9 m from the track; variances: 1 of the fix, 1 of its wandering, 0.01 of the track, 0.0025 of the interpolation.
    assert (found.value, found.sigma) == (pytest.approx(9.0), pytest.approx(math.sqrt(2.0125)))
    told = replace(track, findings=(Finding(FindingKind.FIXES, "gps is bad", begin_s=4.0, end_s=9.0),))
    assert fix_findings(told, [*wrong, *right]) == []
    assert len(fix_findings(told, [*wrong[:-1], replace(wrong[-1], time_s=16.0)])) == 1


def test_a_fix_must_disagree_with_every_device(make_track):
    near = make_track([0.0, 1.0], [(0.0, 0.0), (1.0, 0.0)], 0.01)
    far = replace(near, device=np.array(["other"] * 2), position_m=near.position_m + np.array([0.0, 20.0]))
    one = PositionFix(1.0, np.array([1.0, 0.3]), np.eye(2))
    assert fix_findings(concatenate([near, far]), [one], used=False) == []
    assert len(fix_findings(far, [one], used=False)) == 1


def test_tracks_without_a_covariance_and_walks_without_fixes_have_no_finding(make_track):
    known = make_track([0.0, 1.0], [(0.0, 0.0), (1.0, 0.0)])
    track = replace(known, covariance_m2=np.full((2, 2, 2), np.inf))
    assert fix_findings(track, []) == []
    assert fix_findings(track, [PositionFix(1.0, np.array([90.0, 0.0]), np.eye(2))]) == []


@pytest.mark.parametrize(("scale", "words"), [(0.71, "0.71 is 3.1 sigma"), (1.4, "1.40 is 3.1 sigma"), (1.3, None)])
def test_length_scale_against_its_prior(scale, words):
    found = length_scale_finding(scale, 0.11)
    assert (found is None) == (words is None)
    if words:
        assert words in found.message
        assert (found.kind, found.value, found.sigma) == (FindingKind.LENGTH_SCALE, scale, None)
    assert length_scale_finding(scale, 0.0) is None


def test_the_length_scale_of_the_track_is_told_with_what_was_given():
    track = replace(run("factor-graph", straight(10), KNOWN), length_scale=1.5, sigma_length_scale=0.04)
    given = DeviceMeasurements(DEVICE, 0.0, (*straight(10), LoopClosure(DEVICE, 0.5)))
    found = track_scale_finding(track, [given], StartPose(), 0.11)
    assert (found.value, found.sigma) == (1.5, 0.04)
    assert "usual: the walk does not end where it began (--closed), steps were missed" in found.message
    assert "position fix" not in found.message
    assert "the start heading is wrong" in track_scale_finding(track, [given], KNOWN, 0.11).message


@pytest.mark.parametrize("name", ["ekf", "factor-graph"])
def test_a_walk_that_does_not_end_at_its_start_contradicts_its_closure(name):
    turns = np.repeat([0.0, np.pi / 2.0, 0.0], [20, 1, 20])
    walk = [step(k, 0.7, turn) for k, turn in enumerate(turns, 1)]
    device = DeviceMeasurements(DEVICE, 0.0, (*walk, LoopClosure(DEVICE, 0.5)))
    track = run(name, device.measurements, KNOWN)
    found = [one for one in findings_of(track, [device], [], KNOWN, 0.11, SPECS[name]) if one.doubtful]
    assert found[0].kind is FindingKind.CLOSURE
    assert "its steps lead 20.3 m away" in found[0].message
    assert not any("position fix" in one.message for one in found)


def test_a_walk_that_ends_at_its_start_fits_its_closure():
    turns = np.zeros(40)
    turns[[10, 20, 30]] = np.pi / 2.0
    told = 0
    for seed in range(20):
        walk = simulate(np.random.default_rng(seed), turns)
        out_m = walk.truth[-1, :2] - walk.truth[0, :2]
        device = DeviceMeasurements(DEVICE, 0.0, (*walk.odometry, LoopClosure(DEVICE, 0.5 + np.hypot(*out_m))))
        told += len(closure_findings([device], SIGMA_SCALE))
    assert told <= 1


@pytest.mark.parametrize("start", [StartPose(), StartPose((1.0, 2.0), 0.3), StartPose(None, 0.3)])
def test_a_direction_that_is_known_or_not_asked_for_is_no_finding(start):
    assert unknown_direction_finding([DeviceMeasurements(DEVICE, 0.0, tuple(straight(3)))], start) is None


def test_a_start_position_without_any_direction_is_a_finding():
    start = StartPose((1.0, 2.0))
    relative = replace(heading_prior(1, 0.2), relative=True)
    bare = DeviceMeasurements(DEVICE, 0.0, (*straight(3), relative))
    found = unknown_direction_finding([bare], start)
    assert found.kind is FindingKind.START_HEADING
    assert found.message.startswith("the direction of the track is unknown")
    assert "about its start" in found.message
    for further in (fix(3, 5.0, 5.0), heading_prior(1, 0.2)):
        assert unknown_direction_finding([replace(bare, measurements=(*bare.measurements, further))], start) is None


def test_one_position_without_any_direction_is_a_finding():
    device = DeviceMeasurements(DEVICE, 0.0, (*straight(9), fix(3, 5.0, 5.0), fix(6, 5.0, 5.0)))
    found = unknown_direction_finding([device], StartPose())
    assert "one position does not tell in which direction" in found.message
    for further in (fix(9, 5.0, 8.0), heading_prior(1, 0.2)):
        more = replace(device, measurements=(*device.measurements, further))
        assert unknown_direction_finding([more], StartPose()) is None
    assert unknown_direction_finding([device], StartPose(None, 0.3)) is None


def two_devices(make_track, apart_m, kind="smoothed"):
    """Two devices abreast for 10 s, apart_m between them; a step is 0.7 m."""
    time_s = np.arange(11.0)
    first = make_track(time_s, np.column_stack([0.7 * time_s, np.zeros(11)]))
    first = replace(first, kind=kind, step_length_m=np.where(time_s > 0.0, 0.7, 0.0))
    other = replace(
        first, device=np.array(["other"] * 11), position_m=first.position_m + np.c_[np.zeros(11), apart_m]
    )
    return concatenate([first, other])


TETHERS = [DeviceTether("device", "other", t, 0.5, 0.02) for t in np.arange(0.0, 11.0)]


def test_devices_farther_apart_than_their_tether(make_track):
    apart_m = np.full(11, 0.54)
    assert tether_findings(two_devices(make_track, apart_m), TETHERS) == []
    apart_m[4:7] = [0.6, 3.5, 0.56]
    (found,) = tether_findings(two_devices(make_track, apart_m), TETHERS)
    assert (found.kind, found.begin_s, found.end_s) == (FindingKind.TETHER, 4.0, 6.0)
    assert found.value == pytest.approx(3.0)
    assert "device and other are farther apart than 0.5 m for 27% of the time, by up to 3.0 m at 5 s" in found.message


def test_a_filter_may_have_the_devices_a_step_apart(make_track):
    assert tether_findings(two_devices(make_track, np.full(11, 1.1), "filtered"), TETHERS) == []
    assert len(tether_findings(two_devices(make_track, np.full(11, 1.3), "filtered"), TETHERS)) == 1


def test_the_estimators_own_finding_stands_for_the_general_one(make_track):
    start = StartPose((1.0, 2.0))
    devices = [DeviceMeasurements("device", 0.0, ())]
    track = replace(make_track([0.0], [(0.0, 0.0)]), length_scale=0.5)
    kinds = [one.kind for one in findings_of(track, devices, (), start, SIGMA_SCALE, SPECS["ekf"])]
    assert kinds == [FindingKind.START_HEADING, FindingKind.LENGTH_SCALE]
    own = replace(track, findings=tuple(Finding(kind, "own") for kind in kinds))
    assert findings_of(own, devices, (), start, SIGMA_SCALE, SPECS["ekf"]) == ()


def test_tethers_count_only_where_the_estimator_uses_them(make_track):
    track = two_devices(make_track, np.full(11, 9.0))
    devices = [DeviceMeasurements(name, 0.0, ()) for name in track.devices]
    found = {
        name: findings_of(track, devices, TETHERS, StartPose(), SIGMA_SCALE, SPECS[name])
        for name in ("dead-reckoning", "factor-graph")
    }
    assert found["dead-reckoning"] == ()
    assert [one.kind for one in found["factor-graph"]] == [FindingKind.TETHER]
