"""Entries of the window of the fixed-lag smoother, and the poses that leave it."""

from dataclasses import dataclass, replace

from pdr_est.estimators.common.motion_model import GaussianState, SourceState
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.tethers import NodeTether, PairTether
from pdr_est.estimators.kalman.fix_sources import wandering_part
from pdr_est.frames import Array


@dataclass(frozen=True)
class FilteredNode:
    """Result of the joint EKF at a node.

    Attributes
    ----------
    device : int
        Index of the device.
    node : Node
        Node of this device.
    entered : GaussianState or None
        State with which the device entered the filter here; None if it moved on from its previous node.
    tethers : tuple of NodeTether or of PairTether
        Tethers to be applied at this time.
    mean : Array
        Posterior mean of all d devices and s sources of fixes with a wandering error, (5 d + 2 s,).
    covariance : Array
        Posterior covariance, (5 d + 2 s, 5 d + 2 s).
    present : frozenset[int]
        Indices of the devices that have entered.
    sources : tuple of SourceState
        The sources, in the order of their states.
    """

    device: int
    node: Node
    entered: GaussianState | None
    tethers: tuple[NodeTether, ...] | tuple[PairTether, ...]
    mean: Array
    covariance: Array
    present: frozenset[int]
    sources: tuple[SourceState, ...] = ()

    @classmethod
    def of_state(
        cls,
        state: GaussianState,
        device: int,
        node: Node,
        entered: GaussianState | None,
        tethers: tuple[NodeTether, ...] | tuple[PairTether, ...],
        present: frozenset[int],
        devices: int,
    ) -> "FilteredNode":
        """Make a result from the joint state of all devices; the fixes of the node are taken as the filter did."""
        own = wandering_part(state, devices)
        node = replace(node, fixes=state.taken)
        return cls(device, node, entered, tethers, own.mean, own.covariance, present, own.sources)


@dataclass(frozen=True)
class LaggedPose:
    """Smoothed pose of a device at a node.

    Attributes
    ----------
    device : int
        Index of the device.
    node : Node
        Node of this device.
    pose : Array
        East, north (m) and heading (rad) in the map frame, (3,).
    covariance : Array
        Covariance, (3, 3). NaN at a node that is no step and appears in no track, because it is slow to compute.
    scale : tuple[float, float]
        Length scale and its standard deviation.
    """

    device: int
    node: Node
    pose: Array
    covariance: Array
    scale: tuple[float, float]
