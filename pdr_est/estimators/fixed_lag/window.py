"""Keep the window of the fixed-lag smoother: results of the EKF at the nodes of the last seconds, and their poses."""

from collections import deque
from typing import Any

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.estimators.fixed_lag.pose_window import PoseWindow
from pdr_est.estimators.fixed_lag.window_entries import FilteredNode, LaggedPose


class LagWindow:
    """Fixed-lag window that takes EKF results in order of time and returns each pose a lag later.

    A pickled window keeps its input; the poses are estimated anew from it, which changes results slightly by other
    linearisation points.

    Methods raise EstimationError if a window has no unique solution.
    """

    def __init__(self, parameters: FixedLagParams) -> None:
        self._lag_s = parameters.lag_s
        self._waiting: deque[FilteredNode] = deque()  # items whose poses were not returned yet
        self._relative: set[int] = set()  # devices with headings relative to a reference
        self._poses: PoseWindow | None = None

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_poses": None}

    def push(self, item: FilteredNode) -> list[LaggedPose]:
        """Add an item and return the poses that are more than the lag before it."""
        ready = self.until(item.node.time_s - self._lag_s)
        new_reference = item.device not in self._relative and any(prior.relative for prior in item.node.priors)
        if new_reference:
            self._relative.add(item.device)
        self._waiting.append(item)
        if self._poses is None or new_reference or self._poses.outdated_by(item):
            self._poses = self._rebuilt()
            return ready
        try:
            self._poses.add(item)
        except ArithmeticError as error:
            raise _no_solution(error) from error
        return ready

    def _rebuilt(self) -> PoseWindow:
        try:
            return PoseWindow(self._waiting, self._relative)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            raise _no_solution(error) from error

    def undo(self, count: int) -> None:
        """Remove the last `count` items, which will come again in another form; returned poses stay as they are."""
        for _ in range(min(count, len(self._waiting))):
            self._waiting.pop()
        self._poses = None

    def until(self, time_s: float) -> list[LaggedPose]:
        """Return the poses before a time that were not returned yet, from the measurements so far."""
        ready = []
        while self._waiting and self._waiting[0].node.time_s < time_s:
            poses = self._built()
            ready.append(poses.pose_of(self._waiting[0], len(self._waiting)))
            self._waiting.popleft()
        return ready

    def flush(self) -> list[LaggedPose]:
        """Return all remaining poses at the end of a walk."""
        if self._waiting:
            self._built().iterate()
        return self.until(np.inf)

    def _built(self) -> PoseWindow:
        if self._poses is None:  # after a pickle
            self._poses = self._rebuilt()
        return self._poses


def _no_solution(error: Exception) -> EstimationError:
    return EstimationError(
        f"the window of fixed-lag has no unique solution ({error}): give a start pose, more fixes, or use the ekf"
    )
