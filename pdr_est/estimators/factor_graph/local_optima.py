"""Local optima of a walk's factor graph: where there may be several, the search begins at more than one start.

A heading in the map that may be wrong, such as north by a magnetometer, has Cauchy's kernel in the graph. Its pull
fades with its distance, so that a walk may have one optimum that believes it and another one that does not. Newton's
method finds the one that it begins near. The Kalman filter, which gives the initial values, must believe such a
heading if there is nothing else yet, and may not come back.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.estimators.common.initial_state import start_prior
from pdr_est.estimators.common.motion_model import STATES, GaussianState
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.factor_graph.initial_values import initial_states, with_headings
from pdr_est.estimators.factor_graph.smoothing_problem import LengthScales, Point, SmoothingProblem, as_values
from pdr_est.estimators.reckoned_poses import reckon_means
from pdr_est.frames import wrap_angle
from pdr_est.types.measurements import HeadingPrior, StartPose

_ONE_MODE_RAD = 0.5  # mean difference of headings below which two starts are one, as in `alternatives`
_LEAST_FIXES = 2  # of a device whose heading can be found without any heading that is measured

InitialStates = Sequence[Sequence[GaussianState]]
"""Initial states at all nodes of each device."""


@dataclass(frozen=True)
class Solution:
    """An optimum of a walk: its graph, its length scales, and the values of poses and references."""

    problem: SmoothingProblem
    scales: LengthScales
    at: Point

    def cost(self, sigma_length_scale: float) -> float:
        """Return minus the logarithm of the posterior density, but for a constant."""
        problem, scale = self.problem, self.scales.value
        cost = problem.without_tethers(scale).error(as_values(self.at))
        if len(problem.tethers):
            cost += problem.tethers.error(problem.poses(self.at))
        if sigma_length_scale > 0.0 and problem.scale_is_observable:
            cost += 0.5 * float(np.sum((np.log(scale) / sigma_length_scale) ** 2))
        return cost


def starting_points(
    timelines: Sequence[Timeline],
    node_tethers: Sequence[NodeTether],
    starts: Sequence[StartPose],
    sigma_length_scale: float,
    headings_rad: Sequence[float | None] = (),
) -> list[InitialStates]:
    """Return the initial states from which the optimum should be searched for, one or two.

    The second ones are those of the walk without the headings in the map that may be wrong, turned as the fixes have
    it. They are left out where the first ones are turned much the same.

    Parameters
    ----------
    timelines, node_tethers, starts
        Measurements of each device, the tethers, and the start of each device.
    sigma_length_scale
        Standard deviation of the walker's length scale.
    headings_rad
        Heading of each device at the start to linearise at, where it is unknown.
    """
    guessed = with_headings(starts, headings_rad)
    first = initial_states(timelines, node_tethers, guessed, sigma_length_scale)
    by_fixes = [
        _heading_by_fixes(*one) if _may_mislead(*one[:2]) else None
        for one in zip(timelines, starts, first, strict=True)
    ]
    if all(heading_rad is None for heading_rad in by_fixes):
        return [first]
    doubting = [replace(one, nodes=_without_doubtful(one)) for one in timelines]
    return [first, initial_states(doubting, node_tethers, with_headings(guessed, by_fixes), sigma_length_scale)]


def _may_mislead(timeline: Timeline, start: StartPose) -> bool:
    """Tell whether a heading that may be wrong takes part in finding a heading that fixes can find alone."""
    if len(timeline.fixes) < _LEAST_FIXES or not any(map(_is_doubtful, timeline.priors)):
        return False
    return start_prior(timeline, start, 0.0).heading_open


def _is_doubtful(prior: HeadingPrior) -> bool:
    return prior.robust and not prior.relative


def _heading_by_fixes(timeline: Timeline, start: StartPose, states: Sequence[GaussianState]) -> float | None:
    """Return the start heading at which the steps lie nearest to the fixes; None if it is near that of some states.

    The path of the steps is placed, turned and scaled as a whole, by least squares in complex numbers.
    """
    reckoned = reckon_means(timeline.nodes, np.zeros(STATES))
    pairs = [(k, fix) for k, node in enumerate(timeline.nodes) for fix in node.fixes]
    weight = np.array([1.0 / (np.trace(fix.covariance_m2) + 2.0 * fix.sigma_wander_m**2) for _, fix in pairs])
    path = reckoned[[k for k, _ in pairs], :2] @ [1.0, 1j]
    given = np.array([fix.position_m for _, fix in pairs]) @ [1.0, 1j]
    path, given = (one - np.average(one, weights=weight) for one in (path, given))
    heading_rad = float(np.angle(np.sum(weight * path.conj() * given)))
    turned_rad = wrap_angle(np.array([state.mean[2] for state in states]) - reckoned[:, 2] - heading_rad)
    return heading_rad if np.abs(turned_rad).mean() > _ONE_MODE_RAD else None


def _without_doubtful(timeline: Timeline) -> tuple[Node, ...]:
    """Return the nodes of a device without headings in the map that may be wrong."""
    return tuple(
        replace(node, priors=tuple(one for one in node.priors if not _is_doubtful(one))) if node.priors else node
        for node in timeline.nodes
    )
