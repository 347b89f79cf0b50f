"""Densities of a turn on the circle and the hypotheses from them."""

import numpy as np
import pytest

from pdr_est.frames import wrap_angle
from pdr_est.front_end.heading.placement_change.turn_density import (
    ANGLES_RAD,
    CELLS,
    difference,
    gaussian,
    hypotheses_from,
    mean_and_sigma,
    mixed,
)


def mixture(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet(np.ones(4))
    return mixed(*((float(w), gaussian(rng.uniform(-3.1, 3.1), rng.uniform(0.03, 0.6))) for w in weights[:3]))


@pytest.mark.parametrize("mean_deg", [-180.0, -95.5, 0.0, 30.0, 179.0])
def test_a_gaussian_has_its_mean_and_sigma_anywhere_on_the_circle(mean_deg: float) -> None:
    density = gaussian(np.deg2rad(mean_deg), 0.2)
    assert density.mean() == pytest.approx(1.0)
    off = wrap_angle(ANGLES_RAD - np.deg2rad(mean_deg))
    assert np.sum(density * off) / CELLS == pytest.approx(0.0, abs=1e-3)
    assert np.sqrt(np.sum(density * off**2) / CELLS) == pytest.approx(0.2, rel=1e-3)


def test_the_rest_of_a_mixture_is_uniform() -> None:
    density = mixed((0.9, gaussian(0.0, 0.1)))
    assert density.mean() == pytest.approx(1.0)
    assert density[0] == pytest.approx(0.1)


@pytest.mark.parametrize(("later", "earlier", "shift"), [(0.5, 0.2, 0.0), (2.0, -2.0, 1.0), (-3.0, 3.0, -2.5)])
def test_the_difference_of_two_angles(later: float, earlier: float, shift: float) -> None:
    found = difference(gaussian(later, 0.15), gaussian(earlier, 0.2), shift)
    np.testing.assert_allclose(found, gaussian(later - earlier + shift, 0.25), atol=1e-3 * found.max())


@pytest.mark.parametrize("seed", range(25))
def test_hypotheses_have_the_mean_and_the_variance_of_the_density(seed: int) -> None:
    density = mixture(seed)
    found = hypotheses_from(density, (), 0.0)
    assert sum(one.probability for one in found) == pytest.approx(1.0)
    assert [one.probability for one in found] == sorted((one.probability for one in found), reverse=True)
    assert all(one.sigma_rad < 0.65 for one in found)
    mean, sigma = mean_and_sigma(found)
    exact = float(np.angle(np.sum(density * np.exp(1j * ANGLES_RAD))))
    if abs(np.mean(density * np.exp(1j * ANGLES_RAD))) > 0.2:  # otherwise there is no mean
        assert wrap_angle(mean - exact) == pytest.approx(0.0, abs=0.03)
        spread = np.sqrt(np.sum(density * wrap_angle(ANGLES_RAD - mean) ** 2) / density.sum())
        assert sigma == pytest.approx(spread, rel=0.08)


def test_two_peaks_and_the_rest_are_told_apart_and_named() -> None:
    straight, axis = gaussian(0.0, 0.05), gaussian(1.2, 0.1)
    found = hypotheses_from(
        mixed((0.6, straight), (0.3, axis)), (("straight on", straight), ("principal axis", axis)), 0.02
    )
    assert [one.origin for one in found[:2]] == ["straight on", "principal axis"]
    assert found[0].probability == pytest.approx(0.6, abs=0.05)
    assert found[1].heading_change_rad == pytest.approx(1.2, abs=0.02)
    rest = [one for one in found if one.origin == "any direction"]
    assert len(rest) >= 5
    assert 0.02 < sum(one.probability for one in rest) < 0.1


def test_a_uniform_density_has_hypotheses_all_around() -> None:
    found = hypotheses_from(np.ones(CELLS), (), 0.02)
    assert len(found) == 8
    mean, sigma = mean_and_sigma(found)
    assert sigma == pytest.approx(np.pi / np.sqrt(3.0), rel=0.02)
    assert -np.pi <= mean <= np.pi
