"""Tethers between devices on one body: their parameters, and the nodes that they join."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.nodes import SAME_S
from pdr_est.estimators.common.tether_schedule import TetherSchedule
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.params import Positive, params
from pdr_est.types.measurements import DeviceTether


@params
class TetherParams:
    """Tether between each two devices on one body."""

    max_distance_m: Positive = 0.5
    """Largest distance between the two devices after their mounting offsets are taken off, m (Robust DR: 2R). It is
    larger than the paper's 0.15 m because tracks made of steps are rough within a stride."""

    sigma_m: Positive = 0.02
    """Standard deviation of the largest distance, m: the smaller, the more strictly it holds."""

    every_s: Annotated[float, Ge(0.2), Le(600.0)] = 2.0
    """Time between two tethers of a pair, s."""


def tethers_between(
    spans_s: Mapping[str, tuple[float, float]], parameters: TetherParams, at_end: bool = False
) -> list[DeviceTether]:
    """Make the tethers of all pairs of devices, at multiples of an interval on the common clock.

    Parameters
    ----------
    spans_s
        First and last time of each device.
    parameters
        Distance, standard deviation and interval of the tethers.
    at_end
        If True, each pair is also tethered at the end of its common walk: for estimators that know when that is.
        Otherwise nothing constrains the last steps.
    """
    schedule = TetherSchedule(parameters.every_s)
    names = list(spans_s)
    schedule.spans_s = [spans_s[name] for name in names]
    tethers = []
    for a, b in combinations(range(len(names)), 2):
        times_s = schedule.times_of((a, b))
        begin_s, end_s = (choose(spans_s[names[a]][i], spans_s[names[b]][i]) for i, choose in enumerate((max, min)))
        if at_end and end_s > begin_s and end_s not in times_s:
            times_s.append(end_s)
        tethers += [
            DeviceTether(names[a], names[b], time_s, parameters.max_distance_m, parameters.sigma_m)
            for time_s in times_s
        ]
    return tethers


@dataclass(frozen=True)
class PairTether:
    """Tether between the present poses of two devices of a filter.

    Attributes
    ----------
    device_a, device_b
        Numbers of the devices.
    max_distance_m
        Largest distance between them, m.
    sigma_m
        Standard deviation of that distance, m.
    """

    device_a: int
    device_b: int
    max_distance_m: float
    sigma_m: float


@dataclass(frozen=True)
class NodeTether:
    """Tether between one node of a device and one node of another device.

    Attributes
    ----------
    time_s
        Time of the tether.
    device_a, node_a
        Number of the first device, and number of its last node at or before that time.
    device_b, node_b
        The same for the second device.
    max_distance_m
        Largest distance between them, m.
    sigma_m
        Standard deviation of that distance, m.
    """

    time_s: float
    device_a: int
    node_a: int
    device_b: int
    node_b: int
    max_distance_m: float
    sigma_m: float


def node_tethers_between(timelines: Sequence[Timeline], tethers: Sequence[DeviceTether]) -> list[NodeTether]:
    """Find the nodes that tethers join, in order of time.

    Tethers before the walk of one of their devices are left out. After its last step a device stands still.

    Raises
    ------
    EstimationError
        For devices of the same name, and for a tether to a device without timeline.
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
            node_a, node_b = (
                int(np.searchsorted(times_s[d], tether.time_s + SAME_S, side="right")) - 1 for d in (a, b)
            )
            node_tethers.append(
                NodeTether(tether.time_s, a, node_a, b, node_b, tether.max_distance_m, tether.sigma_m)
            )
    return node_tethers
