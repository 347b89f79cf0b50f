"""A hidden Markov chain whose states are equally likely to follow each other: forward pass, and a look ahead.

From one row to the next the state changes with a probability that is given with the row, to each other state alike.
"""

from collections.abc import Sequence

import numpy as np

from pdr_est.frames import Array


class Chain:
    """The belief in each of some states, carried from row to row."""

    def __init__(self, states: int) -> None:
        self._belief = [1.0 / states] * states

    def fade(self, keep: float) -> None:
        """Mix the belief with ignorance; keep: the share of it that stays."""
        even = (1.0 - keep) / len(self._belief)
        self._belief = [keep * b + even for b in self._belief]

    def forward(self, change: Sequence[float], likelihood: Sequence[Sequence[float]]) -> Array:
        """Belief (n, states) at each row from all rows up to it. change: (n,) probability to have changed the
        state since the row before; likelihood: (n, states) of what the row shows."""
        beliefs = []
        belief = self._belief
        for c, row in zip(change, likelihood, strict=True):
            leave = c / (len(belief) - 1)
            stay = 1.0 - c - leave
            belief = [(stay * b + leave) * x for b, x in zip(belief, row, strict=True)]
            total = sum(belief)
            belief = [b / total for b in belief]
            beliefs.append(belief)
        self._belief = belief
        return np.array(beliefs).reshape(-1, len(belief))


def look_ahead(change: Array, likelihood: Array, count: int, rows: int) -> Array:
    """What the `rows` rows after each of the first `count` say about it, (count, states), up to a factor.

    change: (n,), likelihood: (n, states), with n >= count + rows. A state a row inside, to add them up row by row.
    """
    states = likelihood.shape[1]
    seen = np.ascontiguousarray(likelihood.T)
    leave = change / (states - 1)
    stay = 1.0 - change - leave
    ahead = np.ones((states, count))
    for step in range(rows, 0, -1):
        now = slice(step, step + count)
        ahead *= seen[:, now]
        total = leave[now] * ahead.sum(axis=0)
        ahead *= stay[now]
        ahead += total
    return ahead.T
