"""Alternatives of a walk: the most probable combinations of the courses of its devices."""

from collections.abc import Sequence
from itertools import product
from math import prod

from pdr_est.estimators.alternatives.alternative import DECIDED, Alternative
from pdr_est.estimators.alternatives.chosen_turns import Turns, with_turns
from pdr_est.estimators.alternatives.device_courses import MOST_ALTERNATIVES, DeviceCourse, device_courses
from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.types.measurements import StartPose

_KNOWN_SHARE = 0.9  # of the probability that few alternatives must have; otherwise each turn is open by itself


def alternatives_of(
    timelines: Sequence[Timeline], start: StartPose, sigma_length_scale: float
) -> tuple[Alternative, ...]:
    """Return the alternatives of a walk, the most probable first; a walk without doubt has one.

    Parameters
    ----------
    timelines
        Measurements of each device.
    start
        Start pose of the walk as far as it is known.
    sigma_length_scale
        Standard deviation of the walker's length scale.
    """
    starts = starts_of(timelines, start)
    courses = [device_courses(one, own, sigma_length_scale) for one, own in zip(timelines, starts, strict=True)]
    combinations, total = _most_probable([own.apart for own in courses])
    if total < _KNOWN_SHARE:
        combinations, total = ((tuple(own.together for own in courses),), 1.0)
    return tuple(
        Alternative(
            prod(one.probability for one in some) / total,
            tuple(with_turns(timeline, one.turns) for timeline, one in zip(timelines, some, strict=True)),
            tuple(one.start_heading_rad for one in some),
            tuple(_open(one.turns) for one in some),
        )
        for some in combinations
    )


def _most_probable(courses: Sequence[Sequence[DeviceCourse]]) -> tuple[tuple[tuple[DeviceCourse, ...], ...], float]:
    """Return the most probable combinations of the courses of all devices, and their probability together."""
    some = sorted(product(*courses), key=lambda one: -prod(course.probability for course in one))[:MOST_ALTERNATIVES]
    return tuple(some), sum(prod(course.probability for course in one) for one in some)


def _open(turns: Turns) -> tuple[tuple[int, float], ...]:
    """Return number of the node and probability of the turns that are not decided."""
    return tuple((i, turn.probability) for i, turn in turns if turn.probability < DECIDED)
