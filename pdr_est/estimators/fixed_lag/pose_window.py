"""Poses of the last seconds at fixed length scales, estimated anew with each node.

The factors are those of the batch graph (`factor_graph.factors`): motions, heading priors, fixes with their wandering
errors, and the tethers that are violated. Each node is linearised at the estimate that there is when it comes, and
the whole window again when headings have changed noticeably since.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.common.motion_model import LOG_SCALE, STATES
from pdr_est.estimators.fixed_lag.window_entries import FilteredNode, LaggedPose
from pdr_est.estimators.fixed_lag.window_factors import EnteringPrior, PoseVariable, WindowCheckpoint, WindowFactors
from pdr_est.estimators.fixed_lag.window_prior import log_scales, pose_per_scale
from pdr_est.estimators.fixed_lag.window_rows import WindowPlaces, WindowTether, motion_whitening
from pdr_est.estimators.pose_chains.linear_rows import to_map
from pdr_est.estimators.pose_chains.residuals import RelativePoses
from pdr_est.frames import Array

_SCALE_TOLERANCE = 0.1  # in units of the scale's sigma; a larger change of the scale needs a new window
_RELINEARISE_RAD = 0.01  # what is neglected is half its square times the length of the window: below a millimetre
_MOST_ITERATIONS, _SETTLED = 20, 1e-4  # at the end of a walk, and the change in m and rad that ends them


@dataclass
class _Entry:
    """Node of the window: its pose, the value at which that is linearised, and what is known after it.

    It has the whitening of the motion that leads to it, or a prior, or neither at the begin of the window.
    """

    item: FilteredNode
    variable: PoseVariable
    pose: Array
    after: WindowCheckpoint
    whitening: Array | None = None
    prior: EnteringPrior | None = None
    tethers: Sequence[WindowTether] = ()


class PoseWindow:
    """Window that begins with a prior from the EKF and grows node by node.

    Parameters
    ----------
    items
        Results of the EKF at the nodes of the window; the first one gives the prior, the last one the length scales.
    relative
        Devices with headings relative to a reference.
    """

    def __init__(self, items: Sequence[FilteredNode], relative: set[int]) -> None:
        first, last = items[0], items[-1]
        devices = (len(first.mean) - 2 * len(first.sources)) // STATES
        self._log_scale = log_scales(last.mean, last.covariance, len(last.sources))[0]
        self._scale: list[float] = np.exp(self._log_scale).tolist()
        sources = dict.fromkeys(one.name for one in first.sources)
        sources |= dict.fromkeys(fix.source for one in items for fix in one.node.fixes if fix.sigma_wander_m > 0.0)
        self._places = WindowPlaces.of(devices, sorted(relative), list(sources))
        self._factors = WindowFactors(first, self._scale, self._places)
        self._restart = self._factors.checkpoint()
        variable, pose = self._factors.last[first.device], self._factors.at[self._places.pose(first.device)]
        self._entries = deque([_Entry(first, variable, pose.copy(), self._restart)])
        self._newest = first
        for item in list(items)[1:]:
            self._append(item)
        self._relinearise()

    def outdated_by(self, item: FilteredNode) -> bool:
        """Return True if the EKF's length scales differ noticeably from those here, or a source of fixes is new."""
        for device in item.present:
            row = STATES * device + LOG_SCALE
            sigma = max(float(item.covariance[row, row]), 0.0) ** 0.5
            if abs(float(item.mean[row]) - self._log_scale[device]) > _SCALE_TOLERANCE * sigma + 1e-9:
                return True
        return any(fix.sigma_wander_m > 0.0 and fix.source not in self._places.sources for fix in item.node.fixes)

    def add(self, item: FilteredNode) -> None:
        """Add the pose, the motion, the measurements and the tethers of an item."""
        self._append(item)
        if (item.node.priors or item.node.fixes or item.tethers) and self._has_turned():
            self._relinearise()

    def pose_of(self, item: FilteredNode, waiting: int) -> LaggedPose:
        """Return the pose of an item, the first of `waiting` ones, with the part of the covariance from the scale."""
        while len(self._entries) > waiting:
            self._restart = self._entries.popleft().after
            self._factors.linear.forget(self._restart.rows.complete)
        entry, place = self._entries[0], STATES * item.device + LOG_SCALE
        if entry.variable.row is None:
            change, covariance = self._factors.linear.of_present(self._places.pose(item.device))
        else:
            change, covariance = self._factors.linear.of_complete(entry.variable.row, 3)
        pose = entry.pose + change
        variance = max(float(self._newest.covariance[place, place]), 0.0)
        value = float(np.exp(self._newest.mean[place]))
        scale = (value, value * variance**0.5)
        if not item.node.is_step:
            return LaggedPose(item.device, item.node, pose, np.full((3, 3), np.nan), scale)
        per_scale = pose_per_scale(item.covariance, item.device)
        covariance = covariance + variance * np.outer(per_scale, per_scale)
        return LaggedPose(item.device, item.node, pose, 0.5 * (covariance + covariance.T), scale)

    def iterate(self) -> None:
        """Linearise at present estimates until they do not change any more."""
        for _ in range(_MOST_ITERATIONS):
            self._relinearise()
            if np.abs(self._factors.linear.present_changes()).max() < _SETTLED:
                break

    def _append(self, item: FilteredNode) -> None:
        """Add an item at present estimates."""
        self._newest = item
        factors, variable = self._factors, PoseVariable(item.device)
        if factors.follows(item):
            whitening, prior = motion_whitening(item.node), None
            pose = factors.move(item, variable, whitening)
        else:
            whitening, prior = None, factors.entering_prior(item)
            pose = prior.mean[:3]
            factors.at[prior.columns[3:]] = prior.mean[3:]
            factors.enter(variable, prior, pose)
        tethers = factors.tethers_of(item)
        factors.tether(tethers, settled=False)
        self._entries.append(_Entry(item, variable, pose, factors.checkpoint(), whitening, prior, tethers))

    def _has_turned(self) -> bool:
        """Tell whether the last headings are far from those that they are linearised at."""
        change = self._factors.linear.present_changes()
        return bool(np.abs(change[2 : 3 * self._places.devices : 3]).max() > _RELINEARISE_RAD)

    def _relinearise(self) -> None:
        """Linearise all entries at their present estimates."""
        again, before = [entry for entry in self._entries if entry.after is not self._restart], self._restart
        variables = [*before.last, *(entry.variable for entry in again)]
        poses = self._estimates(
            variables, [*before.at[: 3 * len(before.last)].reshape(-1, 3), *(e.pose for e in again)]
        )
        numbers = {id(variable): number for number, variable in enumerate(variables)}
        for entry in again:
            for one in entry.tethers:
                ends = [numbers[id(entry.after.last[d])] for d in (one.tether.device_a, one.tether.device_b)]
                one.expect(poses[ends].ravel())
        self._factors.return_to(before, poses[: len(before.last)])
        self._restart = self._factors.checkpoint()
        for entry in self._entries:
            if entry.after is before:
                entry.after, entry.pose = self._restart, poses[entry.item.device]
        self._add_again(again, poses)

    def _estimates(self, variables: Sequence[PoseVariable], at: Sequence[Array]) -> Array:
        """Return the estimates (k, 3) of poses that are linearised at some values."""
        linear = self._factors.linear
        present = linear.present_changes()
        complete, first = linear.complete_changes(present), linear.begin
        changes = [
            present[self._places.pose(one.device)] if one.row is None else complete[one.row - first :][:3]
            for one in variables
        ]
        return np.array(at) + np.array(changes)

    def _add_again(self, entries: Sequence[_Entry], poses: Array) -> None:
        """Add entries whose poses are the last ones of `poses`, behind those at the begin of the window."""
        devices = self._places.devices
        motions = self._motions(entries, poses)
        for number, (entry, pose) in enumerate(zip(entries, poses[devices:], strict=True), devices):
            entry.pose, entry.variable.row = pose, None
            if entry.prior is not None:
                self._factors.enter(entry.variable, entry.prior, pose)
            else:
                self._factors.follow(entry.item, entry.variable, pose, motions[number], settled=True)
            self._factors.tether(entry.tethers, settled=True)
            entry.after = self._factors.checkpoint()

    def _motions(self, entries: Sequence[_Entry], poses: Array) -> dict[int, tuple[Array, Array, Array]]:
        """Linearise the motions to entries, by the numbers of the poses that they lead to."""
        last, pairs, moving = list(range(self._places.devices)), [], []
        for number, entry in enumerate(entries, self._places.devices):
            if entry.whitening is not None:
                pairs.append((last[entry.item.device], number))
                moving.append(entry)
            last[entry.item.device] = number
        if not moving:
            return {}
        nodes = [(one.item.node.heading_change_rad, one.item.node.length_m, one.item.device) for one in moving]
        turn, length_m, device = np.array(nodes).T
        ahead = np.array(self._scale)[device.astype(np.intp)] * length_m
        measured = np.stack([ahead * np.cos(turn), ahead * np.sin(turn), turn], axis=1)
        whitening = np.array([one.whitening for one in moving])
        known = RelativePoses(np.array(pairs), measured, whitening, np.zeros(len(moving), dtype=np.bool_))
        linear, from_map = known.linearised(poses), to_map(poses[:, 2]).transpose(0, 2, 1)
        before = linear.jacobian[:, :, :3] @ from_map[known.pose[:, 0]]
        own = linear.jacobian[:, :, 3:] @ from_map[known.pose[:, 1]]
        return dict(zip(known.pose[:, 1].tolist(), zip(before, own, linear.right, strict=True), strict=True))
