"""Arithmetic of a gait model on the features of one step, or of many steps with the same result."""

from collections.abc import Sequence
from math import tanh

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.gait.model import GaitModel, SupportVectorMachine
from pdr_est.types.steps import Gait

SCORE_LIMIT = 2.0
"""Scores are clipped to this magnitude before steps are averaged: one very sure step must not outvote the next."""

CLEAR_SCORE = 0.5
"""A first-level score beyond this, on the other side than the step before's, is a change of gait and no mistake.

By SisFall and MotionSense cut together, people left out: without it one change in eight is seen at the third step or
later, with it one in a hundred; the share of right steps stays within 0.02 %.
"""

Probabilities = tuple[float, float, float]


class LinearScorer:
    """Decision function of a machine with the linear kernel: one scalar product, with the scaling worked in."""

    def __init__(self, machine: SupportVectorMachine) -> None:
        slope = np.array(machine.dual) @ np.array(machine.support) / np.array(machine.scale)
        self._intercept = machine.intercept - float(slope @ np.array(machine.mean))
        self._terms = tuple(zip(machine.columns, slope.tolist(), strict=True))

    def __call__(self, features: Sequence[float]) -> float:
        """Compute the score of one step's features (all of the set): above zero for the faster side."""
        return sum([slope * features[column] for column, slope in self._terms], self._intercept)

    def of_many(self, features: Array) -> Array:
        """Compute the scores (n,) of steps with features (n, k)."""
        score = np.full(len(features), self._intercept)
        for column, slope in self._terms:
            score += slope * features[:, column]
        return score


class RbfScorer:
    """Decision function of a machine with the radial kernel; terms common to all steps are computed beforehand."""

    def __init__(self, machine: SupportVectorMachine) -> None:
        self._columns, self._mean, self._scale = machine.columns, machine.mean, machine.scale
        self._intercept, self._dual = machine.intercept, np.array(machine.dual)
        support = np.array(machine.support)
        # -gamma |s - z|^2 = -gamma (-2 s . z + s . s + z . z), one product with (z, 1, z . z)
        squares = (support * support).sum(axis=1)
        self._weights = -machine.gamma * np.column_stack([-2.0 * support, squares, np.ones_like(squares)])

    def __call__(self, features: Sequence[float]) -> float:
        """Compute the score of one step's features (all of the set): above zero for the faster side."""
        # Plain numbers, because an array operation costs more for so few.
        z = [(features[c] - m) / s for c, m, s in zip(self._columns, self._mean, self._scale, strict=True)]
        square = sum([number * number for number in z])
        kernel = np.exp(self._weights @ np.array((*z, 1.0, square)))
        return float(self._dual @ kernel) + self._intercept

    def of_many(self, features: Array) -> Array:
        """Compute the scores (n,) of steps with features (n, k)."""
        z = (features[:, list(self._columns)] - np.array(self._mean)) / np.array(self._scale)
        terms = np.ones((len(z), z.shape[1] + 2))
        terms[:, :-2] = z
        terms[:, -1] = np.add.accumulate(z * z, axis=1)[:, -1]
        # A product of each step by itself: that of all of them would round in another way.
        kernel = np.exp(np.matmul(self._weights, terms[:, :, None])[:, :, 0])
        score: Array = np.matmul(kernel[:, None, :], self._dual[:, None])[:, 0, 0] + self._intercept
        return score


def scorer(machine: SupportVectorMachine) -> LinearScorer | RbfScorer:
    """Make the decision function of a machine."""
    return LinearScorer(machine) if machine.kernel == "linear" else RbfScorer(machine)


class GaitScorer:
    """Both levels of a model; scores and probabilities are of the faster side: not walking, and then running.

    Parameters
    ----------
    model : GaitModel
        Trained classifier.
    """

    def __init__(self, model: GaitModel) -> None:
        self._faster, self._running = scorer(model.faster), scorer(model.running)
        self._sigmoids = model.faster.sigmoid, model.running.sigmoid

    def scores(self, features: Array) -> list[tuple[float, float]]:
        """Compute the scores of both levels of steps with features (n, k), clipped at `SCORE_LIMIT`."""
        if len(features) == 1:
            (numbers,) = features.tolist()
            return [(_clip(self._faster(numbers)), _clip(self._running(numbers)))]
        both = [map(_clip, level.of_many(features).tolist()) for level in (self._faster, self._running)]
        return list(zip(*both, strict=True))

    def probabilities(self, scores: tuple[float, float]) -> Probabilities:
        """Compute the probabilities of walking, jogging and running from pooled scores."""
        faster, running = (
            _platt_probability(scores[0], self._sigmoids[0]),
            _platt_probability(scores[1], self._sigmoids[1]),
        )
        return 1.0 - faster, faster * (1.0 - running), faster * running


def is_gait_change(score: float, before: float) -> bool:
    """Return True if the first level's score of a step clearly contradicts that of the step before."""
    return score * before < 0.0 and abs(score) > CLEAR_SCORE


def decide_gait(probabilities: Probabilities) -> Gait:
    """Return the gait at the end of the path through the two levels, with the more likely side at each."""
    walking, jogging, running = probabilities
    if walking >= 0.5:
        return Gait.WALKING
    return Gait.RUNNING if running > jogging else Gait.JOGGING


def _clip(score: float) -> float:
    return min(max(score, -SCORE_LIMIT), SCORE_LIMIT)


def _platt_probability(score: float, sigmoid: tuple[float, float]) -> float:
    # The logistic function as a hyperbolic tangent, which cannot overflow.
    return 0.5 + 0.5 * tanh(0.5 * (sigmoid[0] * score + sigmoid[1]))
