"""Check whether two recordings are of one walk, by whether their steps coincide at any shift of the clocks.

Starts, stops and turns may be alike in two walks, along one corridor for example. Steps are not: over a minute the
step rhythms of two walkers, or of one walker on two days, drift apart at every shift.
"""

from collections.abc import Sequence

import numpy as np

from pdr_est.clock_sync.common_signals import CommonSignals
from pdr_est.clock_sync.robust_line import constant_offset_line
from pdr_est.clock_sync.step_matching import match_steps
from pdr_est.clock_sync.windows import comparison_windows

MIN_STEP_AGREEMENT = 0.5
"""Least agreement of the steps of one walk, ours.

In WeAllWalk (18 walks) the best minute of a true pair agrees by at least 0.81, that of two people on one route by at
most 0.43 (36 pairs), on different routes by at most 0.44 (60 pairs). Simulated walks of 30 to 90 s in pockets and
hands: 0.82 and 0.16. Slow walks with 24 samples a second in two pockets (40 trials of Robust DR): 0.59 and 0.34.
"""

_WINDOW_S = 60.0
_LEAST_S = 25.0  # shorter windows of different walks agree by chance
_WALKING = 0.5  # mean magnitude of the step phasor of a device that is walked with


def best_step_agreement(one: CommonSignals, two: CommonSignals, shifts_s: Sequence[float]) -> float | None:
    """Find the best agreement of the steps over all minutes in which both devices were walked with.

    Parameters
    ----------
    one, two
        Signals of the reference device and of the other one.
    shifts_s
        Differences of the clocks, s, near which agreement is searched.

    Returns
    -------
    float or None
        Correlation of the step phasors, at most 1; None when there is no such minute.
    """
    agreements = []
    for shift_s in shifts_s:
        for rows in comparison_windows(one, two, constant_offset_line(shift_s), _WINDOW_S, 0.0, _LEAST_S):
            there = np.interp(one.time_s[rows] + shift_s, two.time_s, np.abs(two.step_phasor))
            if min(float(np.abs(one.step_phasor[rows]).mean()), float(there.mean())) > _WALKING:
                agreements.append(match_steps(one, two, rows, shift_s).agreement)
    return max(agreements, default=None)
