"""Possible courses of one device, weighed by the bank of hypotheses of the Kalman filter."""

from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.alternatives.chosen_turns import (
    Turns,
    chosen_turns,
    turns_one_by_one,
    widened_by_others,
    with_turns,
)
from pdr_est.estimators.common.initial_state import start_prior
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.kalman.device_filter_step import DeviceFilterState, filtered_states, loses_heading
from pdr_est.estimators.kalman.hypothesis_bank import HypothesisBank
from pdr_est.frames import wrap_angle
from pdr_est.types.measurements import StartPose

MOST_ALTERNATIVES = 4  # that are smoothed
_LEAST_PROBABILITY = 0.02  # of an alternative
_ONE_MODE_RAD = 0.5  # headings that differ by less are one alternative, for the smoother moves them


@dataclass(frozen=True)
class DeviceCourse:
    """One possible course of a device: its probability, the turns at its nodes, and its heading at the start."""

    probability: float
    turns: Turns
    start_heading_rad: float | None


@dataclass(frozen=True)
class DeviceCourses:
    """Courses of a device: the most probable ones, and one whose variance is that of all of them."""

    apart: tuple[DeviceCourse, ...]
    together: DeviceCourse


def device_courses(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> DeviceCourses:
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
    together = DeviceCourse(1.0, turns_one_by_one(timeline, last.bank), None)
    modes = _modes(last.bank)
    kept = [mode for mode in modes[:MOST_ALTERNATIVES] if mode[1] >= _LEAST_PROBABILITY]
    apart: list[DeviceCourse] = []
    for hypothesis, probability in kept:
        turns, heading_rad = chosen_turns(timeline, last.bank.lineages[hypothesis], _LEAST_PROBABILITY), None
        if not apart:
            turns = widened_by_others(timeline, last.bank, turns, modes, len(kept))
        if not last.heading_known:
            heading_rad = _heading_at_start(timeline, turns, float(last.bank.means[hypothesis, 2]), number)
        apart.append(DeviceCourse(probability, turns, heading_rad))
    return DeviceCourses(tuple(apart), together)


def _certain(turns: Turns, start_heading_rad: float | None = None) -> DeviceCourses:
    """Return the only course of a device."""
    course = DeviceCourse(1.0, turns, start_heading_rad)
    return DeviceCourses((course,), course)


def _heading_at_start(timeline: Timeline, turns: Turns, heading_rad: float, number: int) -> float:
    """Return the heading at the start that leads to a heading at the node of that number."""
    turned_rad = sum(node.heading_change_rad for node in with_turns(timeline, turns).nodes[1 : number + 1])
    return float(wrap_angle(heading_rad - turned_rad))


def _last_open(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> tuple[DeviceFilterState, int]:
    """Return the state of the filter of a device where nothing is open any more, or at the end, and its node."""
    nodes = timeline.nodes
    opening = max((i for i, node in enumerate(nodes) if node.turn_hypotheses or loses_heading(node)), default=0)
    for number, state in enumerate(filtered_states(nodes, start_prior(timeline, start, sigma_length_scale))):
        last = state, number
        if number >= opening and state.bank is None:
            break
    return last


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
