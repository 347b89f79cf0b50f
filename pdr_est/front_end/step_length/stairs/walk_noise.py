"""Noise of the vertical velocities of a walk over that of the parameters, as the walk itself shows it."""

import numpy as np

from pdr_est.frames import Array

_PRIOR_STEPS = 10.0  # that the parameters count as
_KEPT = 0.97  # of what was learnt, at each further step
_LARGEST_SQUARE = 9.0  # of an error over its variance; a larger one is not the noise of every step
_LEAST = 0.25


class WalkNoise:
    """Noise of a walk, from the errors of the last steps.

    Attributes
    ----------
    variance : float
        Variance of this walk's errors over that of the parameters.
    """

    def __init__(self) -> None:
        self._squares = self._weight = 0.0
        self.variance = 1.0

    def learn(self, squared: float, share: float) -> None:
        """Take in the error of one step.

        Parameters
        ----------
        squared : float
            Square of the error over the variance that was expected.
        share : float
            Probability that the error is noise.
        """
        kept = 1.0 - (1.0 - _KEPT) * share
        self._squares = kept * self._squares + share * min(squared, _LARGEST_SQUARE) * self.variance
        self._weight = kept * self._weight + share
        self.variance = max((_PRIOR_STEPS + self._squares) / (_PRIOR_STEPS + self._weight), _LEAST)

    def learn_of_hypotheses(self, squared: Array, log_weight: Array) -> None:
        """Take in the squared errors (n,) of one step, like `learn`, under hypotheses of these log weights (n,)."""
        weight = np.exp(log_weight - log_weight.max())
        self.learn(float(np.minimum(squared, _LARGEST_SQUARE) @ weight / weight.sum()), 1.0)
