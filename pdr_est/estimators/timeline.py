"""Measurements of one device in order of time: the nodes of a walk and the motion between them.

All estimators work on the same timeline, so that their results can be compared number by number.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.frames import Array
from pdr_est.records import CarryingMode, HeadingPrior, Measurement, PositionFix, StepOdometry
from pdr_est.track import Track

_NO_MOTION = np.diag([1e-6, 1e-6, 1e-6])


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


@dataclass(frozen=True)
class Timeline:
    """The nodes of one device's walk, the start first."""

    device: str
    nodes: tuple[Node, ...] = field(repr=False)

    @property
    def fixes(self) -> tuple[PositionFix, ...]:
        return tuple(fix for node in self.nodes for fix in node.fixes)


def build_timeline(device: str, start_s: float, measurements: Iterable[Measurement]) -> Timeline:
    """Order the measurements of a device and split steps at the fixes that fall inside them.

    start_s: time of the start pose. A fix while the walker stands belongs to the pose before it; fixes before the
    first or after the last step belong to the ends. Measurements of other devices are left out.

    Raises EstimationError for odometry that is not in order of time.
    """
    steps = [m for m in measurements if isinstance(m, StepOdometry) and m.device == device]
    fixes = sorted((m for m in measurements if isinstance(m, PositionFix)), key=lambda fix: fix.time_s)
    priors = [m for m in measurements if isinstance(m, HeadingPrior) and m.device == device]
    for before, after in pairwise(steps):
        if after.time_s < before.time_s:
            raise EstimationError(f"step odometry of {device} goes back in time at {after.time_s:.3f} s: sort it")
    first_mode = steps[0].mode if steps else CarryingMode.UNKNOWN
    nodes = [Node(start_s, start_s, 0.0, 0.0, _NO_MOTION, True, 0.0, first_mode)]
    pending = list(reversed(fixes))
    for step in steps:
        begin = max(step.start_s, nodes[-1].time_s)
        while pending and pending[-1].time_s <= begin:
            nodes[-1] = _with_fix(nodes[-1], pending.pop())
        inside = []
        while pending and pending[-1].time_s < step.time_s:
            inside.append(pending.pop())
        nodes += _split(step, begin, inside)
    while pending:
        nodes[-1] = _with_fix(nodes[-1], pending.pop())
    return Timeline(device, tuple(_attach_priors(nodes, priors)))


def track_from_nodes(
    timeline: Timeline,
    position_m: Array,
    heading_rad: Array,
    covariance: Array,
    kind: str,
    estimator: str,
    length_scale: tuple[float, float] = (1.0, 0.0),
) -> Track:
    """The track of the nodes that are steps. covariance: (n, 3, 3) of (x, y, heading) in the map frame."""
    rows = np.array([node.is_step for node in timeline.nodes])
    nodes = [node for node in timeline.nodes if node.is_step]
    return Track(
        time_s=np.array([node.time_s for node in nodes]),
        moving_from_s=np.array([node.moving_from_s for node in nodes]),
        device=np.array([timeline.device] * len(nodes)),
        position_m=position_m[rows],
        heading_rad=heading_rad[rows],
        covariance_m2=covariance[rows][:, :2, :2],
        sigma_heading_rad=np.sqrt(covariance[rows][:, 2, 2]),
        mode=np.array([node.mode for node in nodes], dtype=np.int8),
        step_length_m=np.array([node.step_length_m for node in nodes]) * length_scale[0],
        kind=kind,
        estimator=estimator,
        length_scale=length_scale[0],
        sigma_length_scale=length_scale[1],
    )


def _with_fix(node: Node, fix: PositionFix) -> Node:
    return replace(node, fixes=(*node.fixes, fix))


def _split(step: StepOdometry, begin_s: float, fixes: Sequence[PositionFix]) -> list[Node]:
    """The nodes of a step: one at each fix inside it, and its end.

    The turn happens at once and its noise with it; the displacement and its noise are spread evenly, so that the
    parts add up to exactly the whole.
    """
    span = max(step.time_s - begin_s, 1e-9)
    borders = [*((fix.time_s - begin_s) / span for fix in fixes), 1.0]
    nodes, done = [], 0.0
    for k, border in enumerate(borders):
        last = k == len(borders) - 1
        nodes.append(
            Node(
                time_s=step.time_s if last else fixes[k].time_s,
                moving_from_s=begin_s,
                length_m=(border - done) * step.length_m,
                heading_change_rad=step.heading_change_rad if k == 0 else 0.0,
                covariance=_part_of_covariance(step, border - done, k == 0),
                is_step=last,
                step_length_m=step.length_m,
                mode=step.mode,
                fixes=() if last else (fixes[k],),
            )
        )
        done = border
    return nodes


def _part_of_covariance(step: StepOdometry, share: float, with_turn: bool) -> Array:
    if share == 1.0:
        return step.covariance
    if not step.observed:
        return np.asarray(share * step.covariance + _NO_MOTION)
    turn = step.covariance[2, 2] if with_turn else 0.0
    sideways = max(step.covariance[1, 1] - step.length_m**2 * step.covariance[2, 2], 0.0)
    length = share * step.length_m
    covariance = np.array(
        [
            [share * step.covariance[0, 0], 0.0, 0.0],
            [0.0, length**2 * turn + share * sideways, length * turn],
            [0.0, length * turn, turn],
        ]
    )
    return np.asarray(covariance + _NO_MOTION)


def _attach_priors(nodes: list[Node], priors: Sequence[HeadingPrior]) -> list[Node]:
    """Each heading prior goes to the first pose at or after its time."""
    times = np.array([node.time_s for node in nodes])
    for prior in priors:
        i = min(int(np.searchsorted(times, prior.time_s - 1e-9)), len(nodes) - 1)
        nodes[i] = replace(nodes[i], priors=(*nodes[i].priors, prior))
    return nodes
