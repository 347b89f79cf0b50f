"""A plan knows which positions lie on its walkable area, and how far others are from it."""

import numpy as np
import pytest

from pdr_est.types.floor_plan import FloorPlan, WalkableArea

SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [0.0, 8.0]])
HOLE = np.array([[4.0, 3.0], [4.0, 5.0], [6.0, 5.0], [6.0, 3.0]])
WALL = np.array([[[0.0, 6.0], [8.0, 6.0]]])
PLAN = FloorPlan("hall", (WalkableArea(SQUARE, (HOLE,)), WalkableArea(SQUARE + np.array([20.0, 0.0]))), WALL, 0.2)


@pytest.mark.parametrize(
    ("position_m", "outside_m"),
    [
        ((1.0, 1.0), 0.0),
        ((5.0, 4.0), 1.0),
        ((5.5, 4.0), 0.5),
        ((12.0, 4.0), 2.0),
        ((25.0, 4.0), 0.0),
        ((33.0, 12.0), 5.0),
        ((-3.0, -4.0), 5.0),
        ((5.0, 7.0), 0.0),
    ],
)
def test_positions_are_inside_or_at_their_distance(position_m: tuple[float, float], outside_m: float) -> None:
    position = np.array([position_m])
    assert PLAN.contains(position).tolist() == [outside_m == 0.0]
    assert PLAN.distance_outside_m(position) == pytest.approx([outside_m])


def test_barriers_are_the_borders_and_the_walls() -> None:
    assert PLAN.borders_m.shape == (12, 2, 2)
    assert PLAN.barriers_m.shape == (13, 2, 2)
    np.testing.assert_array_equal(PLAN.barriers_m[-1], WALL[0])
    assert PLAN.area_m2 == pytest.approx(2 * 80.0 - 4.0)
    assert PLAN.bounds_m == (0.0, 0.0, 30.0, 8.0)


def test_shares_of_a_fine_grid_equal_the_areas() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
    disc = FloorPlan(
        "disc", (WalkableArea(np.column_stack([np.cos(angles), np.sin(angles)])),), np.empty((0, 2, 2)), 0.1
    )
    positions = np.random.default_rng(1).uniform(-1.0, 1.0, (20_000, 2))
    assert disc.contains(positions).mean() == pytest.approx(disc.area_m2 / 4.0, abs=0.01)
    radius_m = np.hypot(*positions.T)
    assert disc.distance_outside_m(positions) == pytest.approx(np.maximum(radius_m - 1.0, 0.0), abs=1e-3)
