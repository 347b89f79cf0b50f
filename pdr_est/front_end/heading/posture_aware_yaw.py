"""The default heading: yaw of the phone in any posture, with an offset that is learnt whenever the posture changes.

The posture is how the phone sits on the body. As long as it stays, the phone turns with the walker; where the phone
swings with a limb, its yaw is averaged over the stride. When the posture changes by more than a limb changes it in a
stride, the phone was put elsewhere, and it is unknown by how much it was turned against the body. Two things tell the
walker's heading across the change: walkers mostly go on as before (MMPDR section III-E), and the principal axis of
their horizontal acceleration, which does not depend on the posture. Where the axis is trusted, both are weighted by
their standard deviations. Until the new offset is known, steps keep the heading from before. A phone that comes back
to its old posture, after a glance at the screen, has its old offset.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.phone_posture import angle_between, mean_up, mean_yaw
from pdr_est.front_end.heading.principal_axis import PrincipalAxisParams, direction_from_steps
from pdr_est.front_end.heading.stride_pairing import mean_yaw_of, stride_average
from pdr_est.params import Positive, params
from pdr_est.types.steps import CarryingMode, Step

_Angle = Annotated[float, Ge(0.05), Le(1.5)]
_LIMB_MODES = (CarryingMode.SWING, CarryingMode.POCKET)
_DISTINCT_MODES = (CarryingMode.HOLDING, *_LIMB_MODES)


@params
class AutoHeadingParams:
    """Parameters of the default heading; all values are ours."""

    moved_rad: _Angle = 0.7
    """Change of the direction of gravity in the phone, rad, mean over a step, beyond which it was put elsewhere."""
    moved_in_mode_rad: _Angle = 0.35
    """The same, rad, where the carrying mode is another one, too."""
    returned_rad: _Angle = 0.4
    """Posture change, rad, below which the phone counts as back in its old posture."""
    bend_rad: _Angle = 0.26
    """Turn within a stride, rad, beyond which steps are not averaged over it: the walker is turning."""
    training_steps: Annotated[int, Ge(2), Le(20)] = 4
    """Number of steps from which an offset is learnt."""
    sigma_kept_rad: Positive = 0.25
    """Standard deviation, rad, of the heading that walkers keep while they handle the phone."""
    sigma_axis_rad: Positive = 0.25
    """Standard deviation, rad, of the heading change by the principal axis, on top of its own."""


@dataclass(frozen=True)
class _Posture:
    """Unit vector up (3,) in device axes, yaw of the phone less the walker's heading, and carrying mode."""

    up: Array
    offset_rad: float
    mode: CarryingMode


class PostureAwareYaw:
    """Stage Step -> Step that fills in the heading, and `sigma_turn_rad` where the phone was put elsewhere.

    A step is emitted when the next one is there, with which it may be averaged, or at the end of a segment.

    Parameters
    ----------
    parameters : AutoHeadingParams
        Thresholds and standard deviations.
    axis : PrincipalAxisParams
        Parameters of the principal axis.
    """

    latency_s = 2.0  # until the next step, which comes before a standstill or begins another walk

    def __init__(self, parameters: AutoHeadingParams, axis: PrincipalAxisParams) -> None:
        self._parameters = parameters
        self._axis = axis
        self._pending: Step | None = None
        self._begin(None)

    def push(self, item: Step, /) -> list[Step]:
        """Take the next step and return the one before with its heading."""
        done: list[Step] = []
        if item.event.segment != self._segment:
            done = self.flush()
            self._begin(item.event.segment)
        return done + self._average_pending(self._with_heading(item))

    def flush(self) -> list[Step]:
        """Return the step that waits for the next one."""
        pending, self._pending = self._pending, None
        if pending is None:
            return []
        before_rad = pending.heading_rad if self._before_pending_rad is None else self._before_pending_rad
        return [self._stride_averaged(before_rad, pending, before_rad)]

    def _begin(self, segment: int | None) -> None:
        self._segment = segment
        self._posture: _Posture | None = None  # the present one, or the last one before a change
        self._repositioned = False  # True while the phone is away from that posture
        self._recent: deque[Step] = deque(maxlen=2 * self._parameters.training_steps + 1)  # steps in that posture
        self._steps_before: tuple[Step, ...] = ()  # steps in the posture that was left
        self._training: list[Step] = []
        self._heading_rad = 0.0
        self._before_pending_rad: float | None = None

    def _with_heading(self, step: Step) -> Step:
        """Give the step its heading, not yet averaged, and continuous within a segment instead of wrapped."""
        up = mean_up(step.samples)
        handled = step.event.mode is CarryingMode.TRANS or step.event.compensated
        if self._posture is None:
            self._posture = _Posture(up, 0.0, step.event.mode)
            self._heading_rad = mean_yaw(step.samples, up)
        moved_rad = angle_between(up, self._posture.up)
        if self._repositioned and not handled and moved_rad < self._parameters.returned_rad:
            self._repositioned = False
        elif not self._repositioned and (
            handled or moved_rad > self._moved_limit_rad(self._posture, step.event.mode)
        ):
            self._leave_posture(self._posture)
        return self._keep_heading(step, up, handled) if self._repositioned else self._oriented(step, self._posture)

    def _oriented(self, step: Step, posture: _Posture) -> Step:
        raw = mean_yaw(step.samples, posture.up) - posture.offset_rad
        self._heading_rad += float(wrap_angle(raw - self._heading_rad))
        oriented = replace(step, heading_rad=self._heading_rad)
        self._recent.append(oriented)
        return oriented

    def _moved_limit_rad(self, posture: _Posture, mode: CarryingMode) -> float:
        """Return the change of posture beyond which the phone was put elsewhere."""
        other_mode = mode is not posture.mode and {mode, posture.mode} <= set(_DISTINCT_MODES)
        return self._parameters.moved_in_mode_rad if other_mode else self._parameters.moved_rad

    def _leave_posture(self, posture: _Posture) -> None:
        self._repositioned = True
        recent = tuple(self._recent)
        # The hand may have turned the phone at the last step already.
        already_moved = (
            recent
            and angle_between(mean_up(recent[-1].samples), posture.up) > 0.5 * self._parameters.moved_in_mode_rad
        )
        self._steps_before = recent[:-1] if already_moved else recent
        self._recent.clear()
        self._training = []
        if self._steps_before:
            self._heading_rad = float(np.mean([step.heading_rad for step in self._latest_steps_before()]))

    def _latest_steps_before(self) -> tuple[Step, ...]:
        """Return the steps that tell the walker's heading before the change of posture.

        They are the last two, because their mean cancels the motion of a limb, but the last one alone where the
        walker was turning.
        """
        latest = self._steps_before[-2:]
        turning = abs(latest[-1].heading_rad - latest[0].heading_rad) > self._parameters.bend_rad
        return latest[-1:] if turning else latest

    def _keep_heading(self, step: Step, up: Array, handled: bool) -> Step:
        """Keep the heading at a step while the phone is handled, or while its new offset is learnt."""
        kept = replace(step, heading_rad=self._heading_rad)
        if handled or not self._is_steady(up):
            self._training = []
        if not handled:
            self._training.append(kept)
        if len(self._training) <= self._parameters.training_steps:
            return kept
        return self._learn_offset(kept)

    def _is_steady(self, up: Array) -> bool:
        """Return True if the phone was not put elsewhere within the last two steps."""
        return all(
            angle_between(up, mean_up(step.samples)) < self._parameters.moved_rad for step in self._training[-2:]
        )

    def _learn_offset(self, step: Step) -> Step:
        """Learn the new offset from all steps but the first in the new posture, and use it from now on."""
        steps = self._training[1:]
        total = np.sum([mean_up(one.samples) for one in steps], axis=0)
        up = np.asarray(total / np.linalg.norm(total))
        yaws = np.array([mean_yaw(one.samples, up) for one in steps])
        yaw_rad = float(np.angle(np.mean(np.exp(1j * yaws))))
        turn_rad, sigma_rad = self._turn_while_handled(steps)
        offset_rad = float(wrap_angle(yaw_rad - self._heading_rad - turn_rad))
        posture = _Posture(up, offset_rad, step.event.mode)
        self._posture, self._repositioned, self._training = posture, False, []
        return replace(self._oriented(step, posture), sigma_turn_rad=sigma_rad)

    def _turn_while_handled(self, steps: Sequence[Step]) -> tuple[float, float]:
        """Estimate the walker's turn since the posture changed, and its standard deviation."""
        p = self._parameters
        before, after = direction_from_steps(self._steps_before, self._axis), direction_from_steps(steps, self._axis)
        if before is None or after is None or not (before.trusted and after.trusted):
            return 0.0, p.sigma_kept_rad
        # The offset is that of all steps before, the yaw that of the latest ones: the walker may have turned.
        before_rad, after_rad = before.at(mean_yaw_of(self._latest_steps_before())), after.at(mean_yaw_of(steps))
        turn_rad = float(wrap_angle(after_rad - before_rad))
        variance = before.sigma_rad**2 + after.sigma_rad**2 + p.sigma_axis_rad**2
        weight = p.sigma_kept_rad**2 / (p.sigma_kept_rad**2 + variance)
        return weight * turn_rad, float(np.sqrt(weight * variance))

    def _average_pending(self, step: Step) -> list[Step]:
        """Return the step before, averaged with its neighbours: they cancel the swing of a limb, once in two steps.

        The first and the last step have one neighbour, which stands for both.
        """
        pending, self._pending = self._pending, step
        if pending is None:
            return []
        before_rad = step.heading_rad if self._before_pending_rad is None else self._before_pending_rad
        self._before_pending_rad = pending.heading_rad
        return [self._stride_averaged(before_rad, pending, step.heading_rad)]

    def _stride_averaged(self, before_rad: float, step: Step, after_rad: float) -> Step:
        heading_rad = step.heading_rad
        if step.event.mode in _LIMB_MODES and abs(after_rad - before_rad) < self._parameters.bend_rad:
            heading_rad = stride_average(before_rad, heading_rad, after_rad)
        return replace(step, heading_rad=float(wrap_angle(heading_rad)), placement_tracked=True)
