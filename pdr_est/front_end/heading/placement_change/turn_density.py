"""Probability densities of an angle on a grid around the full circle, and hypotheses from them.

Densities are relative to the uniform one: their mean is 1. The cell k is at k degrees less half a turn.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array, wrap_angle
from pdr_est.types.steps import TurnHypothesis

CELLS = 360
ANGLES_RAD: Array = (np.arange(CELLS) - CELLS // 2) * 2.0 * np.pi / CELLS
ANGLES_RAD.flags.writeable = False
_SECTORS = 8  # hypotheses for all directions that no peak covers
_CORE = 0.05  # a peak reaches to where its density is this share of the highest one
_WIDEST_PEAK = 120  # cells; anything wider is not near a Gaussian and divided into sectors
_TEMPER = 0.75  # exponent of the probabilities, ours
_LEAST_PROBABILITY = 1e-4  # hypotheses below this are left out
_BLUR_RAD = 0.035  # before peaks are sought: grain of the grid makes none


def gaussian(mean_rad: float, sigma_rad: float) -> Array:
    """Compute the density (360,) of a Gaussian angle, wrapped around the circle."""
    error = wrap_angle(ANGLES_RAD - mean_rad)
    turns = (-2.0 * np.pi, 0.0, 2.0 * np.pi)
    return normalised(np.sum([np.exp(-0.5 * ((error + turn) / sigma_rad) ** 2) for turn in turns], axis=0))


def mixed(*parts: tuple[float, Array]) -> Array:
    """Mix densities (360,) by their weights; what is missing to 1 is uniform."""
    total = sum((weight * density for weight, density in parts), np.zeros(CELLS))
    return np.asarray(total + max(1.0 - sum(weight for weight, _ in parts), 0.0))


def normalised(density: Array) -> Array:
    """Scale a density (360,) to a mean of 1."""
    return np.asarray(density / density.mean())


def difference(later: Array, earlier: Array, shift_rad: float) -> Array:
    """Compute the density (360,) of later − earlier + shift for independent angles with these densities."""
    frequency = np.arange(CELLS // 2 + 1)
    spectrum = np.fft.rfft(np.roll(later, -CELLS // 2)) * np.conj(np.fft.rfft(np.roll(earlier, -CELLS // 2)))
    density = np.fft.irfft(spectrum * np.exp(-1j * frequency * shift_rad), CELLS)
    return normalised(np.maximum(np.roll(density, CELLS // 2), 0.0) + 1e-9)


def mean_and_sigma(hypotheses: Sequence[TurnHypothesis]) -> tuple[float, float]:
    """Compute the circular mean, rad, and the standard deviation around it, rad, of a mixture of hypotheses."""
    weight = np.array([one.probability for one in hypotheses])
    angle = np.array([one.heading_change_rad for one in hypotheses])
    sigma = np.array([one.sigma_rad for one in hypotheses])
    mean = float(np.angle(np.sum(weight * np.exp(-0.5 * sigma**2) * np.exp(1j * angle))))
    variance = float(np.sum(weight * (sigma**2 + wrap_angle(angle - mean) ** 2)) / weight.sum())
    return mean, float(np.sqrt(variance))


def hypotheses_from(
    density: Array, cues: Sequence[tuple[str, Array]], least_sigma_rad: float
) -> tuple[TurnHypothesis, ...]:
    """Divide a density into hypotheses, the most probable one first.

    Each peak is one of them; what no peak covers is divided into sectors. Together they have the mean and the
    variance of the density.

    Parameters
    ----------
    density : ndarray, shape (360,)
        Density of the turn.
    cues : sequence of (str, ndarray)
        Name and density (360,) of what suggests a turn, to name the hypotheses by.
    least_sigma_rad : float
        Standard deviation, rad, that is added to each hypothesis.
    """
    part = _parts(density)
    found = []
    for number in range(int(part.max()) + 1):
        cells = np.flatnonzero(part == number)
        weight = density[cells]
        probability = float(weight.sum() / density.sum()) if len(cells) else 0.0
        if probability < _LEAST_PROBABILITY:
            continue
        middle = float(ANGLES_RAD[cells[int(np.argmax(weight))]])
        off = wrap_angle(ANGLES_RAD[cells] - middle)
        mean = float(np.sum(weight * off) / weight.sum())
        sigma = float(np.sqrt(np.sum(weight * (off - mean) ** 2) / weight.sum()))
        angle = float(wrap_angle(middle + mean))
        name = _origin(angle, cues) if number >= _SECTORS else "any direction"
        found.append(TurnHypothesis(probability, angle, float(np.hypot(sigma, least_sigma_rad)), name))
    total = sum(one.probability for one in found)
    found.sort(key=lambda one: -one.probability)
    return tuple(replace(one, probability=one.probability / total) for one in found)


def tempered(hypotheses: Sequence[TurnHypothesis]) -> tuple[TurnHypothesis, ...]:
    """Return hypotheses with probabilities that are nearer to each other.

    Strides of the same walk and the directions of the building are not independent, as the product of their densities
    has it. Over a whole walk there are many of them.
    """
    weight = np.array([one.probability for one in hypotheses]) ** _TEMPER
    shares = (weight / weight.sum()).tolist()
    return tuple(replace(one, probability=share) for one, share in zip(hypotheses, shares, strict=True))


def _parts(density: Array) -> NDArray[np.int64]:
    """Assign each cell (360,) to a part of the circle: a sector, or a peak, whose numbers come after the sectors."""
    width = CELLS // _SECTORS
    part = ((np.arange(CELLS) + width // 2) // width) % _SECTORS
    frequency = np.arange(CELLS // 2 + 1)
    blurred = np.fft.irfft(np.fft.rfft(density) * np.exp(-0.5 * (_BLUR_RAD * frequency) ** 2), CELLS)
    peaks = np.flatnonzero((blurred > np.roll(blurred, 1)) & (blurred >= np.roll(blurred, -1)))
    number = _SECTORS
    for peak in peaks.tolist():
        left, right = (_reach(np.roll(blurred, -peak)[::way], way) for way in (-1, 1))
        cells = np.arange(peak - left, peak + right + 1) % CELLS
        if len(cells) <= _WIDEST_PEAK:
            part[cells] = number
            number += 1
    return np.asarray(part)


def _reach(density: Array, way: int) -> int:
    """Count the cells from a peak to where its density ends or rises again, forwards (1) or backwards (-1)."""
    ahead = np.roll(density, 1) if way < 0 else density
    falling = (ahead[1:] <= ahead[:-1]) & (ahead[1:] >= _CORE * ahead[0])
    return int(np.argmin(np.append(falling, False)))


def _origin(angle_rad: float, cues: Sequence[tuple[str, Array]]) -> str:
    """Name the cue that speaks for an angle most."""
    cell = (round(angle_rad * CELLS / (2.0 * np.pi)) + CELLS // 2) % CELLS
    return max(cues, key=lambda cue: float(cue[1][cell]))[0] if cues else "any direction"
