"""Lengths of strides (two steps) against those that were measured at the foot.

What a walk's detected steps make of a measured stride can be told in two ways, and the two differ, because the times
at which the foot's sensor places the ends of a stride scatter by several percent of its duration:

* by two steps: twice the mean length of the steps during the stride. Their number decides how many strides it is:
  a sensor that misses the end of one reports two as one, of double length.
* by time: how far the steps lead between the stride's beginning and end, the pace within a step being even. The
  scatter of the ends counts in full here.

A step that lies partly within a stride counts for that part.
"""

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.ground_truth import TrueStrides

LONGEST_STRIDE_M = 3.0  # longer ones are mistakes of the sensor at the foot


def scored_strides(strides: TrueStrides) -> TrueStrides:
    """The strides to score: without the last, in which the walker comes to rest, and without those above 3 m.

    Readers leave out the first of a recording already, whose beginning is not known.
    """
    kept = strides.length_m <= LONGEST_STRIDE_M
    kept[-1:] = False
    return TrueStrides(strides.start_s[kept], strides.end_s[kept], strides.length_m[kept])


def shares(start_s: Array, end_s: Array, strides: TrueStrides) -> Array:
    """Which share of each step's movement lies within each stride: (strides, steps), 0 to 1.

    start_s, end_s: (steps,) of the movements.
    """
    begin = np.maximum(start_s[None, :], strides.start_s[:, None])
    end = np.minimum(end_s[None, :], strides.end_s[:, None])
    share: Array = np.maximum(end - begin, 0.0) / np.maximum(end_s - start_s, 1e-9)[None, :]
    return share


def lengths_by_two_steps(share: Array, length_m: Array) -> Array:
    """Lengths (strides,) from the mean of the steps in each; 0 for a stride without any.

    share: as `shares` gives it; length_m: (steps,). Two steps are one stride, and so is fewer than three: the number
    of strides is half that of the steps, rounded, and at least 1.
    """
    steps = share.sum(axis=1)
    strides = np.maximum(np.floor(steps / 2.0 + 0.5), 1.0)
    lengths: Array = 2.0 * strides * (share @ length_m) / np.maximum(steps, 1e-9)
    return lengths


def lengths_by_time(share: Array, length_m: Array) -> Array:
    """Lengths (strides,) of the way between the beginning and the end of each. Arguments as above."""
    lengths: Array = share @ length_m
    return lengths


def stride_error(length_m: Array, true_m: Array) -> float:
    """`stride_error`: mean of the differences / true lengths, which are positive; at least one stride."""
    return float(np.mean(np.abs(length_m - true_m) / true_m))
