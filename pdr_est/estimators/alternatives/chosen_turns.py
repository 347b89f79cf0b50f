"""Turns of the walker that a hypothesis chose, and the measurements with them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.estimators.common.nodes import Node, with_heading_variance
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.kalman.hypothesis_bank import HypothesisBank, Lineage
from pdr_est.frames import wrap_angle
from pdr_est.types.measurements import TurnHypothesis

Turns = tuple[tuple[int, TurnHypothesis], ...]
"""Numbers of nodes, and the turn that each of them has."""


def chosen_turns(timeline: Timeline, lineage: Lineage, slight_probability: float) -> Turns:
    """Return the turns that a hypothesis chose; the variance includes the others below a probability.

    They are the ones that are no alternative: too slight, or, where the filter went on with one Gaussian, all.
    """
    turns = []
    for i, chosen in lineage:
        hypotheses = timeline.nodes[i].turn_hypotheses
        turn = hypotheses[chosen]
        slight = [one for one in hypotheses if one is not turn and one.probability < slight_probability]
        rest = _moment_about(turn, slight, [one.probability for one in slight])
        turns.append((i, replace(turn, probability=1.0, sigma_rad=float(np.sqrt(turn.sigma_rad**2 + rest)))))
    return tuple(turns)


def turns_one_by_one(timeline: Timeline, bank: HypothesisBank) -> Turns:
    """Return the turns of the most probable hypothesis, each with its probability among all hypotheses.

    The variance of each is the second moment of all its hypotheses about the chosen one.
    """
    turns = []
    for i, chosen in bank.lineages[bank.likeliest]:
        hypotheses, probability = timeline.nodes[i].turn_hypotheses, np.zeros(len(timeline.nodes[i].turn_hypotheses))
        for weight, lineage in zip(bank.weights, bank.lineages, strict=True):
            probability[dict(lineage)[i]] += weight
        sigma_rad = float(np.sqrt(_moment_about(hypotheses[chosen], hypotheses, probability.tolist())))
        turns.append((i, replace(hypotheses[chosen], probability=float(probability[chosen]), sigma_rad=sigma_rad)))
    return tuple(turns)


def widened_by_others(
    timeline: Timeline, bank: HypothesisBank, turns: Turns, modes: Sequence[tuple[int, float]], kept: int
) -> Turns:
    """Return the turns of the most probable hypothesis with variances that cover the hypotheses that are left out.

    Each of these is improbable, but there may be many of them.

    Parameters
    ----------
    timeline
        Measurements of the device.
    bank
        Hypotheses.
    turns
        Turns of the most probable one.
    modes
        Number and probability of hypotheses that differ, the most probable one first.
    kept
        Number of the first modes that are alternatives, and not left out.
    """
    chosen, moment = dict(bank.lineages[modes[0][0]]), dict.fromkeys((i for i, _ in turns), 0.0)
    share = sum(probability for _, probability in modes[:kept]) / modes[0][1]
    for hypothesis, probability in modes[kept:]:
        for i, other in bank.lineages[hypothesis]:
            if other != chosen[i]:
                hypotheses = timeline.nodes[i].turn_hypotheses
                moment[i] += share * probability * _moment_about(hypotheses[chosen[i]], [hypotheses[other]], [1.0])
    widened = []
    for i, turn in turns:
        own_rad = timeline.nodes[i].turn_hypotheses[chosen[i]].sigma_rad
        # The variance of the turn covers the slight hypotheses already, which may be among those left out.
        sigma_rad = max(turn.sigma_rad, float(np.sqrt(own_rad**2 + moment[i])))
        widened.append((i, replace(turn, sigma_rad=sigma_rad)))
    return tuple(widened)


def _moment_about(
    turn: TurnHypothesis, hypotheses: Sequence[TurnHypothesis], probabilities: Sequence[float]
) -> float:
    """Return the second moment of hypotheses with some probabilities about a turn, rad²."""
    off = [float(wrap_angle(one.heading_change_rad - turn.heading_change_rad)) for one in hypotheses]
    squares = [one.sigma_rad**2 + apart**2 for one, apart in zip(hypotheses, off, strict=True)]
    return sum(share * square for share, square in zip(probabilities, squares, strict=True))


def with_turns(timeline: Timeline, turns: Turns) -> Timeline:
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
