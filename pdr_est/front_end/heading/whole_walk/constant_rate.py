"""Candidates for the constant rate with which headings drift: the bias of the gyroscope.

With dominant directions the headings of all straight legs, modulo the spacing of the directions, agree once the rate
is taken off. So the candidates are the rates at which they agree best; the passes over the drift decide.
"""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections

_LARGEST_RADPS = np.deg2rad(0.9)  # beyond, nothing is known of such gyroscopes; ours
# Prior: half of the phones have no bias that matters in a walk, the biases of the others are Student t distributed
# with 3 degrees of freedom. Of 60 recorded walks the middle half drifts by less than 0.12 degrees per second, truth's
# own errors included, and one in twenty by more than 0.3.
_UNBIASED_SHARE = 0.5
_SCALE_RADPS = np.deg2rad(0.15)
_MOST_CANDIDATES = 3


def rate_candidates(sections: LegSections, number: int) -> list[tuple[float, float]]:
    """Find constant rates at which the headings of the sections agree, with the log of their prior probability.

    Parameters
    ----------
    sections : LegSections
        Sections of the straight legs, at least one.
    number : int
        Number of directions.

    Returns
    -------
    list of (float, float)
        Rate, rad/s, and log of its prior probability; the first one is zero.
    """
    none = (0.0, float(np.log(_UNBIASED_SHARE)))
    time_s = sections.time_s - sections.time_s.mean()
    spread_s = float(time_s.std())
    if not spread_s:
        return [none]
    width = 0.5 / (number * spread_s)  # within it the agreement hardly changes
    count = int(min(np.ceil(4.0 * _LARGEST_RADPS / width), 1000))
    rates = np.linspace(-_LARGEST_RADPS, _LARGEST_RADPS, 2 * count + 1)
    agreement = _agreement(sections, number, time_s, rates)
    inner = agreement[1:-1]
    peaks = 1 + np.flatnonzero(
        (inner >= agreement[:-2]) & (inner >= agreement[2:]) & (np.abs(rates[1:-1]) > 0.5 * width)
    )
    best = peaks[np.argsort(-agreement[peaks])][:_MOST_CANDIDATES]
    return [none, *zip(rates[best].tolist(), np.log(_mass(rates[best], width)).tolist(), strict=True)]


def _agreement(sections: LegSections, number: int, time_s: Array, rates_radps: Array) -> Array:
    """Compute the length, 0 to 1, of the mean unit vector of the headings at equally spaced rates (n,).

    Every rate is the sum of a multiple of a large spacing and one of a small spacing, so that the unit vectors of all
    of them are products of few.
    """
    few = int(np.ceil(np.sqrt(len(rates_radps))))
    spacing = float(rates_radps[1] - rates_radps[0])
    steps = sections.last - sections.first
    coarse = number * (sections.heading_rad - (rates_radps[0] + spacing * few * np.arange(few)[:, None]) * time_s)
    fine = (-number * spacing * np.arange(few)) * time_s[:, None]
    total = (steps * _unit(coarse)) @ _unit(fine)
    return np.asarray(np.abs(total).reshape(-1)[: len(rates_radps)] / steps.sum())


def _unit(angle_rad: Array) -> NDArray[np.complex128]:
    unit = np.empty(angle_rad.shape, dtype=np.complex128)
    np.cos(angle_rad, out=unit.real)
    np.sin(angle_rad, out=unit.imag)
    return unit


def _mass(rate_radps: Array, width_radps: float) -> Array:
    """Compute the prior probability within a width around each rate (n,)."""
    t = rate_radps / _SCALE_RADPS
    density = 2.0 / (np.pi * np.sqrt(3.0) * _SCALE_RADPS) * (1.0 + t**2 / 3.0) ** -2
    return np.asarray((1.0 - _UNBIASED_SHARE) * density * width_radps)
