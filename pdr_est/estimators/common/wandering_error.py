"""The wandering error of a source of fixes, whose standard deviation changes with the accuracy that it states."""

from collections.abc import Sequence
from math import exp, sqrt

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix


def wander_to(fix: PositionFix, sigma_before_m: float, elapsed_s: float) -> tuple[float, float]:
    """Return how the wandering error at a fix follows from the one at the fix before of its source.

    The error is a Gauss-Markov process in metres. When the source states less accuracy, an error of its own joins it;
    when it states more, the error does not shrink at once but fades with its correlation time. Otherwise a change of
    what is stated would reveal the error.

    Parameters
    ----------
    fix
        The fix.
    sigma_before_m
        Standard deviation of the error at the fix before, m.
    elapsed_s
        Time since then, s.

    Returns
    -------
    correlation
        Correlation with the error at the fix before.
    sigma_m
        Standard deviation of the error at the fix, m, at least `fix.sigma_wander_m`.
    """
    decay = exp(-max(elapsed_s, 0.0) / fix.wander_time_s)
    kept_m, stated_m2 = decay * sigma_before_m, fix.sigma_wander_m**2
    sigma_m = sqrt(max(stated_m2, kept_m**2 + (1.0 - decay**2) * stated_m2))
    return (kept_m / sigma_m if sigma_m > 0.0 else 0.0), sigma_m


def wander_chain(fixes: Sequence[PositionFix]) -> tuple[Array, Array]:
    """Return correlations (n,) and standard deviations (n,) of `wander_to` for fixes of one source in order of time.

    The first correlation is 0.
    """
    correlation, sigma_m = np.zeros(len(fixes)), np.zeros(len(fixes))
    for i, fix in enumerate(fixes):
        if i == 0:
            sigma_m[i] = fix.sigma_wander_m
        else:
            elapsed_s = fix.time_s - fixes[i - 1].time_s
            correlation[i], sigma_m[i] = wander_to(fix, float(sigma_m[i - 1]), elapsed_s)
    return correlation, sigma_m
