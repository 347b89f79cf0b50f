"""Evidence of the directions of a building for the turn of a walker whose phone was put elsewhere.

A wrong turn is an error of all headings from there on, which the straight legs before and after show up to the angle
between two directions.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams, best_fit
from pdr_est.front_end.heading.whole_walk.drift_model import LEG_PRIOR
from pdr_est.front_end.heading.whole_walk.drift_passes import ForwardPass, backward_pass
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections

# Probability that the directions across a turn are twice as many: even where most corners have 90 degrees, some have
# 45. Half of it is for turns between the directions.
_HALVED_SHARE = 0.35


@dataclass(frozen=True)
class OffsetEvidence:
    """Likelihood of an error of all headings from one section on, by the directions of a building.

    Attributes
    ----------
    spacing_rad : float
        Angle between neighbouring directions, rad.
    error_rad : ndarray, shape (m,)
        Errors from 0 to the spacing, rad.
    likelihood : ndarray, shape (m,)
        Their likelihood over that without any building.
    """

    spacing_rad: float
    error_rad: Array
    likelihood: Array

    def at(self, error_rad: Array) -> Array:
        """Compute the likelihood of any errors (n,), rad."""
        return np.interp(error_rad, self.error_rad, self.likelihood, period=self.spacing_rad)


def offset_evidence(
    sections: LegSections, parameters: DominantParams, borders: Sequence[int]
) -> dict[int, OffsetEvidence]:
    """Compute what the directions tell about an error of the headings from some steps on.

    Parameters
    ----------
    sections : LegSections
        Sections of the straight legs.
    parameters : DominantParams
        Parameters of the search.
    borders : sequence of int
        Numbers of the first steps with the error.

    Returns
    -------
    dict of int to OffsetEvidence
        For each border that has sections on both sides.
    """
    inside = [border for border in borders if len(sections) and sections.first[0] < border <= sections.first[-1]]
    if not inside:
        return {}
    best = best_fit(sections, parameters)
    number, fitted = best.number, best.fitted
    building = 1.0 if parameters.followed else 1.0 / (1.0 + np.exp(-best.log_odds))
    passes = [(building, fitted)]
    if parameters.given_number is None:
        halved = best_fit(sections, replace(parameters, number=2 * number)).fitted
        passes = [(building * (1.0 - _HALVED_SHARE), fitted), (building * _HALVED_SHARE, halved)]
    error = np.arange(0.0, 2.0 * np.pi / number, np.deg2rad(1.0))
    likelihood = {border: np.full(len(error), 1.0 - building) for border in inside}
    for weight, one in passes:
        future = backward_pass(one)
        for border in inside:
            i = int(np.searchsorted(sections.first, border))
            likelihood[border] += weight * _error_likelihood(one, future, i, error)
    return {border: OffsetEvidence(2.0 * np.pi / number, error, values) for border, values in likelihood.items()}


def _error_likelihood(fitted: ForwardPass, future: Array, section: int, error_rad: Array) -> Array:
    """Compute the likelihood of errors (m,), rad, of all headings from one section on, relative to any error."""
    before = np.fft.rfft(fitted.forward[section - 1].sum(axis=0))
    after = np.fft.rfft(LEG_PRIOR @ (fitted.likelihood[section] * future[section]))
    found = np.maximum(np.fft.irfft(after * before.conj(), fitted.grid.cells), 0.0)
    cell_rad = fitted.grid.spacing_rad / fitted.grid.cells
    at = np.arange(fitted.grid.cells) * cell_rad
    return np.asarray(np.interp(error_rad, at, found / found.mean(), period=fitted.grid.spacing_rad))
