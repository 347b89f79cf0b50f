"""History of the online filter: its state after each node, and how that came about."""

from collections.abc import Sequence
from dataclasses import dataclass

from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.tethers import PairTether
from pdr_est.estimators.kalman.joint_filter_step import WalkFilterState
from pdr_est.online.device_log import PendingNode

_NEAR = 50  # records within which all nodes of a step are found


@dataclass(frozen=True)
class OnlineState:
    """State of the online filter after a node.

    Attributes
    ----------
    walk
        State of the filter of all devices.
    last_nodes
        Last node of each device; None before its first node.
    next_tether
        Number of the next tether time to look at.
    """

    walk: WalkFilterState
    last_nodes: tuple[PendingNode | None, ...] = ()
    next_tether: int = 0


@dataclass(frozen=True)
class FilterRecord:
    """Node that the filter has processed.

    Attributes
    ----------
    pending
        The node.
    number
        Its number in the log of its device.
    time_s
        Its place in the order of time: later than its own time if it came after more than the horizon.
    before
        State before the node and before the tethers.
    tethers
        Tethers that were applied before the node.
    tethered
        State after these tethers.
    entered
        State with which the device entered the joint state at this node, if it did.
    after
        State after the node.
    """

    pending: PendingNode
    number: int
    time_s: float
    before: OnlineState
    tethers: tuple[PairTether, ...]
    tethered: OnlineState
    entered: GaussianState | None
    after: OnlineState

    @property
    def order(self) -> tuple[float, int]:
        """Return the place in the order of processing: time, then device."""
        return self.time_s, self.pending.device


def tethered_devices(tethers: Sequence[PairTether]) -> set[int]:
    """Return the numbers of the devices that tethers join."""
    return {device for one in tethers for device in (one.device_a, one.device_b)}


def last_states(history: Sequence[FilterRecord], devices: set[int]) -> list[tuple[OnlineState, int]]:
    """Find the last state of a history that changed the pose of each of some devices, and the device number."""
    found, missing = [], set(devices)
    for record in reversed(history):
        if record.pending.device in missing:
            found.append((record.after, record.pending.device))
            missing.discard(record.pending.device)
        for device in tethered_devices(record.tethers) & missing:
            found.append((record.tethered, device))
            missing.discard(device)
        if not missing:
            break
    return found


def whole_steps(history: Sequence[FilterRecord], count: int) -> int:
    """Reduce a number of oldest records so far that no step is divided."""
    while 0 < count < len(history) and _divides_step(history, count):
        count -= 1
    return count


def _divides_step(history: Sequence[FilterRecord], count: int) -> bool:
    before = {(one.pending.device, one.pending.step) for one in history[max(count - _NEAR, 0) : count]}
    return any((one.pending.device, one.pending.step) in before for one in history[count : count + _NEAR])
