"""Walks that may begin anywhere on their floor plan: places with probabilities, and when one of them is left."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from estimator_walks import DEVICE, SIGMA_SCALE, fix, heading_prior, step

from pdr_est.estimators import estimate_walk
from pdr_est.estimators.particle.cloud import DEVICE_ROWS, Cloud, systematic
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.places.modes import place_modes
from pdr_est.estimators.particle.places.resampling import shares_by_place
from pdr_est.frames import Array
from pdr_est.types.findings import FindingKind
from pdr_est.types.floor_plan import FloorPlan, WalkableArea
from pdr_est.types.measurements import DeviceMeasurements, Measurement, StartPose
from pdr_est.types.on_plan.places import PlaceMode, PlacesAt, PlaceSearch
from pdr_est.types.track import Track

APART_M = 100.0  # between two buildings


def corner(west_m: float, length_m: float, north_m: float = 30.0) -> WalkableArea:
    """Corridor to the east, of 2 m width, with one to the north at its end."""
    east = west_m + length_m
    return WalkableArea(
        np.array(
            [
                (west_m, -1.0),
                (east + 1.0, -1.0),
                (east + 1.0, north_m),
                (east - 1.0, north_m),
                (east - 1.0, 1.0),
                (west_m, 1.0),
            ]
        )
    )


def plan_of(*areas: WalkableArea) -> FloorPlan:
    return FloorPlan("test", areas, np.zeros((0, 2, 2)), 0.1)


def round_the_corner() -> list[Measurement]:
    """Twenty-five metres to the east and fourteen to the north, with north known."""
    walk: list[Measurement] = [step(k, turn_rad=np.pi / 2.0 if k == 37 else 0.0) for k in range(1, 58)]
    return [*walk, heading_prior(1, 0.0, 0.1)]


def found(measurements: Sequence[Measurement], start: StartPose | None = None, seed: int = 0) -> Track:
    devices = [DeviceMeasurements(DEVICE, 0.0, tuple(measurements))]
    settings = ParticleParams(seed=seed, most_start_particles=20_000)
    return estimate_walk("particle", devices, start or StartPose(), SIGMA_SCALE, particle=settings)


def search_of(track: Track) -> PlaceSearch:
    assert track.places is not None
    return track.places


@pytest.mark.parametrize("seed", range(2))
def test_two_equal_buildings_keep_half_of_the_probability_each(seed: int) -> None:
    plan = plan_of(corner(0.0, 30.0), corner(APART_M, 30.0))
    track = found([*round_the_corner(), plan], seed=seed)
    search = search_of(track)
    for places in (search.start, search.end):
        assert [mode.probability for mode in places.modes] == pytest.approx(
            [0.5, 0.5], abs=0.25
        )  # 0.06 over many seeds
        west, east = sorted(mode.position_m for mode in places.modes)
        assert east[0] - west[0] == pytest.approx(APART_M, abs=2.0)
        assert east[1] == pytest.approx(west[1], abs=1.0)
    assert search.unique_since is None
    assert track.distance_m == pytest.approx(57 * 0.7, rel=0.1)  # one of the paths, not the middle of both places
    assert plan.contains(track.position_m).mean() > 0.9
    assert search.filtered[0].walked_m == 0.0
    assert search.filtered[-1].walked_m == pytest.approx(57 * 0.7)
    assert all(before.time_s <= after.time_s for before, after in pairwise(search.filtered))
    assert not search.filtered[0].unique
    assert sum(mode.probability for mode in search.filtered[0].modes) == pytest.approx(1.0, abs=0.05)
    finding = next(one for one in track.findings if one.kind is FindingKind.PLAN)
    assert finding.doubtful
    assert "not decided" in finding.message
    assert "another place" in finding.message


def test_a_building_that_is_too_short_leaves_one_place() -> None:
    plan = plan_of(corner(0.0, 30.0), corner(APART_M, 12.0))
    track = found([*round_the_corner(), plan])
    search = search_of(track)
    since = search.unique_since
    assert since is not None
    assert 12.0 < since.walked_m < 39.0
    assert search.end.modes[0].position_m == pytest.approx((30.0, 14.0), abs=1.5)
    assert search.start.modes[0].position_m == pytest.approx((4.8, 0.0), abs=3.0)
    assert track.position_m[36] == pytest.approx([30.0, 0.0], abs=1.5)
    assert FindingKind.PLAN not in [finding.kind for finding in track.findings]
    assert "was found after" in search.words


def test_a_walk_with_a_known_start_or_a_fix_has_no_search() -> None:
    plan = plan_of(corner(0.0, 30.0))
    assert found([*round_the_corner(), plan], StartPose((4.8, 0.0))).places is None
    assert found([*round_the_corner(), fix(0, 4.8, 0.0, 0.5), plan]).places is None
    assert found(round_the_corner()).places is None


def test_a_plan_without_any_place_for_the_walk_is_told() -> None:
    rooms = [(4.0 * i, 4.0 * j) for i in range(6) for j in range(6)]
    areas = [WalkableArea(np.array([(x, y), (x + 3.0, y), (x + 3.0, y + 3.0), (x, y + 3.0)])) for x, y in rooms]
    track = found([*(step(k) for k in range(1, 51)), heading_prior(1, 0.0, 0.1), plan_of(*areas)])
    assert track.places is None
    assert any("does not fit this walk" in finding.message for finding in track.findings)


def test_modes_are_connected_regions() -> None:
    rng = np.random.default_rng(0)
    left, right = rng.normal(0.0, 1.5, (2, 3000)), rng.normal(0.0, 0.5, (2, 1000)) + np.array([[30.0], [5.0]])
    position = np.concatenate([left, right], axis=1)
    weights = np.concatenate([np.full(3000, 0.3 / 3000), np.full(1000, 0.7 / 1000)])
    modes = place_modes(position, weights)
    assert [mode.probability for mode in modes] == pytest.approx([0.7, 0.3], abs=0.01)
    assert modes[0].position_m == pytest.approx((30.0, 5.0), abs=0.1)
    assert [mode.sigma_m for mode in modes] == pytest.approx([0.5, 1.5], abs=0.15)


def test_a_whole_hall_is_one_place_but_not_a_unique_one() -> None:
    position = np.random.default_rng(1).uniform(0.0, 60.0, (2, 20_000))
    places = PlacesAt(0.0, 0.0, place_modes(position, np.full(20_000, 1.0 / 20_000)))
    assert len(places.modes) == 1
    assert places.modes[0].probability > 0.98
    assert not places.unique


def test_a_single_particle_is_a_mode() -> None:
    assert place_modes(np.array([[3.0], [4.0]]), np.ones(1)) == (PlaceMode(1.0, (3.0, 4.0), 0.0),)


def test_places_that_were_unique_in_between_are_not_unique() -> None:
    def places(walked_m: float, *probabilities: float) -> PlacesAt:
        return PlacesAt(walked_m, walked_m, tuple(PlaceMode(p, (0.0, 0.0), 1.0) for p in probabilities))

    one, two = (0.99,), (0.6, 0.4)
    filtered = (places(0, *two), places(1, *one), places(2, *two), places(3, *one), places(4, *one))
    assert PlaceSearch(filtered, places(0, *one), places(4, *one)).unique_since == filtered[3]
    assert PlaceSearch(filtered, places(0, *one), places(4, *two)).unique_since is None
    assert PlaceSearch(filtered[:3], places(0, *one), places(2, *one)).unique_since is None


def test_shares_by_place_keep_the_weights_and_take_more_of_the_improbable() -> None:
    state = np.zeros((DEVICE_ROWS, 2000))
    state[0, 1000:] = 50.0
    cloud = Cloud(state, np.where(np.arange(2000) < 1000, np.log(99.0), 0.0), 1)
    share = shares_by_place(cloud, cloud.weights)
    far = state[0] > 0.0
    assert share[far].sum() == pytest.approx(np.sqrt(0.01) / (np.sqrt(0.01) + np.sqrt(0.99)))
    kept = systematic(share, 2000, 0.5)
    left: Array = (cloud.weights / share)[kept]
    assert left[far[kept]].sum() / left.sum() == pytest.approx(0.01, rel=0.02)
