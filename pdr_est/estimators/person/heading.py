"""The heading of a person from those of the devices on the body.

Two things of it are ours. The weights of the devices are the same through the walk. With weights from the variance of
each moment, the first device would have all the say at the start, where its direction defines the frame and is known
exactly, and share it at the end: by how much the others set off in another direction would become a turn that no
device saw. And the person's direction is that of a few strides: hips and phones turn to and fro with the legs, and a
walk sets off and ends with steps that are not yet like the others. Walkers who turn are not averaged.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array, wrap_angle
from pdr_est.types.track import Track

_BEND_RAD = 0.26  # a range of the headings beyond which the walker turns, as within a stride in the front end
_HALF_WINDOWS = (4, 2)  # steps to either side: four strides, or two, whichever is without a bend first
LEAST_VARIANCE = 1e-8  # keeps what is known exactly invertible


def heading_of_person(tracks: Sequence[Track], time_s: Array, present: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Heading, rad, not wrapped, and its variance (n,) at the start of a walk and the ends of its steps, time_s (n,).

    present: (d, n) which of the tracks, each of one device, have a say when. The variance is true for any dependence
    between devices and between steps.
    """
    return over_strides(*_of_devices(tracks, time_s, present))


def over_strides(heading_rad: Array, variance: Array) -> tuple[Array, Array]:
    """Headings (n,), not wrapped, at the start and at the ends of steps, averaged over whole strides, with variances.

    The outer steps weigh half, so that what changes from one step to the next cancels. The first and the last steps
    get the mean of the first and the last strides. What the averaged headings vary by is part of the variance. Where
    there is a bend in every window, and at a start in a known direction, the heading stays as it is.
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
        straight = undecided & (np.maximum(ranges, np.abs(heading_rad - means)) < _BEND_RAD)
        mean[straight], spread[straight] = means[straight], spreads[straight]
        undecided &= ~straight
    return mean, spread


def _windows(heading_rad: Array, variance: Array, width: int) -> tuple[Array, Array, Array]:
    """Mean, variance and range of the headings (n,) in every window of that many steps, (n - width + 1,) each."""
    weights = np.ones(width)
    weights[[0, -1]] = 0.5
    weights /= weights.sum()
    headings = np.lib.stride_tricks.sliding_window_view(heading_rad, width)
    mean = headings @ weights
    within = np.lib.stride_tricks.sliding_window_view(variance, width) @ weights
    return mean, within + np.square(headings - mean[:, None]) @ weights, np.ptp(headings, axis=1)


def _of_devices(tracks: Sequence[Track], time_s: Array, present: NDArray[np.bool_]) -> tuple[Array, Array]:
    """The mean of the devices' headings, each unwrapped beside the first, and its variance.

    This is covariance intersection (Julier and Uhlmann 1997) whose weights are those that give the device k the say
    s_k at all times: the mean is sum s_k h_k, the variance sum s_k v_k. The say goes by the mean variance, so that a
    device that loses its direction on the way has little of it from the beginning.
    """
    headings: list[Array] = []
    variances: list[Array] = []
    for one in tracks:
        own = np.interp(time_s, one.time_s, np.unwrap(one.heading_rad))
        headings.append(own if not headings else np.asarray(headings[0] + wrap_angle(own - headings[0])))
        variances.append(np.interp(time_s, one.time_s, np.square(one.sigma_heading_rad)))
    variance = np.stack(variances)
    usual = np.sum(variance * present, axis=1) / np.maximum(present.sum(axis=1), 1)
    say = present / (usual + LEAST_VARIANCE)[:, None]
    say /= say.sum(axis=0)
    return np.unwrap(np.sum(say * np.stack(headings), axis=0)), np.sum(say * variance, axis=0)
