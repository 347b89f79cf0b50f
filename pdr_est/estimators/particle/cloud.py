"""Weighted particles of a walk, with the state of every device of the walker, and how they are resampled.

A particle is one column of an array. Each device has eight rows: east m, north m, heading rad, logarithm of the
length scale, mean and variance of the direction that relative headings count from, and east and north of where it
began, to which closed walks return. That direction is not sampled: given the headings of a particle it is Gaussian,
and each particle carries its Kalman filter (Rao-Blackwellisation). The same holds for the wandering error of a source
of fixes given the positions: two rows for its mean in metres, while its variance is common to all particles. Three
further rows say how the floor plan is displaced; they are 0 for a plan that is as drawn, and without a plan.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array

DEVICE_ROWS = 8
"""Number of rows of a device."""

PLAN_ROWS = 3
"""Number of rows of the displacement of the floor plan, which come after those of the devices."""

_GROUP = 25  # columns whose weights are added up before one of them is drawn

EAST, NORTH, HEADING, LOG_SCALE, REFERENCE, REFERENCE_VARIANCE, START_EAST, START_NORTH = range(DEVICE_ROWS)


@dataclass(frozen=True)
class WanderingSource:
    """Wandering error of a source of fixes: its time, and its variance in each coordinate, m²."""

    name: str
    device: int
    time_s: float
    sigma_m: float
    covariance_m2: Array


@dataclass(frozen=True)
class Cloud:
    """Weighted particles.

    Attributes
    ----------
    state
        (rows, n) states.
    log_weight
        (n,) logarithms of the weights, up to a constant.
    sources
        Sources of fixes with wandering errors, whose means are the last rows.
    devices
        Number of devices.
    """

    state: Array
    log_weight: Array
    devices: int
    sources: tuple[WanderingSource, ...] = field(default=())

    def __len__(self) -> int:
        return int(self.state.shape[1])

    def device(self, number: int) -> Array:
        """Return a view of the rows (8, n) of a device."""
        return self.state[DEVICE_ROWS * number : DEVICE_ROWS * (number + 1)]

    @property
    def displacement(self) -> Array:
        """View of the displacements (3, n) of the floor plan: shift to the east and north, m, and stretch."""
        return self.state[DEVICE_ROWS * self.devices :][:PLAN_ROWS]

    def with_state(self, state: Array) -> "Cloud":
        """Return a cloud with these states (rows, n) and the same weights; faster than `dataclasses.replace`."""
        return Cloud(state, self.log_weight, self.devices, self.sources)

    def with_log_weight(self, log_weight: Array) -> "Cloud":
        """Return a cloud with these logarithms (n,) of the weights and the same states."""
        return Cloud(self.state, log_weight, self.devices, self.sources)

    def source_rows(self, number: int) -> slice:
        """Return the rows of the mean error of a source."""
        begin = DEVICE_ROWS * self.devices + PLAN_ROWS + 2 * number
        return slice(begin, begin + 2)

    @property
    def weights(self) -> Array:
        """Weights (n,), which add up to 1."""
        weights = np.exp(self.log_weight - self.log_weight.max())
        return np.asarray(weights / weights.sum())


def effective(weights: Array) -> float:
    """Return the effective number of particles with these weights (n,), which add up to 1."""
    return 1.0 / float(weights @ weights)


def systematic(weights: Array, count: int, uniform: float) -> NDArray[np.int64]:
    """Return the indices (count,) of particles that systematic resampling takes.

    Parameters
    ----------
    weights
        Weights (n,), which add up to 1.
    count
        Number of particles to take.
    uniform
        Random number between 0 and 1.
    """
    places = (np.arange(count) + uniform) / count
    total = np.cumsum(weights)
    taken = np.searchsorted(total, places * total[-1], side="right")
    return np.asarray(np.minimum(taken, len(weights) - 1), dtype=np.int64)


def drawn_columns(log: Array, draws: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Draw columns of a table of weights, for each row by its own weights.

    First a group of columns is drawn and then one of its columns, so that only few weights are added up one by one.

    Parameters
    ----------
    log
        Logarithms (m, n) of the weights, in each row up to a constant.
    draws
        Number of columns to draw for each row.
    rng
        Source of random numbers.

    Returns
    -------
    NDArray
        Numbers (m, draws) of the columns.
    """
    rows, columns = log.shape
    groups = -(-columns // _GROUP)
    weights = np.zeros((rows, groups * _GROUP), dtype=np.float32)  # which is exact enough, and faster
    weights[:, :columns] = log - log.max(axis=1, keepdims=True)
    np.exp(weights[:, :columns], out=weights[:, :columns])
    weights = weights.reshape(rows, groups, _GROUP)
    row = np.arange(rows)[:, None]
    total = np.cumsum(weights @ np.ones(_GROUP, dtype=np.float32), axis=1, dtype=np.float64)
    wanted = rng.random((rows, draws)) * total[:, -1:]
    group = np.minimum((total[:, None] <= wanted[..., None]).sum(axis=2), groups - 1)
    end = total[row, group]
    begin = np.where(group > 0, total[row, group - 1], 0.0)
    within = np.cumsum(weights[row, group], axis=2, dtype=np.float64)
    inside = (wanted - begin) / (end - begin) * within[..., -1]
    column = np.minimum((within <= inside[..., None]).sum(axis=2), _GROUP - 1)
    return np.asarray(np.minimum(group * _GROUP + column, columns - 1), dtype=np.int64)
