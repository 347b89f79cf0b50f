"""Beliefs about an angle that counts modulo a spacing, on a grid around the circle."""

import numpy as np

from pdr_est.frames import Array

_CELL_RAD = 0.035
_LEAST_CELLS = 18


class CircularGrid:
    """Probability densities, relative to the uniform one, of an angle modulo `spacing_rad`."""

    def __init__(self, spacing_rad: float) -> None:
        self.spacing_rad = spacing_rad
        self.cells = max(round(spacing_rad / _CELL_RAD), _LEAST_CELLS)
        self._angle = (np.arange(self.cells) + 0.5) * spacing_rad / self.cells
        self._frequency = np.fft.rfftfreq(self.cells, 1.0 / self.cells) * 2.0 * np.pi / spacing_rad

    def uniform(self) -> Array:
        return np.ones(self.cells)

    def spread(self, density: Array, sigma_rad: float) -> Array:
        """The density (cells,) after a Gaussian change of the angle."""
        decay = np.exp(-0.5 * (sigma_rad * self._frequency) ** 2)
        return np.maximum(np.fft.irfft(np.fft.rfft(density) * decay, self.cells), 1e-12)

    def likelihood(self, angles_rad: Array, sigma_rad: float, stray: float) -> Array:
        """Of each cell, (n, cells), for measured angles (n,), a share `stray` of which is anywhere."""
        half = 0.5 * self.spacing_rad
        off = (angles_rad[:, None] - self._angle + half) % self.spacing_rad - half
        bell = np.exp(-0.5 * (off / sigma_rad) ** 2)
        bell /= bell.mean(axis=1, keepdims=True)
        mixed: Array = (1.0 - stray) * bell + stray
        return mixed

    def mean(self, density: Array) -> tuple[Array, Array]:
        """Circular mean and standard deviation, both (n,), of densities (n, cells)."""
        turns = np.exp(2j * np.pi * self._angle / self.spacing_rad)
        moment = density @ turns / density.sum(axis=1)
        length = np.clip(np.abs(moment), 1e-9, 1.0)
        radian = self.spacing_rad / (2.0 * np.pi)
        return np.angle(moment) * radian, np.sqrt(-2.0 * np.log(length)) * radian
