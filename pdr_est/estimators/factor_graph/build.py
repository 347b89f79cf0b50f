"""The factor graph of a walk for users who add factors of their own and solve it with GTSAM: `build_graph`."""

from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import dataclass, field, replace

import gtsam
import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import timelines_of
from pdr_est.estimators.factor_graph.initial_values import initial_states
from pdr_est.estimators.factor_graph.keys import GraphKeys
from pdr_est.estimators.factor_graph.smoother import (
    LeftOutFix,
    left_out_fixes,
    lowest_optimum,
    pose_marginals,
    run_gtsam,
    track_from_solution,
)
from pdr_est.estimators.factor_graph.smoothing_problem import LengthScales, SmoothingProblem, as_values
from pdr_est.frames import Array
from pdr_est.types.measurements import (
    DeviceMeasurements,
    DeviceTether,
    Measurement,
    PositionFix,
    StartPose,
    StepOdometry,
)
from pdr_est.types.track import Track

_UNKNOWN_START = StartPose()


@dataclass(frozen=True)
class WalkGraph:
    """Factor graph of a walk, with everything that was measured.

    Attributes
    ----------
    graph : gtsam.NonlinearFactorGraph
        One factor for each start, step, position fix, heading prior and loop closure, those of the wandering errors
        of fixes (`wandering_errors`), and a RangeFactorPose2 for each tether that is active at `values`, with
        auxiliary factors where it ends between two poses (`tether_factors`).
    values : gtsam.Values
        Value of each variable of the graph.
    keys : GraphKeys
        Keys of the variables.
    length_scales : (d,) array
        Length scale of each device, at which the steps of the graph are.
    """

    graph: gtsam.NonlinearFactorGraph = field(repr=False)
    values: gtsam.Values = field(repr=False)
    keys: GraphKeys
    length_scales: Array
    _problem: SmoothingProblem = field(repr=False)
    _scales: LengthScales = field(repr=False)
    _sigma_length_scale: float = field(repr=False)

    @property
    def active_tethers(self) -> frozenset[tuple[int, int]]:
        """Keys of the two ends of each active tether: poses, or places between two poses (``p`` symbols)."""
        factors = map(self.graph.at, range(self.graph.size()))
        ends = [one.keys() for one in factors if isinstance(one, gtsam.RangeFactorPose2)]
        return frozenset((int(a), int(b)) for a, b in ends)

    def with_tethers_at(self, values: gtsam.Values, softening: float = 1.0) -> "WalkGraph":
        """Return the graph with those tethers that are active at some values.

        A tether has a factor only where it is violated, and that factor would also keep its ends from coming closer.
        After the solution has moved, other tethers are active: solve, call this, add your factors again, and repeat
        until `active_tethers` does not change.

        Parameters
        ----------
        values : gtsam.Values
            Values of all poses, references and wandering errors. Other variables of yours are kept.
        softening : float
            Factor on the standard deviations of the tethers. GTSAM's optimisers hardly move a long walk with stiff
            tethers; solve with 64, then 8, then 1 if the solution is far away.
        """
        problem, own = copy(self._problem), _without_auxiliary(self._problem, values)
        _refuse_missing(own, problem.variables.order)
        problem.add_violated_tethers(own)
        problem.softening = softening
        graph, complete = problem.complete(own, self.length_scales)
        return replace(self, graph=graph, values=complete, _problem=problem)

    def left_out_fixes(
        self, values: gtsam.Values | None = None, graph: gtsam.NonlinearFactorGraph | None = None
    ) -> list[LeftOutFix]:
        """Return the leave-one-out residual of every fix (`smoother.left_out_fixes`).

        Squared and divided by its covariance, it has a chi-squared distribution with 2 degrees of freedom if
        everything is as stated.

        Parameters
        ----------
        values : gtsam.Values, optional
            Solution; by default the values of this graph, which are one if it was built as `optimised`.
        graph : gtsam.NonlinearFactorGraph, optional
            Graph of the solution; by default this one.

        Raises
        ------
        EstimationError
            If a variable has no value, or the graph has no unique solution.
        """
        at = self.values if values is None else values
        whole = self.graph if graph is None else graph
        _refuse_missing(at, whole.keyVector())
        return run_gtsam(lambda: left_out_fixes(self._problem, whole, at, self._scales), self.keys.poses)

    def track_from(
        self, values: gtsam.Values | None = None, graph: gtsam.NonlinearFactorGraph | None = None
    ) -> Track:
        """Return the track of some values, with marginal covariances.

        Parameters
        ----------
        values : gtsam.Values, optional
            Solution; by default the values of this graph.
        graph : gtsam.NonlinearFactorGraph, optional
            Graph that the covariances are of, such as this one with your factors; by default this one.

        Returns
        -------
        Track
            Smoothed track of all devices. Its covariances contain the uncertainty of the length scale that the
            estimator `factor-graph` found. If the graph was not built as `optimised`, and positions were measured,
            they are those for the given length scale.

        Raises
        ------
        EstimationError
            If a variable has no value, or the graph has no unique solution.
        """
        at = self.values if values is None else values
        whole = self.graph if graph is None else graph
        _refuse_missing(at, whole.keyVector())
        problem, scales = self._problem, self._scales
        if self._sigma_length_scale > 0.0 and not problem.scale_is_observable:
            scales = problem.prior_scales(at, self.length_scales, self._sigma_length_scale)
        pose, covariance = run_gtsam(lambda: pose_marginals(problem, whole, at), self.keys.poses)
        return track_from_solution(problem, pose, covariance + scales.pose_covariance, scales)


def build_graph(
    measurements: Sequence[DeviceMeasurements] | Sequence[Measurement],
    fixes: Iterable[PositionFix] = (),
    tethers: Sequence[DeviceTether] = (),
    start: StartPose = _UNKNOWN_START,
    sigma_length_scale: float = 0.0,
    *,
    pose_times_s: Iterable[float] = (),
    optimised: bool = False,
) -> WalkGraph:
    """Build the factor graph of a walk, that of the estimator `factor-graph`.

    Parameters
    ----------
    measurements : sequence of DeviceMeasurements, or of measurements of one device
        What is known of each device; of one device its odometry is enough, with heading priors among it or not.
    fixes : iterable of PositionFix
        Position fixes in the map frame, which hold for all devices.
    tethers : sequence of DeviceTether
        Largest distances between devices.
    start : StartPose
        Start of the walk.
    sigma_length_scale : float
        Standard deviation of the walker's length scale; 0 keeps the scale 1.
    pose_times_s : iterable of float
        Further times at which each device gets a pose, such as those of measurements of your own, s.
    optimised : bool
        Whether `values`, length scales and active tethers are those of the optimum; otherwise they are the initial
        ones, those of the Kalman smoother.

    Returns
    -------
    WalkGraph
        Graph, values and keys.

    Raises
    ------
    EstimationError
        For measurements that are out of order or without steps, for tethers that do not fit the devices, and if the
        optimum is asked for and is not unique.
    """
    given = tuple(fixes)
    devices = [replace(one, measurements=(*one.measurements, *given)) for one in _devices(measurements)]
    timelines = timelines_of(devices, tethers, pose_times_s)
    starts, node_tethers = starts_of(timelines, start), node_tethers_between(timelines, tethers)
    if optimised:
        poses = sum(len(one.nodes) for one in timelines)
        best = run_gtsam(lambda: lowest_optimum(timelines, node_tethers, starts, sigma_length_scale), poses)
        problem, scales, values = best.problem, best.scales, as_values(best.at)
    else:
        initial = initial_states(timelines, node_tethers, starts, sigma_length_scale)
        problem = SmoothingProblem(timelines, node_tethers, starts, initial)
        expected = [states[-1].length_scale[0] if problem.scale_is_observable else 1.0 for states in initial]
        scales = LengthScales.known(np.array(expected), problem.keys)
        values = problem.initial_values(initial)
        problem.add_violated_tethers(values)
    graph, complete = problem.complete(values, scales.value)
    return WalkGraph(graph, complete, problem.keys, scales.value, problem, scales, sigma_length_scale)


def _devices(measurements: Sequence[DeviceMeasurements] | Sequence[Measurement]) -> list[DeviceMeasurements]:
    """Return the measurements of each device; a sequence of measurements is that of one device."""
    devices = [one for one in measurements if isinstance(one, DeviceMeasurements)]
    if devices and len(devices) == len(measurements):
        return devices
    steps = [one for one in measurements if isinstance(one, StepOdometry)]
    if devices or not steps:
        raise EstimationError(
            f"{len(measurements)} measurements with {len(steps)} steps and {len(devices)} devices: "
            "give the odometry of one device, or DeviceMeasurements of each device"
        )
    single = tuple(one for one in measurements if not isinstance(one, DeviceMeasurements))
    return [DeviceMeasurements(steps[0].device, steps[0].start_s, single)]


def _without_auxiliary(problem: SmoothingProblem, values: gtsam.Values) -> gtsam.Values:
    """Return a copy of values without the auxiliary variables of tethers."""
    kept = gtsam.Values(values)
    for key in problem.further_variables(values)[0]:
        kept.erase(key)
    return kept


def _refuse_missing(values: gtsam.Values, keys: Iterable[int]) -> None:
    """Raise EstimationError if a variable has no value."""
    missing = [key for key in keys if not values.exists(key)]
    if missing:
        name = gtsam.DefaultKeyFormatter(missing[0])
        raise EstimationError(f"{len(missing)} variables have no value, the first is {name}: give values of all keys")
