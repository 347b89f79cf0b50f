"""Times, lengths and feet of the steps of a walk with starts, stops and pauses."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from annotated_types import Gt, Le
from numpy.typing import NDArray

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.params import NonNegative, Positive, params
from pdr_est.simulate.motion.random_signals import BandlimitedNoise

SETTLE_S = 0.6  # the body comes to rest this long after the last heel strike before a standstill

_DRIFT_HZ = (0.008, 0.03)

_MMPDR_K = {"male": 0.3139, "female": 0.2975}  # MMPDR eq. 9


@params
class Pause:
    """Standstill of the walker at a point of the path."""

    at_m: Positive
    """Arc length of the point, m."""
    duration_s: Annotated[float, Gt(SETTLE_S)]
    """Duration of the standstill, s."""


@params
class WalkerGaitParams:
    """Height and gait of the walker."""

    height_m: Positive = 1.73
    """Body height, m."""
    gender: Literal["male", "female"] = "male"
    """Gender, for the step length of MMPDR eq. 9."""
    cadence_hz: Positive = 1.8
    """Mean number of steps per second."""
    step_length_m: Positive | None = None
    """Mean step length, m; None takes MMPDR eq. 9, k h sqrt(f), from height, gender and the rate of each step."""
    cadence_variation: Annotated[NonNegative, Le(0.1)] = 0.02
    """Relative standard deviation of the cadence from step to step."""
    length_variation: Annotated[NonNegative, Le(0.1)] = 0.02
    """Relative standard deviation of the length from step to step."""
    cadence_drift: Annotated[NonNegative, Le(0.1)] = 0.0
    """Relative root mean square of slow changes of the cadence, over half a minute and more."""
    length_drift: Annotated[NonNegative, Le(0.1)] = 0.0
    """Relative root mean square of slow changes of the length, over half a minute and more."""
    length_habit: Positive = 1.0
    """Ratio of this walker's mean step length to that of step_length_m or eq. 9."""
    boundary_step_share: Annotated[float, Gt(0.0), Le(1.0)] = 0.6
    """Ratio of the first and last step of a bout to the others, because the body speeds up and slows down in them."""
    first_foot: Literal["L", "R"] = "R"
    """Foot of the first step."""
    lead_in_s: NonNegative = 3.0
    """Standing time before the first step, s."""
    lead_out_s: NonNegative = 2.0
    """Standing time after the last step, s."""
    pauses: tuple[Pause, ...] = ()
    """Standstills on the way, in order of arc length."""


def mean_speed_mps(gait: WalkerGaitParams) -> float:
    """Compute the mean speed between starts and stops, m/s."""
    return float(_model_step_length_m(gait, np.array([1.0 / gait.cadence_hz]))[0]) * gait.cadence_hz


@dataclass(frozen=True)
class StepSchedule:
    """Steps of a walk.

    Attributes
    ----------
    start_s : Array
        Start of each step, (n,), s.
    time_s : Array
        Heel strike that ends each step, (n,), s.
    length_m : Array
        Distance that the body moves during each step, (n,), m.
    foot : NDArray
        Striking foot, (n,), "L" or "R".
    end_s : float
        End of the recording, s.
    """

    start_s: Array
    time_s: Array
    length_m: Array
    foot: NDArray[np.str_]
    end_s: float

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def bouts(self) -> list[slice]:
        """Return the ranges of steps without a standstill in between."""
        breaks = np.flatnonzero(self.start_s[1:] > self.time_s[:-1]) + 1
        edges = [0, *breaks.tolist(), len(self)]
        return [slice(first, last) for first, last in pairwise(edges)]


def plan_steps(gait: WalkerGaitParams, path_length_m: float, rng: np.random.Generator) -> StepSchedule:
    """Plan steps that cover a path exactly.

    The lengths of a bout (between two standstills) are scaled together, by half a step at most in all, so that its
    last step ends exactly where the bout does.

    Parameters
    ----------
    gait : WalkerGaitParams
        Height and gait of the walker.
    path_length_m : float
        Length of the path, m.
    rng : numpy.random.Generator
        Source of the variation.

    Raises
    ------
    ConfigError
        If the pauses are not in order on the path.
    """
    stops = [0.0, *(pause.at_m for pause in gait.pauses), path_length_m]
    if any(later <= earlier for earlier, later in pairwise(stops)):
        raise ConfigError(
            f"pauses: at_m {[pause.at_m for pause in gait.pauses]} must rise and lie within the "
            f"{path_length_m:.1f} m of the path"
        )
    standing_s = [gait.lead_in_s, *(pause.duration_s for pause in gait.pauses)]
    drift_rng = rng.spawn(1)[0]  # a stream of its own: without drift the steps are as they ever were
    drift = _Drift(
        BandlimitedNoise(gait.cadence_drift, _DRIFT_HZ, drift_rng),
        BandlimitedNoise(gait.length_drift, _DRIFT_HZ, drift_rng),
    )
    starts, times, lengths, now_s = [], [], [], 0.0
    for stand_s, distance_m in zip(standing_s, np.diff(stops), strict=True):
        period_s, length_m = _plan_bout(gait, float(distance_m), now_s + stand_s, drift, rng)
        edges_s = now_s + stand_s + np.concatenate([[0.0], np.cumsum(period_s)])
        starts.append(edges_s[:-1])
        times.append(edges_s[1:])
        lengths.append(length_m)
        now_s = float(edges_s[-1])
    count = sum(len(bout) for bout in times)
    feet = ("R", "L") if gait.first_foot == "R" else ("L", "R")
    return StepSchedule(
        start_s=np.concatenate(starts),
        time_s=np.concatenate(times),
        length_m=np.concatenate(lengths),
        foot=np.resize(np.array(feet), count),
        end_s=now_s + gait.lead_out_s,
    )


@dataclass(frozen=True)
class _Drift:
    """Slow changes of cadence and length."""

    cadence: BandlimitedNoise
    length: BandlimitedNoise


def _plan_bout(
    gait: WalkerGaitParams, distance_m: float, begin_s: float, drift: _Drift, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Plan periods (s) and lengths (m) of the steps of one bout."""
    usual_m = _model_step_length_m(gait, np.array([1.0 / gait.cadence_hz]))[0]
    short = 2.0 * (1.0 - gait.boundary_step_share)
    count = max(round(distance_m / usual_m + short), 1)
    about_s = begin_s + np.arange(count) / gait.cadence_hz
    cadence_hz = gait.cadence_hz * (1.0 + drift.cadence.at(about_s).value)
    period_s = (1.0 + gait.cadence_variation * _bounded_normal(rng, count)) / cadence_hz
    length_m = _model_step_length_m(gait, period_s) * (1.0 + gait.length_variation * _bounded_normal(rng, count))
    length_m *= 1.0 + drift.length.at(about_s).value
    length_m[[0, -1]] *= gait.boundary_step_share
    return period_s, length_m * (distance_m / length_m.sum())


def _model_step_length_m(gait: WalkerGaitParams, period_s: Array) -> Array:
    """Compute the walker's step lengths at given step periods, s."""
    if gait.step_length_m is not None:
        return np.full(len(period_s), gait.length_habit * gait.step_length_m)
    return gait.length_habit * _MMPDR_K[gait.gender] * gait.height_m / np.sqrt(period_s)


def _bounded_normal(rng: np.random.Generator, count: int) -> Array:
    """Draw standard normal numbers cut at 3, so that no step is absurd."""
    return np.clip(rng.standard_normal(count), -3.0, 3.0)
