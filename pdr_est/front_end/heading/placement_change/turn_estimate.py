"""Estimate how far the walker turned while the phone was put elsewhere, from all that tells it.

The yaw of the phone is continuous but tells nothing while a hand turns it. What is left is:

* Walkers mostly go straight on. Those that turn just before or just after are more likely to turn in between, too.
* A phone that is carried as it was before has the heading offset that it had then.
* The walking direction relative to the phone, before and after (`direction_cues`).

Each is a density with a uniform part, so that none can be certain, and their product is the density of the turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.phone_posture import angle_between, posture_of, yaw_between_postures
from pdr_est.front_end.heading.placement_change.auto_params import AutoHeadingParams
from pdr_est.front_end.heading.placement_change.direction_cues import direction_density
from pdr_est.front_end.heading.placement_change.stride_cues import stride_cues
from pdr_est.front_end.heading.placement_change.turn_density import (
    difference,
    gaussian,
    hypotheses_from,
    mixed,
    normalised,
)
from pdr_est.front_end.heading.step_motion import motions_of
from pdr_est.types.steps import CarryingMode, Step, TurnHypothesis

_LEAST_SIGMA_RAD = 0.02  # of a hypothesis
_TYPICAL_TURN_RAD = 0.7  # part of a corner that falls into the time in which the phone is moved
_SPREAD_TURN_RAD = 0.65
_SIGMA_ANY_TURN_RAD = 0.9
_SLOW_TURN_RAD = 0.48  # turn before and after, extrapolated, at which going straight on is half as likely
_SHARE_ONWARD = 0.88  # of those that turn, so many turn on the way that they turned before or turn after
_SWAY_STEPS, _LEAST_SWAY_STEPS = 8, 4  # most and least steps that tell what a limb turns from step to step
_EDGE_STEPS = 4  # steps before and after that tell how fast the walker turns


@dataclass(frozen=True)
class KnownPlace:
    """A place of the phone in which its yaw less the walker's heading is known: `offset_rad`."""

    up: Array
    mode: CarryingMode
    offset_rad: float


@dataclass(frozen=True)
class PlacedSteps:
    """Steps in one place of the phone, and its posture `up` (3,) there."""

    steps: Sequence[Step]
    up: Array

    @cached_property
    def yaws_rad(self) -> Array:
        """Yaw (n,) of the phone at each step, rad, continuous."""
        posture = posture_of(self.up)
        return np.unwrap([posture.yaw_rad(motion) for motion in motions_of(self.steps)])

    def known(self, offset_rad: float) -> KnownPlace:
        """Return the place with its offset."""
        return KnownPlace(self.up, self.steps[-1].event.mode, offset_rad)


@dataclass(frozen=True)
class TurnEstimate:
    """Turn of the walker from the last steps in one place of the phone to the first ones in the next.

    Attributes
    ----------
    density : ndarray, shape (360,)
        Density of the turn.
    cues : tuple of (str, ndarray)
        Name and density of each thing that tells it.
    """

    density: Array
    cues: tuple[tuple[str, Array], ...]

    @property
    def most_probable_rad(self) -> float:
        """Most probable turn, rad."""
        return self.hypotheses()[0].heading_change_rad

    def given(self, name: str, likelihood: Array) -> "TurnEstimate":
        """Return the turn given something else that tells it, by its likelihood (360,)."""
        return TurnEstimate(normalised(self.density * likelihood), (*self.cues, (name, likelihood)))

    def hypotheses(self) -> tuple[TurnHypothesis, ...]:
        """Return the possible turns, the most probable one first."""
        return hypotheses_from(self.density, self.cues, _LEAST_SIGMA_RAD)


def estimate_turn(
    before: PlacedSteps,
    after: PlacedSteps,
    between: int,
    known: Sequence[KnownPlace],
    heading_rad: float,
    parameters: AutoHeadingParams,
    unmoved: float = 0.0,
) -> TurnEstimate:
    """Estimate the turn of the walker between two places of the phone.

    Parameters
    ----------
    before, after : PlacedSteps
        Steps in both places; at least one each.
    between : int
        Number of steps in between.
    known : sequence of KnownPlace
        Places of the phone so far; the last one is that of the steps before.
    heading_rad : float
        Heading at the end of the steps before.
    parameters : AutoHeadingParams
        Probabilities and standard deviations.
    unmoved : float
        Probability that nobody moved the phone, by all but its yaw.
    """
    yaw_before, yaw_after = before.yaws_rad, after.yaws_rad
    going_on = _habit(yaw_before[-_EDGE_STEPS:], yaw_after[:_EDGE_STEPS], between, parameters)
    directions = [
        direction_density(stride_cues(place.steps, place.up), parameters.sigma_axis_rad) for place in (before, after)
    ]
    start_rad, end_rad = first_heading(yaw_after, parameters.bend_rad), last_heading(yaw_before, parameters.bend_rad)
    by_axis = difference(directions[1], directions[0], start_rad - end_rad)
    as_before = _as_carried_before(after, start_rad - heading_rad, known, parameters, unmoved)
    straight = gaussian(0.0, parameters.sigma_kept_rad)
    cues = (
        ("straight on", straight * parameters.straight),
        ("principal axis", by_axis),
        ("carried as before", as_before),
    )
    return TurnEstimate(normalised(going_on * by_axis * as_before), cues)


def _as_carried_before(
    after: PlacedSteps, turned_rad: float, known: Sequence[KnownPlace], parameters: AutoHeadingParams, unmoved: float
) -> Array:
    """Compute the density (360,) of the turn by the places that the new one may be the same as.

    `turned_rad` is the yaw of the phone in the new place less the heading before. The yaw of a phone that nobody
    moved tells the turn by itself.
    """
    mode = after.steps[-1].event.mode
    offset_rad = known[-1].offset_rad + yaw_between_postures(known[-1].up, after.up)
    parts, left = [(unmoved, gaussian(turned_rad - offset_rad, parameters.sigma_kept_rad))], 1.0 - unmoved
    for number, place in enumerate(reversed(known)):
        alike = np.exp(-0.5 * (angle_between(after.up, place.up) / parameters.sigma_posture_rad) ** 2)
        probability = parameters.same_place if mode is place.mode else parameters.same_in_other_mode * (number == 0)
        weight = left * probability * float(alike)
        offset_rad = place.offset_rad + yaw_between_postures(place.up, after.up)
        parts.append((weight, gaussian(turned_rad - offset_rad, parameters.sigma_offset_rad)))
        left -= weight
    return mixed(*parts)


def last_heading(heading_rad: Array, bend_rad: float) -> float:
    """Return the heading at the end of some steps with continuous headings (n,).

    It is the mean of the last two, because that cancels the motion of a limb, but the last one where the walker turns
    by more than `bend_rad` in between. What a limb turns from step to step and back is no turn of the walker.
    """
    latest = _without_sway(heading_rad[-_SWAY_STEPS:])[-2:]
    return float(latest[-1] if abs(latest[-1] - latest[0]) > bend_rad else latest.mean())


def _without_sway(heading_rad: Array) -> Array:
    """Take off headings (n,) what changes its sign from step to step, by the median over the steps."""
    if len(heading_rad) < _LEAST_SWAY_STEPS:
        return heading_rad
    sign = 1.0 - 2.0 * (np.arange(len(heading_rad)) % 2)
    bends = heading_rad[:-2] - 2.0 * heading_rad[1:-1] + heading_rad[2:]
    return np.asarray(heading_rad + 0.25 * float(np.median(bends * sign[1:-1])) * sign)


def first_heading(heading_rad: Array, bend_rad: float) -> float:
    """Return the heading at the beginning of some steps, as `last_heading` does at the end."""
    return last_heading(heading_rad[::-1], bend_rad)


def _habit(yaw_before: Array, yaw_after: Array, between: int, parameters: AutoHeadingParams) -> Array:
    """Compute the density (360,) of the turn by what walkers do: go straight on, or through a corner."""
    extrapolated = 0.5 * (_turn_a_step(yaw_before[::-1]) * -1.0 + _turn_a_step(yaw_after)) * (between + 2)
    straight = parameters.straight / (1.0 + (extrapolated / _SLOW_TURN_RAD) ** 2)
    corner = float(np.clip(extrapolated / _SLOW_TURN_RAD, -1.0, 1.0)) * _TYPICAL_TURN_RAD
    turning = 1.0 - straight - parameters.any_turn
    return mixed(
        (straight, gaussian(0.0, parameters.sigma_kept_rad)),
        (_SHARE_ONWARD * turning, gaussian(corner, _SPREAD_TURN_RAD)),
        ((1.0 - _SHARE_ONWARD) * turning, gaussian(0.0, _SIGMA_ANY_TURN_RAD)),
    )


def _turn_a_step(yaw_rad: Array) -> float:
    """Compute by how much the first strides turn a step, from means over two steps; 0 for fewer than three steps."""
    strides = 0.5 * (yaw_rad[1:] + yaw_rad[:-1])
    return float(wrap_angle(strides[1] - strides[0])) if len(strides) > 1 else 0.0
