"""The filtered poses at the ends of steps, and which of them are new or have changed since they were last given."""

from collections import OrderedDict
from collections.abc import Iterable
from dataclasses import dataclass

from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.timeline import Node
from pdr_est.frames import Array
from pdr_est.online.filter_records import Record, WalkState


@dataclass(frozen=True)
class Row:
    """A pose (3,) of a device at a node, with its covariance (3, 3) and the length scale with its sigma."""

    device: int
    node: Node
    pose: Array
    covariance: Array
    scale: tuple[float, float]

    def equals(self, other: "Row | None") -> bool:
        return (
            other is not None
            and self.node.time_s == other.node.time_s
            and bool((self.pose == other.pose).all() and (self.covariance == other.covariance).all())
        )


def moments_of_pose(moments: GaussianState) -> tuple[Array, Array]:
    return moments.mean[:3], moments.covariance[:3, :3]


class ChangedPoses:
    """Keeps what was given, as long as it may change."""

    def __init__(self) -> None:
        self._new: dict[tuple[int, int], Row] = {}
        self._given: OrderedDict[tuple[int, int], Row] = OrderedDict()  # nearly in the order of time

    def record(self, record: Record) -> None:
        """A node that the filter went through, and what tethers before it did to others."""
        self.pulled(record.pulled, record.pulls)
        self.last(record.after, record.pending.device)

    def pulled(self, state: WalkState, pulls: Iterable[tuple[int, int]]) -> None:
        """Tethers changed the last poses of some devices."""
        for device in sorted({device for pair in pulls for device in pair}):
            self.last(state, device)

    def last(self, state: WalkState, device: int) -> None:
        """The last pose of a device, as a state has it."""
        pending, moments = state.at[device], state.moments(device)
        if pending is None or not pending.node.is_step:
            return
        own = state.alone[device]
        alone = own is not None and (state.joint is None or not own.directed)
        pose, covariance = (own.pose, own.covariance) if own is not None and alone else moments_of_pose(moments)
        scale = moments.length_scale
        self._new[device, pending.step] = Row(device, pending.node, pose, covariance, scale)

    def changed(self) -> list[Row]:
        """In order of time."""
        rows = {key: row for key, row in self._new.items() if not row.equals(self._given.get(key))}
        self._given.update(rows)
        self._new.clear()
        return sorted(rows.values(), key=lambda row: (row.node.time_s, row.device))

    def forget(self, before_s: float) -> None:
        """Poses before a time will not change any more."""
        while self._given and next(iter(self._given.values())).node.time_s < before_s:
            self._given.popitem(last=False)
