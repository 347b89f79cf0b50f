"""Heights of all seconds under known modes, by a Kalman filter and a smoother."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.seconds import Second
from pdr_est.front_end.height.vertical_filter import Numbers, Passage, jump_variances_m2, passage

_BESIDE_S = 120  # seconds beside a move that tell its rise; the error wanders too much for more


def smoothed_heights(
    seconds: Sequence[Second], mode: Numbers, case: Numbers, sigma_m: float, parameters: HeightParams
) -> tuple[Array, Array]:
    """Estimate the height above that of the first second.

    Parameters
    ----------
    seconds
        The n seconds.
    mode, case
        (n,) their modes and the cases of the pressure.
    sigma_m
        Standard deviation of the noise of the height in a second, m.
    parameters
        Noise of the pressure.

    Returns
    -------
    height_m, variance_m2 : Array
        (n,) m and m²; the variance is that of the rises so far.
    """
    moving = np.flatnonzero(modes.is_moving(mode))
    height_m, variance_m2 = np.zeros(len(seconds)), np.zeros(len(seconds))
    known = np.flatnonzero(np.isfinite([one.height_m for one in seconds]))
    if not len(moving) or not len(known):
        return height_m, variance_m2
    first, last = max(int(moving[0]) - _BESIDE_S, int(known[0])), min(int(moving[-1]) + _BESIDE_S, len(seconds))
    within = slice(first, last)
    filtered = _filtered(seconds[within], mode[within].tolist(), case[within].tolist(), sigma_m**2, parameters)
    height_m[within], variance_m2[within] = _smoothed(filtered)
    height_m[last:], variance_m2[last:] = height_m[last - 1], variance_m2[last - 1]
    return height_m, variance_m2


class _FilteredSecond(NamedTuple):
    """Filter after a second, and how it came there.

    Attributes
    ----------
    change
        Change of the filter from the second before.
    innovation_m, spread_m2
        Measured height less the expected one, and the variance of that; infinite without a measurement.
    gain
        Gains of height, error and speed.
    height
        Height (m), and its covariances with itself, the error and the speed.
    """

    change: Passage
    innovation_m: float
    spread_m2: float
    gain: tuple[float, float, float]
    height: tuple[float, float, float, float]


def _filtered(
    seconds: Sequence[Second], mode: list[int], case: list[int], noise_m2: float, parameters: HeightParams
) -> list[_FilteredSecond]:
    """Filter height, error and vertical speed; plain numbers are faster here than arrays of three."""
    passages = {pair: passage(*pair) for pair in set(zip([modes.LEVEL, *mode], mode, strict=False))}
    jumps_m2, drift_m2 = jump_variances_m2(parameters).tolist(), parameters.drift_m_per_sqrt_s**2
    h, e, s, before = 0.0, seconds[0].height_m, 0.0, modes.LEVEL
    hh, he, hs, ee, es, ss = 0.0, 0.0, 0.0, noise_m2, 0.0, 0.0
    found = []
    for k, second in enumerate(seconds):
        change = passages[before, mode[k]]
        before = mode[k]
        if k:
            a, b, speed, variance = change
            h, s = h + a * s + 0.5 * speed, b * s + speed
            half = hs + a * ss
            hh, he = hh + a * (hs + half) + 0.25 * variance, he + a * es
            hs, es, ss = b * half + 0.5 * variance, b * es, b * b * ss + variance
            ee += drift_m2 + jumps_m2[case[k]]
        if not k or second.height_m != second.height_m:
            found.append(_FilteredSecond(change, 0.0, np.inf, (0.0, 0.0, 0.0), (h, hh, he, hs)))
            continue
        off, by_h, by_e, by_s = second.height_m - h - e, hh + he, he + ee, hs + es
        spread = by_h + by_e + noise_m2 + parameters.sigma_disturbed_m**2 * (before == modes.DISTURBED)
        kh, ke, ks = by_h / spread, by_e / spread, by_s / spread
        h, e, s = h + kh * off, e + ke * off, s + ks * off
        hh, he, hs = hh - kh * by_h, he - kh * by_e, hs - kh * by_s
        ee, es, ss = ee - ke * by_e, es - ke * by_s, ss - ks * by_s
        found.append(_FilteredSecond(change, off, spread, (kh, ke, ks), (h, hh, he, hs)))
    return found


def _smoothed(filtered: Sequence[_FilteredSecond]) -> tuple[Array, Array]:
    """Smooth the heights: means (n,) and variances (n,).

    The smoother of Bryson and Frazier carries back what later measurements say, without inverting a covariance: that
    of height and speed is singular on the level.
    """
    lh = le = ls = hh = he = hs = ee = es = ss = 0.0  # of the later measurements: gradient and curvature
    later = []
    for second in reversed(filtered):
        later.append((lh, le, ls, hh, he, hs, ee, es, ss))
        kh, ke, ks = second.gain
        spread = second.spread_m2
        down = kh * lh + ke * le + ks * ls + second.innovation_m / spread
        lh, le = lh - down, le - down
        uh, ue, us = hh * kh + he * ke + hs * ks, he * kh + ee * ke + es * ks, hs * kh + es * ke + ss * ks
        more = kh * uh + ke * ue + ks * us + 1.0 / spread
        hh, he, ee = hh - 2.0 * uh + more, he - uh - ue + more, ee - 2.0 * ue + more
        hs, es = hs - us, es - us
        a, b, _, _ = second.change
        ls = a * lh + b * ls
        ss = a * a * hh + 2.0 * a * b * hs + b * b * ss
        hs, es = a * hh + b * hs, a * he + b * es
    gradient = np.array(later[::-1])
    height_m, p_h, p_e, p_s = np.array([second.height for second in filtered]).T
    g_h, g_e, g_s, c_hh, c_he, c_hs, c_ee, c_es, c_ss = gradient.T
    curved = (
        p_h * (c_hh * p_h + 2.0 * (c_he * p_e + c_hs * p_s))
        + p_e * (c_ee * p_e + 2.0 * c_es * p_s)
        + c_ss * p_s * p_s
    )
    return height_m - (p_h * g_h + p_e * g_e + p_s * g_s), np.maximum(p_h - curved, 0.0)
