"""Find, step by step, where the phone stays in one place on the body and where it is put elsewhere.

The posture is the direction of gravity in the phone. When it changes by more than a limb changes it in a stride, the
phone was put elsewhere. It has settled in its new place after some steps without another such change.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.phone_posture import Posture, Vector, posture_of
from pdr_est.front_end.heading.placement_change.auto_params import AutoHeadingParams
from pdr_est.front_end.heading.step_motion import motion_of, motions_of
from pdr_est.types.steps import CarryingMode, Step

LIMB_MODES = (CarryingMode.SWING, CarryingMode.POCKET)
_DISTINCT_MODES = frozenset((CarryingMode.HOLDING, *LIMB_MODES))
# Turn of the phone from one step to the next: of a walker who goes straight on with a phone on a limb, in a corner,
# and by any angle; and the probability that a hand still moves a phone that seems to have settled. Ours.
_SIGMA_STRAIGHT_RAD, _SIGMA_CORNER_RAD = 0.2, 0.6
_CORNER, _ANY, _HANDLED = 0.15, 0.01, 0.05


class Placing(Enum):
    """Place of the phone at a step."""

    STAYS = auto()
    """In its place."""
    LEAVES = auto()
    """The first step away from its place."""
    AWAY = auto()
    """In the hand that moves it, or not long enough in a new place."""
    RETURNS = auto()
    """Back in its old place."""
    SETTLES = auto()
    """Long enough in a new place, which `training` and `up` describe."""


class PlacementTracker:
    """Tell for one step after the other whether the phone is in its place.

    Parameters
    ----------
    parameters : AutoHeadingParams
        Thresholds.

    Attributes
    ----------
    posture : Posture
        Posture in the present place, or in the last one while the phone is away from it.
    training : list of Step
        Steps since the hand let go of the phone, while it is away from its last place; the first one may still be
        disturbed. At the step at which it settles they are those that it settled by, without the first.
    """

    def __init__(self, parameters: AutoHeadingParams) -> None:
        self._parameters = parameters
        self._mode = CarryingMode.UNKNOWN
        self._away = False
        self._started = False
        self._otherwise = 0  # steps in a row in another mode, with hardly another posture
        self.posture = Posture((0.0, 0.0, 1.0))
        self.training: list[Step] = []

    @property
    def up(self) -> Array:
        """Return the unit vector (3,) upwards in device axes in that posture."""
        return np.array(self.posture.up)

    def push(self, step: Step) -> Placing:
        """Take the next step of the segment."""
        up, handled = motion_of(step).up, is_handled(step)
        if not self._started:
            self._started, self.posture, self._mode = True, Posture(up), step.event.mode
        moved_rad = self.posture.angle_to(up)
        other_mode = self._in_other_mode(step)
        if self._away:
            if not (handled or other_mode) and moved_rad < self._parameters.returned_rad:
                self._away = False
                return Placing.RETURNS
            return self._settle(step, up, handled)
        self._otherwise = self._otherwise + 1 if other_mode else 0
        limit_rad = self._parameters.moved_in_mode_rad if other_mode else self._parameters.moved_rad
        if handled or moved_rad > limit_rad or self._otherwise >= self._parameters.other_mode_steps:
            self._away, self._otherwise, self.training = True, 0, []
            self._settle(step, up, handled)  # never at once: it takes two steps at least
            return Placing.LEAVES
        return Placing.STAYS

    def staying(self, steps: Sequence[Step]) -> Sequence[Step]:
        """Return some steps in the last place without the last ones, at which the phone may have moved already."""
        stay = list(steps)
        while len(stay) > 1 and self._in_other_mode(stay[-1]):
            stay.pop()
        slight_rad = 0.5 * self._parameters.moved_in_mode_rad
        if len(stay) > 1 and self.posture.angle_to(motion_of(stay[-1]).up) > slight_rad:
            stay.pop()
        return stay

    def _in_other_mode(self, step: Step) -> bool:
        """Return True for a mode that is another one for certain: recognisers tell these apart well."""
        mode = step.event.mode
        return mode is not self._mode and mode in _DISTINCT_MODES and self._mode in _DISTINCT_MODES

    def _settle(self, step: Step, up: Vector, handled: bool) -> Placing:
        self.training = [] if handled else self._steady(step, up)
        if not handled:
            self.training.append(step)
        if len(self.training) <= self._parameters.training_steps:
            return Placing.AWAY
        self.training = _in_place(self.training[1:])
        self.posture, self._mode, self._away = posture_of(common_up(self.training)), step.event.mode, False
        return Placing.SETTLES

    def _steady(self, step: Step, up: Vector) -> list[Step]:
        """Return the steps since the hand let go of the phone that have the same posture as a step.

        A wide swing of the arm takes the phone to another posture at the next step, and back at the one after.
        """
        off_rad = [Posture(up).angle_to(motion_of(one).up) for one in self.training[-2:]]
        if not off_rad:
            return []
        swings = step.event.mode is self.training[-1].event.mode is CarryingMode.SWING
        if off_rad[-1] >= (self._parameters.swung_rad if swings else self._parameters.moved_rad):
            return []
        if off_rad[0] >= self._parameters.moved_rad and len(off_rad) == 2:
            return self.training[-1:] if swings else []
        return self.training


@dataclass(frozen=True)
class Placement:
    """Steps during which the phone stays in one place.

    Attributes
    ----------
    first, last : int
        Numbers of the first step and of the one after the last.
    up : ndarray, shape (3,)
        Unit vector upwards in device axes.
    returned : bool
        True if it is the place before, to which the phone returned.
    settled_at : int
        Number of the step at which the phone had settled.
    mode : CarryingMode
        Carrying mode.
    """

    first: int
    last: int
    up: Array
    returned: bool
    settled_at: int
    mode: CarryingMode


def placements_of(steps: Sequence[Step], parameters: AutoHeadingParams) -> list[Placement]:
    """Find the places of the phone over the steps of a segment."""
    tracker = PlacementTracker(parameters)
    found: list[Placement] = []
    first, settled, returned, up, inside = 0, 0, False, np.zeros(3), True
    for number, step in enumerate(steps):
        event = tracker.push(step)
        if number == 0:
            up = tracker.up
        if event is Placing.LEAVES:
            stay = tracker.staying(steps[first:number])
            if stay:
                found.append(Placement(first, first + len(stay), up, returned, settled, stay[-1].event.mode))
            inside = False
        elif event in (Placing.RETURNS, Placing.SETTLES):
            returned, settled, inside = event is Placing.RETURNS, number, True
            first = number if returned else number - len(tracker.training) + 1
            up = tracker.up
    if inside and first < len(steps):
        found.append(Placement(first, len(steps), up, returned, settled, steps[-1].event.mode))
    return found


def _in_place(steps: Sequence[Step]) -> list[Step]:
    """Return some steps, at least two, without the first ones at which a hand may still have turned the phone.

    A hand turns it about the vertical by any angle, a walker mostly by a small one.
    """
    posture = posture_of(common_up(steps))
    yaw = [posture.yaw_rad(motion) for motion in motions_of(steps)]
    change = wrap_angle(np.diff(yaw))
    straight = np.exp(-0.5 * (change / _SIGMA_STRAIGHT_RAD) ** 2) / _SIGMA_STRAIGHT_RAD
    corner = np.exp(-0.5 * (change / _SIGMA_CORNER_RAD) ** 2) / _SIGMA_CORNER_RAD
    walking = np.sqrt(2.0 * np.pi) * ((1.0 - _CORNER) * straight + _CORNER * corner)  # over the uniform density
    gain = np.cumsum(np.log(_HANDLED) - np.log(walking + _ANY))[: len(steps) - 2]  # of leaving out so many steps
    best = int(np.argmax(gain)) if len(gain) else 0
    return list(steps[best + 1 :] if len(gain) and gain[best] > 0.0 else steps)


def is_handled(step: Step) -> bool:
    """Return True for a step at which a hand moves the phone, or that was not seen."""
    return step.event.mode is CarryingMode.TRANS or step.event.compensated


def common_up(steps: Sequence[Step]) -> Array:
    """Compute the mean unit vector (3,) upwards in device axes over some steps, at least one."""
    total = np.sum([motion.up for motion in motions_of(steps)], axis=0)
    return np.asarray(total / max(float(np.linalg.norm(total)), 1e-9))
