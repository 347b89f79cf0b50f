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
from pdr_est.front_end.heading.placement_change.direction_cues import StrideCue, stride_cues
from pdr_est.front_end.heading.placement_change.turn_density import ANGLES_RAD, CELLS, gaussian, mixed, normalised
from pdr_est.types.steps import CarryingMode, Step, begins_walk

_SIGMA_AXIS_RAD = 0.2  # of the principal axis of a hand, to one side; ILC20's walkers differ by 0.25 on average
# Phase lead of the forward acceleration of a phone in the hand over the vertical one: 90 degrees as that of the trunk,
# 67 to 142 on twelve sets, but 0 to 75 on ILC20, whose phones are pitched with each step.
_LEAD_RAD, _SIGMA_LEAD_RAD = 0.5 * np.pi, 0.7
_NO_AXIS = 0.02  # least probability that the strides tell nothing
_NO_AXIS_COHERENCE = 0.085  # that probability falls by e over so much coherence
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
            self.density = normalised(self._before * _direction_density(self._cues))

    def pointing(self) -> Pointing:
        """Return the direction and its uncertainty by the strides so far."""
        edges = np.interp(np.arange(4) * 0.5 * np.pi, ANGLES_RAD, self.density, period=2.0 * np.pi)
        weight = np.concatenate([_EDGE_SHARE * edges / 4.0, (1.0 - _EDGE_SHARE) * self.density / CELLS])
        angle = np.concatenate([np.arange(4) * 0.5 * np.pi, ANGLES_RAD])
        mean = float(np.angle(np.sum(weight * np.exp(1j * angle))))
        variance = np.sum(weight * wrap_angle(angle - mean) ** 2) / weight.sum()
        return Pointing(self.up, mean, float(np.sqrt(variance)))


def _direction_density(cues: Sequence[StrideCue]) -> Array:
    """Compute the density (360,) of the walking direction less the yaw, for a phone in the hand, from some strides.

    The acceleration at the frequency of the steps lies along one line. Its phase against the vertical acceleration
    tells which end is ahead.
    """
    horizontal = np.array([cue.motion.horizontal_mps2 for cue in cues])
    vertical = np.array([cue.motion.vertical_mps2 for cue in cues])
    along, across = np.abs(horizontal.T) ** 2
    total = float(np.sum(along + across))
    double = complex(np.sum(along - across), 2.0 * np.sum((horizontal[:, 0] * horizontal[:, 1].conj()).real))
    line_rad = 0.5 * float(np.angle(double))
    ahead = horizontal @ np.array([np.cos(line_rad), np.sin(line_rad)])
    product = complex(np.sum(ahead * vertical.conj()))
    power = float(np.sum(np.abs(ahead) ** 2) * np.sum(np.abs(vertical) ** 2))
    if power == 0.0:
        return np.ones(CELLS)
    coherence = min(abs(product) / np.sqrt(power), 1.0)
    noise = (1.0 - coherence**2) / max(2.0 * len(cues) * coherence**2, 1e-9)
    off_rad = wrap_angle(np.angle(product) - np.array([_LEAD_RAD, _LEAD_RAD + np.pi]))
    ends = np.exp(-0.5 * off_rad**2 / (_SIGMA_LEAD_RAD**2 + noise))
    width = np.sqrt(max(total - abs(double), 0.0) / (total + abs(double)))
    sigma_rad = float(np.hypot(_SIGMA_AXIS_RAD, width / np.sqrt(len(cues))))
    seen = (1.0 - _NO_AXIS) * (1.0 - float(np.exp(-coherence / _NO_AXIS_COHERENCE)))
    shares = (seen * ends / ends.sum()).tolist()
    return mixed((shares[0], gaussian(line_rad, sigma_rad)), (shares[1], gaussian(line_rad + np.pi, sigma_rad)))


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
