"""Stretches of a path on which the walker jogs, runs, climbs stairs or walks at another pace.

Running follows published relations with the speed v, in m/s:

* Steps per second: 2.8 at 3 m/s, growing with v^0.15. Runners who were asked to run at 3 m/s with different stride
  frequencies need least energy at 85 strides a minute (Lieberman et al. 2015). From 3.15 to 4.12 m/s the stride
  frequency grows by 4 % only, the stride by 28 % (Cavanagh and Kram 1989); height explains hardly anything of it.
* Share of a step in flight: 1 - 1 / (0.95 + 0.15 v). The mean vertical force over a contact grows from 1.40 body
  weights at 3 m/s to 1.70 at 5 m/s (Munro et al. 1987), and over a whole step the mean is one body weight.

Stairs: one step on each tread, at 0.9 of the usual steps per second upwards and at the usual ones downwards. That is
between 1.4 and 1.7 steps a second on a stair of five steps in a laboratory (Riener et al. 2002) and 1.85 and 2.05 of
four people of MotionSense. The speed along the ground is that of the treads, a third of walking.

References
----------
Cavanagh and Kram 1989, Medicine and Science in Sports and Exercise 21. Lieberman, Warrener, Wang and Castillo 2015,
Journal of Experimental Biology 218. Munro, Miller and Fuglevand 1987, Journal of Biomechanics 20. Riener, Rabuffetti
and Frigo 2002, Gait and Posture 15.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from annotated_types import Ge, Gt, Le
from pydantic import Field

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.params import NonNegative, Positive, params

_RUN_HZ, _RUN_MPS, _RUN_EXPONENT = 2.8, 3.0, 0.15
_FORCE_AT_REST, _FORCE_PER_MPS = 0.95, 0.15  # mean vertical force of a contact, body weights
_SPEED_UP_MPS2 = 1.5  # of runners who change their speed, ours; sprinters reach three times as much
_STAIR_PACE = {"up": 0.9, "down": 1.0}


@params
class PacedStretch:
    """Stretch that is walked at another pace."""

    kind: Literal["walking"] = "walking"
    """Name of the gait."""
    from_m: NonNegative
    """Arc length at which the stretch begins, m."""
    to_m: Positive
    """Arc length at which it ends, m."""
    cadence_hz: Positive
    """Mean number of steps per second."""


@params
class RunningStretch:
    """Stretch that is jogged or run, level."""

    kind: Literal["jogging", "running"]
    """Name of the gait: what the runner calls it. The motion depends on the speed alone."""
    from_m: NonNegative
    """Arc length at which the stretch begins, m."""
    to_m: Positive
    """Arc length at which it ends, m."""
    speed_mps: Annotated[float, Gt(1.5), Le(8.0)]
    """Speed after speeding up, m/s."""
    cadence_hz: Positive | None = None
    """Mean number of steps per second; None takes that of the speed (`running_cadence_hz`)."""


@params
class StairStretch:
    """Flight of stairs, taken step by step."""

    kind: Literal["stairs"] = "stairs"
    """Name of the gait."""
    from_m: NonNegative
    """Arc length at which the flight begins, m."""
    to_m: Positive
    """Arc length at which it ends, m; the path is level seen from above, so that it measures the treads."""
    direction: Literal["up", "down"]
    """Whether the flight is climbed or descended."""
    tread_m: Annotated[float, Ge(0.2), Le(0.5)] = 0.29
    """Depth of a step, m; the treads of a flight share its length evenly."""
    rise_m: Annotated[float, Gt(0.0), Le(0.3)] = 0.17
    """Height of a step, m. 17 cm by 29 cm is the usual stair of buildings, 2 rises + tread = 0.63 m."""
    cadence_hz: Positive | None = None
    """Mean number of steps per second; None takes 0.9 of the walker's own upwards, the same downwards."""

    @property
    def signed_rise_m(self) -> float:
        """Return the change of height in a step, m, upwards positive."""
        return self.rise_m if self.direction == "up" else -self.rise_m

    def steps_per_second(self, usual_hz: float) -> float:
        """Compute the steps per second of somebody who usually takes so many on level ground."""
        return _STAIR_PACE[self.direction] * usual_hz if self.cadence_hz is None else self.cadence_hz


GaitStretch = Annotated[PacedStretch | RunningStretch | StairStretch, Field(discriminator="kind")]


def running_cadence_hz(speed_mps: float) -> float:
    """Compute the steps per second of running at a speed, m/s."""
    return float(_RUN_HZ * (speed_mps / _RUN_MPS) ** _RUN_EXPONENT)


def flight_share(speed_mps: Array) -> Array:
    """Compute the share of a running step in which no foot is on the ground, from 0 to 1, at speeds (n,), m/s."""
    return 1.0 - 1.0 / np.maximum(_FORCE_AT_REST + _FORCE_PER_MPS * speed_mps, 1.0)


def speed_up_shares(usual_mps: float, neighbour_mps: float, cadence_hz: float) -> Array:
    """Compute the ratios (n,) of the first running steps' lengths to the usual one, as a runner gathers speed.

    Parameters
    ----------
    usual_mps, neighbour_mps : float
        Speeds after and before the change, m/s, the second below the first.
    cadence_hz : float
        Steps per second of the runner.
    """
    change_mps = usual_mps - neighbour_mps
    steps = int(np.ceil(change_mps * cadence_hz / _SPEED_UP_MPS2))
    return 1.0 - change_mps / usual_mps * (1.0 - (np.arange(steps) + 0.5) / steps)


def check_stretches(stretches: Sequence[GaitStretch], length_m: float) -> None:
    """Raise ConfigError if stretches overlap, are out of order, or leave a path of that length, m."""
    ends = [0.0, *(edge for stretch in stretches for edge in (stretch.from_m, stretch.to_m)), length_m]
    rising = all(earlier <= later for earlier, later in pairwise(ends))
    if not rising or any(not stretch.from_m < stretch.to_m for stretch in stretches):
        given = ", ".join(f"{stretch.kind} {stretch.from_m:g} to {stretch.to_m:g} m" for stretch in stretches)
        raise ConfigError(
            f"stretches: {given}: they must follow each other, each with from_m below to_m, within the "
            f"{length_m:.1f} m of the path"
        )


def cut_at_stretches(
    stretches: Sequence[GaitStretch], begin_m: float, end_m: float
) -> list[tuple[GaitStretch | None, float]]:
    """Cut a part of the path at the edges of the stretches.

    Returns
    -------
    list of tuple
        Each stretch, or None between them, with its length, m.
    """
    pieces: list[tuple[GaitStretch | None, float]] = []
    at_m = begin_m
    for stretch in stretches:
        first_m, last_m = max(stretch.from_m, begin_m), min(stretch.to_m, end_m)
        if first_m < last_m:
            pieces += [(None, first_m - at_m), (stretch, last_m - first_m)]
            at_m = last_m
    return [(stretch, distance_m) for stretch, distance_m in [*pieces, (None, end_m - at_m)] if distance_m > 0.0]
