"""Delayed estimates: the settled records of the filter, smoothed over a fixed lag."""

from collections.abc import Sequence
from math import inf

from pdr_est.estimators.common.tethers import PairTether
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.estimators.fixed_lag.window import LagWindow
from pdr_est.estimators.fixed_lag.window_entries import FilteredNode, LaggedPose
from pdr_est.online.filter_history import FilterRecord, OnlineState


class DelayedEstimates:
    """Takes the records of the online filter once they have settled, and gives each pose a lag later.

    Poses at which the heading of the device is unknown are left out.

    Parameters
    ----------
    parameters
        Lag of the smoother.
    """

    def __init__(self, parameters: FixedLagParams) -> None:
        self._window = LagWindow(parameters)
        self._smoothed: list[bool] = []  # for each record taken so far: whether the smoother has it
        self._given = (-inf, -1)  # time and device of the last pose that was given

    @property
    def taken(self) -> int:
        """Number of records of the history that have been taken."""
        return len(self._smoothed)

    def rewind(self, kept: int) -> None:
        """Take note that only so many records of the history have not been undone."""
        if kept < self.taken:
            self._window.undo(sum(self._smoothed[kept:]))
            del self._smoothed[kept:]

    def forget(self, count: int) -> None:
        """Take note that the oldest records of the history have been forgotten."""
        del self._smoothed[:count]

    def pending(self, history: Sequence[FilterRecord], settled_s: float) -> bool:
        """Tell whether a record can be taken: one with a successor before a time, which holds its tethers."""
        return self.taken + 1 < len(history) and history[self.taken + 1].time_s < settled_s

    def take(self, history: Sequence[FilterRecord], settled_s: float) -> list[LaggedPose]:
        """Take one record if one is pending; return the poses that are a lag older."""
        if not self.pending(history, settled_s):
            return []
        following = history[self.taken + 1]
        return self._push(history[self.taken], following.tethers, following.tethered)

    def finish(
        self, history: Sequence[FilterRecord], tail_tethers: Sequence[PairTether], state: OnlineState
    ) -> list[LaggedPose]:
        """Take all records and return all remaining poses.

        Parameters
        ----------
        history
            Records of the filter.
        tail_tethers
            Tethers after the last record.
        state
            State after these tethers.
        """
        found: list[LaggedPose] = []
        while self.pending(history, inf):
            found += self.take(history, inf)
        if self.taken < len(history):
            found += self._push(history[-1], tail_tethers, state)
        return [*found, *self._window.flush()]

    def _push(self, record: FilterRecord, tethers: Sequence[PairTether], state: OnlineState) -> list[LaggedPose]:
        """Give a record to the smoother, with the tethers after it and the state after them."""
        device = record.pending.device
        place = (record.pending.time_s, device)
        smoothed = record.after.walk.heading_known(device) and place > self._given
        self._smoothed.append(smoothed)
        if not smoothed:
            return []
        found = self._window.push(
            FilteredNode.of_state(
                state.walk.joint_state(),
                device,
                record.pending.node,
                record.entered,
                tuple(tethers),
                record.after.walk.present,
                len(state.walk.devices),
            )
        )
        if found:
            self._given = (found[-1].node.time_s, found[-1].device)
        return found
