"""The public graph: it holds every measurement, GTSAM solves it, and users add factors of their own."""

from collections import Counter
from dataclasses import replace

import gtsam
import numpy as np
import pytest
from estimator_walks import DEVICE, STEP_S, fix, heading_prior, run, simulate, step, straight, winding

from pdr_est.errors import EstimationError
from pdr_est.estimators import estimate_walk
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Timeline, build_timeline
from pdr_est.estimators.factor_graph.build import WalkGraph, build_graph
from pdr_est.estimators.factor_graph.initial_values import initial_states
from pdr_est.estimators.factor_graph.smoothing_problem import SmoothingProblem
from pdr_est.performance.odometry import SIGMA_SCALE, walk_of
from pdr_est.performance.odometry import START as TETHERED_START
from pdr_est.types.measurements import LoopClosure, Measurement, StartPose

START = StartPose((0.0, 0.0), 0.0, 0.1, 0.1)


def optimised(graph: gtsam.NonlinearFactorGraph, values: gtsam.Values) -> gtsam.Values:
    """GTSAM's Levenberg-Marquardt, to the last digits."""
    parameters = gtsam.LevenbergMarquardtParams()
    parameters.setRelativeErrorTol(1e-14)
    parameters.setAbsoluteErrorTol(1e-14)
    return gtsam.LevenbergMarquardtOptimizer(graph, values, parameters).optimize()


def kinds(graph: gtsam.NonlinearFactorGraph) -> Counter[str]:
    return Counter(type(graph.at(i)).__name__ for i in range(graph.size()))


def measured(robust: bool = True) -> list[Measurement]:
    """30 steps with fixes at and within steps, three of them with a wandering error, and headings in the map and
    relative ones, some of all robust."""
    rng = np.random.default_rng(2)
    walk = simulate(rng, winding(30, rng), fix_every=10, sigma_fix_m=0.3)
    headings = [heading_prior(k, float(walk.truth[k, 2]), robust=robust and k == 20) for k in (4, 20)]
    relative = [replace(heading_prior(k, float(walk.truth[k, 2]) - 1.0), relative=True) for k in (2, 12, 27)]
    inside = [fix(7.4, *walk.truth[7, :2], robust=robust), fix(15.5, *walk.truth[15, :2])]
    off = np.array([2.0, 1.0])
    gps = [
        replace(fix(k, *(walk.truth[int(k), :2] + off), robust=robust and k == 18), source="gps", sigma_wander_m=2.0)
        for k in (6.5, 18, 24)
    ]
    return [*walk.measurements, *inside, *gps, *headings, *relative, LoopClosure(DEVICE, 30.0)]


def problem_of(
    known: list[Measurement],
) -> tuple[list[Timeline], list[NodeTether], list[StartPose], list[list[GaussianState]]]:
    timelines = [build_timeline(DEVICE, 0.0, known)]
    return timelines, [], [START], initial_states(timelines, [], [START], 0.0)


def test_every_measurement_of_a_walk_is_a_factor() -> None:
    built = build_graph(measured(), start=START)
    assert kinds(built.graph) == {
        "PriorFactorPose2": 2,  # start, and the vague one of the reference
        "BetweenFactorPose2": 30 + 3 + 3 + 1,  # steps, three of them divided, relative headings, closure
        "PoseTranslationPrior2D": 4 + 2,
        "PoseRotationPrior2D": 2,
        "CustomFactor": 3,  # fixes with a wandering error
        "PriorFactorPoint2": 1,  # the first of these errors
        "LinearContainerFactor": 2,  # how it goes on
    }
    assert built.values.size() == 34 + 1 + 3
    assert built.keys.reference_of(DEVICE) == 34


def test_the_key_of_a_wandering_error_is_found_by_source_and_time() -> None:
    built = build_graph(measured(), start=START, optimised=True)
    assert [built.keys.of_fix_error("gps", STEP_S * k) for k in (6.5, 18, 24)] == [35, 36, 37]
    assert built.values.atPoint2(36) * 2.0 == pytest.approx([2.0, 1.0], abs=0.5)
    with pytest.raises(EstimationError, match="sigma_wander_m is not 0"):
        built.keys.of_fix_error("gps", 1.0)


def test_fixes_linearised_together_are_the_factors() -> None:
    built = build_graph(measured(), start=START)
    problem = SmoothingProblem(*problem_of(measured()))
    values = gtsam.Values(built.values)
    for key in built.keys.of_device(DEVICE):
        values.update(key, built.values.atPose2(key).retract(np.array([0.3, -0.2, 0.1])))
    for number in range(3):
        values.update(built.keys.first_fix_error + number, np.array([0.5, -1.0 + number]))
    together = problem.without_tethers(np.ones(1))
    assert together.error(values) == pytest.approx(built.graph.error(values), rel=1e-12)
    linear, expected = together.linearize(values), built.graph.linearize(values)
    order = gtsam.Ordering()
    for key in range(values.size()):
        order.push_back(key)
    for found, exact in zip(linear.hessian(order), expected.hessian(order), strict=True):
        np.testing.assert_allclose(found, exact, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("robust", "within_m"), [(False, 3e-6), (True, 1e-5)])
@pytest.mark.parametrize("start", [START, StartPose()], ids=["known start", "unknown start"])
def test_gtsam_finds_the_track_of_the_estimator(start: StartPose, robust: bool, within_m: float) -> None:
    """Robust factors are linearised with their weights, and both optimisers come near to the optimum only slowly."""
    expected = run("factor-graph", measured(robust), start, 0.0)
    built = build_graph(measured(robust), start=start)
    found = optimised(built.graph, built.values)
    track = built.track_from(found)
    assert np.abs(built.track_from().position_m - expected.position_m).max() > 1e-4  # it was not there yet
    assert track.position_m == pytest.approx(expected.position_m, abs=within_m)
    assert track.heading_rad == pytest.approx(expected.heading_rad, abs=within_m)
    assert track.covariance_m2 == pytest.approx(expected.covariance_m2, rel=1e-4, abs=1e-7)
    assert (track.kind, track.estimator, list(track.devices)) == ("smoothed", "factor-graph", [DEVICE])


@pytest.mark.parametrize("sigma_scale", [0.0, 0.1])
def test_the_optimised_graph_is_that_of_the_estimator(sigma_scale: float) -> None:
    expected = run("factor-graph", measured(), START, sigma_scale)
    built = build_graph(measured(), start=START, sigma_length_scale=sigma_scale, optimised=True)
    track = built.track_from()
    for name in ("position_m", "heading_rad", "covariance_m2", "sigma_heading_rad", "time_s", "step_length_m"):
        np.testing.assert_array_equal(getattr(track, name), getattr(expected, name))
    assert built.length_scales == pytest.approx([expected.length_scale])
    assert built.graph.error(optimised(built.graph, built.values)) == pytest.approx(
        built.graph.error(built.values), abs=1e-7
    )


def test_without_positions_the_length_scale_is_as_uncertain_as_its_prior() -> None:
    steps = straight(30)
    expected = run("factor-graph", steps, START, 0.1)
    track = build_graph(steps, start=START, sigma_length_scale=0.1).track_from()
    assert track.covariance_m2 == pytest.approx(expected.covariance_m2)
    assert track.sigma_length_scale == pytest.approx(0.1)


def test_covariances_with_wandering_errors_are_gtsam_s() -> None:
    built = build_graph(measured(), start=START, optimised=True)
    exact, track = gtsam.Marginals(built.graph, built.values), built.track_from()
    for row in (0, 7, 18, 30):
        key = built.keys.of(DEVICE, track.time_s[row])
        turn = built.values.atPose2(key).rotation().matrix()
        expected = turn @ exact.marginalCovariance(key)[:2, :2] @ turn.T
        np.testing.assert_allclose(track.covariance_m2[row], expected, rtol=1e-5)


def tethered(steps: int = 150, **options: object) -> WalkGraph:
    known, tethers = walk_of(steps, 2)
    return build_graph(known, tethers=tethers, start=TETHERED_START, **options)  # type: ignore[arg-type]


def test_every_active_tether_is_a_range_factor_and_the_error_is_that_of_the_result() -> None:
    known, tethers = walk_of(150, 2)
    expected = estimate_walk("factor-graph", known, TETHERED_START, SIGMA_SCALE, tethers)
    built = tethered(sigma_length_scale=SIGMA_SCALE, optimised=True)
    found = kinds(built.graph)
    active = len(built.active_tethers)
    places = sum(built.keys.poses <= max(ends) for ends in built.active_tethers)
    assert active > 5
    assert found["RangeFactorPose2"] == active
    assert found["LinearContainerFactor"] == places
    assert found["BetweenFactorPose2"] == built.keys.poses - 2 + 2 * places
    track = built.track_from()
    np.testing.assert_array_equal(track.position_m, expected.position_m)
    # The estimator has a tether as one row, the graph with auxiliary variables that are eliminated to this row; and
    # normal equations, which square the condition number.
    np.testing.assert_allclose(track.covariance_m2, expected.covariance_m2, rtol=5e-6, atol=1e-7)
    solved = optimised(built.graph, built.values)
    assert built.graph.error(built.values) == pytest.approx(built.graph.error(solved), abs=1e-4)
    assert built.track_from(solved).position_m == pytest.approx(expected.position_m, abs=1e-3)


def test_its_covariances_are_gtsam_s() -> None:
    built = tethered(optimised=True)
    exact, track = gtsam.Marginals(built.graph, built.values), built.track_from()
    for device in built.keys.devices:
        own = track.of_device(device)
        for row in (30, 90, 150):
            key = built.keys.of(device, own.time_s[row])
            turn = built.values.atPose2(key).rotation().matrix()
            expected = turn @ exact.marginalCovariance(key)[:2, :2] @ turn.T
            np.testing.assert_allclose(own.covariance_m2[row], expected, rtol=1e-5)


@pytest.mark.slow
def test_gtsam_finds_the_tethered_track_when_tethers_are_exchanged_and_softened_at_first() -> None:
    built, expected = tethered(60), tethered(60, optimised=True)
    values, solutions = built.values, 0
    for softening in (64.0, 8.0, 1.0):
        for _ in range(20):
            before, built = built.active_tethers, built.with_tethers_at(values, softening)
            values = optimised(built.graph, built.values)
            solutions += 1
            if built.active_tethers == before:
                break
    assert solutions < 40
    assert built.graph.error(values) == pytest.approx(expected.graph.error(expected.values), abs=2e-3)
    apart = built.track_from(values).position_m - expected.track_from().position_m
    assert np.abs(apart).max() < 0.02


def test_the_graph_can_be_written_and_read() -> None:
    built = tethered(optimised=True)
    again = gtsam.NonlinearFactorGraph()
    again.deserialize(built.graph.serialize())
    assert again.error(built.values) == pytest.approx(built.graph.error(built.values), rel=1e-9)


def test_a_landmark_of_the_user_pulls_the_track() -> None:
    """A beacon beside the end of a walk whose direction is uncertain; the range to it settles the direction."""
    built = build_graph(straight(30), start=StartPose((0.0, 0.0), 0.0, 0.1, 0.2))
    graph, values, beacon = gtsam.NonlinearFactorGraph(built.graph), gtsam.Values(built.values), gtsam.symbol("l", 0)
    graph.add(gtsam.PriorFactorPoint2(beacon, np.array([21.0, 5.0]), gtsam.noiseModel.Isotropic.Sigma(2, 0.05)))
    graph.add(
        gtsam.RangeFactor2D(
            built.keys.of(DEVICE, 30 * STEP_S), beacon, 3.0, gtsam.noiseModel.Isotropic.Sigma(1, 0.05)
        )
    )
    values.insert(beacon, np.array([21.0, 5.0]))
    found = optimised(graph, values)
    track, plain = built.track_from(found, graph), built.track_from()
    assert np.hypot(*(track.position_m[-1] - [21.0, 5.0])) == pytest.approx(3.0, abs=0.05)
    assert track.position_m[-1, 1] > 1.5
    assert plain.covariance_m2[-1, 1, 1] > 16.0 * track.covariance_m2[-1, 1, 1]
    exact = gtsam.Marginals(graph, found).marginalCovariance(built.keys.of(DEVICE, 30 * STEP_S))
    turn = found.atPose2(30).rotation().matrix()
    np.testing.assert_allclose(track.covariance_m2[-1], turn @ exact[:2, :2] @ turn.T, rtol=1e-6)


def test_tethers_are_exchanged_and_the_variables_of_the_user_stay() -> None:
    built = tethered(optimised=True)
    values, beacon = gtsam.Values(built.values), gtsam.symbol("l", 0)
    values.insert(beacon, np.array([1.0, 2.0]))
    apart = built.keys.of("phone2", 40.0)
    values.update(apart, values.atPose2(apart).compose(gtsam.Pose2(5.0, 0.0, 0.0)))
    exchanged = built.with_tethers_at(values)
    assert exchanged.active_tethers != built.active_tethers
    assert exchanged.values.atPoint2(beacon) == pytest.approx([1.0, 2.0])
    assert kinds(exchanged.graph)["RangeFactorPose2"] == len(exchanged.active_tethers) > len(built.active_tethers)
    assert kinds(built.graph)["RangeFactorPose2"] == len(built.active_tethers)  # the first one is as it was
    softer = built.with_tethers_at(values, softening=8.0)
    assert softer.graph.error(softer.values) < exchanged.graph.error(exchanged.values)


def test_keys_are_found_by_device_and_time() -> None:
    built = tethered(pose_times_s=(10.1,))
    keys = built.keys
    assert keys.of("phone1", 0.0) == 0
    assert keys.of("phone2", 0.06) == keys.of_device("phone2")[0] == len(keys.of_device("phone1"))
    asked = [int(np.flatnonzero(np.isclose(times_s, 10.1))[0]) for times_s in keys.times_s]
    assert [keys.of(device, 10.1) for device in keys.devices] == [
        keys.of_device(device)[node] for device, node in zip(keys.devices, asked, strict=True)
    ]
    assert keys.of("phone1", 10.11) == keys.of("phone1", 10.1)  # the last pose before
    assert keys.of("phone1", 1e6) == keys.of_device("phone1")[-1]
    assert keys.reference_of("phone1") is None
    with pytest.raises(EstimationError, match=r"unknown device 'watch': name one of phone1, phone2"):
        keys.of("watch", 1.0)
    with pytest.raises(EstimationError, match=r"pose of phone2 at 0\.01 s: its walk begins at 0\.05 s"):
        keys.of("phone2", 0.01)


def test_a_fix_of_two_devices_is_shared_as_in_the_estimator() -> None:
    known, tethers = walk_of(40, 2)
    place = fix(20, 11.5, 4.0)  # near the tracks, so that the estimator takes it as it is
    with_fix = [replace(one, measurements=(*one.measurements, place)) for one in known]
    expected = estimate_walk("factor-graph", with_fix, TETHERED_START, 0.0, tethers)
    built = build_graph(known, [place], tethers, TETHERED_START, optimised=True)
    np.testing.assert_array_equal(built.track_from().position_m, expected.position_m)


def test_unusable_arguments_are_refused() -> None:
    with pytest.raises(EstimationError, match=r"0 measurements with 0 steps and 0 devices: give the odometry"):
        build_graph([])
    known, _ = walk_of(5)
    with pytest.raises(EstimationError, match=r"2 measurements with 1 steps and 1 devices"):
        build_graph([*known, step(1)])  # type: ignore[list-item]
    built = build_graph(known)
    with pytest.raises(EstimationError, match=r"6 variables have no value, the first is 0: give values of all keys"):
        built.track_from(gtsam.Values())
    with pytest.raises(EstimationError, match=r"6 variables have no value, the first is 5"):
        built.with_tethers_at(gtsam.Values())
    graph = gtsam.NonlinearFactorGraph(built.graph)
    graph.add(gtsam.PriorFactorPoint2(gtsam.symbol("l", 0), np.zeros(2), gtsam.noiseModel.Isotropic.Sigma(2, 1.0)))
    with pytest.raises(EstimationError, match=r"1 variables have no value, the first is l0"):
        built.track_from(graph=graph)
