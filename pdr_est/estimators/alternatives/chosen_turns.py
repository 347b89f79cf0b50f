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
