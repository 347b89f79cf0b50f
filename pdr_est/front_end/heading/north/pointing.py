"""The direction that the walker goes, relative to a phone in the hand, whatever axes the manufacturer gave it.

Two things tell it. Phones are held along an edge, so that the walker goes along one of four directions in the phone:
that of the axis that is the most level one, the opposite, and those at right angles. Which of them, the acceleration
of some strides says (`principal_axis`), and without any edge it tells the direction itself, less exactly. Neither the
top of the screen nor the camera decides. On 89 held walks of thirteen sets the strides are sure of another direction
in 3: two phones in landscape format that point aside or at the walker, and one on stairs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.phone_posture import angle_between, mean_up, mean_yaw, yaw_between_postures
from pdr_est.front_end.heading.placement_change.direction_cues import StrideCue, direction_density, stride_cues
from pdr_est.front_end.heading.placement_change.turn_density import ANGLES_RAD, CELLS, normalised
from pdr_est.types.steps import CarryingMode, Step, begins_walk

_SIGMA_AXIS_RAD = 0.2  # of the principal axis of a hand, to one side; ILC20's walker differs by 0.25 on average
_EDGE_SHARE = 0.9  # probability that a phone is held along an edge
_MOST_STRIDES = 24  # in one posture, that tell the direction: more of them are not independent
_OTHER_POSTURE_RAD = 0.4
_KEPT = 0.8  # probability that a phone which was tilted, or put away and taken out again, points as before


@dataclass(frozen=True)
class Pointing:
    """Direction of the walker less the yaw of the phone in the posture `up` (3,), rad, and its standard deviation."""

    up: Array
    offset_rad: float
    sigma_rad: float

    def azimuth(self, step: Step) -> float:
        """Return the direction, rad, in the level frame of the phone's yaw."""
        return mean_yaw(step.samples, self.up) + self.offset_rad


class Hold:
    """Steps with the phone in the hand in one posture, and what their strides tell.

    Parameters
    ----------
    up : ndarray, shape (3,)
        Unit vector upwards in device axes.
    before : ndarray, shape (360,)
        Density of the direction less the yaw from earlier postures.
    """

    def __init__(self, up: Array, before: Array) -> None:
        self.up = up
        self._before = before
        self._previous: Step | None = None
        self._cues: list[StrideCue] = []
        self.density = before

    def push(self, step: Step) -> None:
        """Take the next step."""
        previous, self._previous = self._previous, step
        if previous is None or begins_walk(step, previous) or len(self._cues) >= _MOST_STRIDES:
            return
        found = stride_cues((previous, step), self.up)
        if found:
            self._previous = None
            self._cues += found
            self.density = normalised(self._before * direction_density(self._cues, _SIGMA_AXIS_RAD))

    def pointing(self) -> Pointing:
        """Return the direction and its uncertainty by the strides so far."""
        edges = np.interp(np.arange(4) * 0.5 * np.pi, ANGLES_RAD, self.density, period=2.0 * np.pi)
        weight = np.concatenate([_EDGE_SHARE * edges / 4.0, (1.0 - _EDGE_SHARE) * self.density / CELLS])
        angle = np.concatenate([np.arange(4) * 0.5 * np.pi, ANGLES_RAD])
        mean = float(np.angle(np.sum(weight * np.exp(1j * angle))))
        variance = np.sum(weight * wrap_angle(angle - mean) ** 2) / weight.sum()
        return Pointing(self.up, mean, float(np.sqrt(variance)))


class HoldTracker:
    """Find the hold that each step belongs to, if the phone is in the hand."""

    def __init__(self) -> None:
        self._hold: Hold | None = None
        self._held = False

    def push(self, step: Step) -> Hold | None:
        """Take the next step, and return its hold; None for a phone elsewhere."""
        if step.event.mode is not CarryingMode.HOLDING or step.event.compensated:
            self._held = False
            return None
        up, hold = mean_up(step.samples), self._hold
        if hold is None:
            hold = Hold(up, np.ones(CELLS))
        elif not self._held or angle_between(up, hold.up) > _OTHER_POSTURE_RAD:
            hold = Hold(up, _as_before(hold, up))
        hold.push(step)
        self._hold, self._held = hold, True
        return hold


def _as_before(hold: Hold, up: Array) -> Array:
    """Compute the density (360,) in another posture, which is probably reached by the shortest way."""
    turned = np.interp(ANGLES_RAD + yaw_between_postures(hold.up, up), ANGLES_RAD, hold.density, period=2.0 * np.pi)
    return np.asarray(_KEPT * normalised(turned) + (1.0 - _KEPT))


def final_pointings(steps: Sequence[Step]) -> list[Pointing | None]:
    """Return for each step what all strides of its hold tell; None for a phone that is not in the hand."""
    tracker = HoldTracker()
    holds = [tracker.push(step) for step in steps]
    found = {id(hold): hold.pointing() for hold in holds if hold is not None}
    return [None if hold is None else found[id(hold)] for hold in holds]
