"""The arithmetic of a gait model on the features of one step."""

from math import tanh

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.gait.model import GaitModel, Machine
from pdr_est.records import Gait

SCORE_LIMIT = 2.0
"""Scores are cut at this size before steps are averaged: one very sure step must not outvote the next."""

Probabilities = tuple[float, float, float]


class Scorer:
    """The decision function of a machine, with what does not depend on the step worked out beforehand."""

    def __init__(self, machine: Machine) -> None:
        self._columns = np.array(machine.columns)
        self._mean, self._scale = np.array(machine.mean), np.array(machine.scale)
        support, dual = np.array(machine.support), np.array(machine.dual)
        self._intercept = machine.intercept
        self._rbf = machine.kernel == "rbf"
        if self._rbf:
            # -gamma |s - z|^2 = 2 gamma s . z - gamma s . s - gamma z . z
            self._gamma = machine.gamma
            self._weights = 2.0 * machine.gamma * support
            self._offset = -machine.gamma * (support * support).sum(axis=1)
            self._dual = dual
        else:
            self._weights = dual @ support

    def __call__(self, features: Array) -> float:
        """Score of one step's features (all of the set): above zero for the faster side."""
        z = (features[self._columns] - self._mean) / self._scale
        if not self._rbf:
            return float(self._weights @ z) + self._intercept
        exponent = self._weights @ z
        exponent += self._offset - self._gamma * float(z @ z)
        return float(self._dual @ np.exp(exponent)) + self._intercept


class GaitScorer:
    """The two levels of a model. Scores and probabilities are of the faster side: not walking, and then running."""

    def __init__(self, model: GaitModel) -> None:
        self._faster, self._running = Scorer(model.faster), Scorer(model.running)
        self._sigmoids = model.faster.sigmoid, model.running.sigmoid

    def scores(self, features: Array) -> tuple[float, float]:
        """Scores of both levels, cut at the limit."""
        return _cut(self._faster(features)), _cut(self._running(features))

    def probabilities(self, scores: tuple[float, float]) -> Probabilities:
        """Of walking, jogging and running."""
        faster, running = (_platt(score, sigmoid) for score, sigmoid in zip(scores, self._sigmoids, strict=True))
        return 1.0 - faster, faster * (1.0 - running), faster * running


def gait_of(probabilities: Probabilities) -> Gait:
    """The gait at the end of the path through the two levels, at each of which the likelier side is taken."""
    walking, jogging, running = probabilities
    if walking >= 0.5:
        return Gait.WALKING
    return Gait.RUNNING if running > jogging else Gait.JOGGING


def _cut(score: float) -> float:
    return min(max(score, -SCORE_LIMIT), SCORE_LIMIT)


def _platt(score: float, sigmoid: tuple[float, float]) -> float:
    # The logistic function as a hyperbolic tangent, which cannot overflow.
    return 0.5 + 0.5 * tanh(0.5 * (sigmoid[0] * score + sigmoid[1]))
