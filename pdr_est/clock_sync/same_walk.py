"""Probability that two recordings are of one walk, from whether steps and turns agree at any shift of the clocks.

Starts, stops and turns may be alike in two walks, along one corridor for example. Steps are not: over a minute the
step rhythms of two walkers, or of one walker on two days, drift apart at every shift. How far they agree by chance
depends on how steady they are: signals that repeat for long have few independent samples (Bartlett 1946). A
correlation counts by its likelihood in one walk over that by chance.
"""

from collections.abc import Sequence
from math import lgamma, log

import numpy as np
from numpy.typing import NDArray

from pdr_est.clock_sync.common_signals import RATE_HZ, CommonSignals
from pdr_est.clock_sync.robust_line import constant_offset_line
from pdr_est.clock_sync.step_duration import step_samples_in_window
from pdr_est.clock_sync.step_matching import without_alternation
from pdr_est.clock_sync.windows import comparison_windows, window_correlations

_WINDOW_S, _LEAST_S = 60.0, 25.0  # length and least length of long windows, in which rhythms drift apart
_SHORT_WINDOW_S, _LEAST_SHORT_S = 20.0, 15.0  # and of short ones, most of which a clock that jumps leaves whole
_SEARCH_S = 1.5  # about the shift that is known
_MOST_ALIKE = 0.985  # square of a correlation; no two places on a body feel steps more alike, ours
_WALKING = 0.5  # mean magnitude of the step phasor of a device that is walked with; ours

# Powers a of the density a x^(a - 1), and shares of windows with that density instead of chance, in one walk and in
# different walks. Fitted by maximum likelihood to windows of 25 to 60 s of WeAllWalk and, as more pairs of different
# walks, of OxIOD. Without one of the three walkers of WeAllWalk the powers are 12 to 23 and 6 to 12, the shares of
# steps 0.98 to 0.99 and 0.012 to 0.015, those of turns 0.69 to 0.77 and 0.03 to 0.12. Only the share of windows in
# which one walk turns is not the fitted one: the walkers of WeAllWalk follow corridors with corners, those on the
# treadmills of DSADS, with 0.72 refused in 3 % of windows of 30 s, do not.
_STEP_POWER, _STEPS_IN_ONE_WALK, _STEPS_IN_DIFFERENT_WALKS = 12.0, 0.985, 0.013
_TURN_POWER, _TURNS_IN_ONE_WALK, _TURNS_IN_DIFFERENT_WALKS = 7.0, 0.5, 0.04
# Probability that a walk is one in all windows; else in an unknown share of them: a clock jumps, a device is laid
# aside. Ours.
_THROUGHOUT = 0.9
_SHARES = (np.arange(20) + 0.5) / 20.0


def same_walk_log_odds(one: CommonSignals, two: CommonSignals, shifts_s: Sequence[float]) -> float | None:
    """Compute the log-odds that two devices recorded one walk, with equal odds before.

    Parameters
    ----------
    one, two
        Signals of the reference device and of the other one.
    shifts_s
        Differences of the clocks, s; the best of those within 1.5 s of each counts.

    Returns
    -------
    float or None
        Logarithm of the odds at the best shift, the mean odds of long and of short windows; None when both devices
        were never walked with for at least 25 s.
    """
    found = []
    for shift_s in shifts_s:
        in_long = _log_odds_in_windows(one, two, shift_s, _WINDOW_S, _LEAST_S)
        if in_long is not None:
            in_short = _log_odds_in_windows(one, two, shift_s, _SHORT_WINDOW_S, _LEAST_SHORT_S)
            found.append(in_long if in_short is None else float(np.logaddexp(in_long, in_short)) - log(2.0))
    return max(found, default=None)


def _log_odds_in_windows(
    one: CommonSignals, two: CommonSignals, shift_s: float, window_s: float, least_s: float
) -> float | None:
    """Compute the log-odds from windows of one length; None when nobody walks in any of them."""
    windows = comparison_windows(one, two, constant_offset_line(shift_s), window_s, 0.0, least_s)
    log_odds = [_window_log_odds(one, two, rows, shift_s) for rows in windows if _walked(one, two, rows, shift_s)]
    return _log_odds_of_all(np.array(log_odds)) if log_odds else None


def _walked(one: CommonSignals, two: CommonSignals, rows: NDArray[np.int64], shift_s: float) -> bool:
    there = np.interp(one.time_s[rows] + shift_s, two.time_s, np.abs(two.step_phasor))
    return min(float(np.abs(one.step_phasor[rows]).mean()), float(there.mean())) > _WALKING


def _window_log_odds(one: CommonSignals, two: CommonSignals, rows: NDArray[np.int64], shift_s: float) -> float:
    """Compute the log-odds from one window: from the best step correlation, and the turns at the same shift."""
    step = step_samples_in_window(one, two, rows, shift_s)
    reach, start_s = round(_SEARCH_S * RATE_HZ), one.time_s[rows[0]]
    here = without_alternation(one, one.step_phasor, start_s, len(rows), step)
    start_there_s = start_s + shift_s - reach / RATE_HZ
    there = without_alternation(two, two.step_phasor, start_there_s, len(rows) + 2 * reach, step)
    correlations = window_correlations(here, there)
    best = int(np.argmax(correlations))
    independent = _independent_samples(here, there[best : best + len(rows)])
    log_odds = _step_log_odds(float(correlations[best]), independent)
    if one.turn_rate_radps is not None and two.turn_rate_radps is not None:
        turns = one.turn_rate_radps[rows]
        time_s = start_there_s + (best + np.arange(len(rows))) / RATE_HZ
        other_turns = np.interp(time_s, two.time_s, two.turn_rate_radps)
        correlation = float(window_correlations(turns, other_turns)[0])
        log_odds += _turn_log_odds(correlation, _independent_samples(turns, other_turns))
    return log_odds


def _independent_samples(one: NDArray[np.inexact], two: NDArray[np.inexact]) -> float:
    """Compute how many independent pairs of samples have a correlation as variable as that of two signals (n,).

    That variance, of the correlation by chance, is the sum over all lags of the product of the two autocorrelations,
    over n (Bartlett 1946), computed as the mean of the product of the power spectra.
    """
    size = 1 << (2 * len(one) - 1).bit_length()
    powers = [np.abs(np.fft.fft(signal - signal.mean(), size)) ** 2 for signal in (one, two)]
    product = float(powers[0].mean() * powers[1].mean())
    return len(one) * product / max(float((powers[0] * powers[1]).mean()), 1e-12 * product, 1e-300)


def _step_log_odds(correlation: float, independent: float) -> float:
    """Compute the log-odds from the step correlation r, whose square x has the density a x^(a - 1) in one walk.

    By chance r^2 of n independent complex samples exceeds x with probability p = (1 - x)^(n - 1). The odds are at
    most 1 / p.
    """
    x = min(max(correlation, 1e-3) ** 2, _MOST_ALIKE)
    n = max(independent, 1.01)
    by_chance = log(n - 1.0) + (n - 2.0) * log(1.0 - x)
    log_odds = _mixed(_power_law(x, _STEP_POWER), by_chance, _STEPS_IN_ONE_WALK, _STEPS_IN_DIFFERENT_WALKS)
    return min(log_odds, (1.0 - n) * log(1.0 - x))


def _turn_log_odds(correlation: float, independent: float) -> float:
    """Compute the log-odds from the correlation r of turns: (1 + r) / 2 has a beta distribution by chance."""
    x = min(max(0.5 + 0.5 * correlation, 1e-4), 1.0 - 1e-4)
    half = max(0.5 * independent - 1.0, 0.5)
    by_chance = (half - 1.0) * log(x * (1.0 - x)) + lgamma(2.0 * half) - 2.0 * lgamma(half)
    return _mixed(_power_law(x, _TURN_POWER), by_chance, _TURNS_IN_ONE_WALK, _TURNS_IN_DIFFERENT_WALKS)


def _power_law(x: float, power: float) -> float:
    return log(power) + (power - 1.0) * log(x)


def _mixed(alike: float, by_chance: float, share_in_one_walk: float, share_in_different_walks: float) -> float:
    """Compute the log ratio of two mixtures of the same log densities."""
    one, different = (
        float(np.logaddexp(np.log(share) + alike, np.log1p(-share) + by_chance))
        for share in (share_in_one_walk, share_in_different_walks)
    )
    return one - different


def _log_odds_of_all(log_odds: NDArray[np.float64]) -> float:
    """Combine the log-odds (n,) of windows: one walk in all of them or, less likely, in any share of them."""
    in_share = np.logaddexp(np.log(_SHARES) + log_odds[:, None], np.log1p(-_SHARES)).sum(axis=0)
    partly = float(np.logaddexp.reduce(in_share)) - log(len(_SHARES))
    return float(np.logaddexp(log(_THROUGHOUT) + float(log_odds.sum()), log(1.0 - _THROUGHOUT) + partly))
