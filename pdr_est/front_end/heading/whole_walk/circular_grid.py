"""Probability densities of an angle modulo a spacing, on a grid around the circle."""

from functools import lru_cache

import numpy as np

from pdr_est.frames import Array

_CELL_RAD = 0.035
_LEAST_CELLS = 18
_LEAST_DENSITY = 1e-12
_LARGEST_PRODUCT = 1 << 18  # multiplications: products with matrices are faster than Fourier transforms only below


class CircularGrid:
    """Grid around the circle; densities are relative to the uniform one.

    Parameters
    ----------
    spacing_rad : float
        Angle after which everything repeats.

    Attributes
    ----------
    spacing_rad : float
        The same.
    cells : int
        Number of cells.
    """

    def __init__(self, spacing_rad: float) -> None:
        self.spacing_rad = spacing_rad
        self.cells = max(round(spacing_rad / _CELL_RAD), _LEAST_CELLS)
        self._angle = (np.arange(self.cells) + 0.5) * spacing_rad / self.cells
        self._frequency = np.fft.rfftfreq(self.cells, 1.0 / self.cells) * 2.0 * np.pi / spacing_rad
        self._to_waves, self._from_waves = _waves(self.cells)

    def uniform(self) -> Array:
        """Return the uniform density (cells,)."""
        return np.ones(self.cells)

    def diffuse(self, density: Array, sigma_rad: float) -> Array:
        """Compute the density (..., cells) after a Gaussian change of the angle."""
        return self.damp(density, self.damping(sigma_rad))

    def damping(self, sigma_rad: Array | float) -> Array:
        """Compute what Gaussian changes with sigmas (...), rad, leave of each frequency, (..., 2 * frequencies).

        All frequencies come twice, for the cosines and for the sines.
        """
        damping = np.exp(-0.5 * (np.asarray(sigma_rad)[..., None] * self._frequency) ** 2)
        return np.concatenate([damping, damping], axis=-1)

    def damp(self, density: Array, damping: Array) -> Array:
        """Compute densities (..., cells) after changes that leave so much of each frequency, by `damping`."""
        if density.size * self.cells > _LARGEST_PRODUCT:
            left = np.fft.rfft(density) * damping[..., : len(self._frequency)]
            return np.maximum(np.fft.irfft(left, self.cells), _LEAST_DENSITY)
        shape = density.shape
        waves = (density.reshape(-1, self.cells) @ self._to_waves).reshape(*shape[:-1], -1)
        waves *= damping
        damped = (waves.reshape(-1, waves.shape[-1]) @ self._from_waves).reshape(shape)
        return np.maximum(damped, _LEAST_DENSITY, out=damped)

    def likelihood(self, angles_rad: Array, sigma_rad: Array | float, outlier_share: float) -> Array:
        """Compute the likelihood of measured angles in each cell.

        Parameters
        ----------
        angles_rad : ndarray, shape (...)
            Measured angles.
        sigma_rad : float or ndarray that broadcasts with it
            Standard deviation of a measurement.
        outlier_share : float
            Probability of a measurement that may be any angle.

        Returns
        -------
        ndarray, shape (..., cells)
            Relative to the uniform density.
        """
        likelihood = (angles_rad / self.spacing_rad)[..., None] - self._angle / self.spacing_rad
        likelihood -= np.rint(likelihood)
        likelihood *= (self.spacing_rad / np.asarray(sigma_rad))[..., None]
        likelihood *= likelihood
        likelihood *= -0.5
        np.exp(likelihood, out=likelihood)
        likelihood *= (1.0 - outlier_share) / likelihood.mean(axis=-1, keepdims=True)
        likelihood += outlier_share
        return np.asarray(likelihood)

    def mean_and_sigma(self, density: Array) -> tuple[Array, Array]:
        """Compute circular mean and standard deviation, both (n,), of densities (n, cells)."""
        radian = self.spacing_rad / (2.0 * np.pi)
        phase = self._angle / radian
        total, cos, sin = density.sum(axis=1), density @ np.cos(phase), density @ np.sin(phase)
        length = np.clip(np.hypot(cos, sin) / total, 1e-9, 1.0)
        return np.arctan2(sin, cos) * radian, np.sqrt(-2.0 * np.log(length)) * radian


@lru_cache(maxsize=16)
def _waves(cells: int) -> tuple[Array, Array]:
    """Return the matrices of a discrete Fourier transform of real numbers, and of its inverse.

    The frequencies come twice, first for the cosines and then for the sines.
    """
    frequency = np.arange(cells // 2 + 1)
    phase = np.outer(np.arange(cells), frequency) % cells * (2.0 * np.pi / cells)
    waves = np.concatenate([np.cos(phase), np.sin(phase)], axis=1)
    twice = np.where((frequency > 0) & (2 * frequency < cells), 2.0, 1.0)
    return waves, np.ascontiguousarray(waves.T * (np.tile(twice, 2)[:, None] / cells))
