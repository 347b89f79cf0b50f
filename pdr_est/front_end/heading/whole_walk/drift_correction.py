"""The stage that corrects headings at the end of the walk: by all strides, and by the dominant directions."""

from collections.abc import Sequence
from math import erf, sqrt

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.course.course_offsets import moves_ahead, with_courses, without_courses
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.placement_change.auto_params import AutoHeadingParams
from pdr_est.front_end.heading.placement_change.turn_density import ANGLES_RAD
from pdr_est.front_end.heading.placement_change.turn_estimate import TurnEstimate
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams, dominant_directions
from pdr_est.front_end.heading.whole_walk.later_standing import with_later_standing
from pdr_est.front_end.heading.whole_walk.offset_evidence import offset_evidence
from pdr_est.front_end.heading.whole_walk.placement_turns import placed_walk
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections, straight_leg_sections
from pdr_est.records import changed
from pdr_est.types.analysis import DominantDirections
from pdr_est.types.steps import Step

_LEAST_PROBABILITY = 0.5  # that a section follows a dominant direction, for a prior
_LEAST_DRIFT_RAD = 0.02  # over a walk, that is corrected
_DECIDED = 0.995  # least probability of the nearest direction after a change of place, for priors on both sides


class WholeWalkHeading:
    """Stage Step -> Step that corrects the headings when the whole walk is known.

    The turns while the phone was put elsewhere are estimated again, from all strides in each place and from the
    directions of the building. Steps of sideways and backward walking get the direction of motion. Then the headings
    are corrected by what standing tells of the gyroscope's bias, and by the directions of the building, if it has
    some.

    Parameters
    ----------
    parameters : DominantParams or None
        Parameters of the search for dominant directions; None for no search.
    as_priors : bool
        True to give steps along a dominant direction a `path_heading_rad`, and to take only the drift at a constant
        rate off their heading; False to take off all drift.
    placement : AutoHeadingParams or None
        How to estimate the turns while the phone was put elsewhere again, from the whole walk; None leaves them.
    course : CourseParams or None
        How to search for sideways and backward walking; None for no search.

    Attributes
    ----------
    directions : DominantDirections or None
        Dominant directions, if the walk has straight legs.
    """

    latency_s = float("inf")  # the end of the recording

    def __init__(
        self,
        parameters: DominantParams | None,
        as_priors: bool,
        placement: AutoHeadingParams | None = None,
        course: CourseParams | None = None,
    ) -> None:
        self._parameters = parameters
        self._as_priors = as_priors
        self._placement = placement
        self._course = course
        self._steps: list[Step] = []
        self.directions: DominantDirections | None = None

    def push(self, item: Step, /) -> list[Step]:
        """Keep a step until the end of the walk."""
        self._steps.append(item)
        return []

    def flush(self) -> list[Step]:
        """Return all steps, corrected."""
        steps, self._steps = self._steps, []
        return self._correct(steps) if steps else []

    def _with_turns(self, steps: list[Step]) -> list[Step]:
        """Estimate the turns while the phone was put elsewhere from all steps and the directions of the building."""
        if self._placement is None:
            return steps
        walk = placed_walk(steps, self._placement)
        if walk is None:
            return steps
        if self._parameters is None:
            return walk.oriented(self._placement.bend_rad)
        sections = straight_leg_sections(walk.oriented(self._placement.bend_rad), self._parameters.straight)
        borders = {number: walk.places[number].first for number in walk.turns}
        evidence = offset_evidence(sections, self._parameters, list(borders.values()))

        def refine(number: int, turn: TurnEstimate) -> TurnEstimate:
            if borders[number] not in evidence:
                return turn
            likelihood = evidence[borders[number]].at(walk.turns[number].most_probable_rad - ANGLES_RAD)
            return turn.given("directions of the building", likelihood)

        refined = placed_walk(steps, self._placement, refine) if evidence else walk
        return steps if refined is None else refined.oriented(self._placement.bend_rad)

    def _correct(self, found: list[Step]) -> list[Step]:
        steps = self._with_turns(without_courses(found))
        if self._course is not None:
            steps = with_courses(steps, self._course, moves_ahead(found))
        steps = with_later_standing(steps)
        if self._parameters is None:
            return steps
        sections = straight_leg_sections(steps, self._parameters.straight)
        self.directions = directions = dominant_directions(sections, self._parameters)
        if directions is None:
            return steps
        time_s = np.array([step.event.time_s for step in steps])
        heading_rad = _without_rate(np.array([step.heading_rad for step in steps]), time_s, directions.rate_radps)
        if directions.used and self._as_priors:
            return _with_priors(steps, time_s, heading_rad, sections, directions)
        if directions.used:
            heading_rad = wrap_angle(heading_rad - np.interp(time_s, sections.time_s, directions.drift_rad))
        return [changed(step, heading_rad=one) for step, one in zip(steps, heading_rad.tolist(), strict=True)]


def _with_priors(
    steps: Sequence[Step], time_s: Array, heading_rad: Array, sections: LegSections, directions: DominantDirections
) -> list[Step]:
    """Give steps their headings, and those along a dominant direction that of their path.

    The drift that the walk shows adds to the standard deviations of the turns: so a phone that slips about in its
    pocket has less weight than one in a steady hand.
    """
    run = _decided_runs(steps, directions.spacing_rad)[sections.first]
    follows = directions.follows >= _LEAST_PROBABILITY
    # Priors tell the angles between parts of a walk: of parts whose angle is not known the longest one has them.
    chosen = int(np.argmax(np.bincount(run, weights=follows * (sections.last - sections.first))))
    path = [(step.path_heading_rad, step.sigma_path_heading_rad) for step in steps]
    for i in np.flatnonzero(follows & (run == chosen)).tolist():
        along = float(wrap_angle(directions.path_heading_rad[i])), float(directions.sigma_rad[i])
        first, last = int(sections.first[i]), int(sections.last[i])
        path[first:last] = [along] * (last - first)
    drift_rad = directions.drift_per_sqrt_s * np.sqrt(np.maximum(np.diff(time_s, prepend=time_s[0]), 0.0))
    sigma_rad = np.hypot([step.sigma_turn_rad for step in steps], drift_rad)
    return [
        changed(step, heading_rad=heading, sigma_turn_rad=sigma, path_heading_rad=along, sigma_path_heading_rad=off)
        for step, heading, sigma, (along, off) in zip(
            steps, heading_rad.tolist(), sigma_rad.tolist(), path, strict=True
        )
    ]


def _decided_runs(steps: Sequence[Step], spacing_rad: float) -> NDArray[np.int64]:
    """Count at each step (n,) the turns so far that may be wrong by an angle between directions.

    Where the phone was put elsewhere, a turn may be wrong by half of that angle, too, for a leg may lie between two
    directions. Priors on both sides of such a turn would follow from its most probable angle, and make this one
    certain.
    """
    undecided = [
        bool(step.turn_hypotheses or step.sigma_turn_rad)
        and _nearest(step, (0.25 if step.turn_hypotheses else 0.5) * spacing_rad) < _DECIDED
        for step in steps
    ]
    return np.cumsum(undecided)


def _nearest(step: Step, within_rad: float) -> float:
    """Compute the probability that the turn of a step is within an angle of its most probable one."""
    if not step.turn_hypotheses:
        return erf(within_rad / (sqrt(2.0) * step.sigma_turn_rad)) if step.sigma_turn_rad else 1.0
    first = step.turn_hypotheses[0].heading_change_rad
    near = [one for one in step.turn_hypotheses if abs(wrap_angle(one.heading_change_rad - first)) < within_rad]
    return sum(one.probability for one in near)


def _without_rate(heading_rad: Array, time_s: Array, rate_radps: float) -> Array:
    """Take a constant rate off headings (n,) at times (n,)."""
    if abs(rate_radps) * (time_s[-1] - time_s[0]) < _LEAST_DRIFT_RAD:
        return heading_rad
    return wrap_angle(heading_rad - rate_radps * (time_s - time_s[0]))
