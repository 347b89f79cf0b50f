"""The direction that the walker goes, relative to a phone in the hand.

Three things tell it. Phones are held along an edge, so that the walker goes along one of four directions in the
phone: that of the axis that is the most level one, the opposite, and those at right angles. The acceleration of some
strides tells it by its line and its phase, as the principal axis does, but without an edge less exactly. And where
the axes are those that phones have, the top of the screen or the camera is usually ahead. On 89 held walks of
thirteen sets the strides are sure of another direction in 3: two phones in landscape format that point aside or at
the walker, and one on stairs. Where other axes were laid through the device, the strides decide by themselves.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.north.usual_azimuth import usual_azimuth
from pdr_est.front_end.heading.phone_posture import Posture, Vector, yaw_between_postures
from pdr_est.front_end.heading.placement_change.stride_cues import StrideCue, stride_cues
from pdr_est.front_end.heading.placement_change.turn_density import ANGLES_RAD, CELLS, gaussian, mixed, normalised
from pdr_est.front_end.heading.step_motion import motion_of
from pdr_est.types.steps import CarryingMode, Step, begins_walk

_SIGMA_AXIS_RAD = 0.2  # of the principal axis of a hand, to one side; ILC20's walkers differ by 0.25 on average
# Phase lead of the forward acceleration of a phone in the hand over the vertical one: 90 degrees as that of the
# trunk, 67 to 142 on twelve sets, but 0 to 75 on ILC20, whose phones are pitched with each step.
_LEAD_RAD, _SIGMA_LEAD_RAD = 0.5 * np.pi, 0.7
_NO_AXIS = 0.02  # least probability that the strides tell nothing
_NO_AXIS_COHERENCE = 0.085  # that probability falls by e over so much coherence
_LEAK = 0.05  # share of the vertical acceleration that an error of the tilt by 3 degrees turns into the level
_EDGE_SHARE = 0.9  # probability that a phone is held along an edge
_USUAL_SHARE = 0.95  # probability that this is the usual one
_DECIDED = 0.85  # least probability of the directions near one, for a heading: the usual axes alone reach it
_MOST_STRIDES = 24  # in one posture, that tell the direction: more of them are not independent
_OTHER_POSTURE_RAD = 0.4
_KEPT = 0.8  # probability that a phone which was tilted, or put away and taken out again, points as before


@dataclass(frozen=True)
class Pointing:
    """Direction of the walker less the yaw of the phone in a posture, rad, and its standard deviation.

    It is `decided` if no direction further away is probable; then the standard deviation is that of the near ones.
    """

    posture: Posture
    offset_rad: float
    sigma_rad: float
    decided: bool

    def azimuth(self, step: Step) -> float:
        """Return the direction, rad, in the level frame of the phone's yaw."""
        return self.posture.yaw_rad(motion_of(step)) + self.offset_rad


class Hold:
    """Steps with the phone in the hand in one posture, and what their strides tell.

    Parameters
    ----------
    first : Step
        First step.
    usual_axes : bool
        True if the axes of the device are those that phones have.
    before : ndarray, shape (360,)
        Density of the direction less the yaw from earlier postures.
    """

    def __init__(self, first: Step, usual_axes: bool, before: Array) -> None:
        self.posture = Posture(motion_of(first).up)
        self._edges = _edge_shares(first, self.posture) if usual_axes else np.full(4, 0.25)
        self._before = before
        self._previous: Step | None = None
        self._cues: list[StrideCue] = []
        self._density: Array | None = None
        self._pointing: Pointing | None = None

    def push(self, step: Step) -> None:
        """Take the next step."""
        if len(self._cues) >= _MOST_STRIDES:
            return
        previous, self._previous = self._previous, step
        if previous is None or begins_walk(step, previous):
            return
        found = stride_cues((previous, step), np.array(self.posture.up))
        if found:
            self._previous = self._density = self._pointing = None
            self._cues += found

    @property
    def density(self) -> Array:
        """Density (360,) of the direction less the yaw by the strides so far."""
        if self._density is None:
            known = _direction_density(self._cues) if self._cues else None
            self._density = self._before if known is None else normalised(self._before * known)
        return self._density

    def pointing(self) -> Pointing:
        """Return the direction and its uncertainty by the strides so far."""
        if self._pointing is None:
            self._pointing = self._weighed()
        return self._pointing

    def _weighed(self) -> Pointing:
        """Weigh the edges and the directions between them."""
        edge_rad = np.arange(4) * 0.5 * np.pi
        at_edges = np.interp(edge_rad, ANGLES_RAD, self.density, period=2.0 * np.pi)
        weight = np.concatenate([_EDGE_SHARE * self._edges * at_edges, (1.0 - _EDGE_SHARE) * self.density / CELLS])
        angle = np.concatenate([edge_rad, ANGLES_RAD])
        best = angle[int(np.argmax(weight))]
        near = np.abs(wrap_angle(angle - best)) < 0.25 * np.pi
        share = float(weight[near].sum() / weight.sum())
        mean = float(best + np.average(wrap_angle(angle[near] - best), weights=weight[near]))
        variance = np.average(wrap_angle(angle[near] - mean) ** 2, weights=weight[near])
        return Pointing(self.posture, mean, float(np.sqrt(variance)), share >= _DECIDED)


def _edge_shares(step: Step, posture: Posture) -> Array:
    """Compute the probability (4,) of each edge by the usual axes of phones."""
    motion = motion_of(step)
    usual_rad = usual_azimuth(motion)
    if np.isnan(usual_rad):
        return np.full(4, 0.25)
    shares = np.full(4, (1.0 - _USUAL_SHARE) / 3.0)
    shares[round((usual_rad - posture.yaw_rad(motion)) / (0.5 * np.pi)) % 4] = _USUAL_SHARE
    return shares


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
    moved, leaked = float(np.sum(np.abs(ahead) ** 2)), _LEAK**2 * float(np.sum(np.abs(vertical) ** 2))
    seen = (1.0 - _NO_AXIS) * (1.0 - float(np.exp(-coherence / _NO_AXIS_COHERENCE))) * moved / (moved + leaked)
    shares = (seen * ends / ends.sum()).tolist()
    return mixed((shares[0], gaussian(line_rad, sigma_rad)), (shares[1], gaussian(line_rad + np.pi, sigma_rad)))


class HoldTracker:
    """Find the hold that each step belongs to, if the phone is in the hand.

    Parameters
    ----------
    usual_axes : bool
        True if the axes of the device are those that phones have.
    """

    def __init__(self, usual_axes: bool) -> None:
        self._usual_axes = usual_axes
        self._hold: Hold | None = None
        self._held = False

    def push(self, step: Step) -> Hold | None:
        """Take the next step, and return its hold; None for a phone elsewhere."""
        if step.event.mode is not CarryingMode.HOLDING or step.event.compensated:
            self._held = False
            return None
        up, hold = motion_of(step).up, self._hold
        if hold is None:
            hold = Hold(step, self._usual_axes, np.ones(CELLS))
        elif not self._held or hold.posture.angle_to(up) > _OTHER_POSTURE_RAD:
            hold = Hold(step, self._usual_axes, _as_before(hold, up))
        hold.push(step)
        self._hold, self._held = hold, True
        return hold


def _as_before(hold: Hold, up: Vector) -> Array:
    """Compute the density (360,) in another posture, which is probably reached by the shortest way."""
    change_rad = yaw_between_postures(np.array(hold.posture.up), np.array(up))
    turned = np.interp(ANGLES_RAD + change_rad, ANGLES_RAD, hold.density, period=2.0 * np.pi)
    return np.asarray(_KEPT * normalised(turned) + (1.0 - _KEPT))


def final_pointings(steps: Sequence[Step], usual_axes: bool) -> list[Pointing | None]:
    """Return for each step what all strides of its hold tell; None for a phone that is not in the hand."""
    tracker = HoldTracker(usual_axes)
    holds = [tracker.push(step) for step in steps]
    found = {id(hold): hold.pointing() for hold in holds if hold is not None}
    return [None if hold is None else found[id(hold)] for hold in holds]
