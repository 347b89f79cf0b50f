"""Alternatives of a walk that its measurements leave open, for estimators that smooth.

Where one linearisation cannot know, the bank of hypotheses of the Kalman filter weighs what is possible, by all
measurements of the walk: the turn of a walker whose phone was put elsewhere on the way, and a start heading that
nobody gave. A smoother then works on one alternative at a time, and the tracks are put together as a mixture.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import prod

import numpy as np

from pdr_est.estimators.common.initial_state import start_prior, starts_of
from pdr_est.estimators.common.nodes import Node, with_heading_variance
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.kalman.device_filter_step import DeviceFilterState, loses_heading, start_device, step_device
from pdr_est.estimators.kalman.hypothesis_bank import HypothesisBank
from pdr_est.estimators.kalman.predict_and_update import MultiDeviceEkf
from pdr_est.estimators.turns_of_hypotheses import Turns, chosen_turns, marginal_turns, widened_by_others
from pdr_est.frames import wrap_angle
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import StartPose, TurnHypothesis
from pdr_est.types.track import Track

_MOST, _LEAST_PROBABILITY = 4, 0.02  # alternatives that are smoothed, and the least probability of one
_ONE_MODE_RAD = 0.5  # headings that differ by less are one alternative, for the smoother moves them
_KNOWN_SHARE = 0.9  # of the probability that few alternatives must have; otherwise each turn is open by itself
_DECIDED = 0.95  # probability of an alternative or a turn from which on nothing is reported; ours


@dataclass(frozen=True)
class Alternative:
    """One possible course of a walk.

    Attributes
    ----------
    probability
        Its probability among the alternatives.
    timelines
        Measurements of each device, with the turns that this alternative chose.
    start_headings_rad
        Heading of each device at the start of the walk to linearise at; None where it is known or unambiguous.
    open_turns
        Number of the node, and probability of the chosen turn, of each turn of each device that is not decided within
        this alternative. Its variance is then that of all its hypotheses about the chosen one.
    """

    probability: float
    timelines: tuple[Timeline, ...]
    start_headings_rad: tuple[float | None, ...]
    open_turns: tuple[tuple[tuple[int, float], ...], ...]


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
    courses = [_courses(one, own, sigma_length_scale) for one, own in zip(timelines, starts, strict=True)]
    combinations, total = _most_probable([own.apart for own in courses])
    if total < _KNOWN_SHARE:
        combinations, total = ((tuple(own.together for own in courses),), 1.0)
    return tuple(
        Alternative(
            prod(one.probability for one in some) / total,
            tuple(_resolved(timeline, one.turns) for timeline, one in zip(timelines, some, strict=True)),
            tuple(one.start_heading_rad for one in some),
            tuple(_open(one.turns) for one in some),
        )
        for some in combinations
    )


def estimate_alternatives(alternatives: Sequence[Alternative], estimate: Callable[[Alternative], Track]) -> Track:
    """Return the track of the most probable alternative, with the covariance of the mixture about it.

    Parameters
    ----------
    alternatives
        As `alternatives_of` returns them.
    estimate
        Function that estimates the track of an alternative.
    """
    tracks = [estimate(one) for one in alternatives]
    likeliest = replace(tracks[0], findings=(*tracks[0].findings, *_undecided(alternatives)))
    if len(tracks) == 1:
        return likeliest
    weights = np.array([one.probability for one in alternatives])
    apart = np.array([one.position_m - likeliest.position_m for one in tracks])
    turned = np.array([wrap_angle(one.heading_rad - likeliest.heading_rad) for one in tracks])
    covariance = np.array([one.covariance_m2 for one in tracks]) + apart[..., :, None] * apart[..., None, :]
    variance = np.array([one.sigma_heading_rad**2 for one in tracks]) + turned**2
    return replace(
        likeliest,
        covariance_m2=np.einsum("k,knij->nij", weights, covariance),
        sigma_heading_rad=np.sqrt(weights @ variance),
    )


@dataclass(frozen=True)
class _Course:
    """One possible course of a device: its probability, the turns at its nodes, and its heading at the start."""

    probability: float
    turns: Turns
    start_heading_rad: float | None


@dataclass(frozen=True)
class _Courses:
    """Courses of a device: the most probable ones, and one whose variance is that of all of them."""

    apart: tuple[_Course, ...]
    together: _Course


def _most_probable(courses: Sequence[Sequence[_Course]]) -> tuple[tuple[tuple[_Course, ...], ...], float]:
    """Return the most probable combinations of the courses of all devices, and their probability together."""
    some = sorted(product(*courses), key=lambda one: -prod(course.probability for course in one))[:_MOST]
    return tuple(some), sum(prod(course.probability for course in one) for one in some)


def _courses(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> _Courses:
    """Return the possible courses of a device, the most probable first."""
    prior = start_prior(timeline, start, sigma_length_scale)
    if not prior.heading_open and not any(node.turn_hypotheses for node in timeline.nodes):
        return _certain(())
    last, number = _last_open(timeline, start, sigma_length_scale)
    if last.bank is None:
        turns, heading_rad = chosen_turns(timeline, last.decided, 1.0), None
        if prior.heading_open and last.segment_begin == 0:
            heading_rad = _heading_at_start(timeline, turns, float(last.state.mean[2]), number)
        return _certain(turns, heading_rad)
    together = _Course(1.0, marginal_turns(timeline, last.bank), None)
    modes = _modes(last.bank)
    kept = [mode for mode in modes[:_MOST] if mode[1] >= _LEAST_PROBABILITY]
    apart: list[_Course] = []
    for hypothesis, probability in kept:
        turns, heading_rad = chosen_turns(timeline, last.bank.lineages[hypothesis], _LEAST_PROBABILITY), None
        if not apart:
            turns = widened_by_others(timeline, last.bank, turns, modes, len(kept))
        if not last.heading_known:
            heading_rad = _heading_at_start(timeline, turns, float(last.bank.means[hypothesis, 2]), number)
        apart.append(_Course(probability, turns, heading_rad))
    return _Courses(tuple(apart), together)


def _certain(turns: Turns, start_heading_rad: float | None = None) -> _Courses:
    """Return the only course of a device."""
    course = _Course(1.0, turns, start_heading_rad)
    return _Courses((course,), course)


def _heading_at_start(timeline: Timeline, turns: Turns, heading_rad: float, number: int) -> float:
    """Return the heading at the start that leads to a heading at the node of that number."""
    turned_rad = sum(node.heading_change_rad for node in _resolved(timeline, turns).nodes[1 : number + 1])
    return float(wrap_angle(heading_rad - turned_rad))


def _open(turns: Turns) -> tuple[tuple[int, float], ...]:
    """Return number of the node and probability of the turns that are not decided."""
    return tuple((i, turn.probability) for i, turn in turns if turn.probability < _DECIDED)


def _last_open(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> tuple[DeviceFilterState, int]:
    """Return the state of the filter of a device where nothing is open any more, or at the end, and its node."""
    scratch, nodes = MultiDeviceEkf(1), timeline.nodes
    observing = max((i for i, node in enumerate(nodes) if node.observes_heading), default=0)
    opening = max((i for i, node in enumerate(nodes) if node.turn_hypotheses or loses_heading(node)), default=0)
    state = start_device(nodes[0], 0, start_prior(timeline, start, sigma_length_scale), scratch)
    for number, node in enumerate(nodes[1:], 1):
        if number > opening and state.bank is None:
            return state, number - 1
        state = step_device(state, node, number, number <= observing, scratch)
    return state, len(nodes) - 1


def _modes(bank: HypothesisBank) -> list[tuple[int, float]]:
    """Return number and probability of hypotheses that differ by turns or heading, each with those alike."""
    left, modes = list(np.argsort(-bank.weights, kind="stable")), []
    while left:
        first = left[0]
        alike = [
            i
            for i in left
            if bank.lineages[i] == bank.lineages[first]
            and abs(wrap_angle(bank.means[i, 2] - bank.means[first, 2])) < _ONE_MODE_RAD
        ]
        modes.append((int(first), float(bank.weights[alike].sum())))
        left = [i for i in left if i not in alike]
    return sorted(modes, key=lambda mode: -mode[1])


def _resolved(timeline: Timeline, turns: Turns) -> Timeline:
    """Return a timeline with the chosen turns."""
    if not turns:
        return timeline
    nodes = list(timeline.nodes)
    for number, turn in turns:
        nodes[number] = _turned(nodes[number], turn)
    return replace(timeline, nodes=tuple(nodes))


def _turned(node: Node, turn: TurnHypothesis) -> Node:
    """Return a node with one turn instead of its hypotheses."""
    covariance = with_heading_variance(node.covariance, turn.sigma_rad**2)
    return replace(node, heading_change_rad=turn.heading_change_rad, covariance=covariance, turn_hypotheses=())


def _undecided(alternatives: Sequence[Alternative]) -> list[Finding]:
    """Report the turns and start headings that the measurements do not decide."""
    first, findings = alternatives[0], []
    others = alternatives[1:] if first.probability < _DECIDED else ()
    for number, one in enumerate(first.timelines):
        probabilities = dict(first.open_turns[number])
        for i, node in enumerate(one.nodes):
            if any(
                other.timelines[number].nodes[i].heading_change_rad != node.heading_change_rad for other in others
            ):
                probabilities[i] = first.probability
        findings += [_open_turn(one.device, one.nodes[i].time_s, probabilities[i]) for i in sorted(probabilities)]
        if any(other.start_headings_rad[number] != first.start_headings_rad[number] for other in others):
            findings.append(_open_start(one.device, first.probability))
    return findings


def _open_turn(device: str, time_s: float, probability: float) -> Finding:
    """Report that the turn at a time is not decided."""
    return Finding(
        FindingKind.PLACEMENT,
        f"{device}: after the phone was put elsewhere at {time_s:.0f} s the direction of the walk is not certain: "
        f"that of the track has a probability of {probability:.0%}; its uncertainty covers the others, and a "
        "position fix later on would decide",
        device=device,
        begin_s=time_s,
        value=probability,
    )


def _open_start(device: str, probability: float) -> Finding:
    """Report that the start heading is not decided."""
    return Finding(
        FindingKind.START_HEADING,
        f"{device}: the measurements fit several start headings; the one of the track has a probability of "
        f"{probability:.0%}, and its uncertainty covers the others: give a start heading, or one more fix",
        device=device,
        value=probability,
    )
