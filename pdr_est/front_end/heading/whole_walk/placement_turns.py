"""The turns while the phone was put elsewhere, estimated from all steps before and after.

At the end of a walk the walking direction in each place of the phone is known from all its strides, and the time at
which the phone was put down, too. So the headings of the steps in between are interpolated, and the possible turns
belong to the first step in the new place. Later steps in the walk change nothing about what a hand did.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.placement_change.auto_params import AutoHeadingParams
from pdr_est.front_end.heading.placement_change.placement_tracker import (
    LIMB_MODES,
    Placement,
    placements_of,
)
from pdr_est.front_end.heading.placement_change.turn_density import tempered
from pdr_est.front_end.heading.placement_change.turn_estimate import (
    KnownPlace,
    PlacedSteps,
    TurnEstimate,
    estimate_turn,
    first_heading,
    last_heading,
)
from pdr_est.front_end.heading.stride_pairing import stride_average
from pdr_est.records import changed
from pdr_est.types.steps import Step, TurnHypothesis


@dataclass(frozen=True)
class PlacedWalk:
    """Steps of a segment with the places of the phone and the turns between them.

    Attributes
    ----------
    steps : sequence of Step
        The steps.
    places : sequence of Placement
        Places in order of time.
    turns : mapping of int to TurnEstimate
        Turn before each place to which the phone did not return, by the number of the place.
    heading_rad : ndarray, shape (n,)
        Headings by the most probable turns, continuous, not averaged over the stride; interpolated between two
        places.
    """

    steps: Sequence[Step]
    places: Sequence[Placement]
    turns: dict[int, TurnEstimate]
    heading_rad: Array

    def oriented(self, bend_rad: float) -> list[Step]:
        """Return the steps with headings by the most probable turns, and with the other possible turns."""
        averaged = _stride_averaged(self.steps, self.heading_rad, bend_rad)
        done = [
            changed(step, heading_rad=float(wrap_angle(angle)), turn_hypotheses=(), placement_tracked=True)
            for step, angle in zip(self.steps, averaged.tolist(), strict=True)
        ]
        for number, turn in self.turns.items():
            self._mark(done, averaged, number, tempered(turn.hypotheses()))
        return done

    def _mark(self, steps: list[Step], heading: Array, number: int, hypotheses: Sequence[TurnHypothesis]) -> None:
        """Give the first step in a place the possible turns, and the steps before it their share of the noise.

        The interpolated turn is as uncertain at each of these steps, and all of them together as the narrowest
        hypothesis.
        """
        first, last_before = self.places[number].first, self.places[number - 1].last
        share = min(one.sigma_rad for one in hypotheses) ** 2 / (first - last_before + 1)
        for k in range(last_before, first):
            steps[k] = changed(steps[k], sigma_turn_rad=float(np.hypot(steps[k].sigma_turn_rad, np.sqrt(share))))
        spent = share * (first - last_before)
        change = heading[first] - heading[first - 1] - hypotheses[0].heading_change_rad
        steps[first] = changed(
            steps[first],
            turn_hypotheses=tuple(
                changed(
                    one,
                    heading_change_rad=float(wrap_angle(one.heading_change_rad + change)),
                    sigma_rad=float(np.sqrt(one.sigma_rad**2 - spent)),
                )
                for one in hypotheses
            ),
        )


Refine = Callable[[int, TurnEstimate], TurnEstimate]
"""Function of the number of a place and of the turn before it that returns a better estimate of the turn."""


def placed_walk(
    steps: Sequence[Step], parameters: AutoHeadingParams, refine: Refine = lambda _, turn: turn
) -> PlacedWalk | None:
    """Find the places of the phone over the steps of a walk and the turns between them; None for one place only.

    Parameters
    ----------
    steps : sequence of Step
        All steps of the walk.
    parameters : AutoHeadingParams
        Parameters.
    refine : callable
        What else tells the turns; by default nothing.
    """
    places = placements_of(steps, parameters)
    if len(places) < 2:
        return None
    turns: dict[int, TurnEstimate] = {}
    known: list[KnownPlace] = []
    at, headings = [], []
    offset_rad = end_rad = 0.0
    placed = [PlacedSteps(steps[place.first : place.last], place.up) for place in places]
    for number, (place, here) in enumerate(zip(places, placed, strict=True)):
        yaw = here.yaws_rad
        if number and not place.returned:
            between = place.first - places[number - 1].last
            turn = estimate_turn(placed[number - 1], here, between, known, end_rad, parameters, place.unmoved)
            turns[number] = refine(number, turn)
            turn_rad = turns[number].hypotheses()[0].heading_change_rad
            offset_rad = first_heading(yaw, parameters.bend_rad) - end_rad - turn_rad
        heading = yaw - offset_rad
        if number:
            heading = heading + 2.0 * np.pi * np.round((end_rad - heading[0]) / (2.0 * np.pi))
        end_rad = last_heading(heading, parameters.bend_rad)
        if not place.returned:
            known.append(here.known(offset_rad))
        at += list(range(place.first, place.last))
        headings += heading.tolist()
    return PlacedWalk(steps, places, turns, np.asarray(np.interp(np.arange(len(steps)), at, headings)))


def _stride_averaged(steps: Sequence[Step], heading: Array, bend_rad: float) -> Array:
    """Average headings (n,) over the stride where the phone is on a limb and the walker does not turn."""
    padded = np.concatenate([heading[1:2], heading, heading[-2:-1]])
    before, after = padded[:-2], padded[2:]
    on_limb = np.array([step.event.mode in LIMB_MODES for step in steps])
    chosen = on_limb & (np.abs(after - before) < bend_rad)
    return np.where(chosen, stride_average(before, heading, after), heading)
