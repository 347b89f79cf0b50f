"""What the tracker says of one pose of one device."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.timeline import Node
from pdr_est.frames import Array, rotate_vectors, wrap_angle
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

Kind = Literal["filtered", "delayed"]


@dataclass(frozen=True)
class Update:
    """The pose of a device at the end of a step, or at its start.

    position_m (2,) east and north, covariance_m2 (2, 2), heading_rad counter-clockwise from east with its standard
    deviation. kind: "filtered" from what is known by now, "delayed" from that up to the lag later. moving_from_s:
    when the movement to this pose began. What comes late may change a pose: the last update of a kind, device and
    time counts.
    """

    device: str
    time_s: float
    position_m: Array
    covariance_m2: Array
    heading_rad: float
    sigma_heading_rad: float
    kind: Kind
    step_length_m: float
    mode: CarryingMode
    moving_from_s: float


def track_of(updates: Iterable[Update], kind: Kind = "filtered", estimator: str | None = None) -> Track:
    """The track that updates of a kind leave, device by device in order of their first appearance.

    Raises EstimationError without any.
    """
    latest: dict[str, dict[float, Update]] = {}
    for update in updates:
        if update.kind == kind:
            latest.setdefault(update.device, {})[update.time_s] = update
    rows = [row for device in latest.values() for _, row in sorted(device.items())]
    if not rows:
        raise EstimationError(f"no {kind} update: push more of the walk, and flush at its end")
    return Track(
        time_s=np.array([row.time_s for row in rows]),
        moving_from_s=np.array([row.moving_from_s for row in rows]),
        device=np.array([row.device for row in rows]),
        position_m=np.array([row.position_m for row in rows]),
        heading_rad=np.array([row.heading_rad for row in rows]),
        covariance_m2=np.array([row.covariance_m2 for row in rows]),
        sigma_heading_rad=np.array([row.sigma_heading_rad for row in rows]),
        mode=np.array([row.mode for row in rows], dtype=np.int8),
        step_length_m=np.array([row.step_length_m for row in rows]),
        kind=kind,
        estimator=estimator or ("ekf" if kind == "filtered" else "fixed-lag"),
    )


class Pose(Protocol):
    """A pose (3,) of a device at a node, with its covariance (3, 3) and the length scale with its sigma."""

    @property
    def device(self) -> int: ...

    @property
    def node(self) -> Node: ...

    @property
    def pose(self) -> Array: ...

    @property
    def covariance(self) -> Array: ...

    @property
    def scale(self) -> tuple[float, float]: ...


def update_of(pose: Pose, device: str, kind: Kind) -> Update:
    return Update(
        device=device,
        time_s=pose.node.time_s,
        position_m=pose.pose[:2].copy(),
        covariance_m2=pose.covariance[:2, :2].copy(),
        heading_rad=float(wrap_angle(pose.pose[2])),
        sigma_heading_rad=float(np.sqrt(pose.covariance[2, 2])),
        kind=kind,
        step_length_m=pose.node.step_length_m * pose.scale[0],
        mode=pose.node.mode,
        moving_from_s=pose.node.moving_from_s,
    )


def placed(update: Update, offset_m: tuple[float, float]) -> Update:
    """The update of a device that sits offset_m, forward and left, from the centre of the body whose pose it is."""
    if offset_m == (0.0, 0.0):
        return update
    return replace(update, position_m=update.position_m + rotate_vectors(np.array(offset_m), update.heading_rad))
