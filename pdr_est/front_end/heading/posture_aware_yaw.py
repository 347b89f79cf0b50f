"""The default heading: yaw of the phone in any posture, averaged over the stride where it swings with a limb, and an
offset learnt anew whenever the phone is put elsewhere.

As long as the phone sits still on the body, the walker turns with it. When its posture changes, by more than a limb
does in a stride, the phone was put elsewhere, and nobody knows by how much it was turned against the body. Two things
tell the walker's direction across the change: walkers mostly go on as before (MMPDR section III-E), and the principal
axis of their horizontal acceleration, which does not depend on how the phone sits. Where that is trusted, both are
weighed by their standard deviations. Until the new offset is known, steps keep the direction from before. A phone
that comes back to its old posture, after a glance at the screen, has its old offset.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.phone_posture import angle_between, mean_up, mean_yaw
from pdr_est.front_end.heading.principal_axis import PrincipalAxisParams, direction_of
from pdr_est.front_end.heading.stride_averaging import mean_yaw_of, over_stride
from pdr_est.params import Positive, params
from pdr_est.types.steps import CarryingMode, Step

_Angle = Annotated[float, Ge(0.05), Le(1.5)]
_WITH_A_LIMB = (CarryingMode.SWING, CarryingMode.POCKET)
_TOLD_APART = (CarryingMode.HOLDING, *_WITH_A_LIMB)


@params
class AutoHeadingParams:
    """moved_rad: a change of the direction of gravity in the phone, mean over a step, beyond which it was put
    elsewhere. moved_in_mode_rad: likewise where the carrying mode is another one, too. returned_rad: within which of
    its old posture it is back there. bend_rad: turn within a stride beyond
    which steps are not averaged over it: the walker is turning. training_steps: from which an offset is learnt.
    sigma_kept_rad: how well walkers keep their direction while they handle the phone. sigma_axis_rad: of the change
    of direction that the principal axis tells, on top of what it knows of itself. All are ours."""

    moved_rad: _Angle = 0.7
    moved_in_mode_rad: _Angle = 0.35
    returned_rad: _Angle = 0.4
    bend_rad: _Angle = 0.26
    training_steps: Annotated[int, Ge(2), Le(20)] = 4
    sigma_kept_rad: Positive = 0.25
    sigma_axis_rad: Positive = 0.25


@dataclass(frozen=True)
class _Placement:
    """How the phone sits: up (3,) in device axes, its yaw less the walker's direction, and the carrying mode."""

    up: Array
    offset_rad: float
    mode: CarryingMode


class PostureAwareYaw:
    """Stage Step -> Step that fills in the heading, and sigma_turn_rad where the phone was put elsewhere.

    A step is emitted when the next one is there, with which it may be averaged, or at the end of a segment.
    """

    latency_s = 2.0  # until the next step, which comes within a standstill or begins another walk

    def __init__(self, parameters: AutoHeadingParams, axis: PrincipalAxisParams) -> None:
        self._parameters = parameters
        self._axis = axis
        self._held: Step | None = None
        self._begin(None)

    def push(self, item: Step, /) -> list[Step]:
        done: list[Step] = []
        if item.event.segment != self._segment:
            done = self.flush()
            self._begin(item.event.segment)
        return done + self._averaged(self._directed(item))

    def flush(self) -> list[Step]:
        held, self._held = self._held, None
        if held is None:
            return []
        before_rad = held.heading_rad if self._before_held_rad is None else self._before_held_rad
        return [self._over_stride(before_rad, held, before_rad)]

    def _begin(self, segment: int | None) -> None:
        self._segment = segment
        self._placement: _Placement | None = None  # where the phone is, or was until it was taken
        self._away = False  # whether it was taken from there
        self._recent: deque[Step] = deque(maxlen=2 * self._parameters.training_steps + 1)  # in the placement
        self._before: tuple[Step, ...] = ()  # the steps in the placement that was left
        self._training: list[Step] = []
        self._heading_rad = 0.0
        self._before_held_rad: float | None = None

    def _directed(self, step: Step) -> Step:
        """The step with its direction, not yet averaged; headings of a segment are continuous, not wrapped."""
        up = mean_up(step.samples)
        handled = step.event.mode is CarryingMode.TRANS or step.event.compensated
        if self._placement is None:
            self._placement = _Placement(up, 0.0, step.event.mode)
            self._heading_rad = mean_yaw(step.samples, up)
        moved_rad = angle_between(up, self._placement.up)
        if self._away and not handled and moved_rad < self._parameters.returned_rad:
            self._away = False
        elif not self._away and (handled or moved_rad > self._moved_rad(self._placement, step.event.mode)):
            self._leave(self._placement)
        return self._on_its_way(step, up, handled) if self._away else self._walked(step, self._placement)

    def _walked(self, step: Step, placement: _Placement) -> Step:
        raw = mean_yaw(step.samples, placement.up) - placement.offset_rad
        self._heading_rad += float(wrap_angle(raw - self._heading_rad))
        directed = replace(step, heading_rad=self._heading_rad)
        self._recent.append(directed)
        return directed

    def _moved_rad(self, placement: _Placement, mode: CarryingMode) -> float:
        """The change of posture beyond which the phone was put elsewhere."""
        other_mode = mode is not placement.mode and {mode, placement.mode} <= set(_TOLD_APART)
        return self._parameters.moved_in_mode_rad if other_mode else self._parameters.moved_rad

    def _leave(self, placement: _Placement) -> None:
        self._away = True
        recent = tuple(self._recent)
        taken = (
            recent
            and angle_between(mean_up(recent[-1].samples), placement.up) > 0.5 * self._parameters.moved_in_mode_rad
        )
        self._before = recent[:-1] if taken else recent  # at the last one the hand may have been there already
        self._recent.clear()
        self._training = []
        if self._before:
            self._heading_rad = float(np.mean([step.heading_rad for step in self._latest_before()]))

    def _latest_before(self) -> tuple[Step, ...]:
        """The steps before the phone was taken that tell the walker's direction then: the last two, which cancel what
        a limb does, but the last one alone where the walker was turning."""
        latest = self._before[-2:]
        turning = abs(latest[-1].heading_rad - latest[0].heading_rad) > self._parameters.bend_rad
        return latest[-1:] if turning else latest

    def _on_its_way(self, step: Step, up: Array, handled: bool) -> Step:
        """A step while the phone is handled, or while its new offset is learnt: it keeps the direction."""
        kept = replace(step, heading_rad=self._heading_rad)
        if handled or not self._is_settled(up):
            self._training = []
        if not handled:
            self._training.append(kept)
        if len(self._training) <= self._parameters.training_steps:
            return kept
        return self._settle(kept)

    def _is_settled(self, up: Array) -> bool:
        """Whether the phone was not put elsewhere since one and two steps ago."""
        return all(
            angle_between(up, mean_up(step.samples)) < self._parameters.moved_rad for step in self._training[-2:]
        )

    def _settle(self, step: Step) -> Step:
        """Learn the new offset from the steps since the phone sits there, but the first, and take it into use."""
        steps = self._training[1:]
        total = np.sum([mean_up(one.samples) for one in steps], axis=0)
        up = np.asarray(total / np.linalg.norm(total))
        yaws = np.array([mean_yaw(one.samples, up) for one in steps])
        yaw_rad = float(np.angle(np.mean(np.exp(1j * yaws))))
        turn_rad, sigma_rad = self._turn_meanwhile(steps)
        offset_rad = float(wrap_angle(yaw_rad - self._heading_rad - turn_rad))
        placement = _Placement(up, offset_rad, step.event.mode)
        self._placement, self._away, self._training = placement, False, []
        return replace(self._walked(step, placement), sigma_turn_rad=sigma_rad)

    def _turn_meanwhile(self, steps: Sequence[Step]) -> tuple[float, float]:
        """By how much the walker turned since the phone was taken, and the standard deviation."""
        p = self._parameters
        before, after = direction_of(self._before, self._axis), direction_of(steps, self._axis)
        if before is None or after is None or not (before.trusted and after.trusted):
            return 0.0, p.sigma_kept_rad
        # The offset is that of all steps before, the direction that of the latest: the walker may have turned.
        then_rad, now_rad = before.at(mean_yaw_of(self._latest_before())), after.at(mean_yaw_of(steps))
        told_rad = float(wrap_angle(now_rad - then_rad))
        variance = before.sigma_rad**2 + after.sigma_rad**2 + p.sigma_axis_rad**2
        weight = p.sigma_kept_rad**2 / (p.sigma_kept_rad**2 + variance)
        return weight * told_rad, float(np.sqrt(weight * variance))

    def _averaged(self, step: Step) -> list[Step]:
        """The step before, averaged with its neighbours: a limb swings once in two steps, so that they cancel it. The
        first and the last step have one neighbour, which stands for both."""
        held, self._held = self._held, step
        if held is None:
            return []
        before_rad = step.heading_rad if self._before_held_rad is None else self._before_held_rad
        self._before_held_rad = held.heading_rad
        return [self._over_stride(before_rad, held, step.heading_rad)]

    def _over_stride(self, before_rad: float, step: Step, after_rad: float) -> Step:
        heading_rad = step.heading_rad
        if step.event.mode in _WITH_A_LIMB and abs(after_rad - before_rad) < self._parameters.bend_rad:
            heading_rad = over_stride(before_rad, heading_rad, after_rad)
        return replace(step, heading_rad=float(wrap_angle(heading_rad)), placement_tracked=True)
