"""Arithmetic of a gait model on the features of steps; each has the same scores in whatever batch it comes."""

from math import tanh

import numpy as np
from numpy.typing import NDArray

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

    def __call__(self, features: Array) -> Array:
        """Compute the scores (n,) of steps with features (n, k), all of the set: above zero for the faster side."""
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

    def __call__(self, features: Array) -> Array:
        """Compute the scores (n,) of steps with features (n, k), all of the set: above zero for the faster side."""
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

    def scores(self, features: Array) -> Array:
        """Compute the scores (2, n) of both levels of steps with features (n, k), clipped at `SCORE_LIMIT`."""
        both = np.stack([self._faster(features), self._running(features)])
        return np.asarray(np.minimum(np.maximum(both, -SCORE_LIMIT), SCORE_LIMIT))

    def probabilities(self, scores: Array) -> Array:
        """Compute the probabilities (n, 3) of walking, jogging and running from pooled scores (2, n)."""
        faster, running = (
            _platt_probability(level, sigmoid) for level, sigmoid in zip(scores, self._sigmoids, strict=True)
        )
        return np.stack([1.0 - faster, faster * (1.0 - running), faster * running], axis=1)


def gait_changes(score: Array, before: Array) -> NDArray[np.bool_]:
    """Tell where the first level's scores (n,) clearly contradict those of the steps before (n,)."""
    return np.asarray((score * before < 0.0) & (np.abs(score) > CLEAR_SCORE))


def decide_gait(probabilities: Probabilities) -> Gait:
    """Return the gait at the end of the path through the two levels, with the more likely side at each."""
    walking, jogging, running = probabilities
    if walking >= 0.5:
        return Gait.WALKING
    return Gait.RUNNING if running > jogging else Gait.JOGGING


def _platt_probability(score: Array, sigmoid: tuple[float, float]) -> Array:
    # The logistic function as a hyperbolic tangent, which cannot overflow; that of the standard library, because the
    # rounding of NumPy's may depend on where in the array a number is.
    logits = 0.5 * (sigmoid[0] * score + sigmoid[1])
    return 0.5 + 0.5 * np.array(list(map(tanh, logits.tolist())))
