"""Modes of a second: level, level with a disturbed pressure, and stairs, escalators and lifts down or up."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.types.height import MoveKind


@dataclass(frozen=True)
class _Pace:
    """Properties of a kind of move.

    Attributes
    ----------
    speed_mps, sigma_speed_mps
        Vertical speed and its standard deviation, m/s.
    steadiness
        Correlation of the speed from one second to the next, about the mean of the kind.
    stepping, resting
        How much more probable a second with a step, and one without, is in the move than on the level, where people
        walk or stand for long. Walking and standing last, so seconds are not independent: no ratio is extreme.
    duration_s
        Mean duration, s.
    share
        Share of the moves.
    """

    speed_mps: float
    sigma_speed_mps: float
    steadiness: float
    stepping: float
    resting: float
    duration_s: float
    share: float


_PACES = {
    # 0.17 m a step at 1.5 to 2 steps a second; landings slow it down.
    MoveKind.STAIRS: _Pace(0.30, 0.08, 0.7, 1.0, 0.3, 10.0, 0.5),
    # 0.5 m/s at 30 degrees (EN 115-1); some walk on them.
    MoveKind.ESCALATOR: _Pace(0.27, 0.08, 0.95, 0.8, 1.0, 15.0, 0.2),
    # 0.6 to 2.5 m/s, with accelerations up to 1 m/s².
    MoveKind.LIFT: _Pace(1.4, 0.9, 0.8, 0.3, 1.0, 12.0, 0.3),
}
_KINDS = tuple(_PACES)

LEVEL, DISTURBED = 0, 1
"""The modes in which the height stays; then each kind of move follows downwards and upwards."""

STILL = 2
"""Number of these; higher modes are moves."""

MODES = STILL + 2 * len(_KINDS)
"""Number of modes."""


def kind_of(mode: int) -> MoveKind:
    """Return the kind of move of a mode in which the height changes."""
    return _KINDS[(mode - STILL) // 2]


def direction_of(mode: int) -> int:
    """Return -1 for a mode downwards, 1 upwards and 0 for one in which the height stays."""
    return 0 if mode < STILL else 1 if mode % 2 else -1


def is_moving(mode: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Tell in which modes the height changes."""
    return mode >= STILL


def _of_modes(still: float, values: list[float]) -> Array:
    """List a value for each mode from those of the kinds."""
    return np.array([*[still] * STILL, *np.repeat(values, 2)])


_DIRECTION = np.array([float(direction_of(mode)) for mode in range(MODES)])

SPEED_MPS = _DIRECTION * _of_modes(0.0, [pace.speed_mps for pace in _PACES.values()])
"""Mean vertical speed (modes,), m/s."""

SIGMA_SPEED_MPS = _of_modes(0.0, [pace.sigma_speed_mps for pace in _PACES.values()])
"""Standard deviation of that speed between moves (modes,), m/s."""

STEADINESS = _of_modes(0.0, [pace.steadiness for pace in _PACES.values()])
"""Correlation of the speed from one second of a move to the next, about its mean (modes,)."""

LOG_STEPPING = np.log(_of_modes(1.0, [pace.stepping for pace in _PACES.values()]))
"""Log of how much more probable a second with a step is in each mode than on the level (modes,)."""

LOG_RESTING = np.log(_of_modes(1.0, [pace.resting for pace in _PACES.values()]))
"""The same for a second without a step (modes,)."""


def transitions(parameters: HeightParams) -> Array:
    """Return the probability (modes, modes) of each mode, column, in the second after each mode, row."""
    begin = _of_modes(0.0, [0.5 * pace.share for pace in _PACES.values()]) / parameters.time_between_moves_s
    begin[DISTURBED] = 1.0 / parameters.time_between_disturbances_s
    matrix = np.zeros((MODES, MODES))
    matrix[LEVEL] = begin
    matrix[LEVEL, LEVEL] = 1.0 - begin.sum()
    durations = [parameters.disturbed_s, *np.repeat([pace.duration_s for pace in _PACES.values()], 2)]
    for mode, duration_s in enumerate(durations, start=DISTURBED):
        matrix[mode, mode], matrix[mode, LEVEL] = 1.0 - 1.0 / duration_s, 1.0 / duration_s
    return matrix
