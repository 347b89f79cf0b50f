"""Wandering errors of the sources of fixes as states of a filter."""

from dataclasses import replace

import numpy as np

from pdr_est.estimators.common.motion_model import STATES, GaussianState, SourceState
from pdr_est.estimators.common.wandering_error import wander_to
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix


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
    now = SourceState(
        fix.source,
        max(fix.time_s, earlier.time_s),
        sigma_m,
        fix.wander_time_s,
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


def with_jump(sources: tuple[SourceState, ...], name: str, variance: float) -> tuple[SourceState, ...]:
    """Return the sources after a jump of the error of one of them, by which its variance grew."""
    return tuple(
        replace(source, jump_variance=source.jump_variance + variance) if source.name == name else source
        for source in sources
    )
