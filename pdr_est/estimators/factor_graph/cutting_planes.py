"""Where the tracks of tethered devices part although their tethers hold: between the moments of these.

Tethers are asked for every other second, tracks are lines between the ends of steps. Two tracks that are within reach
of each other at every tether can part in between, where one device ended a step and the other is about to. The
distance between two points that move along lines is greatest where one of the lines ends, so that only these moments
have to be looked at, and the tether added at the worst of them (a cutting plane).
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.factor_graph.factors import Keys
from pdr_est.estimators.factor_graph.tether_constraints import TetherConstraints
from pdr_est.frames import Array
from pdr_est.types.track import bracketing_poses

_ALL_TIME_S = 5.0  # tethers of a pair that follow each other so soon stand for all the time between them; ours
_WITHIN = 0.02  # of the largest distance, that tracks may exceed it by before a tether is added; ours


@dataclass(frozen=True)
class BetweenStepConstraints:
    """Every moment at which the lines of two tethered tracks may be farthest apart, pair by pair, as the tether that
    it would take; none that is a tie already. stretch (m,): number of the tie that comes next, pair by pair."""

    tethers: TetherConstraints
    stretch: NDArray[np.int64]

    @classmethod
    def of(
        cls, timelines: Sequence[Timeline], node_tethers: Sequence[NodeTether], keys: Keys
    ) -> "BetweenStepConstraints":
        """Between successive ties of a pair, and from where both walk to the first."""
        drawn = [_Rows.of(timeline, first) for timeline, first in zip(timelines, keys.first, strict=True)]
        pairs: dict[tuple[int, int], list[NodeTether]] = defaultdict(list)
        for node_tether in node_tethers:
            pairs[node_tether.device_a, node_tether.device_b].append(node_tether)
        tethers, stretches, count = TetherConstraints.of([], keys), [np.zeros(0, dtype=np.int64)], 0
        for (a, b), own in pairs.items():
            for rows in (drawn, [one.without_pauses() for one in drawn]):
                time_s, stretch = _moments(rows[a], rows[b], own)
                tethers = tethers + _between(rows[a], rows[b], time_s, own, stretch)
                stretches.append(stretch + count)
            count += len(own)
        held = TetherConstraints.of(node_tethers, keys)
        _, first = np.unique(np.concatenate([held.ends, tethers.ends]), axis=0, return_index=True)
        return cls(tethers, np.concatenate(stretches))._only(np.sort(first[first >= len(held)]) - len(held))

    def exceeded(self, pose: Array) -> tuple[TetherConstraints, "BetweenStepConstraints"]:
        """Tethers where poses (n, 3) exceed the distance most, one in each stretch in which they do, and what is left
        without these: a tether gives way, and one that was added twice would be stricter than it should."""
        if not len(self.tethers):
            return self.tethers, self
        excess = self.tethers.near(pose).violation_m / self.tethers.max_distance_m
        order = np.lexsort((-excess, self.stretch))
        _, worst = np.unique(self.stretch[order], return_index=True)
        chosen = order[worst]
        chosen = chosen[excess[chosen] > _WITHIN]
        return self.tethers.only(chosen), self._only(np.delete(np.arange(len(self.stretch)), chosen))

    def _only(self, chosen: NDArray[np.int64]) -> "BetweenStepConstraints":
        return BetweenStepConstraints(self.tethers.only(chosen), self.stretch[chosen])


@dataclass(frozen=True)
class _Rows:
    """The rows of a device's track. time_s, moving_from_s: (n,); key: (n,) of their poses."""

    time_s: Array
    moving_from_s: Array
    key: NDArray[np.int64]

    @classmethod
    def of(cls, timeline: Timeline, first: int) -> "_Rows":
        kept = [(node.time_s, node.moving_from_s, first + i) for i, node in enumerate(timeline.nodes) if node.is_step]
        time_s, moving_from_s, key = np.array(kept).T
        return cls(time_s, moving_from_s, key.astype(np.int64))

    def without_pauses(self) -> "_Rows":
        """As they look to someone who joins the poses by straight lines in time and does not know of pauses."""
        return replace(self, moving_from_s=np.concatenate([self.time_s[:1], self.time_s[:-1]]))

    def places(self, time_s: Array) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
        """Keys (m,) of the poses that the line leads from and to at some times, and the share (m,) of the way."""
        before, after, share = bracketing_poses(self.time_s, self.moving_from_s, time_s)
        before, after = np.where(share >= 1.0, after, before), np.where(share <= 0.0, before, after)
        return self.key[before], self.key[after], share


def _moments(a: _Rows, b: _Rows, node_tethers: Sequence[NodeTether]) -> tuple[Array, NDArray[np.int64]]:
    """Times (m,) at which a line of either ends within a stretch before a tie, and numbers (m,) of the ties."""
    begin_s = max(a.time_s[0], b.time_s[0])
    asked_s = np.array([begin_s, *(node_tether.time_s for node_tether in node_tethers)])
    time_s = np.unique(np.concatenate([a.time_s, a.moving_from_s, b.time_s, b.moving_from_s]))
    stretch = np.searchsorted(asked_s, time_s, side="right") - 1
    inside = (stretch >= 0) & (stretch < len(asked_s) - 1)
    time_s, stretch = time_s[inside], stretch[inside]
    short = asked_s[stretch + 1] - asked_s[stretch] <= _ALL_TIME_S
    return time_s[short], stretch[short]


def _between(
    a: _Rows, b: _Rows, time_s: Array, node_tethers: Sequence[NodeTether], stretch: NDArray[np.int64]
) -> TetherConstraints:
    """The larger of the distances of the two ties about a stretch, and the sigma that goes with it."""
    limits = np.array([[node_tether.max_distance_m, node_tether.sigma_m] for node_tether in node_tethers])
    before = np.maximum(stretch - 1, 0)
    wider = np.where(limits[before, 0] > limits[stretch, 0], before, stretch)
    (earlier_a, later_a, share_a), (earlier_b, later_b, share_b) = a.places(time_s), b.places(time_s)
    return TetherConstraints.between(
        np.stack([earlier_a, earlier_b], axis=1),
        np.stack([later_a, later_b], axis=1),
        np.stack([share_a, share_b], axis=1),
        limits[wider, 0],
        limits[wider, 1],
    )
