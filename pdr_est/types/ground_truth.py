"""Reference data of a recording: known positions, steps, strides, turns and carrying modes.

Evaluation compares results with it. No estimator ever sees it.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.steps import CarryingMode

DENSE_S = 1.5
"""Median time between true positions, s, below which they are recorded poses: nobody taps or surveys so fast."""


@dataclass(frozen=True)
class TruePositions:
    """Reference positions.

    Attributes
    ----------
    time_s
        (n,) s.
    position_m
        (n, 2) east and north, m.
    sigma_m
        Standard deviation of each coordinate, m.
    source
        Origin in words: "waypoints", "surveyed points", "gps", "poses".
    """

    time_s: Array
    position_m: Array
    sigma_m: float
    source: str

    @property
    def dense(self) -> bool:
        """True for recorded poses, which follow each other faster than waypoints."""
        return are_dense(self.time_s)


def are_dense(time_s: Array) -> bool:
    """Tell whether true positions at times (n,), s, in any order, are recorded poses and no waypoints."""
    return len(time_s) > 1 and float(np.median(np.diff(np.sort(time_s)))) < DENSE_S


@dataclass(frozen=True)
class TrueSteps:
    """Annotated foot contacts.

    Attributes
    ----------
    time_s
        (n,) s.
    foot
        (n,) "L" or "R".
    """

    time_s: Array
    foot: NDArray[Any]


@dataclass(frozen=True)
class TrueStrides:
    """Measured strides (two steps each) in order of time.

    Attributes
    ----------
    start_s, end_s
        (n,) s.
    length_m
        (n,) m.
    """

    start_s: Array
    end_s: Array
    length_m: Array


@dataclass(frozen=True)
class TrueTurns:
    """Annotated turns.

    Attributes
    ----------
    time_s
        (n,) s.
    angle_rad
        (n,) rad, counter-clockwise positive.
    """

    time_s: Array
    angle_rad: Array


@dataclass(frozen=True)
class TrueModes:
    """Annotated carrying modes of a device.

    Attributes
    ----------
    start_s
        (n,) s, increasing; a mode lasts until the next start.
    mode
        (n,) values of `CarryingMode`.
    """

    start_s: Array
    mode: NDArray[np.int8]

    def at(self, time_s: Array) -> NDArray[np.int8]:
        """Look up the modes (k,) at times (k,); UNKNOWN before the first start."""
        number = np.searchsorted(self.start_s, time_s, side="right") - 1
        unknown = np.int8(CarryingMode.UNKNOWN)
        return np.where(number < 0, unknown, self.mode[np.maximum(number, 0)]).astype(np.int8)


@dataclass(frozen=True)
class Truth:
    """All reference data of one recording; a part is None where the recording has none.

    Attributes
    ----------
    positions, steps, turns, strides
        Reference positions, foot contacts, turns and strides.
    step_count
        Number of steps.
    distance_m
        Length of the walk, m.
    activity
        Label of the activity as the data set gives it.
    modes
        Carrying modes of the first device.
    speed_mps
        Constant speed of the walk, such as that of a treadmill's belt, m/s.
    """

    positions: TruePositions | None = None
    steps: TrueSteps | None = None
    turns: TrueTurns | None = None
    step_count: int | None = None
    distance_m: float | None = None
    activity: str | None = None
    modes: TrueModes | None = None
    strides: TrueStrides | None = None
    speed_mps: float | None = None
