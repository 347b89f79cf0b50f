"""Probability densities of an angle modulo a spacing, on a grid around the circle."""

import numpy as np

from pdr_est.frames import Array

_CELL_RAD = 0.035
_LEAST_CELLS = 18


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

    def uniform(self) -> Array:
        """Return the uniform density (cells,)."""
        return np.ones(self.cells)

    def diffuse(self, density: Array, sigma_rad: float) -> Array:
        """Compute the density (..., cells) after a Gaussian change of the angle."""
        return self.damp(density, self.damping(sigma_rad))

    def damping(self, sigma_rad: Array | float) -> Array:
        """Compute what Gaussian changes with sigmas (...), rad, leave of each frequency, (..., frequencies)."""
        damping: Array = np.exp(-0.5 * (np.asarray(sigma_rad)[..., None] * self._frequency) ** 2)
        return damping

    def damp(self, density: Array, damping: Array) -> Array:
        """Compute densities (..., cells) after changes that leave so much of each frequency."""
        return np.maximum(np.fft.irfft(np.fft.rfft(density) * damping, self.cells), 1e-12)

    def likelihood(self, angles_rad: Array, sigma_rad: Array | float, outlier_share: float) -> Array:
        """Compute the likelihood of measured angles in each cell.

        Parameters
        ----------
        angles_rad : ndarray, shape (...)
            Measured angles.
        sigma_rad : float or ndarray that fits to it
            Standard deviation of a measurement.
        outlier_share : float
            Probability of a measurement that may be any angle.

        Returns
        -------
        ndarray, shape (..., cells)
            Relative to the uniform density.
        """
        half = 0.5 * self.spacing_rad
        error = (angles_rad[..., None] - self._angle + half) % self.spacing_rad - half
        gaussian = np.exp(-0.5 * (error / np.asarray(sigma_rad)[..., None]) ** 2)
        gaussian /= gaussian.mean(axis=-1, keepdims=True)
        mixed: Array = (1.0 - outlier_share) * gaussian + outlier_share
        return mixed

    def mean_and_sigma(self, density: Array) -> tuple[Array, Array]:
        """Compute circular mean and standard deviation, both (n,), of densities (n, cells)."""
        phasor = np.exp(2j * np.pi * self._angle / self.spacing_rad)
        moment = density @ phasor / density.sum(axis=1)
        length = np.clip(np.abs(moment), 1e-9, 1.0)
        radian = self.spacing_rad / (2.0 * np.pi)
        return np.angle(moment) * radian, np.sqrt(-2.0 * np.log(length)) * radian
