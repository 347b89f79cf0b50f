"""Nodes of a walk: poses at the ends of steps and at fixes on the way, and the builder that makes them."""

from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf
from operator import attrgetter

import numpy as np

from pdr_est.estimators.common.measurement_checks import averaged_fixes
from pdr_est.frames import Array
from pdr_est.types.measurements import HeadingPrior, PositionFix, StepOdometry, TurnHypothesis
from pdr_est.types.steps import CarryingMode

SAME_S = 1e-9
"""Two times that differ by less than this (s) are the same time."""


@dataclass(frozen=True)
class Node:
    """Pose of the walker at the end of a step or at a fix within a step, with the motion that leads to it.

    The walker turns by `heading_change_rad` and then moves `length_m` straight ahead.

    Attributes
    ----------
    time_s
        Time of the pose.
    moving_from_s
        Time at which the step began that this node belongs to.
    length_m
        Distance from the previous node, m.
    heading_change_rad
        Turn since the previous node, rad, counter-clockwise.
    covariance
        Covariance of the motion, (3, 3), of (forward m, left m, heading rad) in the body frame at this node.
    is_step
        True at the start of the walk and at the end of a step, which are the poses of the track.
    step_length_m
        Length of the whole step that this node belongs to, m.
    mode
        Carrying mode of the phone during the step.
    fixes
        Position fixes that apply to this pose.
    priors
        Heading priors that apply to this pose.
    turn_hypotheses
        Possible heading changes at the beginning of a step before which the phone was put elsewhere;
        `heading_change_rad` and `covariance` are their mean and covariance. Empty for any other node.
    """

    time_s: float
    moving_from_s: float
    length_m: float
    heading_change_rad: float
    covariance: Array
    is_step: bool
    step_length_m: float
    mode: CarryingMode
    fixes: tuple[PositionFix, ...] = ()
    priors: tuple[HeadingPrior, ...] = ()
    turn_hypotheses: tuple[TurnHypothesis, ...] = ()

    @property
    def observes_heading(self) -> bool:
        """Tell whether a measurement at this node helps to find the heading of the walk in the map frame."""
        return bool(self.fixes) or (bool(self.priors) and not all(prior.relative for prior in self.priors))


class NodeBuilder:
    """Build the nodes of one device's walk step by step.

    Steps are numbered from 1; number 0 is the start of the walk. Old steps can be forgotten, numbers never change.

    Parameters
    ----------
    start_s
        Time of the start pose. The end of the first step replaces it if that is earlier: step detectors put a step
        back by their delay, possibly to before the first sample.
    """

    def __init__(self, start_s: float) -> None:
        self.start_s = start_s
        self._first = 1  # number of the oldest remembered step
        self._end_before_s = start_s  # end of the step before it
        self._steps: list[StepOdometry] = []
        self._priors: defaultdict[int, list[HeadingPrior]] = defaultdict(list)  # by number of the step

    @property
    def count(self) -> int:
        """Number of the last known step."""
        return self._first + len(self._steps) - 1

    @property
    def remembered(self) -> int:
        """Number of steps that have not been forgotten."""
        return len(self._steps)

    def append(self, item: StepOdometry | HeadingPrior) -> None:
        """Add the next step, or a heading prior of a step that was added before."""
        if isinstance(item, StepOdometry):
            self._steps.append(item)
            if self.count == 1:
                self._end_before_s = min(self.start_s, item.time_s)
            return
        time_s = item.time_s - SAME_S
        number = self._first + bisect_left(self._steps, time_s, key=_time_of)
        if self._first == 1 and time_s <= self._end_before_s:
            number = 0
        self._priors[min(number, self.count)].append(item)

    def step_end_s(self, number: int) -> float:
        """Return the time at which a step ends; for number 0, the time at which the walk begins."""
        return self._end_before_s if number < self._first else self._steps[number - self._first].time_s

    def motion_begin_s(self, number: int) -> float:
        """Return the time at which the motion of a step begins; minus infinity for the start and forgotten steps."""
        if number < self._first or number == 0:
            return -inf
        return max(self._steps[number - self._first].start_s, self.step_end_s(number - 1))

    def nodes_of(
        self,
        number: int,
        fixes: Sequence[PositionFix] = (),
        split_times_s: Sequence[float] = (),
        known_until_s: float = inf,
    ) -> list[Node]:
        """Return the nodes of a step, one at each fix and split time within it and one at its end.

        Parameters
        ----------
        number
            Number of the step; 0 returns the single node of the start.
        fixes
            Position fixes, as ordered by `sort_fixes`.
        split_times_s
            Ascending times at which a node is wanted.
        known_until_s
            No later step begins before this time. Fixes after the last step apply to its end up to this time.
        """
        standing = self.standing_fixes(number, fixes, known_until_s) if fixes else ()
        priors = tuple(self._priors.get(number, ()))
        if number == 0:
            begin_s, mode = self.step_end_s(0), self._steps[0].mode if self._steps else CarryingMode.UNKNOWN
            return [Node(begin_s, begin_s, 0.0, 0.0, np.zeros((3, 3)), True, 0.0, mode, standing, priors)]
        step, begin_s = self._steps[number - self._first], self.motion_begin_s(number)
        inside = averaged_fixes(_between(fixes, begin_s, step.time_s)) if fixes else ()
        first = bisect_right(split_times_s, begin_s)
        splits = split_times_s[first : bisect_left(split_times_s, step.time_s, first)]
        if not inside and not splits:
            moved = step.length_m, step.heading_change_rad, step.covariance, True, step.length_m
            return [Node(step.time_s, begin_s, *moved, step.mode, standing, priors, step.turn_hypotheses)]
        nodes = split_step(step, begin_s, inside, splits)
        if standing:
            nodes[-1] = replace(nodes[-1], fixes=standing)
        return _with_priors(nodes, priors)

    def standing_fixes(
        self, number: int, fixes: Sequence[PositionFix], known_until_s: float = inf
    ) -> tuple[PositionFix, ...]:
        """Return the fixes at the end of a step and while the walker stands still after it.

        The parameters are those of `nodes_of`.
        """
        until_s = (
            self.motion_begin_s(number + 1) if number < self.count else max(known_until_s, self.step_end_s(number))
        )
        begin = 0
        if number > 0:  # a fix at the very begin of the motion applies to the node before
            begin = max(
                bisect_left(fixes, self.step_end_s(number), key=_time_of),
                bisect_right(fixes, self.motion_begin_s(number), key=_time_of),
            )
        return averaged_fixes(fixes[begin : bisect_right(fixes, until_s, key=_time_of)])

    def forget(self, before: int) -> None:
        """Forget the steps before a number, but keep at least the last one."""
        drop = min(max(before - self._first, 0), max(len(self._steps) - 1, 0))
        if drop:
            self._end_before_s = self._steps[drop - 1].time_s
            del self._steps[:drop]
            self._first += drop
            for number in [number for number in self._priors if number < self._first]:
                del self._priors[number]


def sort_fixes(fixes: Iterable[PositionFix]) -> tuple[PositionFix, ...]:
    """Sort fixes by time, those of equal time with the last given first: the order in which estimators use them."""
    latest_first = sorted(fixes, key=_time_of, reverse=True)
    return tuple(reversed(latest_first))


def split_step(
    step: StepOdometry, begin_s: float, fixes: Sequence[PositionFix] = (), split_times_s: Iterable[float] = ()
) -> list[Node]:
    """Divide a step into nodes: one at each time inside it, and its end. The walker moves at an even pace.

    Parameters
    ----------
    step
        Measured step.
    begin_s
        Time at which the motion begins.
    fixes
        Position fixes strictly between `begin_s` and the end of the step.
    split_times_s
        Further times strictly between them at which a node is wanted.
    """
    inside = sorted({fix.time_s for fix in fixes}.union(split_times_s))
    borders = [0.0, *((time_s - begin_s) / (step.time_s - begin_s) for time_s in inside), 1.0]
    shares = [float(after - before) for before, after in pairwise(borders)]
    covariances = split_covariance(step.covariance, step.length_m, shares)
    return [
        Node(
            time_s=time_s,
            moving_from_s=begin_s,
            length_m=shares[k] * step.length_m,
            heading_change_rad=step.heading_change_rad if k == 0 else 0.0,
            covariance=covariances[k],
            is_step=k == len(inside),
            step_length_m=step.length_m,
            mode=step.mode,
            fixes=tuple(fix for fix in fixes if fix.time_s == time_s),
            turn_hypotheses=step.turn_hypotheses if k == 0 else (),
        )
        for k, time_s in enumerate([*inside, step.time_s])
    ]


def split_covariance(covariance: Array, length_m: float, shares: Sequence[float]) -> list[Array]:
    """Divide the covariance of a step among its parts, which composed have the mean and covariance of the step.

    The walker turns at the beginning, so the heading error arises in the first part and displaces the rest of the
    step. The remaining noise is spread evenly. Later parts have no heading noise and are singular.

    Parameters
    ----------
    covariance
        Covariance of the step, (3, 3), of (forward m, left m, heading rad) in the body frame at its end.
    length_m
        Length of the step.
    shares
        Shares of the length, which add up to 1.

    Returns
    -------
    list of Array
        Covariances (3, 3) of the parts, each in the body frame at the end of its part.
    """
    if len(shares) == 1:
        return [covariance]
    heading = covariance[2, 2]
    with_heading = covariance[:2, 2] / heading if heading > 0.0 else np.zeros(2)
    of_displacement = covariance[:2, :2] - heading * np.outer(with_heading, with_heading)
    parts = []
    for share in shares:
        part = np.zeros((3, 3))
        part[:2, :2] = share * of_displacement
        parts.append(part)
    remaining_m = (1.0 - shares[0]) * length_m  # swings to the left by this much per radian
    error = np.array([with_heading[0], with_heading[1] - remaining_m, 1.0])
    parts[0] += heading * np.outer(error, error)
    return parts


def with_heading_variance(covariance: Array, variance_rad2: float) -> Array:
    """Return the covariance (3, 3) of a motion with another variance of its turn, and of what the turn displaces."""
    before = covariance[2, 2]
    if before <= 0.0:
        changed = covariance.copy()
        changed[2, 2] = variance_rad2
        return changed
    displaced = covariance[:, 2] / before
    return np.asarray(covariance + (variance_rad2 - before) * np.outer(displaced, displaced))


def _with_priors(nodes: list[Node], priors: Sequence[HeadingPrior]) -> list[Node]:
    """Attach each heading prior to the first node at or after its time, or to the last node."""
    for prior in priors:
        row = next((i for i, node in enumerate(nodes) if node.time_s >= prior.time_s - SAME_S), len(nodes) - 1)
        nodes[row] = replace(nodes[row], priors=(*nodes[row].priors, prior))
    return nodes


def _between(fixes: Sequence[PositionFix], begin_s: float, end_s: float) -> Sequence[PositionFix]:
    """Select the fixes strictly between two times."""
    begin = bisect_right(fixes, begin_s, key=_time_of)
    return fixes[begin : bisect_left(fixes, end_s, begin, key=_time_of)]


_time_of = attrgetter("time_s")
