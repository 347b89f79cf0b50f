"""Dominant directions of the walls of made-up plans."""

import numpy as np
import pytest
from heading_walks import park, with_headings

from pdr_est.frames import Array
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams, dominant_directions
from pdr_est.front_end.heading.whole_walk.straight_legs import StraightLegParams, straight_leg_sections
from pdr_est.front_end.heading.whole_walk.wall_directions import wall_directions
from pdr_est.types.floor_plan import FloorPlan, WalkableArea


def plan_of(walls_m: Array) -> FloorPlan:
    return FloorPlan("walls", (), walls_m, 0.2)


def walls(angles_deg: Array, rng: np.random.Generator, spread_deg: float = 0.5) -> Array:
    """Return one wall of 2 to 20 m anywhere along each angle, as exactly as it is drawn."""
    angle = np.deg2rad(angles_deg + spread_deg * rng.standard_normal(len(angles_deg)))
    begin = rng.uniform(0.0, 100.0, (len(angle), 2))
    along = rng.uniform(2.0, 20.0, len(angle))[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.stack([begin, begin + along], axis=1)


@pytest.mark.parametrize(("number", "first_deg"), [(4, 20.0), (4, 0.0), (6, 11.0), (2, 75.0), (8, 40.0)])
@pytest.mark.parametrize("seed", range(3))
def test_the_directions_of_a_building_are_found(number: int, first_deg: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles_deg = first_deg + 360.0 / number * rng.integers(number, size=60)
    others_deg = rng.uniform(0.0, 360.0, 20)
    found = wall_directions(plan_of(walls(np.concatenate([angles_deg, others_deg]), rng)))
    assert found is not None
    assert found.number == number
    spacing_deg = 360.0 / number
    off_deg = (np.degrees(found.direction_rad) - first_deg + spacing_deg / 2) % spacing_deg - spacing_deg / 2
    assert abs(off_deg) < 1.0
    assert found.share == pytest.approx(0.75, abs=0.2)


def test_walls_in_all_directions_have_none() -> None:
    rng = np.random.default_rng(5)
    assert wall_directions(plan_of(walls(rng.uniform(0.0, 360.0, 80), rng))) is None
    angles = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    disc = WalkableArea(30.0 * np.column_stack([np.cos(angles), np.sin(angles)]))
    assert wall_directions(FloorPlan("disc", (disc,), np.empty((0, 2, 2)), 0.2)) is None
    assert wall_directions(plan_of(np.empty((0, 2, 2)))) is None


def test_given_directions_that_are_not_certain_need_the_walk_to_follow_them() -> None:
    steps = with_headings(park(np.random.default_rng(1), 600))
    sections = straight_leg_sections(steps, StraightLegParams())
    certain = dominant_directions(sections, DominantParams(number=4, direction_rad=0.0))
    known = dominant_directions(sections, DominantParams(number=4, direction_rad=0.0, certain=False))
    assert certain is not None
    assert known is not None
    assert (certain.used, known.used) == (True, False)
    assert known.number == 4
