"""Metrics of stride lengths (two steps) against those that were measured at the foot.

The length of a measured stride follows from the detected steps by one of two rules. They differ because the sensor at
the foot places the ends of a stride with a scatter of several percent of its duration:

* by two steps: twice the mean length of the steps during the stride. Their number decides how many strides it is, for
  a sensor that misses the end of a stride reports two as one, of double length.
* by time: the distance between beginning and end of the stride, at constant speed within a step. The scatter of the
  ends counts in full here.

A step that lies partly within a stride counts for that part.
"""

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.ground_truth import TrueStrides

LONGEST_STRIDE_M = 3.0  # longer ones are errors of the sensor at the foot


def scored_strides(strides: TrueStrides) -> TrueStrides:
    """Return the strides to score: without the last, in which the walker comes to rest, and those above 3 m.

    Readers already leave out the first stride of a recording, whose beginning is not known.
    """
    kept = strides.length_m <= LONGEST_STRIDE_M
    kept[-1:] = False
    return TrueStrides(strides.start_s[kept], strides.end_s[kept], strides.length_m[kept])


def step_shares(start_s: Array, end_s: Array, strides: TrueStrides) -> Array:
    """Compute the share of each step that lies within each stride.

    Parameters
    ----------
    start_s, end_s : ndarray
        Begin and end (steps,) of the steps, s.
    strides : TrueStrides
        Measured strides.

    Returns
    -------
    ndarray
        Shares (strides, steps), 0 to 1.
    """
    begin = np.maximum(start_s[None, :], strides.start_s[:, None])
    end = np.minimum(end_s[None, :], strides.end_s[:, None])
    share: Array = np.maximum(end - begin, 0.0) / np.maximum(end_s - start_s, 1e-9)[None, :]
    return share


def lengths_by_two_steps(share: Array, length_m: Array) -> Array:
    """Compute the length of each measured stride from the mean length of the steps in it.

    Two steps are one stride: the number of strides is half that of the steps, rounded, and at least 1.

    Parameters
    ----------
    share : ndarray
        Shares (strides, steps), from `step_shares`.
    length_m : ndarray
        Lengths (steps,) of the steps, m.

    Returns
    -------
    ndarray
        Lengths (strides,), m; 0 for a stride without steps.
    """
    steps = share.sum(axis=1)
    strides = np.maximum(np.floor(steps / 2.0 + 0.5), 1.0)
    lengths: Array = 2.0 * strides * (share @ length_m) / np.maximum(steps, 1e-9)
    return lengths


def lengths_by_time(share: Array, length_m: Array) -> Array:
    """Compute the distance between beginning and end of each stride; see `lengths_by_two_steps`."""
    lengths: Array = share @ length_m
    return lengths


def stride_error(length_m: Array, true_m: Array) -> float:
    """Compute `stride_error`: the mean absolute error per true length, which is positive, of at least one stride."""
    return float(np.mean(np.abs(length_m - true_m) / true_m))
