"""The default heading: yaw of the phone in any posture, with an offset that is learnt whenever the posture changes.

The posture is how the phone sits on the body. As long as it stays, the phone turns with the walker; where the phone
swings with a limb, its yaw is averaged over the stride. When the phone is put elsewhere, it is unknown by how much it
was turned against the body. `placement_change` tells how far the walker may have turned in the meantime: several
possible turns with their probabilities, of which the heading follows the most probable one. Until the phone has
settled, steps keep the heading from before. A phone that comes back to its old posture, after a glance at the screen,
has its old offset.
"""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.heading.phone_posture import wrapped
from pdr_est.front_end.heading.placement_change.auto_params import AutoHeadingParams
from pdr_est.front_end.heading.placement_change.placement_tracker import (
    LIMB_MODES,
    PlacementTracker,
    Placing,
    is_handled,
)
from pdr_est.front_end.heading.placement_change.turn_estimate import (
    KnownPlace,
    PlacedSteps,
    estimate_turn,
    first_heading,
    last_heading,
)
from pdr_est.front_end.heading.principal_axis import PrincipalAxisParams
from pdr_est.front_end.heading.step_motion import motion_of, with_motions
from pdr_est.front_end.heading.stride_pairing import stride_average
from pdr_est.records import changed
from pdr_est.types.steps import Step, TurnHypothesis

_MOST_PLACES = 8  # so many places of the phone are remembered
_ELSEWHERE = (Placing.LEAVES, Placing.AWAY)


class _Oriented(NamedTuple):
    """A step with its heading, not yet averaged, and continuous within a segment instead of wrapped."""

    step: Step
    heading_rad: float
    turn_hypotheses: tuple[TurnHypothesis, ...] = ()


class PostureAwareYaw:
    """Stage Step -> Step that fills in the heading, and `turn_hypotheses` where the phone was put elsewhere.

    A step is emitted when the next one is there, with which it may be averaged, or at the end of a segment.

    Parameters
    ----------
    parameters : AutoHeadingParams
        Thresholds and standard deviations.
    axis : PrincipalAxisParams
        Parameters of the principal axis, for the number of strides that count together.
    """

    latency_s = 2.0  # until the next step, which comes before a standstill or begins another walk

    def __init__(self, parameters: AutoHeadingParams, axis: PrincipalAxisParams) -> None:
        self._parameters = parameters
        self._axis = axis
        self._pending: _Oriented | None = None
        self._segment: int | None = None
        self._tracker = PlacementTracker(self._parameters)
        self._offset_rad: float | None = None  # yaw of the phone less the heading in the present place, or the last
        # Steps in that place; the deque also holds the one before the strides that count together.
        self._recent: deque[_Oriented] = deque(maxlen=2 * self._axis.strides + 1)
        self._before: PlacedSteps | None = None  # the latest steps in the place that was left
        self._between = 0  # steps since
        self._known: list[KnownPlace] = []  # places before
        self._heading_rad = 0.0
        self._before_pending_rad: float | None = None
        self._emitted_rad: float | None = None

    def push(self, item: Step, /) -> list[Step]:
        """Take the next step and return the one before with its heading."""
        return self.push_all([item])

    def push_all(self, items: Sequence[Step], /) -> list[Step]:
        """Take the next steps, and return those before the last one with their headings."""
        done: list[Step] = []
        for step in with_motions(items):
            if step.event.segment != self._segment:  # the yaw goes on, but neighbours are no pair any more
                done += self.flush()
                self._segment, self._before_pending_rad = step.event.segment, None
            done += self._average_pending(self._with_heading(step))
        return done

    def flush(self) -> list[Step]:
        """Return the step that waits for the next one."""
        pending, self._pending = self._pending, None
        if pending is None:
            return []
        before_rad = pending.heading_rad if self._before_pending_rad is None else self._before_pending_rad
        return [self._stride_averaged(before_rad, pending, before_rad)]

    def _with_heading(self, step: Step) -> _Oriented:
        up_before = self._tracker.posture
        placing = self._tracker.push(step)
        if self._offset_rad is None:
            self._offset_rad, self._heading_rad = 0.0, self._tracker.posture.yaw_rad(motion_of(step))
            if placing is Placing.LEAVES:
                self._before, self._between = None, 0
        elif placing is Placing.LEAVES:
            self._leave(np.array(up_before.up))
        if placing in _ELSEWHERE:
            self._between += 1
            heading_rad = self._heading_rad
            if self._tracker.perhaps_unmoved and not is_handled(step):
                heading_rad += wrapped(up_before.yaw_rad(motion_of(step)) - self._offset_rad - heading_rad)
            return _Oriented(step, heading_rad)
        if placing is Placing.SETTLES:
            return self._settle(step)
        return self._oriented(step, self._offset_rad)

    def _oriented(self, step: Step, offset_rad: float) -> _Oriented:
        raw = self._tracker.posture.yaw_rad(motion_of(step)) - offset_rad
        self._heading_rad += wrapped(raw - self._heading_rad)
        oriented = _Oriented(step, self._heading_rad)
        self._recent.append(oriented)
        return oriented

    def _leave(self, up: Array) -> None:
        """Keep the heading of the last steps in the place that is left, with the direction up in it."""
        steps = self._tracker.staying([one.step for one in self._recent])
        heading = np.array([one.heading_rad for one in self._recent][: len(steps)])
        self._between = len(self._recent) - len(steps)
        self._before = PlacedSteps(steps, up) if steps else None
        self._recent.clear()
        if steps:
            self._heading_rad = last_heading(heading, self._parameters.bend_rad)

    def _settle(self, step: Step) -> _Oriented:
        """Learn the new offset from the steps in the new place, and use it from now on."""
        after = PlacedSteps(tuple(self._tracker.training), self._tracker.up)
        straight_rad = first_heading(after.yaws_rad, self._parameters.bend_rad) - self._heading_rad
        hypotheses: tuple[TurnHypothesis, ...] = ()
        turn_rad = 0.0
        if self._before is not None:
            between = self._between - len(after.steps) + 1
            known = [*self._known, self._before.known(self._offset_rad or 0.0)]
            turn = estimate_turn(
                self._before, after, between, known, self._heading_rad, self._parameters, self._tracker.unmoved
            )
            self._known = known[-_MOST_PLACES:]
            hypotheses = turn.hypotheses()
            turn_rad = hypotheses[0].heading_change_rad
        self._offset_rad = straight_rad - turn_rad
        oriented = self._oriented(step, self._offset_rad)
        return oriented._replace(turn_hypotheses=_turned(hypotheses, -turn_rad))

    def _average_pending(self, step: _Oriented) -> list[Step]:
        """Return the step before, averaged with its neighbours: they cancel the swing of a limb, once in two steps.

        The first and the last step have one neighbour, which stands for both.
        """
        pending, self._pending = self._pending, step
        if pending is None:
            return []
        before_rad = step.heading_rad if self._before_pending_rad is None else self._before_pending_rad
        self._before_pending_rad = pending.heading_rad
        return [self._stride_averaged(before_rad, pending, step.heading_rad)]

    def _stride_averaged(self, before_rad: float, at: _Oriented, after_rad: float) -> Step:
        """Average the heading, and count the hypotheses from the step before as it was emitted."""
        step, heading_rad, hypotheses = at
        if step.event.mode in LIMB_MODES and abs(after_rad - before_rad) < self._parameters.bend_rad:
            heading_rad = stride_average(before_rad, heading_rad, after_rad)
        if hypotheses:
            hypotheses = _turned(
                hypotheses, heading_rad - (heading_rad if self._emitted_rad is None else self._emitted_rad)
            )
        self._emitted_rad = heading_rad
        return changed(step, heading_rad=wrapped(heading_rad), turn_hypotheses=hypotheses, placement_tracked=True)


def _turned(hypotheses: Sequence[TurnHypothesis], by_rad: float) -> tuple[TurnHypothesis, ...]:
    """Add an angle to the heading changes of hypotheses."""
    return tuple(changed(one, heading_change_rad=wrapped(one.heading_change_rad + by_rad)) for one in hypotheses)
