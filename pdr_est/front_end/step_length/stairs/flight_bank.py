"""The bank of flight hypotheses: choosing, updating and merging them, all at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.step_length.stairs import flight_tables as column

MOST_HYPOTHESES = 12  # that are kept
_SAME_MPS = 0.08  # hypotheses are merged whose velocity errors lie in the same interval of this width
_EACH = np.eye(MOST_HYPOTHESES)
_FIRST = np.zeros(1, dtype=np.intp)
_ROW, _COLUMN = np.divmod(np.arange(column.STATES**2), column.STATES)  # of the numbers of a covariance

Places = NDArray[np.intp]


@dataclass(frozen=True)
class Bank:
    """Hypotheses: mode (n,), log weight (n,), filter (n, 20) and past (n, k).

    The filter is mean and covariance, as in `flight_tables`. The past is the probability of each of the last k steps
    to have been on stairs, under the hypothesis.
    """

    mode: Places
    log_weight: Array
    filters: Array
    past: Array


def most_probable(log_weight: Array) -> tuple[Places, Array]:
    """Return the places of the most probable hypotheses, and their weights; impossible ones are left out."""
    chosen = (-log_weight).argsort(kind="stable")[: 4 * MOST_HYPOTHESES]
    logarithm = log_weight.take(chosen)
    weight = np.exp(logarithm - logarithm[0])
    possible = np.count_nonzero(weight)  # they come first
    return chosen[:possible], weight[:possible]


def measure(rows: Array, innovation: Array, shared: Array, spread: Array) -> None:
    """Update filters by a measurement.

    Parameters
    ----------
    rows : ndarray, shape (n, WIDTH)
        The filters; changed in place.
    innovation, spread : ndarray, shape (n,)
        Measured value less the expected one, and its variance.
    shared : ndarray, shape (n, 4)
        Covariance of the expected value with each state.
    """
    gain = shared / spread[:, None]
    rows[:, column.MEAN] += gain * innovation[:, None]
    rows[:, column.COVARIANCE] -= _products(gain, shared)


def _products(a: Array, b: Array) -> Array:
    """Multiply each number of a row of a (n, 4) with each number of the row of b (n, 4); return (n, 16)."""
    products: Array = a.take(_ROW, axis=1) * b.take(_COLUMN, axis=1)
    return products


def merged_bank(mode: Places, weight: Array, filters: Array, on_stairs: Array, past: Array, parent: Places) -> Bank:
    """Merge hypotheses that nearly agree, by their moments, and keep the most probable ones.

    Parameters
    ----------
    mode, weight : ndarray, shape (n,)
        Modes and weights of the hypotheses.
    filters : ndarray, shape (n, 20)
        Means and covariances.
    on_stairs : ndarray, shape (modes,)
        1 for modes on stairs, 0 for others.
    past : ndarray, shape (parents, k)
        Past of the hypotheses that they split off from.
    parent : ndarray, shape (n,)
        The number of that hypothesis.
    """
    cell = np.rint(filters[:, column.VELOCITY] / _SAME_MPS) * len(on_stairs) + mode
    order = cell.argsort(kind="stable")
    ordered = cell.take(order)
    first = np.concatenate([_FIRST, (ordered[1:] != ordered[:-1]).nonzero()[0] + 1])
    totals = np.add.reduceat(weight.take(order), first)
    kept = (-totals).argsort(kind="stable")[:MOST_HYPOTHESES]
    totals = totals.take(kept)
    belongs = ordered.take(first.take(kept))[:, None] == cell
    share = belongs * weight / totals[:, None]
    moments = share @ filters
    difference = filters[:, column.MEAN] - moments[:, column.MEAN].take(belongs.argmax(axis=0), axis=0)
    moments[:, column.COVARIANCE] += share @ _products(difference, difference)
    longer = np.empty((len(kept), past.shape[1] + 1))
    np.matmul((share @ _EACH.take(parent, axis=0))[:, : len(past)], past, out=longer[:, :-1])
    longer[:, -1] = share @ on_stairs.take(mode)
    return Bank(mode.take(belongs.argmax(axis=1)), np.log(totals / totals.sum()), moments, longer)
