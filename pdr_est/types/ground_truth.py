"""Ground truth."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.steps import CarryingMode


@dataclass(frozen=True)
class TruePositions:
    """Known positions. time_s: (n,); position_m: (n, 2) east, north; sigma_m: per axis; source in words
    ("waypoints", "surveyed points", "gps", "poses")."""

    time_s: Array
    position_m: Array
    sigma_m: float
    source: str


@dataclass(frozen=True)
class TrueSteps:
    """Annotated foot contacts. time_s: (n,), foot: (n,) "L" or "R"."""

    time_s: Array
    foot: NDArray[Any]


@dataclass(frozen=True)
class TrueStrides:
    """Measured strides (two steps each) in order of time. start_s, end_s: (n,); length_m: (n,)."""

    start_s: Array
    end_s: Array
    length_m: Array


@dataclass(frozen=True)
class TrueTurns:
    """Annotated turns. time_s: (n,), angle_rad: (n,) counter-clockwise positive."""

    time_s: Array
    angle_rad: Array


@dataclass(frozen=True)
class TrueModes:
    """How the device was really carried. start_s: (n,) rising; mode: (n,) values of CarryingMode from then on
    until the next start."""

    start_s: Array
    mode: NDArray[np.int8]

    def at(self, time_s: Array) -> NDArray[np.int8]:
        """The modes (k,) at some times (k,); UNKNOWN before the first start."""
        number = np.searchsorted(self.start_s, time_s, side="right") - 1
        unknown = np.int8(CarryingMode.UNKNOWN)
        return np.where(number < 0, unknown, self.mode[np.maximum(number, 0)]).astype(np.int8)


@dataclass(frozen=True)
class Truth:
    """What is known of the walk besides the sensors; each part None where the recording has none.

    modes: of the first device.
    """

    positions: TruePositions | None = None
    steps: TrueSteps | None = None
    turns: TrueTurns | None = None
    step_count: int | None = None
    distance_m: float | None = None
    activity: str | None = None
    modes: TrueModes | None = None
    strides: TrueStrides | None = None
