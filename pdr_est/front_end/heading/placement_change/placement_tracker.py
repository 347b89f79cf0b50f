"""Find, step by step, where the phone stays in one place on the body and where it is put elsewhere.

The posture is the direction of gravity in the phone. When it changes by more than a limb changes it in a stride, the
phone was put elsewhere. It has settled in its new place after some steps without another such change.
"""

from collections import deque
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
_FLIPS_FORESEEN = 2.0  # changes of the mode that the prior probability of a flip is worth, against those of the walk
_SURE = 0.95  # probability from which on a phone stays without doubt
_LOOKED_AT = 6  # steps among which the hand may have turned the phone, for the recogniser's delay


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
        self._latest: deque[Step] = deque(maxlen=_LOOKED_AT)
        self._stays = 0.0  # probability that the present other mode is an error of the recogniser
        self._flip_odds = 0.0  # that probability by the walk so far only, as odds
        self._unmoved = 0.0  # probability that the phone was where it was when it settled, by all but the yaw
        self._flips, self._changes = 0.0, 0  # such errors so far, by their probability, of so many changes of mode
        self._taken = False  # out of its place for certain, or out of sight only
        self.posture = Posture((0.0, 0.0, 1.0))
        self.training: list[Step] = []

    @property
    def up(self) -> Array:
        """Return the unit vector (3,) upwards in device axes in that posture."""
        return np.array(self.posture.up)

    def push(self, step: Step) -> Placing:
        """Take the next step of the segment."""
        up, handled = motion_of(step).up, is_handled(step)
        self._latest.append(step)
        if not self._started:
            self._started, self.posture, self._mode = True, Posture(up), step.event.mode
        moved_rad = self.posture.angle_to(up)
        other_mode = self._in_other_mode(step)
        self._otherwise = self._otherwise + 1 if other_mode else 0
        taken = step.event.mode is CarryingMode.TRANS or moved_rad > self._parameters.moved_rad
        if other_mode and moved_rad > self._parameters.moved_in_mode_rad:
            on_limb = self._mode in LIMB_MODES and step.event.mode in LIMB_MODES  # which tilts it at one step
            over = posture_of(common_up(list(self._latest)[-2:])).up if on_limb else up
            taken = taken or self.posture.angle_to(over) > self._parameters.moved_in_mode_rad
        if self._otherwise == self._parameters.other_mode_steps and not taken:
            self._judge_flip()
        if self._away:
            self._taken = self._taken or taken
            if not handled and moved_rad < self._parameters.returned_rad and (not other_mode or self._stays_surely()):
                self._away = False
                return Placing.RETURNS
            return self._settle(step, up, handled)
        elsewhere = self._otherwise >= self._parameters.other_mode_steps and not self._stays_surely()
        if handled or taken or elsewhere:
            self._away, self._taken, self.training = True, taken, []
            self._settle(step, up, handled)  # never at once: it takes two steps at least
            return Placing.LEAVES
        if self._otherwise >= _LOOKED_AT:  # a hand would have moved the phone by now
            self._mode, self._otherwise = step.event.mode, 0
        return Placing.STAYS

    @property
    def perhaps_unmoved(self) -> bool:
        """Return True while the phone is more probably where it was than away from there."""
        return not self._taken and self._otherwise >= self._parameters.other_mode_steps and self._stays >= 0.5

    @property
    def unmoved(self) -> float:
        """Return the probability that a phone which has just settled was not moved at all, by all but its yaw."""
        return 0.0 if self._taken else self._unmoved

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

    def _stays_surely(self) -> bool:
        """Return True if another mode in hardly another posture is nearly certainly an error of the recogniser."""
        judged = self._otherwise >= self._parameters.other_mode_steps
        return judged and not self._taken and self._stays > _SURE

    def _judge_flip(self) -> None:
        """Compute how probably the phone stays although the last steps are in another mode.

        A recogniser may take a phone that stays where it is for one in another place, and back. Then the posture is
        the old one, and the yaw goes on as a walker turns, while a hand turns the phone about the vertical by any
        angle and leaves it in any posture. How often the recogniser errs is learnt from the walk.
        """
        steps = list(self._latest)
        flips = (_FLIPS_FORESEEN * self._parameters.flip + self._flips) / (_FLIPS_FORESEEN + self._changes)
        self._flip_odds = flips / (1.0 - flips)
        odds = self._unmoved_odds(steps[-self._otherwise :]) * _kept_yaw(steps, self.posture)
        self._stays = odds / (1.0 + odds)
        self._changes, self._flips = self._changes + 1, self._flips + self._stays

    def _unmoved_odds(self, steps: Sequence[Step]) -> float:
        return self._flip_odds * _kept_posture(
            self.posture.angle_to(posture_of(common_up(steps)).up), self._parameters
        )

    def _settle(self, step: Step, up: Vector, handled: bool) -> Placing:
        self.training = [] if handled else self._steady(step, up)
        if not handled:
            self.training.append(step)
        if len(self.training) <= self._parameters.training_steps:
            return Placing.AWAY
        self.training = _in_place(self.training[1:])
        odds = self._unmoved_odds(self.training)
        self._unmoved = odds / (1.0 + odds)
        self.posture, self._mode, self._away = posture_of(common_up(self.training)), step.event.mode, False
        self._otherwise = 0
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
    unmoved : float
        Probability that it is the place before, because nobody moved the phone, by all but its yaw.
    """

    first: int
    last: int
    up: Array
    returned: bool
    settled_at: int
    mode: CarryingMode
    unmoved: float = 0.0


def placements_of(steps: Sequence[Step], parameters: AutoHeadingParams) -> list[Placement]:
    """Find the places of the phone over the steps of a segment."""
    tracker = PlacementTracker(parameters)
    found: list[Placement] = []
    first, settled, returned, up, inside, unmoved = 0, 0, False, np.zeros(3), True, 0.0
    for number, step in enumerate(steps):
        event = tracker.push(step)
        if number == 0:
            up = tracker.up
        if event is Placing.LEAVES:
            stay = tracker.staying(steps[first:number])
            if stay:
                found.append(Placement(first, first + len(stay), up, returned, settled, stay[-1].event.mode, unmoved))
            inside = False
        elif event in (Placing.RETURNS, Placing.SETTLES):
            returned, settled, inside = event is Placing.RETURNS, number, True
            first = number if returned else number - len(tracker.training) + 1
            up, unmoved = tracker.up, 0.0 if returned else tracker.unmoved
    if inside and first < len(steps):
        found.append(Placement(first, len(steps), up, returned, settled, steps[-1].event.mode, unmoved))
    return found


def _in_place(steps: Sequence[Step]) -> list[Step]:
    """Return some steps, at least two, without the first ones at which a hand may still have turned the phone.

    A hand turns it about the vertical by any angle, a walker mostly by a small one.
    """
    posture = posture_of(common_up(steps))
    yaw = [posture.yaw_rad(motion) for motion in motions_of(steps)]
    walking = _walking_turn(wrap_angle(np.diff(yaw)))
    gain = np.cumsum(np.log(_HANDLED) - np.log(walking + _ANY))[: len(steps) - 2]  # of leaving out so many steps
    best = int(np.argmax(gain)) if len(gain) else 0
    return list(steps[best + 1 :] if len(gain) and gain[best] > 0.0 else steps)


def _walking_turn(change_rad: Array) -> Array:
    """Compute how likely turns of the phone from step to step are for a walker, over the uniform density."""
    straight = np.exp(-0.5 * (change_rad / _SIGMA_STRAIGHT_RAD) ** 2) / _SIGMA_STRAIGHT_RAD
    corner = np.exp(-0.5 * (change_rad / _SIGMA_CORNER_RAD) ** 2) / _SIGMA_CORNER_RAD
    return np.asarray(np.sqrt(2.0 * np.pi) * ((1.0 - _CORNER) * straight + _CORNER * corner))


def _kept_yaw(steps: Sequence[Step], posture: Posture) -> float:
    """Compute the likelihood ratio of a phone that stays, against one turned by any angle at one of some steps."""
    change = wrap_angle(np.diff([posture.yaw_rad(motion) for motion in motions_of(steps)]))
    return float(1.0 / np.mean(1.0 / (_walking_turn(change) + _ANY))) if len(change) else 1.0


def _kept_posture(moved_rad: float, parameters: AutoHeadingParams) -> float:
    """Compute the likelihood ratio of a phone that stays, against one in any posture below the limit of its mode."""
    sigma_rad = parameters.sigma_flip_rad
    kept = np.exp(-0.5 * (moved_rad / sigma_rad) ** 2) / sigma_rad**2
    return float(0.5 * parameters.moved_in_mode_rad**2 * kept)


def is_handled(step: Step) -> bool:
    """Return True for a step at which a hand moves the phone, or that was not seen."""
    return step.event.mode is CarryingMode.TRANS or step.event.compensated


def common_up(steps: Sequence[Step]) -> Array:
    """Compute the mean unit vector (3,) upwards in device axes over some steps, at least one."""
    total = np.sum([motion.up for motion in motions_of(steps)], axis=0)
    return np.asarray(total / max(float(np.linalg.norm(total)), 1e-9))
