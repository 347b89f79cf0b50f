"""What holds between the devices of one walk: which nodes are tied, and how the devices set off together."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import ceil, floor
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.timeline import SAME_S, Timeline
from pdr_est.params import Positive, params
from pdr_est.types.measurements import LATE_START_S, DeviceTether, StartPose

# Of the first direction of one device against another's, where nothing but these directions defines the frame.
SIGMA_SET_OFF_RAD = 0.2


@params
class TetherParams:
    """max_distance_m: between two devices on one body, Robust DR's 2 R, once their fixed places on it are taken off;
    more than the paper's 0.15 m, for tracks of steps are rough within a stride. sigma_m: how strictly it holds.
    every_s: how often it is asked for."""

    max_distance_m: Positive = 0.5
    sigma_m: Positive = 0.02
    every_s: Annotated[float, Ge(0.2), Le(600.0)] = 2.0


def tethers_between(
    spans_s: Mapping[str, tuple[float, float]], parameters: TetherParams, at_end: bool = False
) -> list[DeviceTether]:
    """The tethers of all pairs of devices, at multiples of an interval on the common clock.

    spans_s: first and last time of each device. at_end: also where the walk of a pair ends, for those who know when
    that is: what the last steps led to would else be held by nothing.
    """
    tethers = []
    for a, b in combinations(spans_s, 2):
        begin_s, end_s = max(spans_s[a][0], spans_s[b][0]), min(spans_s[a][1], spans_s[b][1])
        first, last = ceil(begin_s / parameters.every_s), floor(end_s / parameters.every_s)
        times_s = [k * parameters.every_s for k in range(first, last + 1)]
        if at_end and end_s > begin_s and end_s not in times_s:
            times_s.append(end_s)
        tethers += [DeviceTether(a, b, time_s, parameters.max_distance_m, parameters.sigma_m) for time_s in times_s]
    return tethers


@dataclass(frozen=True)
class NodeTether:
    """Two nodes at one moment, by number of device and of node, that are never farther apart than max_distance_m."""

    time_s: float
    device_a: int
    node_a: int
    device_b: int
    node_b: int
    max_distance_m: float
    sigma_m: float


def node_tethers_between(timelines: Sequence[Timeline], tethers: Sequence[DeviceTether]) -> list[NodeTether]:
    """The tethers as ties, in order of time; those before the walk of one of their devices are left out. After its
    last step a device stands.

    Raises EstimationError for devices of one name, and for a tether to a device that is not there.
    """
    names = [timeline.device for timeline in timelines]
    if len(set(names)) < len(names):
        raise EstimationError(f"devices {names}: each needs a name of its own")
    times_s = [np.array([node.time_s for node in timeline.nodes]) for timeline in timelines]
    node_tethers = []
    for tether in sorted(tethers, key=lambda one: one.time_s):
        ends = (tether.device_a, tether.device_b)
        if not set(ends) <= set(names) or ends[0] == ends[1]:
            raise EstimationError(f"tether between {ends[0]!r} and {ends[1]!r}: name two of {names}")
        a, b = names.index(ends[0]), names.index(ends[1])
        if max(times_s[a][0], times_s[b][0]) <= tether.time_s:
            nodes = (int(np.searchsorted(times_s[d], tether.time_s + SAME_S, side="right")) - 1 for d in (a, b))
            node_tethers.append(
                NodeTether(tether.time_s, a, next(nodes), b, next(nodes), tether.max_distance_m, tether.sigma_m)
            )
    return node_tethers


def donor_of(number: int, time_s: float, begun_s: float, present: Collection[int]) -> int | None:
    """The device beside which another one joins a filter, with its node of that number, because the walk is under way
    since begun_s; None for a device that joins by itself. present: those that have joined."""
    late = number == 0 and time_s - begun_s > LATE_START_S
    return min(present, default=None) if late else None


def starts_of(timelines: Sequence[Timeline], start: StartPose) -> list[StartPose]:
    """The start pose of each device: where their first directions define the frame, all but the first device may have
    set off in a slightly other one."""
    directed = any(node.tells_direction for timeline in timelines for node in timeline.nodes)
    if start.heading_rad is not None or directed:
        return [start] * len(timelines)
    other = replace(start, heading_rad=0.0, sigma_heading_rad=SIGMA_SET_OFF_RAD)
    return [start, *[other] * (len(timelines) - 1)]
