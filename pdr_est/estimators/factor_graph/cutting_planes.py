"""Tethers between the tether times: cutting planes for the straight lines between the ends of steps.

Tethers are given at certain times, for example every other second, while a track is a straight line from the end of
one step to the end of the next. Two tracks that fulfil every tether can still be too far apart in between, where one
device ended a step and the other is about to. The distance of two points that move along lines is greatest where one
of the lines ends, so only these times need to be checked, and a tether is added at the worst of them.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.factor_graph.keys import GraphKeys
from pdr_est.estimators.pose_chains.tether_constraints import TetherConstraints
from pdr_est.frames import Array
from pdr_est.types.track import bracketing_poses

_MAX_INTERVAL_S = 5.0  # successive tethers of a pair that are no further apart hold in between, too; ours
_TOLERANCE = 0.02  # share of the length by which it may be exceeded before a tether is added; ours


@dataclass(frozen=True)
class BetweenStepConstraints:
    """Candidate tethers: every time at which the lines of two tethered tracks may be farthest apart.

    Attributes
    ----------
    tethers : TetherConstraints
        The m candidates, without those that are given tethers already.
    interval : (m,) array of int
        Number of the interval between two given tethers of a pair that each candidate lies in.
    """

    tethers: TetherConstraints
    interval: NDArray[np.int64]

    @classmethod
    def of_timelines(
        cls, timelines: Sequence[Timeline], node_tethers: Sequence[NodeTether], keys: GraphKeys
    ) -> "BetweenStepConstraints":
        """List the candidates between successive tethers of each pair, and before the first one."""
        lines = [_TrackLines.of(timeline, first) for timeline, first in zip(timelines, keys.first, strict=True)]
        pairs: dict[tuple[int, int], list[NodeTether]] = defaultdict(list)
        for node_tether in node_tethers:
            pairs[node_tether.device_a, node_tether.device_b].append(node_tether)
        tethers, intervals, count = TetherConstraints.between_nodes([], keys.first), [np.zeros(0, dtype=np.int64)], 0
        for (a, b), own in pairs.items():
            for variant in (lines, [one.without_pauses() for one in lines]):
                time_s, interval = _corner_times(variant[a], variant[b], own)
                tethers = tethers + _tethers_at(variant[a], variant[b], time_s, own, interval)
                intervals.append(interval + count)
            count += len(own)
        given = TetherConstraints.between_nodes(node_tethers, keys.first)
        _, first = np.unique(np.concatenate([given.ends, tethers.ends]), axis=0, return_index=True)
        return cls(tethers, np.concatenate(intervals))._only(np.sort(first[first >= len(given)]) - len(given))

    def most_violated(self, pose: Array) -> tuple[TetherConstraints, "BetweenStepConstraints"]:
        """Select the most violated candidate of each interval, and return the remaining ones, too.

        A candidate is returned once only: a tether that was added twice would be twice as stiff.
        """
        if not len(self.tethers):
            return self.tethers, self
        excess = self.tethers.linearised(pose).violation_m / self.tethers.max_distance_m
        order = np.lexsort((-excess, self.interval))
        _, worst = np.unique(self.interval[order], return_index=True)
        chosen = order[worst]
        chosen = chosen[excess[chosen] > _TOLERANCE]
        return self.tethers.only(chosen), self._only(np.delete(np.arange(len(self.interval)), chosen))

    def _only(self, chosen: NDArray[np.int64]) -> "BetweenStepConstraints":
        return BetweenStepConstraints(self.tethers.only(chosen), self.interval[chosen])


@dataclass(frozen=True)
class _TrackLines:
    """Rows (n,) of a device's track: their times, when the movement to them begins, and the keys of their poses."""

    time_s: Array
    moving_from_s: Array
    key: NDArray[np.int64]

    @classmethod
    def of(cls, timeline: Timeline, first: int) -> "_TrackLines":
        kept = [(node.time_s, node.moving_from_s, first + i) for i, node in enumerate(timeline.nodes) if node.is_step]
        time_s, moving_from_s, key = np.array(kept).T
        return cls(time_s, moving_from_s, key.astype(np.int64))

    def without_pauses(self) -> "_TrackLines":
        """Return the lines as drawn by a reader who interpolates in time and does not know of pauses."""
        return replace(self, moving_from_s=np.concatenate([self.time_s[:1], self.time_s[:-1]]))

    def places(self, time_s: Array) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
        """Return the poses (m,) that the lines lead from and to at some times, and the shares (m,) of the way."""
        before, after, share = bracketing_poses(self.time_s, self.moving_from_s, time_s)
        before, after = np.where(share >= 1.0, after, before), np.where(share <= 0.0, before, after)
        return self.key[before], self.key[after], share


def _corner_times(
    a: _TrackLines, b: _TrackLines, node_tethers: Sequence[NodeTether]
) -> tuple[Array, NDArray[np.int64]]:
    """Return the times (m,) at which a line of either ends before a tether, and the numbers (m,) of these tethers."""
    begin_s = max(a.time_s[0], b.time_s[0])
    tethered_s = np.array([begin_s, *(node_tether.time_s for node_tether in node_tethers)])
    time_s = np.unique(np.concatenate([a.time_s, a.moving_from_s, b.time_s, b.moving_from_s]))
    interval = np.searchsorted(tethered_s, time_s, side="right") - 1
    inside = (interval >= 0) & (interval < len(tethered_s) - 1)
    time_s, interval = time_s[inside], interval[inside]
    short = tethered_s[interval + 1] - tethered_s[interval] <= _MAX_INTERVAL_S
    return time_s[short], interval[short]


def _tethers_at(
    a: _TrackLines, b: _TrackLines, time_s: Array, node_tethers: Sequence[NodeTether], interval: NDArray[np.int64]
) -> TetherConstraints:
    """Make tethers with the longer one of the two given tethers around each time, and its standard deviation."""
    limits = np.array([[node_tether.max_distance_m, node_tether.sigma_m] for node_tether in node_tethers])
    before = np.maximum(interval - 1, 0)
    wider = np.where(limits[before, 0] > limits[interval, 0], before, interval)
    (earlier_a, later_a, share_a), (earlier_b, later_b, share_b) = a.places(time_s), b.places(time_s)
    return TetherConstraints.between_places(
        np.stack([earlier_a, earlier_b], axis=1),
        np.stack([later_a, later_b], axis=1),
        np.stack([share_a, share_b], axis=1),
        limits[wider, 0],
        limits[wider, 1],
    )
