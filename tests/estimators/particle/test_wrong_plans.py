"""Plans that are wrong: displaced, stretched, with a closed corridor, or of another place."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import DEVICE, SIGMA_SCALE, STEP_S, step

from pdr_est.estimators import estimate_walk
from pdr_est.estimators.particle.cloud import DEVICE_ROWS, PLAN_ROWS, Cloud
from pdr_est.estimators.particle.kernel import moved_by_kernel
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.plan import displacement
from pdr_est.estimators.particle.plan.displacement import (
    SHARE_DISPLACED,
    displacement_terms,
    draw_displacements,
    roughened_displacement,
    shift_at,
)
from pdr_est.estimators.particle.plan.plan_model import PlanModel
from pdr_est.frames import Array
from pdr_est.types.findings import FindingKind
from pdr_est.types.floor_plan import FloorPlan, WalkableArea
from pdr_est.types.measurements import DeviceMeasurements, Measurement, PositionFix, StartPose
from pdr_est.types.track import Track

START = StartPose((102.0, 100.0), 0.0, sigma_position_m=0.3, sigma_heading_rad=0.05)
LEGS = (34, 30, 30)  # steps of 0.7 m: east, north, west
NO_WALLS = np.zeros((0, 2, 2))


def corridors(*boxes: tuple[float, float, float, float]) -> FloorPlan:
    """Rooms (west, south, east, north) that do not overlap."""
    areas = tuple(WalkableArea(np.array([(w, s), (e, s), (e, n), (w, n)])) for w, s, e, n in boxes)
    return FloorPlan("test", areas, NO_WALLS, 0.1)


HOOK = corridors(
    (100.0, 98.8, 127.2, 101.2), (124.8, 101.2, 127.2, 120.0), (100.0, 120.0, 127.2, 122.4)
)  # three corridors of 2.4 m
CLOSED = corridors(
    (100.0, 98.8, 127.2, 101.2),
    (124.8, 101.2, 127.2, 107.0),
    (124.8, 112.0, 127.2, 120.0),
    (100.0, 120.0, 127.2, 122.4),
)
ROOMS = corridors(*[(90.0 + 5 * i, 90.0 + 5 * j, 93.5 + 5 * i, 93.5 + 5 * j) for i in range(9) for j in range(9)])


def walk() -> list[Measurement]:
    """East, north and west through the corridors, with a slight drift."""
    corners = {LEGS[0] + 1, LEGS[0] + LEGS[1] + 1}
    return [step(k, turn_rad=0.003 + (np.pi / 2.0 if k in corners else 0.0)) for k in range(1, sum(LEGS) + 1)]


def true_way() -> Array:
    heading = np.repeat([0.0, np.pi / 2.0, np.pi], LEGS)
    moves = 0.7 * np.stack([np.cos(heading), np.sin(heading)], axis=1)
    return np.asarray(np.array(START.position_m) + np.concatenate([np.zeros((1, 2)), np.cumsum(moves, axis=0)]))


def moved(plan: FloorPlan, change: Callable[[Array], Array]) -> FloorPlan:
    return replace(plan, areas=tuple(replace(area, outline_m=change(area.outline_m)) for area in plan.areas))


def smoothed(
    plan: FloorPlan | None, fixes: Sequence[PositionFix] = (), seed: int = 0, unrelated: float = 0.01
) -> Track:
    own = (*walk(), *fixes) if plan is None else (*walk(), *fixes, plan)
    settings = ParticleParams(seed=seed, unrelated_plan=unrelated)
    devices = [DeviceMeasurements(DEVICE, 0.0, own)]
    return estimate_walk("particle", devices, START, SIGMA_SCALE, particle=settings)


def error_m(track: Track) -> float:
    return float(np.hypot(*(track.position_m - true_way()).T).mean())


def test_the_right_plan_helps_and_nothing_is_told() -> None:
    track = smoothed(HOOK)
    assert error_m(track) < 0.6 * error_m(smoothed(None))
    assert track.findings == ()
    assert HOOK.contains(track.position_m).mean() > 0.99


@pytest.mark.parametrize("size_m", [30.0, 60.0, 200.0])
def test_a_hall_of_any_size_fits_a_walk_inside(size_m: float) -> None:
    """In a hall, to be far from all walls is not evidence against the plan."""
    track = smoothed(corridors((113.0 - size_m, 110.0 - size_m, 113.0 + size_m, 110.0 + size_m)))
    assert track.findings == ()
    assert track.on_plan


@pytest.mark.parametrize(
    "change",
    [
        lambda x: x + np.array([1.0, 0.0]),
        lambda x: x + np.array([0.0, 1.0]),
        lambda x: 1.02 * x - 0.02 * np.array([113.0, 110.0]),
    ],
    ids=["shifted east", "shifted north", "stretched about its centre"],
)
def test_a_displaced_plan_is_better_than_none(change: Callable[[Array], Array]) -> None:
    track = smoothed(moved(HOOK, change))
    assert error_m(track) < 0.9 * error_m(smoothed(None))
    assert track.findings == ()


def test_fixes_tell_that_a_plan_is_stretched(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stretched by 2 % about an origin 140 m away, the plan lies 2.8 m beside the walk."""
    fixes = [
        PositionFix(STEP_S * k, true_way()[k], 1.5**2 * np.eye(2), source="surveyed") for k in range(8, sum(LEGS), 8)
    ]
    stretched = moved(HOOK, lambda x: 1.02 * x)
    learnt = np.mean([error_m(smoothed(stretched, fixes, seed, unrelated=0.0)) for seed in range(4)])
    monkeypatch.setattr(displacement, "SHARE_DISPLACED", 0.0)
    as_drawn = np.mean([error_m(smoothed(stretched, fixes, seed, unrelated=0.0)) for seed in range(4)])
    assert learnt < 0.87 * as_drawn  # 0.67 over many seeds


def test_a_missing_corridor_is_passed() -> None:
    track = smoothed(CLOSED)
    assert error_m(track) < 0.8 * error_m(smoothed(None))


def test_the_plan_of_another_place_is_told() -> None:
    track, free = smoothed(ROOMS), smoothed(None)
    assert [finding.kind for finding in track.findings] == [FindingKind.PLAN]
    assert error_m(track) < 1.2 * error_m(free)


def test_equal_seeds_give_equal_tracks() -> None:
    first, again, other = smoothed(CLOSED), smoothed(CLOSED), smoothed(CLOSED, seed=1)
    assert np.array_equal(first.position_m, again.position_m)
    assert not np.array_equal(first.position_m, other.position_m)


def test_most_plans_are_as_drawn() -> None:
    rng = np.random.default_rng(0)
    drawn = draw_displacements(20_000, rng)
    as_drawn = (drawn == 0.0).all(axis=0)
    assert np.mean(~as_drawn) == pytest.approx(SHARE_DISPLACED, rel=0.1)
    later = roughened_displacement(drawn, rng)
    assert np.array_equal((later == 0.0).all(axis=0), as_drawn)
    assert later.std(axis=1) == pytest.approx(drawn.std(axis=1), rel=0.05)
    assert roughened_displacement(np.zeros((3, 5)), rng).tolist() == np.zeros((3, 5)).tolist()


def test_a_stretch_shifts_what_is_far_from_the_anchor() -> None:
    alike = np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 0.02]])
    shift_m = shift_at(alike, np.full((2, 2), 50.0), np.array([0.0, 50.0]))
    assert shift_m.tolist() == [[1.0, 1.0], [0.0, 0.0]]


def test_a_kernel_moves_no_particle_through_a_wall_of_the_displaced_plan() -> None:
    """The corridor is drawn 3 m too far to the south: in truth its walls are 2 and 4 m to the north."""
    rng = np.random.default_rng(0)
    plan = PlanModel.of(corridors((0.0, -1.0, 60.0, 1.0)), ParticleParams())
    cloud = Cloud(np.zeros((DEVICE_ROWS + PLAN_ROWS, 2000)), np.zeros(2000), 1)
    cloud.state[0], cloud.state[1] = 30.0, rng.uniform(2.05, 3.95, 2000)
    cloud.displacement[1:] = np.array([[3.0], [1e-9]])
    north_m = moved_by_kernel(cloud, rng, plan).state[1]
    assert np.mean(~np.isin(north_m, cloud.state[1])) > 0.5
    assert 1.85 < north_m.min() < north_m.max() < 4.15


def test_displacements_fit_those_alike() -> None:
    paths = np.array([[0.0, 0.4], [0.0, 0.0], [0.0, 0.01]])
    terms, factors = displacement_terms(paths, np.array([[0.0, 0.4, 0.8], [0.0, 0.0, 0.0], [0.0, 0.01, 0.01]]))
    twice = terms.T @ factors  # -2 times the log density
    assert np.diag(twice)[:2] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert twice[0, 1] > 1e3 < twice[1, 0]
    assert 0.0 < twice[1, 2] < 1e3
