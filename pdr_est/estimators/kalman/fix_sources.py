"""Wandering errors of the sources of fixes as states of a filter, and the trust that a source has earned.

A source whose latest fixes scatter more than they should, by their innovations, is weighed down as a whole: a stretch
of bad positions has one cause. The variance has an inverse gamma prior about the stated one, and forgets.
"""

from dataclasses import replace
from math import exp

import numpy as np

from pdr_est.estimators.common.motion_model import STATES, GaussianState, SourceState
from pdr_est.estimators.common.wandering_error import wander_to
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix

_PRIOR_COUNT = 8.0  # coordinates that the prior of the variance is worth; ours
_MEMORY_S = 10.0  # time in which the count of a coordinate falls to 37 %; ours
_DEGREES_OF_FREEDOM = 10.0  # ours
_IMPROBABLE = 13.8  # squared normalised error in two dimensions with a probability of 0.001


def place_of_source(sources: tuple[SourceState, ...], devices: int, fix: PositionFix) -> int | None:
    """Return the row of the first of the two states of a fix's wandering error; None for a fix without one."""
    if fix.sigma_wander_m <= 0.0:
        return None
    return STATES * devices + 2 * [source.name for source in sources].index(fix.source)


def fix_rows(state: GaussianState, devices: int, fix: PositionFix, device: int = 0) -> Array:
    """Return the Jacobian (2, n) of a fix of a device: of its position, and of the wandering error if it has one."""
    rows = np.zeros((2, len(state.mean)))
    rows[:, STATES * device : STATES * device + 2] = np.eye(2)
    wander = place_of_source(state.sources, devices, fix)
    if wander is not None:
        rows[:, wander : wander + 2] = state.sources[(wander - STATES * devices) // 2].sigma_m * np.eye(2)
    return rows


def with_source_at(state: GaussianState, devices: int, fix: PositionFix) -> GaussianState:
    """Predict the wandering error of a fix's source to the time of the fix; add the error if it is new.

    Parameters
    ----------
    state
        State of all devices.
    devices
        Their number.
    fix
        Fix of a source whose error wanders.
    """
    number = next((i for i, source in enumerate(state.sources) if source.name == fix.source), None)
    if number is None:
        size = len(state.mean)
        covariance = np.eye(size + 2)
        covariance[:size, :size] = state.covariance
        added = SourceState(fix.source, fix.time_s, fix.sigma_wander_m, fix.wander_time_s)
        return GaussianState(np.append(state.mean, [0.0, 0.0]), covariance, (*state.sources, added), state.trusts)
    earlier = state.sources[number]
    elapsed_s = max(fix.time_s - earlier.time_s, 0.0)
    correlation, sigma_m = wander_to(fix, earlier.sigma_m, elapsed_s)
    kept = exp(-elapsed_s / _MEMORY_S)
    now = SourceState(
        fix.source,
        max(fix.time_s, earlier.time_s),
        sigma_m,
        fix.wander_time_s,
        misfit=kept * earlier.misfit,
        count=kept * earlier.count,
        jump_variance=earlier.jump_variance,
    )
    sources = (*state.sources[:number], now, *state.sources[number + 1 :])
    if correlation == 1.0:
        return replace(state, sources=sources)
    first = STATES * devices + 2 * number
    own = slice(first, first + 2)
    mean, covariance = state.mean.copy(), state.covariance.copy()
    mean[own] *= correlation
    covariance[own] *= correlation
    covariance[:, own] *= correlation
    covariance[own, own] += (1.0 - correlation**2) * np.eye(2)
    return GaussianState(mean, covariance, sources, state.trusts)


def variance_factor(source: SourceState, squared_distance: float) -> tuple[float, SourceState]:
    """Return the factor on the variances of a fix, at least 1, and what is known of its source after it.

    Parameters
    ----------
    source
        What was known at the time of the fix, before it.
    squared_distance
        Squared normalised innovation of the fix, 2 on average for the stated variances.
    """
    misfit, count = source.misfit + squared_distance, source.count + 2.0
    factor = max((_PRIOR_COUNT + misfit) / (_PRIOR_COUNT + count), 1.0)
    return factor, replace(source, misfit=misfit, count=count, jump_variance=source.jump_variance + factor - 1.0)


def contradiction_factor(squared_distance: float) -> float:
    """Return the factor on the variances of position and fix where the two contradict each other, at least 1.

    It is that of a multivariate Student's t distribution, and begins where a Gaussian error is as large once in a
    thousand times. Either may be wrong; the position goes as far towards the fix as it would, but nothing is learnt
    of the other states, and the covariance tells the doubt.

    References
    ----------
    M. Roth, E. Özkan, F. Gustafsson, "A Student's t filter for heavy tailed process and measurement noise", ICASSP
    2013.
    """
    return max((_DEGREES_OF_FREEDOM + squared_distance) / (_DEGREES_OF_FREEDOM + _IMPROBABLE), 1.0)
