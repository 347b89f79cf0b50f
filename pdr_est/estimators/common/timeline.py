"""Measurements of one device in order of time: the nodes of a walk and the motion between them.

All estimators work on the same timeline, so that their results can be compared number by number.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby

import numpy as np

from pdr_est.estimators.common.measurement_checks import refuse_unusable
from pdr_est.frames import Array, wrap_angle
from pdr_est.types.measurements import HeadingPrior, LoopClosure, Measurement, PositionFix, StepOdometry
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

SAME_S = 1e-9  # times that are no further apart are the same moment


@dataclass(frozen=True)
class Node:
    """A pose of the walker: the end of a step, or the moment of a fix within one.

    The motion that leads to it: turn by heading_change_rad, then length_m ahead, with covariance (3, 3) of (forward,
    left, heading) in the frame of this node. is_step: whether it is the end of a step (or the start of the walk)
    and thus a row of the track.
    """

    time_s: float
    moving_from_s: float
    length_m: float
    heading_change_rad: float
    covariance: Array
    is_step: bool
    step_length_m: float
    mode: CarryingMode
    fixes: tuple[PositionFix, ...] = ()
    priors: tuple[HeadingPrior, ...] = ()

    @property
    def tells_direction(self) -> bool:
        """Whether something here helps to find the direction of a walk in the map."""
        return bool(self.fixes) or any(not prior.relative for prior in self.priors)


@dataclass(frozen=True)
class Timeline:
    """The nodes of one device's walk, the start first. closure_sigma_m: how near to the start it ends, if it does."""

    device: str
    nodes: tuple[Node, ...] = field(repr=False)
    closure_sigma_m: float | None = None

    @property
    def fixes(self) -> tuple[PositionFix, ...]:
        return tuple(fix for node in self.nodes for fix in node.fixes)

    @property
    def priors(self) -> tuple[HeadingPrior, ...]:
        return tuple(prior for node in self.nodes for prior in node.priors)


def build_timeline(
    device: str, start_s: float, measurements: Iterable[Measurement], split_times_s: Iterable[float] = ()
) -> Timeline:
    """Order the measurements of a device and split steps at the fixes and at other moments that fall inside them.

    start_s: time of the start pose, or the end of the first step if that is earlier: detectors put a step back by
    their delay, which may lead to before the first sample. A fix while the walker stands belongs to the pose before
    it; fixes before the first or after the last step belong to the ends. Left out are odometry, heading priors and
    loop closures of other devices, and tethers, which tell nothing about one device alone.

    Raises EstimationError for odometry that is not in order of time and for measurements without a usable value.
    """
    given = tuple(measurements)
    steps = [m for m in given if isinstance(m, StepOdometry) and m.device == device]
    fixes = [m for m in given if isinstance(m, PositionFix)]
    priors = [m for m in given if isinstance(m, HeadingPrior) and m.device == device]
    closures = [m for m in given if isinstance(m, LoopClosure) and m.device == device]
    refuse_unusable(device, steps, fixes, priors, closures)
    first_mode = steps[0].mode if steps else CarryingMode.UNKNOWN
    begin_s = min([start_s, *(step.time_s for step in steps[:1])])
    nodes = [Node(begin_s, begin_s, 0.0, 0.0, np.zeros((3, 3)), True, 0.0, first_mode)]
    pending = [SplitPoint(fix.time_s, (fix,)) for fix in fixes] + [SplitPoint(time_s, ()) for time_s in split_times_s]
    pending.sort(key=lambda moment: moment.time_s, reverse=True)
    for step in steps:
        begin = max(step.start_s, nodes[-1].time_s)
        while pending and pending[-1].time_s <= begin:
            nodes[-1] = _with_fixes(nodes[-1], pending.pop())
        inside = []
        while pending and pending[-1].time_s < step.time_s:
            inside.append(pending.pop())
        nodes += split_step(step, begin, inside)
    while pending:
        nodes[-1] = _with_fixes(nodes[-1], pending.pop())
    closure_sigma_m = min((closure.sigma_m for closure in closures), default=None)
    return Timeline(device, tuple(_attach_priors(nodes, priors)), closure_sigma_m)


def track_from_nodes(
    timeline: Timeline,
    position_m: Array,
    heading_rad: Array,
    covariance: Array,
    kind: str,
    estimator: str,
    length_scale: tuple[float, float] = (1.0, 0.0),
) -> Track:
    """The track of the nodes that are steps, headings wrapped.

    covariance: (n, 3, 3) of (x, y, heading) in the map frame; length_scale: estimate and standard deviation.
    """
    rows = np.array([node.is_step for node in timeline.nodes])
    nodes = [node for node in timeline.nodes if node.is_step]
    return Track(
        time_s=np.array([node.time_s for node in nodes]),
        moving_from_s=np.array([node.moving_from_s for node in nodes]),
        device=np.array([timeline.device] * len(nodes)),
        position_m=position_m[rows],
        heading_rad=wrap_angle(heading_rad[rows]),
        covariance_m2=covariance[rows][:, :2, :2],
        sigma_heading_rad=np.sqrt(covariance[rows][:, 2, 2]),
        mode=np.array([node.mode for node in nodes], dtype=np.int8),
        step_length_m=np.array([node.step_length_m for node in nodes]) * length_scale[0],
        kind=kind,
        estimator=estimator,
        length_scale=length_scale[0],
        sigma_length_scale=length_scale[1],
    )


@dataclass(frozen=True)
class SplitPoint:
    """A time at which a pose is wanted, with what was measured then."""

    time_s: float
    fixes: tuple[PositionFix, ...]


def _with_fixes(node: Node, moment: SplitPoint) -> Node:
    return replace(node, fixes=(*node.fixes, *moment.fixes)) if moment.fixes else node


def split_step(step: StepOdometry, begin_s: float, inside: Sequence[SplitPoint]) -> list[Node]:
    """The nodes of a step: one at each moment inside it, and its end. The walker's pace is even."""
    moments = [
        (time_s, tuple(fix for moment in group for fix in moment.fixes))
        for time_s, group in groupby(inside, key=lambda moment: moment.time_s)
    ]
    moments.append((step.time_s, ()))
    borders = [(time_s - begin_s) / (step.time_s - begin_s) for time_s, _ in moments[:-1]]
    shares = [float(share) for share in np.diff([0.0, *borders, 1.0])]
    covariances = split_covariance(step.covariance, step.length_m, shares)
    return [
        Node(
            time_s=time_s,
            moving_from_s=begin_s,
            length_m=shares[k] * step.length_m,
            heading_change_rad=step.heading_change_rad if k == 0 else 0.0,
            covariance=covariances[k],
            is_step=k == len(moments) - 1,
            step_length_m=step.length_m,
            mode=step.mode,
            fixes=fixes_then,
        )
        for k, (time_s, fixes_then) in enumerate(moments)
    ]


def _attach_priors(nodes: list[Node], priors: Sequence[HeadingPrior]) -> list[Node]:
    """Each heading prior goes to the first pose at or after its time, or to the last."""
    times = np.array([node.time_s for node in nodes])
    rows = np.searchsorted(times, np.array([prior.time_s for prior in priors]) - SAME_S)
    for row, prior in zip(np.minimum(rows, len(nodes) - 1), priors, strict=True):
        nodes[row] = replace(nodes[row], priors=(*nodes[row].priors, prior))
    return nodes


def split_covariance(covariance: Array, length_m: float, shares: Sequence[float]) -> list[Array]:
    """Covariances of the parts of a step, each (3, 3) of (forward, left, heading) at the end of its part.

    covariance: of the whole step, likewise; shares: of the length, they add up to 1. One after the other, the parts
    give exactly the mean and the covariance of the whole. The walker turns at the beginning, so the heading error
    arises in the first part and carries the displacement along; what remains of the noise is spread evenly. Later
    parts are therefore without heading noise, and singular.
    """
    if len(shares) == 1:
        return [covariance]
    heading = covariance[2, 2]
    with_heading = covariance[:2, 2] / heading if heading > 0.0 else np.zeros(2)
    of_displacement = covariance[:2, :2] - heading * np.outer(with_heading, with_heading)
    parts = []
    for share in shares:
        part = np.zeros((3, 3))
        part[:2, :2] = share * of_displacement
        parts.append(part)
    still_to_come = (1.0 - shares[0]) * length_m  # will swing to the left by this much per radian
    error = np.array([with_heading[0], with_heading[1] - still_to_come, 1.0])
    parts[0] += heading * np.outer(error, error)
    return parts
