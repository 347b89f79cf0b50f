"""The delayed estimates: what the filter went through, once it has settled, smoothed over a lag."""

from collections.abc import Sequence
from math import inf

from pdr_est.estimators.common.tethers import TetherParams
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.estimators.fixed_lag.window import FilteredNode, LaggedPose, LagWindow, Limit
from pdr_est.online.filter_records import Record, WalkState, joint_moments


class Delayed:
    """Follows the history of a WalkFilter from behind. fed: how many of its records were taken.

    A pose where the direction of the device is open is left out.
    """

    def __init__(self, parameters: FixedLagParams, tether: TetherParams) -> None:
        self._window, self._tether = LagWindow(parameters), tether
        self._taken: list[bool] = []  # of the records that were taken, whether the smoother has them
        self._given = (-inf, -1)  # time and device of the last pose that was given out

    @property
    def fed(self) -> int:
        return len(self._taken)

    def undone(self, left: int) -> None:
        """The history was undone back to so many records."""
        if left < self.fed:
            self._window.undo(sum(self._taken[left:]))
            del self._taken[left:]

    def forgotten(self, count: int) -> None:
        """The first records of the history were forgotten."""
        del self._taken[:count]

    def waits(self, history: Sequence[Record], settled_s: float) -> bool:
        """Whether there is a record before a time that was not taken, and another one behind it: what follows a
        record may belong to it."""
        return self.fed + 1 < len(history) and history[self.fed + 1].time_s < settled_s

    def take(self, history: Sequence[Record], settled_s: float) -> list[LaggedPose]:
        """Take a record, if one `waits`."""
        if not self.waits(history, settled_s):
            return []
        following = history[self.fed + 1]
        return self._push(history[self.fed], following.pulls, following.pulled)

    def finish(
        self, history: Sequence[Record], pulls: Sequence[tuple[int, int]], state: WalkState
    ) -> list[LaggedPose]:
        """Take all, with the tethers after the last of them, and give out everything."""
        found: list[LaggedPose] = []
        while self.waits(history, inf):
            found += self.take(history, inf)
        if self.fed < len(history):
            found += self._push(history[-1], pulls, state)
        return [*found, *self._window.flush()]

    def _push(self, record: Record, pulls: Sequence[tuple[int, int]], state: WalkState) -> list[LaggedPose]:
        own = record.after.alone[record.pending.device]
        smoothed = own is not None and own.directed and (record.pending.time_s, record.pending.device) > self._given
        self._taken.append(smoothed)
        if not smoothed:
            return []
        moments = joint_moments(state)
        limits = tuple(Limit(a, b, self._tether.max_distance_m, self._tether.sigma_m) for a, b in pulls)
        found = self._window.push(
            FilteredNode(
                record.pending.device,
                record.pending.node,
                record.entered,
                limits,
                moments.mean,
                moments.covariance,
                record.after.present,
            )
        )
        if found:
            self._given = (found[-1].node.time_s, found[-1].device)
        return found
