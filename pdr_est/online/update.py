"""Updates: what the tracker tells about one pose of one device."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.unknown_direction import covariance_any_direction
from pdr_est.frames import SIGMA_UNIFORM_RAD, Array, rotate_vectors, wrap_angle
from pdr_est.types.findings import Finding
from pdr_est.types.height import HeightProfile
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

Kind = Literal["filtered", "delayed"]
"""Kind of a pose: estimated from what is known so far, or with a lag from what came up to the lag later."""


@dataclass(frozen=True)
class Update:
    """Pose of a device at the end of a step or at its start.

    Data that comes late may change a pose: the last update of a kind, device and time counts.

    Attributes
    ----------
    device
        Name of the device, or `fused` for the person.
    time_s
        Time of the pose.
    position_m
        Position (2,), east and north.
    covariance_m2
        Covariance (2, 2) of the position, m².
    heading_rad
        Heading, counter-clockwise from east, rad.
    sigma_heading_rad
        Standard deviation of the heading, rad.
    kind
        "filtered" from what is known so far, or "delayed" from what is known up to the lag later.
    step_length_m
        Length of the step that ends here, m.
    mode
        Carrying mode of the phone during the step.
    moving_from_s
        Time at which the step began.
    height_m, sigma_height_m
        Height of the walker above the floor at the start, and its standard deviation, m; None where not known.
    floor, floor_probability
        Number of the nearest floor, counted from that at the start, and its probability; None where not known.
    findings
        What does not fit in the walk so far; each finding comes once, with the first update after it showed.
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
    findings: tuple[Finding, ...] = ()
    height_m: float | None = None
    sigma_height_m: float | None = None
    floor: int | None = None
    floor_probability: float | None = None


def track_of(updates: Iterable[Update], kind: Kind = "filtered", estimator: str | None = None) -> Track:
    """Return the track that updates of one kind leave, device by device in order of their first appearance.

    Its findings are those of all updates.

    Raises
    ------
    EstimationError
        If there is no update of that kind.
    """
    latest: dict[str, dict[float, Update]] = {}
    findings: dict[Finding, None] = {}
    for update in updates:
        findings |= dict.fromkeys(update.findings)
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
        findings=tuple(findings),
        height=_heights_of(rows),
    )


def _heights_of(rows: Sequence[Update]) -> HeightProfile | None:
    """Return the heights of the walker at the times of some updates; None where none is known."""
    known = {row.time_s: row for row in rows if row.height_m is not None}
    if not known:
        return None
    in_time = [known[time_s] for time_s in sorted(known)]
    return HeightProfile(
        time_s=np.array([row.time_s for row in in_time]),
        height_m=np.array([row.height_m for row in in_time], dtype=np.float64),
        sigma_m=np.array([row.sigma_height_m for row in in_time], dtype=np.float64),
        floor=np.array([row.floor for row in in_time], dtype=np.int64),
        floor_probability=np.array([row.floor_probability for row in in_time], dtype=np.float64),
    )


class PoseEstimate(Protocol):
    """Estimated pose of a device at a node, from the filter or from the fixed-lag smoother."""

    @property
    def device(self) -> int:
        """Return the number of the device."""

    @property
    def node(self) -> Node:
        """Return the node."""

    @property
    def pose(self) -> Array:
        """Return the pose (3,), east m, north m, heading rad."""

    @property
    def covariance(self) -> Array:
        """Return the covariance (3, 3) of the pose in the map frame."""

    @property
    def scale(self) -> tuple[float, float]:
        """Return the length scale and its standard deviation."""


def update_of(pose: PoseEstimate, device: str, kind: Kind) -> Update:
    """Make the update of a device's pose."""
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


def in_unknown_direction(update: Update, start_m: Array) -> Update:
    """Give an update the uncertainty of a walk that may be turned by any angle about its start (2,)."""
    covariance = covariance_any_direction(update.position_m[None], update.covariance_m2[None], start_m)[0]
    return replace(update, covariance_m2=covariance, sigma_heading_rad=SIGMA_UNIFORM_RAD)


def at_mounting(update: Update, offset_m: tuple[float, float]) -> Update:
    """Move an update from the centre of the body to a device that is mounted `offset_m` forward and left of it."""
    if offset_m == (0.0, 0.0):
        return update
    return replace(update, position_m=update.position_m + rotate_vectors(np.array(offset_m), update.heading_rad))
