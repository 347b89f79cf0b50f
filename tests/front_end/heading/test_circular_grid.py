"""Densities around a circle against exact answers: wrapped normal distributions."""

import numpy as np
import pytest

from pdr_est.frames import Array
from pdr_est.front_end.heading.whole_walk.circular_grid import CircularGrid

SPACINGS = [2.0 * np.pi, np.pi, np.pi / 2.0, np.pi / 4.0]


def wrapped_normal(circle: CircularGrid, mean_rad: float, sigma_rad: float) -> Array:
    """Density (cells,) relative to the uniform one."""
    cell = circle.spacing_rad / circle.cells
    angle = (np.arange(circle.cells) + 0.5) * cell
    turns = np.arange(-40, 41)[:, None] * circle.spacing_rad
    bells = np.exp(-0.5 * ((angle + turns - mean_rad) / sigma_rad) ** 2).sum(axis=0)
    return np.asarray(bells * circle.spacing_rad / (sigma_rad * np.sqrt(2.0 * np.pi)))


@pytest.mark.parametrize("spacing_rad", SPACINGS)
@pytest.mark.parametrize("sigma_rad", [0.0, 0.05, 0.3, 3.0])
def test_to_spread_keeps_the_mass_and_leaves_nothing_negative(spacing_rad: float, sigma_rad: float) -> None:
    circle = CircularGrid(spacing_rad)
    density = np.zeros(circle.cells)
    density[3] = circle.cells
    spread = circle.diffuse(density, sigma_rad)
    assert spread.min() > 0.0
    # what the few waves of a grid leave below zero is cut off
    assert spread.mean() == pytest.approx(1.0, abs=0.05 if 0.0 < sigma_rad < 0.1 else 1e-6)


@pytest.mark.parametrize("spacing_rad", SPACINGS)
def test_wrapped_normals_spread_to_wrapped_normals(spacing_rad: float) -> None:
    """Variances add."""
    circle = CircularGrid(spacing_rad)
    spread = circle.diffuse(wrapped_normal(circle, 0.2, 0.1), 0.15)
    np.testing.assert_allclose(spread, wrapped_normal(circle, 0.2, np.hypot(0.1, 0.15)), atol=1e-6)


def test_nothing_is_known_after_much_spreading() -> None:
    circle = CircularGrid(np.pi / 2.0)
    np.testing.assert_allclose(circle.diffuse(wrapped_normal(circle, 0.3, 0.1), 5.0), circle.uniform(), atol=1e-6)


@pytest.mark.parametrize("outlier_share", [0.0, 0.1, 1.0])
@pytest.mark.parametrize("spacing_rad", SPACINGS)
def test_likelihoods_are_normalised_and_come_back_after_the_spacing(spacing_rad: float, outlier_share: float) -> None:
    circle = CircularGrid(spacing_rad)
    angles = np.array([-7.0, 0.0, 0.3, 12.0])
    likelihood = circle.likelihood(angles, 0.08, outlier_share)
    np.testing.assert_allclose(likelihood.mean(axis=1), 1.0)
    np.testing.assert_allclose(
        likelihood, circle.likelihood(angles + 3.0 * spacing_rad, 0.08, outlier_share), atol=1e-9
    )
    assert (likelihood >= outlier_share).all()
    if outlier_share == 0.0:
        np.testing.assert_allclose(likelihood[2], wrapped_normal(circle, 0.3, 0.08), atol=1e-3)


@pytest.mark.parametrize("spacing_rad", SPACINGS)
@pytest.mark.parametrize("mean_share", [-0.49, -0.2, 0.0, 0.37])
def test_mean_and_sigma_are_those_of_the_wrapped_normal(spacing_rad: float, mean_share: float) -> None:
    circle = CircularGrid(spacing_rad)
    sigmas = np.array([0.05, 0.1, 0.2]) * spacing_rad
    densities = np.array([wrapped_normal(circle, mean_share * spacing_rad, sigma) for sigma in sigmas])
    mean, sigma = circle.mean_and_sigma(densities)
    np.testing.assert_allclose(mean, mean_share * spacing_rad, atol=1e-6 * spacing_rad)
    np.testing.assert_allclose(sigma, sigmas, rtol=1e-6)


def test_of_the_uniform_density_the_sigma_is_more_than_the_spacing() -> None:
    circle = CircularGrid(np.pi / 2.0)
    _, sigma = circle.mean_and_sigma(circle.uniform()[None])
    assert sigma[0] > circle.spacing_rad


@pytest.mark.parametrize("spacing_rad", SPACINGS)
def test_many_densities_spread_as_each_of_them(spacing_rad: float) -> None:
    """Few are multiplied by matrices, many are Fourier transformed."""
    circle = CircularGrid(spacing_rad)
    sigmas = np.linspace(0.0, 0.3, 400)
    densities = np.random.default_rng(0).uniform(size=(400, circle.cells))
    together = circle.diffuse(densities, sigmas)
    alone = [circle.diffuse(density, sigma) for density, sigma in zip(densities, sigmas.tolist(), strict=True)]
    np.testing.assert_allclose(together, alone, atol=1e-12)
