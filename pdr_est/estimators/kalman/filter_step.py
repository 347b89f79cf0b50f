"""The filter of one device by itself, node by node: what `ekf.run_filter` does, for a walk that goes on.

A state is never changed, only followed by the next, so that going back to an earlier one costs nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pdr_est.estimators.common.initial_state import StartPrior, prior_after_lost_turn
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.timeline import Node
from pdr_est.estimators.kalman.heading_search import HeadingSearch, search_heading
from pdr_est.estimators.kalman.multi_device_ekf import PoseFilter
from pdr_est.estimators.kalman.single_device import HEADING_RESET_VARIANCE_RAD2, undecided
from pdr_est.frames import Array

Raw = tuple[Array, Array]  # mean and covariance of a PoseFilter as it left them


@dataclass(frozen=True)
class DeviceFilterState:
    """State after a node. begin: number of the first node of the stretch, prior: its state there. seeking: until the
    direction is known, raw: from then on. pose (3,), covariance (3, 3): for the track. end: the whole state.

    entered: whether the direction became known at this very node. lost_s: time of the first turn, since the last
    measurement of the direction, that left nothing of it; such a measurement would open a new stretch there.
    """

    begin: int
    prior: GaussianState
    seeking: HeadingSearch | None
    raw: Raw | None
    pose: Array
    covariance: Array
    end: GaussianState
    entered: bool
    lost_s: float | None = None

    @property
    def directed(self) -> bool:
        return self.raw is not None


def begin(node: Node, number: int, prior: StartPrior, workhorse: PoseFilter) -> DeviceFilterState:
    """The state at the first node of a stretch."""
    if prior.heading_open:
        return _seek(None, node, [node], number, prior.moments)
    workhorse.enter(prior.moments)
    workhorse.measure(node)
    return _aligned(number, prior.moments, workhorse, entered=True)


def follow(
    before: DeviceFilterState,
    node: Node,
    number: int,
    nodes: Sequence[Node],
    found_again: bool,
    workhorse: PoseFilter,
) -> DeviceFilterState:
    """The state at the next node. nodes: those of the stretch up to this one; found_again: whether something at this
    node or later tells the direction, so that it pays to give up one that a turn has left nothing of."""
    is_lost = bool(node.covariance[2, 2] > HEADING_RESET_VARIANCE_RAD2)
    if is_lost and found_again:
        return begin(node, number, prior_after_lost_turn(before.end, node), workhorse)
    lost_s = before.lost_s if before.lost_s is not None or not is_lost else node.time_s
    lost_s = None if node.tells_direction else lost_s
    if before.raw is None:
        return replace(_seek(before.seeking, node, nodes, before.begin, before.prior), lost_s=lost_s)
    load(workhorse, before.raw)
    workhorse.advance(node)
    workhorse.measure(node)
    return replace(_aligned(before.begin, before.prior, workhorse, entered=False), lost_s=lost_s)


def begin_anew(before: DeviceFilterState, node: Node, number: int, workhorse: PoseFilter) -> DeviceFilterState:
    """The state at a node when too many nodes have passed to remember them all until the direction is known: what was
    known of it is given up, and the position is as uncertain as it has become."""
    return begin(node, number, prior_after_lost_turn(before.end, node), workhorse)


def load(workhorse: PoseFilter, raw: Raw) -> None:
    workhorse.x, workhorse.P = raw[0].copy(), raw[1].copy()


def unload(workhorse: PoseFilter) -> Raw:
    return workhorse.x.copy(), workhorse.P.copy()


def _seek(
    before: HeadingSearch | None, node: Node, nodes: Sequence[Node], number: int, prior: GaussianState
) -> DeviceFilterState:
    found, aligned = search_heading(before, node, nodes, prior)
    if aligned is None:
        end = undecided(found.pose, found.covariance, prior)
        return DeviceFilterState(number, prior, found, None, found.pose, found.covariance, end, entered=False)
    raw = (aligned.mean, aligned.covariance)
    end = GaussianState(aligned.mean, 0.5 * (aligned.covariance + aligned.covariance.T))
    return DeviceFilterState(
        number, prior, None, raw, aligned.mean[:3], aligned.covariance[:3, :3], end, entered=True
    )


def _aligned(number: int, prior: GaussianState, workhorse: PoseFilter, entered: bool) -> DeviceFilterState:
    end = workhorse.moments()
    return DeviceFilterState(
        number, prior, None, unload(workhorse), end.mean[:3], end.covariance[:3, :3], end, entered=entered
    )
