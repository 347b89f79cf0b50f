"""Errors that the fixes of a source have in common, as states of a filter.

A source has three states from its first fix on. The first two hold the wandering error of sources that have one.
Those of other sources are zero as long as the fixes are as good as stated; if they are not, successive fixes err
alike: the point on the map was mistaken, the signals are reflected. The third one is the correction of its clock
(`source_clock`).
"""

from dataclasses import replace
from math import exp, sqrt

import numpy as np

from pdr_est.estimators.common.motion_model import SOURCE_STATES, STATES, GaussianState, SourceState
from pdr_est.estimators.common.wandering_error import wander_to
from pdr_est.estimators.kalman.source_clock import CLOCK_WRONG_PRIOR, clock_variance
from pdr_est.frames import Array
from pdr_est.types.measurements import START_SOURCE, PositionFix

_COMMON_TIME_S = 15.0  # correlation time of the common error of a source that states none: that of GPS; ours


def place_of_source(sources: tuple[SourceState, ...], devices: int, fix: PositionFix) -> int | None:
    """Return the row of the first of the three states of a fix's source; None for the end of a closed walk."""
    if fix.source == START_SOURCE:
        return None
    return STATES * devices + SOURCE_STATES * [source.name for source in sources].index(fix.source)


def fix_rows(state: GaussianState, devices: int, fix: PositionFix, device: int = 0) -> Array:
    """Return the Jacobian (2, n) of a fix of a device: of its position, and of the common error of its source.

    That of the clock of the source is left at zero.
    """
    rows = np.zeros((2, state.mean.shape[-1]))
    rows[:, STATES * device : STATES * device + 2] = np.eye(2)
    wander = place_of_source(state.sources, devices, fix)
    if wander is not None:
        rows[:, wander : wander + 2] = state.sources[(wander - STATES * devices) // SOURCE_STATES].sigma_m * np.eye(2)
    return rows


def source_prior(source: SourceState) -> Array:
    """Return the prior covariance (3, 3) of the states of a source."""
    return np.diag([source.usual_variance, source.usual_variance, clock_variance(source.clock_wrong)])


def with_source_at(state: GaussianState, devices: int, fix: PositionFix) -> GaussianState:
    """Predict the common error of a fix's source to the time of the fix; add the error if it is new.

    Parameters
    ----------
    state
        State of all devices, or k of them with mean (k, n) and covariance (k, n, n).
    devices
        Their number.
    fix
        The fix.
    """
    number = next((i for i, source in enumerate(state.sources) if source.name == fix.source), None)
    usual = float(fix.sigma_wander_m > 0.0)
    time_s = fix.wander_time_s if usual else _COMMON_TIME_S
    sigma_m = fix.sigma_wander_m if usual else sqrt(float(np.trace(fix.covariance_m2)) / 2.0)
    if number is None:
        size = state.mean.shape[-1]
        wrong = 0.0 if fix.clock_known else CLOCK_WRONG_PRIOR
        added = SourceState(fix.source, fix.time_s, sigma_m, time_s, usual_variance=usual, clock_wrong=wrong)
        mean = np.zeros((*state.mean.shape[:-1], size + SOURCE_STATES))
        covariance = np.zeros((*mean.shape, size + SOURCE_STATES))
        mean[..., :size], covariance[..., :size, :size] = state.mean, state.covariance
        covariance[..., size:, size:] = source_prior(added)
        return replace(state, mean=mean, covariance=covariance, sources=(*state.sources, added))
    earlier = state.sources[number]
    elapsed_s = max(fix.time_s - earlier.time_s, 0.0)
    if usual:
        correlation, sigma_m = wander_to(fix, earlier.sigma_m, elapsed_s)
    else:
        correlation = exp(-elapsed_s / time_s) * earlier.sigma_m / sigma_m
    now = SourceState(
        fix.source,
        max(fix.time_s, earlier.time_s),
        sigma_m,
        time_s,
        earlier.jump_variance,
        usual,
        earlier.clock_wrong,
    )
    sources = (*state.sources[:number], now, *state.sources[number + 1 :])
    if correlation == 1.0:
        return replace(state, sources=sources)
    first = STATES * devices + SOURCE_STATES * number
    own = slice(first, first + 2)
    mean, covariance = state.mean.copy(), state.covariance.copy()
    mean[..., own] *= correlation
    covariance[..., own, :] *= correlation
    covariance[..., :, own] *= correlation
    covariance[..., own, own] += (1.0 - correlation**2) * usual * np.eye(2)
    return replace(state, mean=mean, covariance=covariance, sources=sources)


def with_jump(sources: tuple[SourceState, ...], name: str, variance: float) -> tuple[SourceState, ...]:
    """Return the sources after a jump of the error of one of them, by which its variance grew."""
    return tuple(
        replace(source, jump_variance=source.jump_variance + variance) if source.name == name else source
        for source in sources
    )


def wandering_part(state: GaussianState, devices: int) -> GaussianState:
    """Return a state of all devices without clocks, and with the errors of those sources only whose error wanders.

    Two states are left of each of these sources. The others are marginalised.
    """
    kept = [i for i, source in enumerate(state.sources) if source.usual_variance > 0.0]
    firsts = [STATES * devices + SOURCE_STATES * i for i in kept]
    rows = [*range(STATES * devices), *(first + axis for first in firsts for axis in (0, 1))]
    sources = tuple(state.sources[i] for i in kept)
    return replace(state, mean=state.mean[rows], covariance=state.covariance[np.ix_(rows, rows)], sources=sources)
