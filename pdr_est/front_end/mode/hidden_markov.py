"""Hidden Markov model with states that follow each other with equal probability: filter, and backward pass.

From one row to the next the state changes with a probability that is given with the row, and to each other state
alike. That probability is below (states - 1) / states, so that even the most likely change leaves the old state a
chance. Arrays are (states, n).
"""

import numpy as np

from pdr_est.frames import Array

STATES = 4
"""Number of states of a `ModeBelief`."""


class ModeBelief:
    """Filtered probabilities of four states, carried from row to row; all are equally likely at the beginning."""

    def __init__(self) -> None:
        self._belief = (1.0 / STATES,) * STATES

    def relax(self, kept_share: float) -> None:
        """Mix the belief with the uniform one; `kept_share` is the weight of the belief."""
        uniform = (1.0 - kept_share) / STATES
        first, second, third, fourth = (kept_share * b + uniform for b in self._belief)
        self._belief = first, second, third, fourth

    def forward(self, change: Array, likelihood: Array) -> Array:
        """Filter further rows: compute the probabilities of the states at each row given all rows up to it.

        Parameters
        ----------
        change : ndarray, shape (n,)
            Probability that the state changed since the row before.
        likelihood : ndarray, shape (STATES, n)
            Likelihood of each row under each state, up to a factor.

        Returns
        -------
        ndarray, shape (STATES, n)
            The filtered probabilities.
        """
        beliefs = []
        a, b, c, d = self._belief
        ratio = _switch_ratio(change, STATES).tolist()
        # The states are written out: four numbers are too few for an array, and a row comes for every hop of a walk.
        for m, likely_a, likely_b, likely_c, likely_d in zip(ratio, *likelihood.tolist(), strict=True):
            a, b, c, d = (a + m) * likely_a, (b + m) * likely_b, (c + m) * likely_c, (d + m) * likely_d
            scale = 1.0 / (a + b + c + d)
            a, b, c, d = scale * a, scale * b, scale * c, scale * d
            beliefs.append((a, b, c, d))
        self._belief = a, b, c, d
        return np.array(beliefs).reshape(-1, STATES).T


def backward_likelihood(change: Array, likelihood: Array, count: int, rows: int) -> Array:
    """Compute the likelihood of the next `rows` rows given the state at each of the first `count` rows.

    Parameters
    ----------
    change : ndarray, shape (n,)
        Probability that the state changed since the row before; n is at least count + rows.
    likelihood : ndarray, shape (states, n)
        Likelihood of each row under each state, up to a factor.
    count : int
        Number of rows for which the result is computed.
    rows : int
        Number of later rows that are looked at.

    Returns
    -------
    ndarray, shape (states, count)
        The likelihood up to a factor.
    """
    ahead = np.ones((len(likelihood), count))
    ratio = _switch_ratio(change, len(likelihood))
    for step in range(rows, 0, -1):
        ahead *= likelihood[:, step : step + count]
        ahead += ratio[step : step + count] * np.add.reduce(ahead)
    return ahead


def _switch_ratio(change: Array, states: int) -> Array:
    """Compute leave / stay of the prediction belief -> stay * belief + leave * sum(belief); the ratio is enough."""
    leave = change / (states - 1)
    ratio: Array = leave / (1.0 - change - leave)
    return ratio
