"""Step of the filter of a whole walk: every device by itself, and all devices in one joint state.

The offline filter (`offline_filter.py`) is a fold of these steps over all nodes; the online filter takes the same
steps and can return to any earlier state, because a state is never changed in place.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf
from typing import TypeVar

from pdr_est.estimators.common.initial_state import StartPrior, late_start_donor
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.tethers import NodeTether, PairTether
from pdr_est.estimators.kalman.device_filter_step import DeviceFilterState, start_device, step_device
from pdr_est.estimators.kalman.predict_and_update import NodeFilter, marginal_of
from pdr_est.frames import Array

Tether = TypeVar("Tether", NodeTether, PairTether)


@dataclass(frozen=True)
class WalkFilterState:
    """State of the filter of all devices.

    Attributes
    ----------
    devices
        State of each device by its own measurements; None before its first node.
    joint
        Joint state of all devices as the EKF left it, zero for devices that have not entered; None if a single
        device is filtered by itself.
    present
        Numbers of the devices that have entered the joint state.
    begun_s
        Time of the first node of the walk.
    """

    devices: tuple[DeviceFilterState | None, ...] = ()
    joint: GaussianState | None = None
    present: frozenset[int] = frozenset()
    begun_s: float = inf

    def heading_known(self, device: int) -> bool:
        """Tell whether a device has begun and its heading is known, so that it takes part in the joint state."""
        own = self.devices[device]
        return own is not None and own.heading_known

    def state_of(self, device: int) -> GaussianState:
        """Return the state of a device that has begun: from the joint state if it takes part there."""
        own = self._own(device)
        if self.joint is None or not own.heading_known:
            return own.state
        return marginal_of(self.joint, device, len(self.devices))

    def pose_of(self, device: int) -> tuple[Array, Array]:
        """Return the pose (3,) of a device that has begun, and its covariance (3, 3), for the track."""
        own = self._own(device)
        if self.joint is None or not own.heading_known:
            return own.pose, own.covariance
        state = self.state_of(device)
        return state.mean[:3], state.covariance[:3, :3]

    def joint_state(self) -> GaussianState:
        """Return the state of all devices with a symmetric covariance; that of the device if there is only one."""
        if self.joint is None:
            return self.state_of(0)
        covariance = self.joint.covariance
        return replace(self.joint, mean=self.joint.mean.copy(), covariance=0.5 * (covariance + covariance.T))

    def _own(self, device: int) -> DeviceFilterState:
        own = self.devices[device]
        if own is None:
            raise LookupError(f"device {device} has no node yet")
        return own


class WalkStepper:
    """Pure functions that step the filter of a walk; the two EKFs inside serve as working memory only.

    Parameters
    ----------
    devices
        Number of devices.
    """

    def __init__(self, devices: int) -> None:
        self._own = NodeFilter(1)
        self._devices = devices

    @cached_property
    def _joint(self) -> NodeFilter:
        from pdr_est.estimators.kalman.filterpy_ekf import MultiDeviceEkf  # slow to load, and for a joint state only

        return MultiDeviceEkf(self._devices)

    def initial(self, joint: bool) -> WalkFilterState:
        """Return the state before the first node; `joint` tells whether there is a joint state."""
        return WalkFilterState((None,) * self._devices, _zero_state(self._devices) if joint else None)

    def with_joint_of(self, devices: Sequence[DeviceFilterState | None], begun_s: float) -> WalkFilterState:
        """Return a state with a new joint state made of the devices' own states, without correlation between them."""
        self._joint.load(_zero_state(self._devices))
        known = {number: own.state for number, own in enumerate(devices) if own is not None and own.heading_known}
        for number, state in known.items():
            self._joint.set_state(state, number)
        return WalkFilterState(tuple(devices), self._joint.dump(), frozenset(known), begun_s)

    def step(
        self,
        before: WalkFilterState,
        device: int,
        number: int,
        node: Node,
        *,
        heading_observed_later: bool,
        prior: StartPrior | None,
        own_node: Node | None = None,
    ) -> tuple[WalkFilterState, GaussianState | None]:
        """Step to the next node of any device.

        Parameters
        ----------
        before
            State before the node.
        device
            Number of the device that the node belongs to.
        number
            Number of the node among the nodes of its device.
        node
            Node to step to.
        heading_observed_later
            True if a measurement at this node or later observes the heading of the device.
        prior
            Prior of the device's state, needed at its first node.
        own_node
            Node with the measurements that only the device's own filter uses, if there are such.

        Returns
        -------
        WalkFilterState
            State after the node.
        GaussianState or None
            State with which the device enters the joint state at this node, if it does.
        """
        previous, own_node = before.devices[device], node if own_node is None else own_node
        if previous is None:
            if prior is None:
                raise LookupError(f"first node of device {device} without prior")
            own = start_device(own_node, number, prior, self._own)
        else:
            own = step_device(previous, own_node, number, heading_observed_later, self._own)
        joint, entered = before.joint, own.state if own.heading_found else None
        if joint is not None and own.heading_known:
            donor = late_start_donor(number, node.time_s, before.begun_s, before.present)
            joint, entered = self._step_joint(joint, device, node, entered, donor)
        devices = (*before.devices[:device], own, *before.devices[device + 1 :])
        present = before.present | {device} if own.heading_known else before.present
        return WalkFilterState(devices, joint, present, min(before.begun_s, node.time_s)), entered

    def apply_tethers(
        self, state: WalkFilterState, tethers: Sequence[Tether]
    ) -> tuple[WalkFilterState, tuple[Tether, ...]]:
        """Update the joint state with the tethers between devices that take part in it.

        Returns
        -------
        WalkFilterState
            State after the tethers.
        tuple of NodeTether or of PairTether
            Tethers that were applied.
        """
        applied = tuple(
            one for one in tethers if state.heading_known(one.device_a) and state.heading_known(one.device_b)
        )
        if state.joint is None or not applied:
            return state, ()
        self._joint.load(state.joint)
        for one in applied:
            self._joint.update_tether(one.device_a, one.device_b, one.max_distance_m, one.sigma_m)
        return replace(state, joint=self._joint.dump()), applied

    def _step_joint(
        self, joint: GaussianState, device: int, node: Node, entered: GaussianState | None, donor: int | None
    ) -> tuple[GaussianState, GaussianState | None]:
        """Step the joint state to a node; the device enters with its own state, or moves on."""
        self._joint.load(joint)
        if entered is not None:
            entered = self._joint.add_device(entered, node, device, donor)
        else:
            self._joint.predict_node(node, device)
            self._joint.update_node(node, device)
        return self._joint.dump(), entered


def _zero_state(devices: int) -> GaussianState:
    empty = NodeFilter(devices)
    return empty.dump()
