"""Cut accelerometer and gyroscope into windows in which both can be compared, and integrate the rotation of each.

See `pdr_est.io.conversion.gravity_drift` for what is compared. Constants are ours.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.recording import Signal

_WINDOW_S = 6.0
_HOP_S = 3.0
_PERIOD_S = 0.04  # of the means of samples that are rotated; a limb turns by less than half a radian meanwhile
_MOST_WINDOWS = 120  # spread over longer recordings
_LONGEST_PAUSE_S = 0.25
_STEADY_SIGMA_MPS2 = 0.3  # of a mean over two strides: slow accelerations, time stamps, drift
_MOTION_SHARE = 0.1  # of the motion in a window that is left in such a mean


@dataclass(frozen=True)
class GravityWindows:
    """Windows of synchronous samples of accelerometer and gyroscope.

    Attributes
    ----------
    start_s
        (k,) s, beginnings of the windows.
    force_mps2, rate_radps
        (k, n, 3) mean specific force and rotation rate of consecutive short intervals.
    period_s
        Length of these intervals.
    variance_m2ps4
        (k,) upper bound of the variance of each component of a mean over two strides, for the motion in the window.
    """

    start_s: Array
    force_mps2: Array
    rate_radps: Array
    period_s: float
    variance_m2ps4: Array

    def __len__(self) -> int:
        return len(self.start_s)

    @cached_property
    def turned(self) -> Array:
        """Return the rotations (k, n, 3, 3) of `turned_by` with the rates as they are."""
        return turned_by(self.rate_radps, self.period_s)


def gravity_windows(force: Signal, rate: Signal, lag_s: float = 0.0) -> GravityWindows | None:
    """Cut accelerometer and gyroscope into windows of 6 s without pauses.

    Parameters
    ----------
    force, rate
        (n, 3) specific force, m/s², and rotation rate, rad/s, with time stamps of their own.
    lag_s
        Time that is added to the time stamps of the gyroscope's samples.

    Returns
    -------
    GravityWindows or None
        None when the two never run together for the length of a window.
    """
    usable_force, usable_rate = _usable(force), _usable(rate)
    if len(usable_force) < 2 or len(usable_rate) < 2:
        return None
    begin_s = max(usable_force.time_s[0], usable_rate.time_s[0] + lag_s)
    end_s = min(usable_force.time_s[-1], usable_rate.time_s[-1] + lag_s)
    if not end_s - begin_s >= _WINDOW_S:
        return None
    count = int((end_s - begin_s - _WINDOW_S) / _HOP_S) + 1
    chosen = np.arange(count) if count <= _MOST_WINDOWS else np.linspace(0.0, count - 1.0, _MOST_WINDOWS).round()
    start_s = begin_s + _HOP_S * chosen
    edges_s = start_s[:, None] + np.arange(round(_WINDOW_S / _PERIOD_S) + 1) * _PERIOD_S
    force_mps2, whole = _Integral.of(_near(usable_force, edges_s)).means(edges_s)
    rate_radps, also_whole = _Integral.of(_near(usable_rate, edges_s - lag_s)).means(edges_s - lag_s)
    usable = whole & also_whole
    if not usable.any():
        return None
    force_mps2 = force_mps2[usable]
    motion = np.square(force_mps2 - force_mps2.mean(axis=1, keepdims=True)).sum(axis=2).mean(axis=1)
    return GravityWindows(
        start_s=start_s[usable],
        force_mps2=force_mps2,
        rate_radps=rate_radps[usable],
        period_s=_PERIOD_S,
        variance_m2ps4=_STEADY_SIGMA_MPS2**2 + _MOTION_SHARE**2 * motion,
    )


def _usable(signal: Signal) -> Signal:
    """Leave out the rows that are not finite or not later than those before."""
    time_s, values = signal.time_s, signal.values
    if (np.diff(time_s) > 0.0).all() and np.isfinite(np.einsum("ij->", values)) and np.isfinite(time_s[-1:]).all():
        return signal
    finite = np.isfinite(time_s) & np.isfinite(values).all(axis=1)
    time_s, values = time_s[finite], values[finite]
    if len(time_s) and (np.diff(time_s) <= 0.0).any():
        later = np.concatenate([[True], time_s[1:] > np.maximum.accumulate(time_s)[:-1]])
        time_s, values = time_s[later], values[later]
    return Signal(time_s, values)


def _near(signal: Signal, edges_s: Array) -> Signal:
    """Return the samples of a long recording that lie in windows with edges (k, n), and one on either side."""
    first = np.searchsorted(signal.time_s, edges_s[:, 0], side="right") - 1
    last = np.searchsorted(signal.time_s, edges_s[:, -1]) + 1
    near = np.zeros(len(signal) + 1, dtype=np.int64)
    np.add.at(near, first.clip(0), 1)
    np.add.at(near, last.clip(max=len(signal)), -1)
    inside = np.cumsum(near[:-1]) > 0
    return signal if inside.all() else Signal(signal.time_s[inside], signal.values[inside])


@dataclass(frozen=True)
class _Integral:
    """Integral of a signal over time, for means over intervals of any length."""

    time_s: Array
    integral: Array
    pauses: NDArray[np.int64]

    @classmethod
    def of(cls, signal: Signal) -> "_Integral":
        """Integrate by the trapezoidal rule."""
        time_s, values = signal.time_s, signal.values
        step_s = np.diff(time_s)
        areas = 0.5 * (values[1:] + values[:-1]) * step_s[:, None]
        longest_s = max(_LONGEST_PAUSE_S, 2.5 * float(np.median(step_s)))
        return cls(
            time_s,
            np.concatenate([np.zeros((1, 3)), np.cumsum(areas, axis=0)]),
            np.concatenate([[0], np.cumsum(step_s > longest_s)]),
        )

    def means(self, edges_s: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Return the means (k, n, 3) between edges (k, n + 1), and tell which windows (k,) have no pause."""
        at_edges = np.stack([np.interp(edges_s, self.time_s, column) for column in self.integral.T], axis=-1)
        last = len(self.time_s) - 1
        before = (np.searchsorted(self.time_s, edges_s[:, 0], side="right") - 1).clip(0, last)
        after = np.searchsorted(self.time_s, edges_s[:, -1]).clip(0, last)
        whole = self.pauses[before] == self.pauses[after]
        return np.diff(at_edges, axis=1) / (edges_s[0, 1] - edges_s[0, 0]), whole


def turned_by(rate_radps: Array, period_s: float) -> Array:
    """Integrate rotation rates (k, n, 3) over each window.

    Returns
    -------
    (k, n, 3, 3) array
        Rotations from the axes at the middle of each interval to those at the beginning of the window.
    """
    whole, half = _rotations(rate_radps * period_s), _rotations(rate_radps * (0.5 * period_s))
    before = np.empty((*rate_radps.shape, 3))
    sofar = np.broadcast_to(np.eye(3), (len(rate_radps), 3, 3))
    for j in range(rate_radps.shape[1]):
        before[:, j] = sofar
        sofar = sofar @ whole[:, j]
    turned: Array = before @ half
    return turned


def _rotations(vector: Array) -> Array:
    """Make the matrices (..., 3, 3) of rotation vectors (..., 3)."""
    angle = np.sqrt(np.square(vector).sum(axis=-1))
    safe = np.maximum(angle, 1e-9)
    first, second = np.sin(safe) / safe, 2.0 * np.square(np.sin(0.5 * safe) / safe)
    rotation = cross_matrices(first[..., None] * vector)
    rotation += (second[..., None] * vector)[..., :, None] * vector[..., None, :]
    rotation[..., range(3), range(3)] += (1.0 - second * np.square(vector).sum(axis=-1))[..., None]
    return rotation


def cross_matrices(vector: Array) -> Array:
    """Make the matrices (..., 3, 3) whose product with a vector is the cross product of vectors (..., 3) with it."""
    cross = np.zeros((*vector.shape, 3))
    cross[..., 2, 1], cross[..., 0, 2], cross[..., 1, 0] = (vector[..., k] for k in range(3))
    cross[..., 1, 2], cross[..., 2, 0], cross[..., 0, 1] = (-vector[..., k] for k in range(3))
    return cross
