"""Batch smoothing of a whole walk, of one device or several, in a GTSAM factor graph: estimator `factor-graph`.

The graph holds every measurement: steps, start, position fixes, heading priors and loop closures (`factors`), and the
tethers that are active at the optimum (`tether_factors`). Its optimum is found by Newton's method with an active set
(`newton`), the marginal covariances by `marginals`, and the walker's length scale beside the graph (`length_scale`);
the share of the scale is added to the marginals. `build` hands out the graph.
"""

import threading
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import gtsam
import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.huber import HUBER
from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.motion_model import MIN_SIGMA, GaussianState
from pdr_est.estimators.common.tethers import NodeTether, node_tethers_between
from pdr_est.estimators.common.timeline import Timeline, track_from_nodes
from pdr_est.estimators.factor_graph.length_scale import optimise_with_scales
from pdr_est.estimators.factor_graph.local_optima import Solution, starting_points
from pdr_est.estimators.factor_graph.marginals import marginal_covariances
from pdr_est.estimators.factor_graph.newton import CONTINUATION_FACTORS, EXACTLY_TETHERED, ROUGHLY, SOFTLY
from pdr_est.estimators.factor_graph.smoothing_problem import LengthScales, Point, SmoothingProblem, as_values
from pdr_est.estimators.pose_chains.line_search import EXACTLY
from pdr_est.estimators.pose_chains.linear_rows import to_map
from pdr_est.frames import Array
from pdr_est.types.measurements import DeviceTether, PositionFix, StartPose
from pdr_est.types.track import Track, concatenate

NAME = "factor-graph"
_SCALE_ROUNDS, _SOFT_SCALE_ROUNDS = 30, 2  # Newton steps on the scales, with tethers as they are and softened
_CUTTING_ROUNDS = 6  # rounds of adding tethers between the given ones

LARGE_STACK_POSES = 5_000
"""From how many poses on GTSAM's elimination, which recurses deeply, needs a large stack."""

_LEAST_REST = 1e-9  # share of the variance of a fix that its expected value does not have, against rounding
_STACK_BYTES = 512 * 1024 * 1024

T = TypeVar("T")


def estimate(
    timelines: Sequence[Timeline],
    tethers: Sequence[DeviceTether],
    start: StartPose,
    sigma_length_scale: float,
    start_headings_rad: Sequence[float | None] = (),
) -> Track:
    """Smooth the walk of all devices.

    Parameters
    ----------
    timelines : sequence of Timeline
        Measurements of each device.
    tethers : sequence of DeviceTether
        Largest distances between devices.
    start : StartPose
        Start of the walk.
    sigma_length_scale : float
        Standard deviation of the walker's length scale.
    start_headings_rad : sequence of float or None
        Heading of each device at the start to linearise at, where it is unknown; by default it is searched for.

    Returns
    -------
    Track
        Smoothed track with marginal covariances in the map frame.

    Raises
    ------
    EstimationError
        If the graph has no unique solution, or tethers do not fit the devices.
    """
    starts = starts_of(timelines, start)
    node_tethers = node_tethers_between(timelines, tethers)

    def work() -> tuple[SmoothingProblem, LengthScales, Array, Array]:
        best = lowest_optimum(timelines, node_tethers, starts, sigma_length_scale, start_headings_rad)
        problem, scales, at = best.problem, best.scales, best.at
        found = problem.banded_marginals(at, scales.value)
        if found is None:
            values = as_values(at)
            linear = problem.linear(values, scales.value, with_stiffness=False)
            found = marginals_of(problem, linear.factors, values)
        return problem, scales, *found

    problem, scales, pose, covariance = run_gtsam(work, sum(len(one.nodes) for one in timelines))
    return track_from_solution(problem, pose, covariance + scales.pose_covariance, scales)


def lowest_optimum(
    timelines: Sequence[Timeline],
    node_tethers: Sequence[NodeTether],
    starts: Sequence[StartPose],
    sigma_length_scale: float,
    headings_rad: Sequence[float | None] = (),
) -> Solution:
    """Find the optimum from each of the starting points, and return the one of the lowest cost.

    Each has a graph of its own: the prior of an unknown start heading lies about the initial one, so that it prefers
    none of them.
    """
    found = []
    for initial in starting_points(timelines, node_tethers, starts, sigma_length_scale, headings_rad):
        problem = SmoothingProblem(timelines, node_tethers, starts, initial)
        found.append(Solution(problem, *solve(problem, initial, sigma_length_scale)))
    return found[0] if len(found) == 1 else min(found, key=lambda one: one.cost(sigma_length_scale))


def solve(
    problem: SmoothingProblem, initial: Sequence[Sequence[GaussianState]], sigma_length_scale: float
) -> tuple[LengthScales, Point]:
    """Find the optimal length scales and values of poses and references, from initial states of each device."""
    expected = [states[-1].length_scale[0] if problem.scale_is_observable else 1.0 for states in initial]
    scales = LengthScales.known(np.array(expected), problem.keys)
    at, tethered = problem.initial_point(initial), len(problem.tethers) > 0
    for softening in CONTINUATION_FACTORS[:-1] if tethered else ():
        problem.softening = softening
        scales, at = optimise_with_scales(problem, at, scales, sigma_length_scale, SOFTLY, _SOFT_SCALE_ROUNDS)
        problem.add_violated_tethers(at)
    problem.softening = 1.0
    for _ in range(_CUTTING_ROUNDS if tethered or problem.scale_is_observable else 0):
        scales, at = optimise_with_scales(problem, at, scales, sigma_length_scale, ROUGHLY, _SCALE_ROUNDS)
        if not problem.add_violated_tethers(at):
            break
    at = problem.optimised(at, scales.value, EXACTLY_TETHERED if tethered else EXACTLY)
    if sigma_length_scale > 0.0 and not problem.scale_is_observable:
        scales = problem.prior_scales(at, scales.value, sigma_length_scale)
    return scales, at


def pose_marginals(
    problem: SmoothingProblem, graph: gtsam.NonlinearFactorGraph, values: gtsam.Values
) -> tuple[Array, Array]:
    """Compute the poses and their marginal covariances, for given length scales.

    Parameters
    ----------
    problem : SmoothingProblem
        The walk.
    graph, values
        Its complete graph and values; both may have further variables. Values of variables that the graph does not
        have are left out.

    Returns
    -------
    pose : (n, 3) array
        East m, north m, heading rad of all devices.
    covariance : (n, 3, 3) array
        Covariances in the map frame.
    """
    return marginals_of(problem, graph.linearize(values), values, *problem.further_variables(graph))


def marginals_of(
    problem: SmoothingProblem,
    linear: gtsam.GaussianFactorGraph,
    values: gtsam.Values,
    auxiliary: Sequence[int] = (),
    others: Sequence[int] = (),
) -> tuple[Array, Array]:
    """Compute `pose_marginals` from a linear system, with auxiliary and other variables beside those of the walk."""
    pose, count = problem.poses(values), problem.keys.poses
    rotation = to_map(pose[:, 2])
    covariance = marginal_covariances(linear, (*problem.variables.order, *others), auxiliary)
    own = np.array([covariance[key] for key in range(count)])
    return pose, rotation @ own @ rotation.transpose(0, 2, 1)


@dataclass(frozen=True)
class LeftOutFix:
    """Position fix of a device compared with what all other measurements say of it.

    Attributes
    ----------
    fix : PositionFix
        The fix, with the share of the device in its covariance.
    key : int
        Key of the pose that it is a measurement of.
    residual_m : (2,) array
        Measured position less the one expected without the fix, its wandering error included, m.
    covariance_m2 : (2, 2) array
        Covariance of the residual, m².
    """

    fix: PositionFix
    key: int
    residual_m: Array
    covariance_m2: Array


def left_out_fixes(
    problem: SmoothingProblem, graph: gtsam.NonlinearFactorGraph, values: gtsam.Values, scales: LengthScales
) -> list[LeftOutFix]:
    """Compute the leave-one-out residual of every fix from the marginal covariances of one solution.

    A fix whose white error has the covariance R, and whose expected value has the residual r and the covariance P,
    has to first order the residual R (R - P)⁻¹ r without the fix. For a robust fix that counts less, R is as much
    larger. Where several devices have a fix, the measurement of only one of them is left out at a time.

    Parameters
    ----------
    problem : SmoothingProblem
        The walk.
    graph, values : gtsam.NonlinearFactorGraph and gtsam.Values
        Its complete graph and values; both may have further variables.
    scales : LengthScales
        Its length scales.
    """
    linear, keys = graph.linearize(values), problem.keys
    pose, number = problem.poses(values), {known: i for i, known in enumerate(keys.fix_errors)}
    expected: dict[int, list[int]] = defaultdict(list)  # variables of the expected measurements, by pose
    left_out: list[tuple[int, PositionFix, Array, Array]] = []
    for key, fix in problem.fixes():
        own = int(gtsam.symbol("h", len(left_out)))
        value, per_log, to_east_north = pose[key, :2], scales.pose_per_log[key, :2], to_map(pose[key, 2:])[0, :2]
        blocks: list[Any] = [own, np.eye(2) / MIN_SIGMA, key, -to_east_north / MIN_SIGMA]
        if fix.sigma_wander_m > 0.0:
            error = number[fix.source, fix.time_s]
            blocks += [keys.first_fix_error + error, -fix.sigma_wander_m / MIN_SIGMA * np.eye(2)]
            value = value + fix.sigma_wander_m * values.atPoint2(keys.first_fix_error + error)
            per_log = per_log + fix.sigma_wander_m * scales.fix_error_per_log[error]
        blocks += [np.zeros(2), gtsam.noiseModel.Unit.Create(2)]
        linear.add(gtsam.JacobianFactor(*blocks))
        expected[key].append(own)
        left_out.append((own, fix, fix.position_m - value, per_log @ scales.log_covariance @ per_log.T))
    auxiliary, others = problem.further_variables(graph)
    order = [one for key in (*problem.variables.order, *others) for one in (*expected.get(key, ()), key)]
    spread = marginal_covariances(linear, order, auxiliary)
    of_pose = {own: key for key, some in expected.items() for own in some}
    return [
        LeftOutFix(fix, of_pose[own], *_left_out(fix, residual_m, spread[own] + of_scales))
        for own, fix, residual_m, of_scales in left_out
    ]


def _left_out(fix: PositionFix, residual_m: Array, spread_m2: Array) -> tuple[Array, Array]:
    """Return residual (2,) and covariance (2, 2) without a fix, given residual and covariance of what is expected."""
    root = np.linalg.cholesky(np.asarray(fix.covariance_m2, dtype=np.float64))
    white = np.linalg.solve(root, residual_m)
    inflated = max(1.0, float(np.hypot(*white)) / HUBER) if fix.robust else 1.0
    whitened = np.linalg.solve(root, np.linalg.solve(root, spread_m2).T) / inflated
    share, axes = np.linalg.eigh(0.5 * (whitened + whitened.T))
    rest = np.maximum(1.0 - share, _LEAST_REST)
    residual = root @ axes @ (axes.T @ white / rest)
    without = inflated * (root @ axes * (share / rest)) @ (root @ axes).T
    return residual, without + root @ root.T


def track_from_solution(problem: SmoothingProblem, pose: Array, covariance: Array, scales: LengthScales) -> Track:
    """Make the track of all devices from poses (n, 3) and their covariances (n, 3, 3) in the map frame."""
    tracks = []
    for d, (timeline, first) in enumerate(zip(problem.timelines, problem.keys.first, strict=True)):
        own = slice(first, first + len(timeline.nodes))
        scale = scales.of_device(d)
        position_m, heading_rad = pose[own, :2], pose[own, 2]
        tracks.append(track_from_nodes(timeline, position_m, heading_rad, covariance[own], "smoothed", NAME, scale))
    return concatenate(tracks)


def run_gtsam(work: Callable[[], T], poses: int) -> T:
    """Run `work`, with a large stack for a walk of many poses, and raise EstimationError where GTSAM fails."""
    try:
        return with_large_stack(work) if poses > LARGE_STACK_POSES else work()
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[0] if str(error).strip() else "no reason given"
        raise EstimationError(
            f"the factor graph has no unique solution ({reason}): give a start pose, more fixes, or use the ekf"
        ) from error


def with_large_stack(work: Callable[[], T]) -> T:
    """Run `work` in a thread with a stack of 512 MB and return its result; what it raises is raised here."""
    outcome: list[T] = []
    failure: list[BaseException] = []

    def run() -> None:
        try:
            outcome.append(work())
        except BaseException as error:
            failure.append(error)

    previous = threading.stack_size(_STACK_BYTES)
    try:
        thread = threading.Thread(target=run)
        thread.start()
    finally:
        threading.stack_size(previous)
    thread.join()
    if failure:
        raise failure[0]
    return outcome[0]
