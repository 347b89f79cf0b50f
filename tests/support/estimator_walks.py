"""Simulated walks whose noise follows the model of the odometry exactly, and shorthands for measurements."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.estimators import EstimatorName, estimate_track, timelines_of
from pdr_est.estimators.factor_graph.smoother import estimate
from pdr_est.frames import Array, rotation_matrix
from pdr_est.front_end.step_noise import step_covariance
from pdr_est.types.measurements import (
    DeviceMeasurements,
    HeadingPrior,
    Measurement,
    PositionFix,
    StartPose,
    StepOdometry,
)
from pdr_est.types.track import Track

DEVICE = "phone"
STEP_S = 0.5
SIGMA_LENGTH_M = 0.07
SIGMA_DIRECTION_RAD = 0.1
SIGMA_HEADING_RAD = 0.02
SIGMA_SCALE = 0.1


def step(
    k: int, length_m: float = 0.7, turn_rad: float = 0.0, covariance: Array | None = None, observed: bool = True
) -> StepOdometry:
    """The k-th step (from 1), which takes STEP_S and follows the one before without a pause."""
    return StepOdometry(
        device=DEVICE,
        time_s=STEP_S * k,
        start_s=STEP_S * (k - 1),
        length_m=length_m,
        heading_change_rad=turn_rad,
        covariance=usual_covariance(length_m) if covariance is None else covariance,
        observed=observed,
    )


def usual_covariance(length_m: float) -> Array:
    return step_covariance(length_m, SIGMA_LENGTH_M, SIGMA_DIRECTION_RAD, SIGMA_HEADING_RAD)


def straight(count: int, length_m: float = 0.7, covariance: Array | None = None) -> list[StepOdometry]:
    return [step(k, length_m, 0.0, covariance) for k in range(1, count + 1)]


def fix(k: float, x_m: float, y_m: float, sigma_m: float = 0.5, robust: bool = False) -> PositionFix:
    """A fix at the end of step k; broken k for a moment within a step. Its clock is certainly right."""
    return PositionFix(STEP_S * k, np.array([x_m, y_m]), sigma_m**2 * np.eye(2), robust=robust, clock_known=True)


def heading_prior(k: float, heading_rad: float, sigma_rad: float = 0.05, robust: bool = False) -> HeadingPrior:
    return HeadingPrior(DEVICE, STEP_S * k, heading_rad, sigma_rad, robust)


def run(
    name: EstimatorName, measurements: Sequence[Measurement], start: StartPose, sigma_scale: float = SIGMA_SCALE
) -> Track:
    return estimate_track(name, DEVICE, 0.0, measurements, start, sigma_scale)


def smooth_as_given(measurements: Sequence[Measurement], start: StartPose, sigma_scale: float = SIGMA_SCALE) -> Track:
    """Smooth by the factor graph with all measurements as they are, without comparing fixes with steps before."""
    return estimate(timelines_of([DeviceMeasurements(DEVICE, 0.0, tuple(measurements))]), [], start, sigma_scale)


@dataclass(frozen=True)
class SimulatedWalk:
    """True poses (n + 1, 3), the start first, and what was measured."""

    truth: Array
    odometry: list[StepOdometry]
    fixes: list[PositionFix]

    @property
    def measurements(self) -> list[Measurement]:
        return [*self.odometry, *self.fixes]


def simulate(
    rng: np.random.Generator,
    turns_rad: Sequence[float] | Array,
    start: tuple[float, float, float] = (0.0, 0.0, 0.0),
    scale: float = 1.0,
    fix_every: int = 0,
    first_fix: int = 0,
    sigma_fix_m: float = 0.5,
    covariance: Array | None = None,
) -> SimulatedWalk:
    """A walk with these measured turns, errors drawn from the covariances, and fixes every so many steps."""
    odometry = [step(k, 0.7, float(turn), covariance) for k, turn in enumerate(turns_rad, 1)]
    variance, axes = np.linalg.eigh(usual_covariance(0.7) if covariance is None else covariance)
    errors = rng.standard_normal((len(odometry), 3)) * np.sqrt(np.maximum(variance, 0.0)) @ axes.T
    truth = [np.array(start, dtype=np.float64)]
    for measured, (forward, left, heading) in zip(odometry, errors, strict=True):
        ahead = truth[-1][2] + measured.heading_change_rad
        move = rotation_matrix(ahead) @ [scale * measured.length_m + forward, left]
        truth.append(np.array([*(truth[-1][:2] + move), ahead + heading]))
    fixes = []
    if fix_every:
        for k in range(first_fix, len(truth), fix_every):
            fixes.append(fix(k, *(truth[k][:2] + sigma_fix_m * rng.standard_normal(2)), sigma_fix_m))
    return SimulatedWalk(np.array(truth), odometry, fixes)


def with_near_fixes(walk: SimulatedWalk) -> SimulatedWalk:
    """The walk with half the errors of its fixes, at the ends of steps: no error larger than stated is probable."""
    fixes = [
        replace(one, position_m=0.5 * (one.position_m + walk.truth[round(one.time_s / STEP_S), :2]))
        for one in walk.fixes
    ]
    return replace(walk, fixes=fixes)


def winding(count: int, rng: np.random.Generator) -> Array:
    """Turns of a walk along gently bending ways."""
    return np.asarray(0.15 * np.sin(np.arange(count) / 9.0 + rng.uniform(0, 6)) + 0.02 * rng.standard_normal(count))


def turned(pose: tuple[float, float, float], points: Array) -> Array:
    """Points (n, 2) of the walker's own frame seen from the map when that frame lies at `pose`."""
    return np.asarray(points @ rotation_matrix(pose[2]).T + pose[:2])
