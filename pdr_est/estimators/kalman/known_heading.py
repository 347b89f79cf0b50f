"""Joint filter of devices whose headings are known throughout and whose positions nothing measures.

The state of a device by its own measurements then decides nothing after its first node: the filter is one fold over
the joint state, with the numbers of `offline_filter` and a fraction of its operations.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.initial_state import late_start_donor, start_prior
from pdr_est.estimators.common.motion_model import JITTER_VARIANCE, STATES, GaussianState, linearise_each
from pdr_est.estimators.common.nodes import SAME_S
from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.kalman.device_filter_step import loses_heading, start_device
from pdr_est.estimators.kalman.predict_and_update import NodeFilter, rows_of
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose

_ROWS = 4096  # that are smoothed together, which bounds the memory


@dataclass(frozen=True)
class KnownHeadings:
    """Joint states of d devices after each of n nodes, in order of time, and the tethers that follow it.

    Attributes
    ----------
    device, node
        Numbers (n,) of device and node.
    mean, covariance
        Joint states: means (n, 5 d) and covariances (n, 5 d, 5 d).
    entered
        State with which a device entered, by row of its first node.
    tethers
        Tethers that were applied after a node, by its row.
    """

    device: NDArray[np.int64]
    node: NDArray[np.int64]
    mean: Array
    covariance: Array
    entered: dict[int, GaussianState]
    tethers: dict[int, list[NodeTether]]

    def filtered(self, timelines: Sequence[Timeline]) -> list[tuple[Array, Array]]:
        """Return the states of each device at its nodes: means (k, 5) and covariances (k, 5, 5).

        The state at a node is that after the last tether that ends there.
        """
        found = []
        for device, timeline in enumerate(timelines):
            rows, own = np.flatnonzero(self.device == device), rows_of(device)
            last = np.zeros(len(timeline.nodes), dtype=np.int64)
            last[self.node[rows]] = rows
            for row, tethers in self.tethers.items():
                for one in tethers:
                    for number, node in ((one.device_a, one.node_a), (one.device_b, one.node_b)):
                        if number == device:
                            last[node] = row
            covariance = self.covariance[last, own, own]
            found.append((self.mean[last, own], 0.5 * (covariance + covariance.transpose(0, 2, 1))))
        return found

    def smoothed_means(self, timelines: Sequence[Timeline]) -> list[Array]:
        """Return the smoothed means (k, 5) of each device at its nodes (Rauch-Tung-Striebel)."""
        mean = self.mean.copy()
        for begin in range((len(mean) - 2) // _ROWS * _ROWS, -1, -_ROWS):
            rows = slice(begin, min(begin + _ROWS, len(mean) - 1))
            moved, gain = self._gains(rows, timelines)
            for k in range(len(gain) - 1, -1, -1):
                mean[begin + k] += gain[k] @ (mean[begin + k + 1] - moved[k])
        return [mean[self.device == device, rows_of(device)] for device in range(len(timelines))]

    def _gains(self, rows: slice, timelines: Sequence[Timeline]) -> tuple[Array, Array]:
        """Return predicted means (k, 5 d) of what follows some rows, and the gains (k, 5 d, 5 d) of the smoother."""
        covariance = self.covariance[rows]
        covariance = 0.5 * (covariance + covariance.transpose(0, 2, 1))
        moved, jacobian = self.mean[rows].copy(), np.tile(np.eye(self.mean.shape[1]), (len(covariance), 1, 1))
        noise, after = np.zeros(covariance.shape), np.arange(rows.start, rows.stop) + 1
        entering = np.isin(after, list(self.entered))
        for device, timeline in enumerate(timelines):
            own, going = rows_of(device), np.flatnonzero((self.device[after] == device) & ~entering)
            nodes = [timeline.nodes[i] for i in self.node[after[going]].tolist()]
            if nodes:
                moved[going, own], jacobian[going, own, own], noise[going, own, own] = linearise_each(
                    moved[going, own], nodes
                )
        for k in np.flatnonzero(entering).tolist():
            own, state = rows_of(int(self.device[after[k]])), self.entered[int(after[k])]
            jacobian[k, own, own] = 0.0
            noise[k, own, own], moved[k, own] = state.covariance, state.mean
        ahead = jacobian @ covariance
        regular = ahead @ jacobian.transpose(0, 2, 1) + noise + JITTER_VARIANCE * np.eye(self.mean.shape[1])
        return moved, np.asarray(np.linalg.solve(regular, ahead).transpose(0, 2, 1))


def known_headings(
    timelines: Sequence[Timeline],
    node_tethers: Sequence[NodeTether],
    starts: Sequence[StartPose],
    sigma_length_scale: float,
) -> KnownHeadings | None:
    """Filter the nodes of several devices in order of time, then of device.

    Parameters
    ----------
    timelines, node_tethers, starts, sigma_length_scale
        As for `offline_filter.filter_walk`.

    Returns
    -------
    KnownHeadings or None
        None for a walk with measured positions, with a heading that is unknown at first or lost on the way, or with
        a device that begins late.
    """
    priors = [start_prior(one, start, sigma_length_scale) for one, start in zip(timelines, starts, strict=True)]
    begins_s = [one.nodes[0].time_s for one in timelines]
    late = any(late_start_donor(0, begin_s, min(begins_s), (0,)) is not None for begin_s in begins_s)
    if late or any(prior.heading_open for prior in priors) or not all(map(_keeps_heading, timelines)):
        return None
    order = sorted((node.time_s, d, i) for d, one in enumerate(timelines) for i, node in enumerate(one.nodes))
    ekf, alone, due = NodeFilter(len(timelines)), NodeFilter(1), deque(node_tethers)
    size = STATES * len(timelines)
    found = KnownHeadings(
        np.array([device for _, device, _ in order]),
        np.array([node for _, _, node in order]),
        np.empty((len(order), size)),
        np.empty((len(order), size, size)),
        {},
        {},
    )
    for row, (time_s, device, number) in enumerate([*order, (np.inf, 0, 0)]):
        while due and due[0].time_s + SAME_S < time_s:
            if row > 0:
                _tether(ekf, due[0], found, row - 1)
            due.popleft()
        if row == len(order):
            break
        node = timelines[device].nodes[number]
        if number == 0:
            entering = start_device(node, 0, priors[device], alone).state
            found.entered[row] = ekf.add_device(entering, node, device, None)
        else:
            ekf.predict_motion(node, device)
            ekf.update_node(node, device)
        found.mean[row], found.covariance[row] = ekf.x, ekf.P
    return found


def _tether(ekf: NodeFilter, tether: NodeTether, found: KnownHeadings, row: int) -> None:
    """Apply a tether after a row, if both devices are there."""
    present = {int(found.device[first]) for first in found.entered}
    if {tether.device_a, tether.device_b} <= present:
        ekf.update_tether(tether.device_a, tether.device_b, tether.max_distance_m, tether.sigma_m)
        found.mean[row], found.covariance[row] = ekf.x, ekf.P
        found.tethers.setdefault(row, []).append(tether)


def _keeps_heading(timeline: Timeline) -> bool:
    """Tell whether nothing measures positions, and no turn makes the heading be given up."""
    if timeline.closure_sigma_m is not None:
        return False
    last = max((i for i, node in enumerate(timeline.nodes) if node.observes_heading), default=0)
    return not any(node.fixes or (1 <= i <= last and loses_heading(node)) for i, node in enumerate(timeline.nodes))
