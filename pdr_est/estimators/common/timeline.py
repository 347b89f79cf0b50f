"""Timeline: the measurements of one device in order of time, as nodes and the motion between them.

All estimators work on the same timeline, so that their results can be compared number by number.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pdr_est.estimators.common.measurement_checks import refuse_unusable
from pdr_est.estimators.common.nodes import SAME_S, Node, NodeBuilder, sort_fixes
from pdr_est.frames import Array, wrap_angle
from pdr_est.types.measurements import (
    DeviceMeasurements,
    DeviceTether,
    HeadingPrior,
    LoopClosure,
    Measurement,
    PositionFix,
    StepOdometry,
)
from pdr_est.types.track import Track

__all__ = ["SAME_S", "Node", "Timeline", "build_timeline", "timelines_of", "track_from_nodes"]


@dataclass(frozen=True)
class Timeline:
    """Nodes of one device's walk.

    Attributes
    ----------
    device
        Name of the device.
    nodes
        Nodes in order of time; the first one is the start.
    closure_sigma_m
        Standard deviation of the loop closure in each coordinate, m; None for a walk that is not closed.
    """

    device: str
    nodes: tuple[Node, ...] = field(repr=False)
    closure_sigma_m: float | None = None

    @cached_property
    def fixes(self) -> tuple[PositionFix, ...]:
        """List the position fixes of all nodes."""
        return tuple(fix for node in self.nodes for fix in node.fixes)

    @cached_property
    def priors(self) -> tuple[HeadingPrior, ...]:
        """List the heading priors of all nodes."""
        return tuple(prior for node in self.nodes for prior in node.priors)

    @cached_property
    def observes_heading(self) -> bool:
        """Tell whether any node helps to find the heading of the walk in the map frame."""
        return any(node.observes_heading for node in self.nodes)


def build_timeline(
    device: str, start_s: float, measurements: Iterable[Measurement], split_times_s: Iterable[float] = ()
) -> Timeline:
    """Order the measurements of a device, and divide steps at the fixes and split times that fall inside them.

    A fix while the walker stands still applies to the pose before it; fixes before the first or after the last step
    apply to the ends. Odometry, heading priors and loop closures of other devices are left out, and so are tethers,
    which tell nothing about one device alone.

    Parameters
    ----------
    device
        Name of the device.
    start_s
        Time of the start pose, or the end of the first step if that is earlier.
    measurements
        Measurements in any order, but the steps in order of time.
    split_times_s
        Further times at which a node is wanted.

    Raises
    ------
    EstimationError
        For odometry that is not in order of time and for measurements without a usable value.
    """
    given = tuple(measurements)
    steps = [m for m in given if isinstance(m, StepOdometry) and m.device == device]
    fixes = [m for m in given if isinstance(m, PositionFix)]
    priors = [m for m in given if isinstance(m, HeadingPrior) and m.device == device]
    closures = [m for m in given if isinstance(m, LoopClosure) and m.device == device]
    refuse_unusable(device, steps, fixes, priors, closures)
    builder = NodeBuilder(start_s)
    for step in steps:
        builder.append(step)
    for prior in priors:
        builder.append(prior)
    ordered, splits = sort_fixes(fixes), sorted(split_times_s)
    nodes = [node for number in range(builder.count + 1) for node in builder.nodes_of(number, ordered, splits)]
    closure_sigma_m = min((closure.sigma_m for closure in closures), default=None)
    return Timeline(device, tuple(nodes), closure_sigma_m)


def timelines_of(
    devices: Sequence[DeviceMeasurements],
    tethers: Iterable[DeviceTether] = (),
    pose_times_s: Iterable[float] = (),
) -> list[Timeline]:
    """Build the timeline of each device, with a node at the time of each tether.

    A position fix among the measurements of n devices is one piece of knowledge about one walker: each device gets it
    with n times its covariance.

    Parameters
    ----------
    devices
        Measurements of each device.
    tethers
        Tethers between the devices.
    pose_times_s
        Further times at which each device gets a node, s.
    """
    split_times_s = sorted({*(tether.time_s for tether in tethers), *pose_times_s})
    return [
        build_timeline(one.device, one.start_s, _shared(one.measurements, len(devices)), split_times_s)
        for one in devices
    ]


def _shared(measurements: Sequence[Measurement], devices: int) -> list[Measurement]:
    """Return measurements with the share of one device in each position fix."""
    if devices == 1:
        return list(measurements)
    return [
        replace(m, covariance_m2=m.covariance_m2 * devices) if isinstance(m, PositionFix) else m for m in measurements
    ]


def track_from_nodes(
    timeline: Timeline,
    position_m: Array,
    heading_rad: Array,
    covariance: Array,
    kind: str,
    estimator: str,
    length_scale: tuple[float, float] = (1.0, 0.0),
) -> Track:
    """Make the track of one device from the poses at its nodes; only the ends of steps appear in it.

    Parameters
    ----------
    timeline
        Timeline with n nodes.
    position_m
        Positions (n, 2), east and north.
    heading_rad
        Headings (n,), wrapped or not.
    covariance
        Covariances (n, 3, 3) of (east, north, heading) in the map frame.
    kind, estimator
        Values of the fields of the track.
    length_scale
        Estimate of the length scale and its standard deviation.
    """
    rows = np.array([node.is_step for node in timeline.nodes])
    nodes = [node for node in timeline.nodes if node.is_step]
    time_s, moving_from_s, step_length_m = np.array(
        [(node.time_s, node.moving_from_s, node.step_length_m) for node in nodes]
    ).T.copy()
    return Track(
        time_s=time_s,
        moving_from_s=moving_from_s,
        device=np.array([timeline.device] * len(nodes)),
        position_m=position_m[rows],
        heading_rad=wrap_angle(heading_rad[rows]),
        covariance_m2=covariance[rows][:, :2, :2],
        sigma_heading_rad=np.sqrt(covariance[rows][:, 2, 2]),
        mode=np.array([node.mode for node in nodes], dtype=np.int8),
        step_length_m=step_length_m * length_scale[0],
        kind=kind,
        estimator=estimator,
        length_scale=length_scale[0],
        sigma_length_scale=length_scale[1],
    )
