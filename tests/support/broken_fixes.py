"""Simulated walks whose fixes contradict each other, are repeated, late, gross, biased or of a wrong accuracy.

The odometry is drawn from its own noise model, so that a walk costs next to nothing. Every even case has surveyed
points, every odd one GPS fixes whose error wanders as `GpsNoise` says.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from estimator_walks import STEP_S, SimulatedWalk, simulate

from pdr_est.estimators.common.fix_noise import FixNoiseParams, fixes_with_noise
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix, StartPose

SIGMA_SCALE = 0.08  # of the simulated walkers; the estimators take SIGMA_SCALE of estimator_walks
SIGMA_POINT_M = 0.7
GROSS_M = 50.0
OUTSIDE = 11.8  # squared Mahalanobis distance that one correct fix in 365 exceeds

Fixes = list[PositionFix]


@dataclass(frozen=True)
class BrokenWalk:
    """A walk with broken fixes.

    fault: key of `FAULTS`. wrong_share: share of the fixes that lie outside of their own 99.7 % region.
    """

    fault: str
    walk: SimulatedWalk
    start: StartPose
    wrong_share: float


def broken_walk(number: int) -> BrokenWalk:
    """The case of a number; the faults take turns."""
    rng = np.random.default_rng([number, 14])
    fault = list(FAULTS)[number // 2 % len(FAULTS)]
    x_m, y_m, heading_rad = rng.uniform(-3.0, 3.0, 3)
    scale = float(np.exp(rng.normal(0.0, SIGMA_SCALE)))
    walk = simulate(rng, corridor_turns(rng), (x_m, y_m, heading_rad), scale)
    correct = surveyed_points(rng, walk.truth) if number % 2 == 0 else gps_fixes(rng, walk.truth)
    fixes = sorted(FAULTS[fault](rng, correct, walk.truth), key=lambda one: one.time_s)
    known = StartPose((x_m, y_m), heading_rad + rng.normal(0.0, 0.1), 0.1, 0.1)
    start = known if rng.uniform() < 0.5 else StartPose()
    wrong = np.mean([_outside(one, walk.truth) for one in fixes])
    return BrokenWalk(fault, replace(walk, fixes=fixes), start, float(wrong))


def corridor_turns(rng: np.random.Generator) -> Array:
    """Turns of 60 to 240 steps along corridors that meet at right angles."""
    turns = np.zeros(int(rng.integers(60, 240)))
    k = int(rng.integers(6, 20))
    while k < len(turns):
        turns[k] = rng.choice([-0.5, 0.5]) * np.pi
        k += int(rng.integers(6, 30))
    return turns


def surveyed_points(rng: np.random.Generator, truth: Array) -> Fixes:
    """A point in 8 to 25 steps, 6 at least."""
    every = min(int(rng.integers(8, 26)), (len(truth) - 1) // 5)
    return [
        PositionFix(STEP_S * k, truth[k, :2] + rng.normal(0.0, SIGMA_POINT_M, 2), SIGMA_POINT_M**2 * np.eye(2))
        for k in range(0, len(truth), every)
    ]


def gps_fixes(rng: np.random.Generator, truth: Array) -> Fixes:
    """A fix in 1 to 3 s whose error follows the noise model of the source."""
    accuracy_m, every = rng.uniform(3.0, 10.0), int(rng.integers(2, 7))
    stated = [
        PositionFix(STEP_S * k, truth[k, :2], accuracy_m**2 * np.eye(2), "gps", robust=True)
        for k in range(0, len(truth), every)
    ]
    fixes, wander = [], rng.standard_normal(2)
    for fix in fixes_with_noise(stated, FixNoiseParams()):
        white = rng.normal(0.0, np.sqrt(fix.covariance_m2[0, 0]), 2)
        fixes.append(replace(fix, position_m=fix.position_m + fix.sigma_wander_m * wander + white))
        kept = np.exp(-STEP_S * every / fix.wander_time_s)
        wander = kept * wander + np.sqrt(1.0 - kept**2) * rng.standard_normal(2)
    return fixes


def _contradicting(rng: np.random.Generator, fixes: Fixes, _truth: Array) -> Fixes:
    """Up to three fixes have a twin of the same moment that lies 10 to 40 m away."""
    chosen = rng.choice(len(fixes), int(rng.integers(1, 4)), replace=False)
    return [*fixes, *(_moved(rng, fixes[i], rng.uniform(10.0, 40.0)) for i in chosen)]


def _duplicated(rng: np.random.Generator, fixes: Fixes, _truth: Array) -> Fixes:
    """Every fix comes two to five times, in half of the cases a second apart."""
    times, apart_s = int(rng.integers(2, 6)), float(rng.choice([0.0, 1.0]))
    return [replace(one, time_s=one.time_s + k * apart_s) for one in fixes for k in range(times)]


def _shifted(rng: np.random.Generator, fixes: Fixes, truth: Array) -> Fixes:
    """The clock of the fixes is up to 5 s fast or slow."""
    shift_s = rng.uniform(-5.0, 5.0)
    moved = [replace(one, time_s=one.time_s + shift_s) for one in fixes]
    return [one for one in moved if 0.0 <= one.time_s <= STEP_S * (len(truth) - 1)]


def _gross(rng: np.random.Generator, fixes: Fixes, _truth: Array) -> Fixes:
    """One fix in five is wrong by 50 m."""
    return [_moved(rng, one, GROSS_M) if rng.uniform() < 0.2 else one for one in fixes]


def _stretch(rng: np.random.Generator, fixes: Fixes, _truth: Array) -> Fixes:
    """For 15 to 35 % of the walk all fixes lie 10 to 40 m away in one direction, which comes and goes slowly."""
    count = max(int(rng.uniform(0.15, 0.35) * len(fixes)), 1)
    begin = int(rng.integers(0, len(fixes) - count + 1))
    bias_m = _direction(rng) * rng.uniform(10.0, 40.0) * np.sin(np.linspace(0.3, np.pi - 0.3, count))[:, None]
    bad = [
        replace(one, position_m=one.position_m + b)
        for one, b in zip(fixes[begin : begin + count], bias_m, strict=True)
    ]
    return [*fixes[:begin], *bad, *fixes[begin + count :]]


def _accuracy(rng: np.random.Generator, fixes: Fixes, _truth: Array) -> Fixes:
    """The stated accuracy is that of the errors times 0.2 to 5."""
    factor = float(np.exp(rng.uniform(np.log(0.2), np.log(5.0))))
    return [
        replace(one, covariance_m2=factor**2 * one.covariance_m2, sigma_wander_m=factor * one.sigma_wander_m)
        for one in fixes
    ]


FAULTS: dict[str, Callable[[np.random.Generator, Fixes, Array], Fixes]] = {
    "contradicting": _contradicting,
    "duplicated": _duplicated,
    "shifted": _shifted,
    "gross": _gross,
    "stretch": _stretch,
    "accuracy": _accuracy,
}
"""What each fault does to correct fixes, from a generator, the fixes and the true poses."""


def _moved(rng: np.random.Generator, fix: PositionFix, distance_m: float) -> PositionFix:
    return replace(fix, position_m=fix.position_m + distance_m * _direction(rng))


def _direction(rng: np.random.Generator) -> Array:
    angle = rng.uniform(0.0, 2.0 * np.pi)
    return np.array([np.cos(angle), np.sin(angle)])


def _outside(fix: PositionFix, truth: Array) -> bool:
    """Tell whether a fix lies outside of its own 99.7 % region about the true position."""
    steps = np.arange(len(truth))
    true_m = np.array([np.interp(fix.time_s / STEP_S, steps, truth[:, axis]) for axis in (0, 1)])
    error_m = fix.position_m - true_m
    return float(error_m @ np.linalg.solve(fix.total_covariance_m2, error_m)) > OUTSIDE
