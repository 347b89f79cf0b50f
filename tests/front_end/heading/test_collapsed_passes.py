"""The approximate comparison of all drifts against the passes on a grid, and the search that relies on it."""

import numpy as np
import pytest
from heading_walks import of_legs, park, random_legs, unsteady, with_headings

from pdr_est.frames import Array
from pdr_est.front_end.heading.whole_walk.collapsed_passes import collapsed_evidences
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams, best_fit
from pdr_est.front_end.heading.whole_walk.drift_model import DRIFT_LEVELS, Drift, DriftEvidence, SectionTransitions
from pdr_est.front_end.heading.whole_walk.drift_passes import DriftPasses
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections, StraightLegParams, straight_leg_sections

PARAMETERS = DominantParams()
RATES_RADPS = (0.0, 0.002, -0.004)
DRIFTS = [Drift(level, rate, np.log(level.probability)) for level in DRIFT_LEVELS for rate in RATES_RADPS]


def building(seed: int, legs: int, spacing_deg: float = 90.0, rate_radps: float = 0.0) -> Array:
    rng = np.random.default_rng(seed)
    heading = unsteady(random_legs(rng, spacing_deg, legs), rng, 0.003)
    return np.asarray(heading + rate_radps * 0.5 * np.arange(len(heading)))


def sections_of(heading_rad: Array) -> tuple[LegSections, SectionTransitions]:
    sections = straight_leg_sections(with_headings(heading_rad), StraightLegParams())
    return sections, SectionTransitions.of(sections, PARAMETERS.turn_rad)


def approximate_and_exact(heading_rad: Array, number: int) -> tuple[list[DriftEvidence], list[DriftEvidence]]:
    sections, transitions = sections_of(heading_rad)
    approximate = collapsed_evidences(sections, transitions, {5: DRIFTS[:1], number: DRIFTS})[number]
    return approximate, DriftPasses(sections, transitions, number, DRIFTS).evidences


@pytest.mark.parametrize("legs", [1, 5, 40])
@pytest.mark.parametrize(("spacing_deg", "number"), [(90.0, 4), (60.0, 6), (45.0, 8)])
def test_the_evidence_of_steady_headings_is_that_on_a_grid(legs: int, spacing_deg: float, number: int) -> None:
    """Also of a walk that is divided into blocks, and without directions."""
    approximate, exact = approximate_and_exact(building(legs, legs, spacing_deg), number)
    assert [one.drift for one in approximate] == [one.drift for one in exact] == DRIFTS
    steady = [k for k, one in enumerate(exact) if not one.drift.rate_radps and one.drift.level.tells_directions]
    for name in ("log_evidence", "log_evidence_of_none"):
        own, on_grid = (np.array([getattr(one, name) for one in several]) for several in (approximate, exact))
        np.testing.assert_array_equal(np.isnan(own), np.isnan(on_grid))
        np.testing.assert_allclose(own[steady], on_grid[steady], rtol=0.03, atol=2.0)


@pytest.mark.parametrize("rate_radps", RATES_RADPS)
def test_the_most_probable_rate_is_that_on_a_grid(rate_radps: float) -> None:
    approximate, exact = approximate_and_exact(building(3, 30, rate_radps=rate_radps), 4)
    best = [max(several, key=lambda one: one.log_evidence) for several in (approximate, exact)]
    assert best[0].drift == best[1].drift
    assert best[0].drift.rate_radps == rate_radps


def test_an_isolated_diagonal_costs_no_more_than_on_a_grid() -> None:
    """The directions from before the diagonal hold after it."""
    right = [(90.0 * (k % 2), 30) for k in range(6)]
    heading = unsteady(of_legs([*right, (33.0, 40), *right]), np.random.default_rng(0), 0.003)
    approximate, exact = approximate_and_exact(heading, 4)
    assert approximate[0].log_evidence == pytest.approx(exact[0].log_evidence, abs=3.0)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("legs", [6, 60])
@pytest.mark.parametrize("diagonals", [0.0, 0.1])
def test_the_search_finds_what_a_full_one_finds(seed: int, legs: int, diagonals: float) -> None:
    rng = np.random.default_rng(seed)
    direction = np.cumsum(rng.choice([-90.0, 90.0], legs)) + np.where(rng.random(legs) < diagonals, 35.0, 0.0)
    heading = unsteady(of_legs([(float(one), int(rng.integers(10, 40))) for one in direction]), rng, 0.005)
    check_search(heading)


def test_the_search_in_a_park_finds_what_a_full_one_finds() -> None:
    check_search(unsteady(park(np.random.default_rng(5), 400), np.random.default_rng(6), 0.004))


def check_search(heading_rad: Array) -> None:
    """Compare with the search among all drifts with the number that was found, which is what a given number means."""
    sections, transitions = sections_of(heading_rad)
    found = best_fit(sections, PARAMETERS)
    drift = found.fitted.drift
    same_rate = [Drift(level, drift.rate_radps, np.log(level.probability)) for level in DRIFT_LEVELS]
    passes = DriftPasses(sections, transitions, found.number, same_rate)
    telling = [one for one in passes.evidences if one.drift.level.tells_directions]
    best = max(telling, key=lambda one: one.log_evidence + one.drift.log_prior)
    assert best.drift.level == drift.level
    alone = DriftPasses(sections, transitions, found.number, [drift]).forward_pass(drift)
    np.testing.assert_allclose(found.fitted.forward, alone.forward, rtol=1e-9, atol=1e-12)
    given = best_fit(sections, DominantParams(number=found.number))
    assert given.number == found.number


def test_forward_passes_of_few_drifts_are_kept() -> None:
    sections, transitions = sections_of(building(0, 6))
    assert DriftPasses(sections, transitions, 4, DRIFTS[:3]).has_forward(DRIFTS[2])
    assert not DriftPasses(sections, transitions, 4, DRIFTS[:3]).has_forward(DRIFTS[3])
    assert not DriftPasses(sections, transitions, 4, DRIFTS).has_forward(DRIFTS[0])
