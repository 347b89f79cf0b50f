"""Fuse the headings of the devices on a body into the heading of the person.

Two choices are ours. First, the weights of the devices are constant over the walk. With weights from the variance at
each time, the first device would have all the weight at the start, where its heading defines the frame and is known
exactly, and only part of it at the end: a constant offset between the devices would become a turn that no device
measured. Second, the heading of the person is averaged over a few strides, because hips and phones sway with the
legs, and the first and last steps of a walk differ from the others. Headings are not averaged over turns.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array, wrap_angle
from pdr_est.types.track import Track

_TURN_RAD = 0.26  # range of headings above which the walker turns; the front end uses the same within a stride
_HALF_WINDOWS = (4, 2)  # steps to either side: four strides, or two, the first one without a turn
LEAST_VARIANCE = 1e-8  # rad^2 or m^2; keeps exactly known values invertible


def heading_of_person(tracks: Sequence[Track], time_s: Array, present: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Fuse the headings of the devices at the start of a walk and the ends of its steps.

    Parameters
    ----------
    tracks
        Tracks of the d devices.
    time_s
        Start of the walk and ends of its steps, (n,), s.
    present
        True where a device takes part, (d, n).

    Returns
    -------
    heading_rad : Array
        Unwrapped heading of the person, (n,), rad.
    variance_rad2 : Array
        Its variance, (n,), rad^2, which is consistent for any correlation between devices and between steps.
    """
    return over_strides(*_of_devices(tracks, time_s, present))


def over_strides(heading_rad: Array, variance: Array) -> tuple[Array, Array]:
    """Average headings over whole strides, except in turns.

    The outer steps of a window have half the weight, so that alternating left and right deviations cancel. The first
    and last steps get the mean of the first and last strides. The spread of the averaged headings is added to the
    variance. If every window contains a turn, and at a start with known heading, the heading is not changed.

    Parameters
    ----------
    heading_rad
        Unwrapped headings at the start and at the ends of steps, (n,), rad.
    variance
        Their variances, (n,), rad^2.

    Returns
    -------
    heading_rad : Array
        Averaged headings, (n,), rad.
    variance : Array
        Their variances, (n,), rad^2.
    """
    mean, spread = heading_rad.copy(), variance.copy()
    undecided = np.ones(len(heading_rad), dtype=np.bool_)
    undecided[0] = variance[0] > LEAST_VARIANCE
    for half in _HALF_WINDOWS:
        width = 2 * half + 1
        if len(heading_rad) < width + 1:  # the start is no step
            continue
        nearest = np.clip(np.arange(len(heading_rad)) - 1 - half, 0, len(heading_rad) - 1 - width)
        means, spreads, ranges = (part[nearest] for part in _windows(heading_rad[1:], variance[1:], width))
        straight = undecided & (np.maximum(ranges, np.abs(heading_rad - means)) < _TURN_RAD)
        mean[straight], spread[straight] = means[straight], spreads[straight]
        undecided &= ~straight
    return mean, spread


def _windows(heading_rad: Array, variance: Array, width: int) -> tuple[Array, Array, Array]:
    """Compute mean, variance and range of the headings in every window of `width` steps, (n - width + 1,) each."""
    weights = np.ones(width)
    weights[[0, -1]] = 0.5
    weights /= weights.sum()
    headings = np.lib.stride_tricks.sliding_window_view(heading_rad, width)
    mean = headings @ weights
    within = np.lib.stride_tricks.sliding_window_view(variance, width) @ weights
    return mean, within + np.square(headings - mean[:, None]) @ weights, np.ptp(headings, axis=1)


def intersected_headings(headings_rad: Array, variances: Array, present: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Compute the weighted mean of the devices' headings, each counted from the first one, and its variance.

    This is covariance intersection (Julier and Uhlmann 1997) with weights w_k of device k that are constant in time:
    the mean is sum w_k h_k, the variance sum w_k v_k. Weights are inverse to the mean variance, so that a device that
    loses its heading during the walk has a small weight from the beginning.

    Parameters
    ----------
    headings_rad
        Heading of each of d devices at n times, (d, n), rad; the rows may differ by whole turns.
    variances
        Their variances, (d, n), rad^2.
    present
        True where a device takes part, (d, n).

    Returns
    -------
    heading_rad : Array
        Mean heading (n,), rad, beside that of the first device.
    variance_rad2 : Array
        Its variance, (n,), rad^2.
    """
    beside = headings_rad.copy()
    beside[1:] = headings_rad[0] + wrap_angle(headings_rad[1:] - headings_rad[0])
    usual = np.sum(variances * present, axis=1) / np.maximum(present.sum(axis=1), 1)
    weights = present / (usual + LEAST_VARIANCE)[:, None]
    weights /= weights.sum(axis=0)
    return np.sum(weights * beside, axis=0), np.sum(weights * variances, axis=0)


def _of_devices(tracks: Sequence[Track], time_s: Array, present: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Fuse the headings of the devices at each time, and unwrap them."""
    headings = np.stack([np.interp(time_s, one.time_s, np.unwrap(one.heading_rad)) for one in tracks])
    variances = np.stack([np.interp(time_s, one.time_s, np.square(one.sigma_heading_rad)) for one in tracks])
    heading, variance = intersected_headings(headings, variances, present)
    return np.unwrap(heading), variance
