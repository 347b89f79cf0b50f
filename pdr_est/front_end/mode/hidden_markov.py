"""A hidden Markov chain whose states are equally likely to follow each other: forward pass, and a look ahead.

From one row to the next the state changes with a probability that is given with the row, to each other state alike.
It is below (states - 1) / states: even the likeliest change leaves the old state a chance. Arrays are (states, n).
"""

import numpy as np

from pdr_est.frames import Array


class ModeBelief:
    """The belief in each of some states, carried from row to row."""

    def __init__(self, states: int) -> None:
        self._belief = [1.0 / states] * states

    def fade(self, keep: float) -> None:
        """Mix the belief with ignorance; keep: the share of it that stays."""
        even = (1.0 - keep) / len(self._belief)
        self._belief = [keep * b + even for b in self._belief]

    def forward(self, change: Array, likelihood: Array) -> Array:
        """Belief (states, n) at each row from all rows up to it. change: (n,) probability to have changed the
        state since the row before; likelihood: (states, n) of what the row shows."""
        beliefs = []
        belief = self._belief
        moved = _moved(change, len(belief)).tolist()
        for m, row in zip(moved, likelihood.T.tolist(), strict=True):
            seen = [(b + m) * x for b, x in zip(belief, row, strict=True)]
            scale = 1.0 / sum(seen)
            belief = [scale * b for b in seen]
            beliefs.append(belief)
        self._belief = belief
        return np.array(beliefs).reshape(-1, len(belief)).T


def look_ahead(change: Array, likelihood: Array, count: int, rows: int) -> Array:
    """What the `rows` rows after each of the first `count` say about it, (states, count), up to a factor.

    change: (n,), likelihood: (states, n), with n >= count + rows.
    """
    ahead = np.ones((len(likelihood), count))
    moved = _moved(change, len(likelihood))
    for step in range(rows, 0, -1):
        ahead *= likelihood[:, step : step + count]
        ahead += moved[step : step + count] * np.add.reduce(ahead)
    return ahead


def _moved(change: Array, states: int) -> Array:
    """Of the step belief -> stay * belief + leave * sum(belief), leave over stay: only the ratio matters."""
    leave = change / (states - 1)
    ratio: Array = leave / (1.0 - change - leave)
    return ratio
