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
from pdr_est.estimators.kalman.device_filter_step import DeviceFilterState, start_device, step_device
from pdr_est.estimators.kalman.hypothesis_bank import HypothesisBank, Lineage
from pdr_est.estimators.kalman.predict_and_update import MultiDeviceEkf
from pdr_est.frames import wrap_angle
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import StartPose
from pdr_est.types.track import Track

_MOST, _LEAST_PROBABILITY = 4, 0.02  # alternatives that are smoothed, and the least probability of one
_ONE_MODE_RAD = 0.5  # headings that differ by less are one alternative, for the smoother moves them
_KNOWN_SHARE = 0.9  # of the probability that few alternatives must have; otherwise the heading is simply unknown
_DECIDED = 0.95  # probability of an alternative from which on nothing is reported; ours


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
    """

    probability: float
    timelines: tuple[Timeline, ...]
    start_headings_rad: tuple[float | None, ...]


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
    ways = [_ways(one, own, sigma_length_scale) for one, own in zip(timelines, starts, strict=True)]
    together = sorted(product(*ways), key=lambda some: -prod(one.probability for one in some))[:_MOST]
    total = sum(prod(one.probability for one in some) for some in together)
    return tuple(
        Alternative(
            prod(one.probability for one in some) / total,
            tuple(_resolved(timeline, one.lineage) for timeline, one in zip(timelines, some, strict=True)),
            tuple(one.start_heading_rad for one in some),
        )
        for some in together
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
    likeliest = tracks[0]
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
        findings=(*likeliest.findings, *_undecided(alternatives)),
    )


@dataclass(frozen=True)
class _Way:
    """One possible course of a device: its probability, the turns that it chose, and its heading at the start."""

    probability: float
    lineage: Lineage
    start_heading_rad: float | None


def _ways(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> list[_Way]:
    """Return the possible courses of a device, the most probable first."""
    prior = start_prior(timeline, start, sigma_length_scale)
    if not prior.heading_open and not any(node.turn_hypotheses for node in timeline.nodes):
        return [_Way(1.0, (), None)]
    last = _filtered(timeline, start, sigma_length_scale)
    if last.bank is None:
        return [_Way(1.0, last.decided, None)]
    modes = _modes(last.bank)[:_MOST]
    likely = [mode for mode in modes if mode[1] >= _LEAST_PROBABILITY]
    share = sum(probability for _, probability in likely)
    if share < _KNOWN_SHARE and last.heading_known:
        return [_Way(1.0, last.decided, None)]  # undecided turns keep the mean and covariance of all hypotheses
    if share < _KNOWN_SHARE:
        return [_Way(1.0, last.bank.lineages[last.bank.likeliest], None)]
    turned_rad = sum(node.heading_change_rad for node in timeline.nodes[1:])
    return [
        _Way(
            probability / share,
            last.bank.lineages[number],
            float(wrap_angle(last.bank.means[number, 2] - turned_rad)) if not last.heading_known else None,
        )
        for number, probability in likely
    ]


def _filtered(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> DeviceFilterState:
    """Return the state of the filter at the end of a device's walk."""
    scratch, nodes = MultiDeviceEkf(1), timeline.nodes
    observing = max((i for i, node in enumerate(nodes) if node.observes_heading), default=0)
    state = start_device(nodes[0], 0, start_prior(timeline, start, sigma_length_scale), scratch)
    for number, node in enumerate(nodes[1:], 1):
        state = step_device(state, node, number, number <= observing, scratch)
    return state


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


def _resolved(timeline: Timeline, lineage: Lineage) -> Timeline:
    """Return a timeline with the chosen turns."""
    if not lineage:
        return timeline
    nodes = list(timeline.nodes)
    for number, chosen in lineage:
        nodes[number] = _turned(nodes[number], chosen)
    return replace(timeline, nodes=tuple(nodes))


def _turned(node: Node, chosen: int) -> Node:
    """Return a node with one of its turn hypotheses for its turn."""
    turn = node.turn_hypotheses[chosen]
    slight = [one for one in node.turn_hypotheses if one is not turn and one.probability < _LEAST_PROBABILITY]
    off = [one.sigma_rad**2 + wrap_angle(one.heading_change_rad - turn.heading_change_rad) ** 2 for one in slight]
    rest = sum(one.probability * square for one, square in zip(slight, off, strict=True))  # never an alternative
    covariance = with_heading_variance(node.covariance, turn.sigma_rad**2 + float(rest))
    return replace(node, heading_change_rad=turn.heading_change_rad, covariance=covariance, turn_hypotheses=())


def _undecided(alternatives: Sequence[Alternative]) -> list[Finding]:
    """Report the turns and start headings that the measurements do not decide."""
    first = alternatives[0]
    if first.probability >= _DECIDED:
        return []
    share = f"{first.probability:.0%}"
    findings = []
    for number, one in enumerate(first.timelines):
        others = [other.timelines[number] for other in alternatives[1:]]
        for i, node in enumerate(one.nodes):
            if any(other.nodes[i].heading_change_rad != node.heading_change_rad for other in others):
                findings.append(
                    Finding(
                        FindingKind.PLACEMENT,
                        f"{one.device}: after the phone was put elsewhere at {node.time_s:.0f} s the direction of "
                        f"the walk is not certain: that of the track has a probability of {share}; its uncertainty "
                        "covers the others, and a position fix later on would decide",
                        device=one.device,
                        begin_s=node.time_s,
                        value=first.probability,
                    )
                )
        if any(other.start_headings_rad[number] != first.start_headings_rad[number] for other in alternatives[1:]):
            findings.append(
                Finding(
                    FindingKind.START_HEADING,
                    f"{one.device}: the measurements fit several start headings; the one of the track has a "
                    f"probability of {share}, and its uncertainty covers the others: give a start heading, or one "
                    "more fix",
                    device=one.device,
                    value=first.probability,
                )
            )
    return findings
