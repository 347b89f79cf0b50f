"""Regions of the poses of the particle smoother: mixtures fitted to paths, and whether they hold the truth."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import DEVICE, SIGMA_SCALE, step, usual_covariance

from pdr_est.estimators import estimate_walk
from pdr_est.estimators.particle.paths.mixture_fit import fitted_region
from pdr_est.frames import Array
from pdr_est.types.floor_plan import FloorPlan, WalkableArea
from pdr_est.types.measurements import DeviceMeasurements, StartPose
from pdr_est.types.region import PoseRegion
from pdr_est.types.steps import TurnHypothesis
from pdr_est.types.track import Track

POSES, PATHS = 1500, 200
Draw = Callable[[np.random.Generator, tuple[int, int]], Array]


def normal(rng: np.random.Generator, shape: tuple[int, int]) -> Array:
    return np.stack([3.0 * rng.normal(size=shape), rng.normal(size=shape)], axis=1)


def corridor(rng: np.random.Generator, shape: tuple[int, int]) -> Array:
    return np.stack([rng.uniform(-8.0, 8.0, shape), rng.uniform(-1.0, 1.0, shape)], axis=1)


def parallel_corridors(rng: np.random.Generator, shape: tuple[int, int]) -> Array:
    """Two long corridors beside each other, six metres apart; three of ten points are in the second."""
    side = rng.random(shape) < 0.3
    return np.stack([4.0 * rng.normal(size=shape), 0.4 * rng.normal(size=shape) + 6.0 * side], axis=1)


def three_rooms(rng: np.random.Generator, shape: tuple[int, int]) -> Array:
    middle = np.array([(0.0, 0.0), (10.0, 0.0), (5.0, 8.0)])[rng.integers(0, 3, shape)]
    return np.moveaxis(middle + rng.normal(size=(*shape, 2)), 2, 1)


def bend(rng: np.random.Generator, shape: tuple[int, int]) -> Array:
    """Round a corner: on a curve of a right angle, 10 m in radius."""
    angle, radius = 0.7 * rng.normal(size=shape), 10.0 + 0.5 * rng.normal(size=shape)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def fitted(draw: Draw) -> tuple[PoseRegion, PoseRegion, Array]:
    """Region and ellipses of points, and one more point of each pose, of which the fit does not know."""
    points = draw(np.random.default_rng(3), (POSES, PATHS + 1))
    given, further = points[:, :, :-1], points[:, :, -1]
    mean = given.mean(axis=2)
    off = given - mean[:, :, None]
    covariance = off @ off.transpose(0, 2, 1) / PATHS
    return fitted_region(given, mean, covariance), PoseRegion.of_gaussians(mean, covariance), further


def area_m2(region: PoseRegion) -> float:
    ellipses = region.ellipses()
    return float(np.sqrt(np.linalg.det(ellipses.covariance_m2)).sum() * 5.99 * np.pi / len(region))


@pytest.mark.parametrize(
    ("draw", "components", "smaller"),
    [(parallel_corridors, 2, 2.0), (three_rooms, 3, 4.0), (bend, 3, 1.3)],
)
def test_a_mixture_holds_95_percent_on_less_ground(draw: Draw, components: int, smaller: float) -> None:
    region, ellipses, further = fitted(draw)
    assert 0.93 <= region.contains(further).mean() <= 0.97
    assert np.median(region.components) == components
    assert area_m2(region) < area_m2(ellipses) / smaller


@pytest.mark.parametrize("draw", [normal, corridor])
def test_what_one_ellipse_describes_stays_as_it_is(draw: Draw) -> None:
    region, ellipses, _ = fitted(draw)
    assert np.mean(region.components == 1) > 0.995
    alone = region.components == 1
    assert np.array_equal(region.mean_m[alone, 0], ellipses.mean_m[alone, 0])


def test_places_that_are_close_are_one() -> None:
    rng = np.random.default_rng(0)
    near = 0.05 * rng.normal(size=(20, 2, PATHS)) + 0.4 * (rng.random((20, 1, PATHS)) < 0.5)
    region = fitted_region(near, near.mean(axis=2), np.repeat(0.05 * np.eye(2)[None], 20, axis=0))
    assert region.components.tolist() == [1] * 20


def test_the_largest_component_comes_first_and_weights_are_shares_of_the_points() -> None:
    region, _, _ = fitted(parallel_corridors)
    assert np.all(np.diff(region.weight, axis=1) <= 0.0)
    assert region.weight.sum(axis=1) == pytest.approx(np.ones(POSES))
    assert region.weight[:, 1].mean() == pytest.approx(0.3, abs=0.02)
    assert region.mean_m[:, 1, 1].mean() == pytest.approx(6.0, abs=0.1)


# A corridor to the east that forks after 12 m into two that lead to the north-east and the south-east.
FORK = FloorPlan(
    "fork",
    (
        WalkableArea(
            np.array(
                [(0, -1), (12, -1), (32, -21), (33.5, -19.5), (14, 0), (33.5, 19.5), (32, 21), (12, 1), (0, 1.0)]
            )
        ),
    ),
    np.zeros((0, 2, 2)),
    0.05,
)
FIRST_M = 2.0
FORK_STEP, STEPS, WALKS = 17, 26, 40
TURN_RAD = np.pi / 4.0


def forked_walk(seed: int) -> tuple[Track, Array]:
    """Track of a walk in the fork, and its true positions, which were drawn from what the estimator assumes.

    The phone was put elsewhere in the fork, so that the turn there is not known: left or right.
    """
    rng = np.random.default_rng(seed)
    covariance = usual_covariance(0.7)
    while True:
        scale, heading_rad = np.exp(SIGMA_SCALE * rng.normal()), 0.02 * rng.normal()
        side = 1.0 if rng.random() < 0.5 else -1.0
        errors = rng.multivariate_normal(np.zeros(3), covariance, STEPS)
        place, places = np.array([FIRST_M, 0.0]) + 0.2 * rng.normal(size=2), []
        for k in range(1, STEPS + 1):
            error = errors[k - 1]
            heading_rad += side * TURN_RAD + 0.05 * rng.normal() if k == FORK_STEP else 0.0
            ahead = np.array([np.cos(heading_rad), np.sin(heading_rad)])
            place = place + (0.7 * scale + error[0]) * ahead + error[1] * np.array([-ahead[1], ahead[0]])
            heading_rad += error[2] if k != FORK_STEP else 0.0
            places.append(place)
        if FORK.contains(np.array(places)).all():
            break
    covariance[2, 2] = 0.05**2 + TURN_RAD**2
    turns = tuple(TurnHypothesis(0.5, sign * TURN_RAD, 0.05, words) for sign, words in ((1, "left"), (-1, "right")))
    walk = [step(k) for k in range(1, STEPS + 1)]
    walk[FORK_STEP - 1] = replace(walk[FORK_STEP - 1], covariance=covariance, turn_hypotheses=turns)
    start = StartPose((FIRST_M, 0.0), 0.0, sigma_position_m=0.2, sigma_heading_rad=0.02)
    devices = [DeviceMeasurements(DEVICE, 0.0, (*walk, FORK))]
    return estimate_walk("particle", devices, start, SIGMA_SCALE), np.array(places)


def test_a_fork_has_two_places_and_its_region_keeps_off_the_wall() -> None:
    track, _ = forked_walk(0)
    assert track.region is not None
    assert track.region.components[5] == 1
    assert track.region.components[-1] == 2
    assert track.region.weight[-1, :2] == pytest.approx([0.5, 0.5], abs=0.2)
    ends = track.region.mean_m[-1, :2]
    assert sorted(np.sign(ends[:, 1]).tolist()) == [-1.0, 1.0]
    assert FORK.contains(ends).all()
    between = np.array([ends.mean(axis=0)])
    assert not track.region.rows(np.array([STEPS])).contains(between).any()
    assert PoseRegion.of_gaussians(track.position_m[-1:], track.covariance_m2[-1:]).contains(between).all()


@pytest.mark.slow
def test_regions_hold_the_truth_of_walks_in_the_fork() -> None:
    """Of 200 walks it is 94 % before the fork and 96 % behind it."""
    inside = []
    for seed in range(WALKS):
        track, places = forked_walk(seed)
        assert track.region is not None
        inside.append(track.region.rows(slice(1, None)).contains(places))
    shares = np.mean(inside, axis=0)
    assert 0.90 <= shares[FORK_STEP:].mean() <= 0.99
    assert 0.90 <= shares[:FORK_STEP].mean() <= 0.99
