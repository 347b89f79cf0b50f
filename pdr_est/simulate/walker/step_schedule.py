"""Times, lengths and feet of the steps of a walk with starts, stops and pauses."""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from annotated_types import Gt, Le
from numpy.typing import NDArray

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.params import NonNegative, Positive, params
from pdr_est.simulate.motion.random_signals import BandlimitedNoise
from pdr_est.simulate.walker.gait_stretches import (
    GaitStretch,
    PacedStretch,
    RunningStretch,
    StairStretch,
    check_stretches,
    cut_at_stretches,
    flight_share,
    running_cadence_hz,
    speed_up_shares,
)
from pdr_est.types.steps import Gait

# The body comes to rest this long after the last heel strike before a standstill. In real halts (weallwalk,
# oxford-steps, awinda) the signal of the default step detector rises once more by a quarter of a usual step's rise.
SETTLE_S = 0.4

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
    stretches: tuple[GaitStretch, ...] = ()
    """Stretches in another gait or pace, in order of arc length: jogging, running, stairs. The rest is walked."""


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
    gait : NDArray
        Gait of each step, (n,), values of `Gait`; stairs are walked.
    flight_s : Array
        Time without a foot on the ground before each heel strike, (n,), s; 0 in walking.
    rise_m : Array
        Change of height in each step, (n,), m; 0 on level ground.
    """

    start_s: Array
    time_s: Array
    length_m: Array
    foot: NDArray[np.str_]
    end_s: float
    gait: NDArray[np.int8]
    flight_s: Array
    rise_m: Array

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

    The lengths of a bout (between two standstills), and of each stretch within it, are scaled together, by half a
    step at most in all, so that its last step ends exactly where the stretch does.

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
        If the pauses or the stretches are not in order on the path.
    """
    stops = [0.0, *(pause.at_m for pause in gait.pauses), path_length_m]
    if any(later <= earlier for earlier, later in pairwise(stops)):
        raise ConfigError(
            f"pauses: at_m {[pause.at_m for pause in gait.pauses]} must rise and lie within the "
            f"{path_length_m:.1f} m of the path"
        )
    check_stretches(gait.stretches, path_length_m)
    standing_s = [gait.lead_in_s, *(pause.duration_s for pause in gait.pauses)]
    drift_rng = rng.spawn(1)[0]  # a stream of its own: without drift the steps are as they ever were
    drift = _Drift(
        BandlimitedNoise(gait.cadence_drift, _DRIFT_HZ, drift_rng),
        BandlimitedNoise(gait.length_drift, _DRIFT_HZ, drift_rng),
    )
    edges: list[Array] = []
    planned: list[_Steps] = []
    now_s = 0.0
    for stand_s, (begin_m, end_m) in zip(standing_s, pairwise(stops), strict=True):
        now_s += stand_s
        for section in _sections(gait, begin_m, end_m):
            steps = _plan_section(section, now_s, drift, rng)
            edges.append(now_s + np.concatenate([[0.0], np.cumsum(steps.period_s)]))
            planned.append(steps)
            now_s = float(edges[-1][-1])
    length_m = np.concatenate([steps.length_m for steps in planned])
    feet = ("R", "L") if gait.first_foot == "R" else ("L", "R")
    return StepSchedule(
        start_s=np.concatenate([edges_s[:-1] for edges_s in edges]),
        time_s=np.concatenate([edges_s[1:] for edges_s in edges]),
        length_m=length_m,
        foot=np.resize(np.array(feet), len(length_m)),
        end_s=now_s + gait.lead_out_s,
        gait=np.concatenate([steps.gait for steps in planned]),
        flight_s=np.concatenate([steps.flight_s for steps in planned]),
        rise_m=np.concatenate([steps.rise_m for steps in planned]),
    )


@dataclass(frozen=True)
class _Drift:
    """Slow changes of cadence and length."""

    cadence: BandlimitedNoise
    length: BandlimitedNoise


@dataclass(frozen=True)
class _Section:
    """Part of a bout in one gait: its distance (m) and the speeds (m/s) of what comes before and after it."""

    gait: WalkerGaitParams
    stretch: GaitStretch | None
    distance_m: float
    speed_before_mps: float
    speed_after_mps: float


@dataclass(frozen=True)
class _Steps:
    """Planned steps of a section, arrays (n,): periods (s), lengths (m), gaits, flights (s) and rises (m)."""

    period_s: Array
    length_m: Array
    gait: NDArray[np.int8]
    flight_s: Array
    rise_m: Array


def _sections(gait: WalkerGaitParams, begin_m: float, end_m: float) -> list[_Section]:
    """Cut a bout, given by its arc lengths, at the edges of the stretches."""
    pieces = cut_at_stretches(gait.stretches, begin_m, end_m)
    gaits = [_gait_on(gait, stretch) for stretch, _ in pieces]
    speeds = [0.0, *(mean_speed_mps(own) for own in gaits), 0.0]
    return [
        _Section(own, stretch, distance_m, speeds[k], speeds[k + 2])
        for k, (own, (stretch, distance_m)) in enumerate(zip(gaits, pieces, strict=True))
    ]


def _gait_on(gait: WalkerGaitParams, stretch: GaitStretch | None) -> WalkerGaitParams:
    """Return the cadence and step length of a walker on a stretch."""
    match stretch:
        case PacedStretch():
            return replace(gait, cadence_hz=stretch.cadence_hz)
        case RunningStretch():
            cadence_hz = stretch.cadence_hz or running_cadence_hz(stretch.speed_mps)
            length_m = stretch.speed_mps / cadence_hz
            return replace(gait, cadence_hz=cadence_hz, step_length_m=length_m, length_habit=1.0)
        case StairStretch():
            cadence_hz = stretch.steps_per_second(gait.cadence_hz)
            return replace(gait, cadence_hz=cadence_hz, step_length_m=stretch.tread_m, length_habit=1.0)
    return gait


def _plan_section(section: _Section, begin_s: float, drift: _Drift, rng: np.random.Generator) -> _Steps:
    """Plan the steps of one section."""
    gait, distance_m, stretch = section.gait, section.distance_m, section.stretch
    usual_m = _model_step_length_m(gait, np.array([1.0 / gait.cadence_hz]))[0]
    first, last = _boundary_shares(section)
    count = max(round(distance_m / usual_m + float(np.sum(1.0 - first) + np.sum(1.0 - last))), 1)
    about_s = begin_s + np.arange(count) / gait.cadence_hz
    cadence_hz = gait.cadence_hz * (1.0 + drift.cadence.at(about_s).value)
    period_s = (1.0 + gait.cadence_variation * _bounded_normal(rng, count)) / cadence_hz
    length_m = _model_step_length_m(gait, period_s) * (1.0 + gait.length_variation * _bounded_normal(rng, count))
    length_m *= 1.0 + drift.length.at(about_s).value
    length_m[: len(first)] *= first[:count]
    length_m[max(count - len(last), 0) :] *= last[-count:]
    if isinstance(stretch, StairStretch):
        length_m = np.ones(count)  # a tread each
    length_m *= distance_m / length_m.sum()
    running = isinstance(stretch, RunningStretch)
    own = Gait[stretch.kind.upper()] if isinstance(stretch, RunningStretch) else Gait.WALKING
    return _Steps(
        period_s=period_s,
        length_m=length_m,
        gait=np.full(count, own, dtype=np.int8),
        flight_s=period_s * flight_share(length_m / period_s) if running else np.zeros(count),
        rise_m=np.full(count, stretch.signed_rise_m if isinstance(stretch, StairStretch) else 0.0),
    )


def _boundary_shares(section: _Section) -> tuple[Array, Array]:
    """Compute the ratios of the first and last lengths of a section to the others, as the body changes its speed."""
    usual_mps = mean_speed_mps(section.gait)
    shares = []
    for neighbour_mps in (section.speed_before_mps, section.speed_after_mps):
        change = 1.0 - neighbour_mps / usual_mps
        if change <= 0.0 or isinstance(section.stretch, StairStretch):
            shares.append(np.array([]))  # of two neighbours the faster one changes its speed
        elif isinstance(section.stretch, RunningStretch):
            shares.append(speed_up_shares(usual_mps, neighbour_mps, section.gait.cadence_hz))
        else:
            standing = neighbour_mps == 0.0
            shares.append(np.array([section.gait.boundary_step_share if standing else 1.0 - 0.5 * change]))
    return shares[0], shares[1][::-1]


def _model_step_length_m(gait: WalkerGaitParams, period_s: Array) -> Array:
    """Compute the walker's step lengths at given step periods, s."""
    if gait.step_length_m is not None:
        return np.full(len(period_s), gait.length_habit * gait.step_length_m)
    return gait.length_habit * _MMPDR_K[gait.gender] * gait.height_m / np.sqrt(period_s)


def _bounded_normal(rng: np.random.Generator, count: int) -> Array:
    """Draw standard normal numbers cut at 3, so that no step is absurd."""
    return np.clip(rng.standard_normal(count), -3.0, 3.0)
