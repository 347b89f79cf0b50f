"""Whether two recordings are of one walk at all: then their steps fall together somewhere.

Starts, stops and turns may be alike in two walks, along one corridor say. Steps are not: over a minute of them the
rhythms of two walkers, or of one walker on two days, lose each other, wherever one is shifted to.
"""

from collections.abc import Sequence

import numpy as np

from pdr_est.clock_sync.common_signals import CommonSignals
from pdr_est.clock_sync.robust_line import level_line, stretches
from pdr_est.clock_sync.step_matching import same_step

# All ours. Of WeAllWalk's 18 walks the best minute of a true pair agrees by 0.81 at least, that of two people on one
# route by 0.43 at most (36 pairs), on different ones by 0.44 (60 pairs); of simulated walks of 30 to 90 s, pockets
# and hands, by 0.82 and 0.16, of slow ones with 24 samples a second in two pockets (40 trials of Robust DR) by 0.59
# and 0.34.
LEAST_AGREEMENT = 0.5
_WINDOW_S = 60.0
_LEAST_S = 25.0  # shorter stretches of strangers agree by chance
_BEAT = 0.5  # mean size of the beat of a device that is walked with


def best_minute(one: CommonSignals, two: CommonSignals, shifts_s: Sequence[float]) -> float | None:
    """The best agreement of the steps, at most 1, in any minute in which both devices were walked with, near any of
    some shifts of the clocks. None without such a minute, for then nothing is known."""
    found = []
    for shift_s in shifts_s:
        for rows in stretches(one, two, level_line(shift_s), _WINDOW_S, 0.0, _LEAST_S):
            there = np.interp(one.time_s[rows] + shift_s, two.time_s, np.abs(two.beat))
            if min(float(np.abs(one.beat[rows]).mean()), float(there.mean())) > _BEAT:
                found.append(same_step(one, two, rows, shift_s).agreement)
    return max(found, default=None)
