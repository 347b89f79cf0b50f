"""The state of the filter of all devices after a node, and the record of how it came about."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from pdr_est.estimators.common.motion_model import STATES, GaussianState
from pdr_est.estimators.common.timeline import Node
from pdr_est.estimators.kalman.filter_step import DeviceFilterState, Raw

_NEAR = 50  # records among which the nodes of a step are looked for


@dataclass(frozen=True)
class Pending:
    """A node that the filter has to go through: the number of its step, when that has its first node, and whether
    this node or a later one tells the direction."""

    time_s: float
    device: int
    node: Node
    step: int
    step_from_s: float
    is_last: bool
    told_later: bool


@dataclass(frozen=True)
class WalkState:
    """alone: of each device by itself, None before its start; at: the last node of each; joint: of all together, None
    for a single device; present: the devices that ever came into it. next_tie: number of the next moment at which
    tethers are asked for. begun_s: time of the first node of all."""

    alone: tuple[DeviceFilterState | None, ...] = ()
    at: tuple[Pending | None, ...] = ()
    joint: Raw | None = None
    present: frozenset[int] = frozenset()
    next_tie: int = 0
    begun_s: float = inf

    def directed(self, device: int) -> bool:
        """Whether a device has started and its direction is known."""
        own = self.alone[device]
        return own is not None and own.directed

    def moments(self, device: int) -> GaussianState:
        """What is known of a device that has started: by all of them, or where its direction is open by itself."""
        own = self.alone[device]
        if own is None:
            raise LookupError(f"device {device} has not started")
        if self.joint is None or not own.directed:
            return GaussianState(own.end.mean, own.end.covariance)
        rows = slice(STATES * device, STATES * (device + 1))
        covariance = self.joint[1][rows, rows]
        return GaussianState(self.joint[0][rows], 0.5 * (covariance + covariance.T))


@dataclass(frozen=True)
class Record:
    """A node that the filter went through. number: of the node in its device's log; time_s: its place in the order.

    pulls: pairs of devices whose tethers were asked for before the node; pulled: the state after them, and before
    the node. entered: with what the device came into the filter of all here, if it did.
    """

    pending: Pending
    number: int
    time_s: float
    before: WalkState
    pulls: tuple[tuple[int, int], ...]
    pulled: WalkState
    entered: GaussianState | None
    after: WalkState


def joint_moments(state: WalkState) -> GaussianState:
    """Mean (5 d,) and covariance (5 d, 5 d) of all devices; of a single one by itself."""
    if state.joint is None:
        return state.moments(0)
    return GaussianState(state.joint[0].copy(), 0.5 * (state.joint[1] + state.joint[1].T))


def whole_steps(history: Sequence[Record], count: int) -> int:
    """So many of the oldest records or fewer, so that no step is cut in two."""
    while 0 < count < len(history) and _cut(history, count):
        count -= 1
    return count


def _cut(history: Sequence[Record], count: int) -> bool:
    begun = {(record.pending.device, record.pending.step) for record in history[max(count - _NEAR, 0) : count]}
    return any((one.pending.device, one.pending.step) in begun for one in history[count : count + _NEAR])
