"""Estimate the dominant directions of a building from the walk itself.

In a building the straight legs of a walk follow a few directions at equal angles: four in most, any number in others,
none in a park. The heading of a leg, modulo the spacing of the directions, then is the same all over the walk but for
the drift of the heading. Here that drift is a random walk on a circle of the spacing, whose steps are larger across
turns, and it is estimated by a forward and a backward pass over the sections of the legs.

The evidence for a building comes from turns alone: with dominant directions the heading after a turn is predicted up
to the drift, without them it is anywhere. How the heading moves along a leg says nothing, for both explain it as
drift; so a winding path is not taken for a bad gyroscope. A leg as a whole may be a diagonal, which tells nothing of
the drift. Numbers of directions and levels of drift are compared by their probability.

Ours, after the idea of heuristic drift elimination (Borenstein and Ojeda 2010), whose feedback needs the directions
beforehand.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.whole_walk.circular_grid import CircularGrid
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections, StraightLegParams
from pdr_est.params import params
from pdr_est.types.analysis import DominantDirections

# Prior probability of each number of directions; the rest is that there are none.
_NUMBER_PRIOR: Mapping[int, float] = MappingProxyType({2: 0.1, 3: 0.04, 4: 0.5, 5: 0.02, 6: 0.04, 8: 0.1})
_PRIOR_OF_NONE = 1.0 - sum(_NUMBER_PRIOR.values())


@dataclass(frozen=True)
class DriftLevel:
    """Level of the drift of headings.

    Attributes
    ----------
    per_sqrt_s : float
        Random walk along the way, rad per root second.
    per_turn : float
        Standard deviation of the change in a quarter turn, rad.
    of_section : float
        Standard deviation of a section around its direction, rad.
    probability : float
        Prior probability of such a phone.
    """

    per_sqrt_s: float
    per_turn: float
    of_section: float
    probability: float


# From a phone in a steady hand to one that slips about in a pocket.
_DRIFT_LEVELS = (
    DriftLevel(0.003, 0.045, 0.055, 0.25),
    DriftLevel(0.005, 0.07, 0.06, 0.3),
    DriftLevel(0.012, 0.14, 0.08, 0.25),
    DriftLevel(0.026, 0.2, 0.1, 0.15),
    DriftLevel(0.052, 0.26, 0.12, 0.05),
)
_OUTLIER_SHARE = 0.1  # share of sections off their direction, such as the rest of a corner or a detour; ours
_DIAGONAL_SHARE = 0.02  # share of legs that follow no dominant direction; ours
_LEG_PRIOR = np.array([1.0 - _DIAGONAL_SHARE, _DIAGONAL_SHARE])
_LEG_PRIOR.flags.writeable = False
_QUARTER_RAD = 0.5 * np.pi
_MOST_TURN = 2.0  # quarter turns beyond which a turn adds no more uncertainty


@params
class DominantParams:
    """Parameters of the search for dominant directions."""

    enabled: bool = True
    """True to look for dominant directions."""
    number: Annotated[int, Ge(1), Le(16)] | None = None
    """Given number of directions at equal angles; null estimates it, and whether there are any."""
    direction_rad: Annotated[float, Ge(-6.3), Le(6.3)] | None = None
    """One of the directions in the map, rad, null where unknown; given, the directions hold from the first step on,
    and without a number there are four.
    """
    least_log_odds: float = 2.0
    """Log odds of dominant directions against none from which on they are used; ours."""
    turn_rad: Annotated[float, Ge(0.1), Le(1.5)] = 0.44
    """Change of heading between legs, rad, below which it is no evidence; ours."""
    straight: StraightLegParams = StraightLegParams()
    """Parameters of the straight legs."""

    @property
    def given_number(self) -> int | None:
        """Return the given number of directions, None if it is to be estimated."""
        return 4 if self.number is None and self.direction_rad is not None else self.number


def dominant_directions(sections: LegSections, parameters: DominantParams) -> DominantDirections | None:
    """Estimate the most probable dominant directions of a walk; None for one without straight legs."""
    if not len(sections):
        return None
    number, log_odds, fitted = _best_fit(sections, parameters)
    used = parameters.given_number is not None or log_odds >= parameters.least_log_odds
    return _smooth(sections, fitted, number, log_odds, bool(used))


@dataclass(frozen=True)
class OffsetEvidence:
    """What the directions of a building tell about an error of all headings from one section on.

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
    _, log_odds, fitted = _best_fit(sections, parameters)
    building = 1.0 if parameters.given_number is not None else 1.0 / (1.0 + np.exp(-log_odds))
    future = _futures(fitted)
    found = {}
    for border in inside:
        i = int(np.searchsorted(sections.first, border))
        before = np.fft.rfft(fitted.forward[i - 1].sum(axis=0))
        after = np.fft.rfft(_LEG_PRIOR @ (fitted.likelihood[i] * future[i]))
        likelihood = np.fft.irfft(after * before.conj(), fitted.grid.cells)
        likelihood = building * np.maximum(likelihood / likelihood.mean(), 0.0) + 1.0 - building
        error = np.arange(fitted.grid.cells) * fitted.grid.spacing_rad / fitted.grid.cells
        found[border] = OffsetEvidence(fitted.grid.spacing_rad, error, likelihood)
    return found


def _best_fit(sections: LegSections, parameters: DominantParams) -> "tuple[int, float, _ForwardPass]":
    """Find the most probable number of directions, its log odds against none, and the forward pass of its drift."""
    given = parameters.given_number
    numbers = _NUMBER_PRIOR if given is None else {given: 1.0 - _PRIOR_OF_NONE}
    transitions = _Transitions.of(sections, parameters.turn_rad)
    passes = {
        number: [_forward_pass(sections, transitions, number, level) for level in _DRIFT_LEVELS] for number in numbers
    }
    log_odds = {
        number: _log_mean_over_levels([run.log_evidence for run in runs])
        - _log_mean_over_levels([run.log_evidence_of_none for run in runs])
        + np.log(numbers[number] / _PRIOR_OF_NONE)
        for number, runs in passes.items()
    }
    number = max(log_odds, key=lambda one: log_odds[one])
    best = max(
        zip(passes[number], _DRIFT_LEVELS, strict=True),
        key=lambda pair: pair[0].log_evidence + np.log(pair[1].probability),
    )
    return number, float(log_odds[number]), best[0]


@dataclass(frozen=True)
class _Transitions:
    """Transition from each section to the next one.

    `elapsed_s`; `quarter_turns`, 0 within a leg; `new_leg`, True if another leg begins; `informative`, True if so and
    by a turn that is evidence.
    """

    elapsed_s: Array
    quarter_turns: Array
    new_leg: NDArray[np.bool_]
    informative: NDArray[np.bool_]

    @classmethod
    def of(cls, sections: LegSections, turn_rad: float) -> "_Transitions":
        """Describe the transitions between sections; `turn_rad` is the least turn that is evidence."""
        change = np.abs(np.diff(sections.heading_rad))
        new_leg = np.diff(sections.leg) != 0
        quarter_turns = np.where(new_leg, np.minimum(change / _QUARTER_RAD, _MOST_TURN), 0.0)
        elapsed_s = np.maximum(np.diff(sections.time_s), 0.1)
        return cls(elapsed_s, quarter_turns, new_leg, new_leg & (change > turn_rad))


@dataclass(frozen=True)
class _ForwardPass:
    """Forward pass for one number of directions and one level of drift.

    `likelihood`, `forward`: (n, 2, cells) of each section and drift, if its leg follows a direction and if it is a
    diagonal. `sigma`: (n - 1,) of the drift between sections. `log_evidence`, `log_evidence_of_none`: log probability
    of the headings with dominant directions, and if each turn leads anywhere.
    """

    grid: CircularGrid
    level: DriftLevel
    likelihood: Array
    forward: Array
    sigma: Array
    new_leg: NDArray[np.bool_]
    log_evidence: float
    log_evidence_of_none: float


def _forward_pass(sections: LegSections, transitions: _Transitions, number: int, level: DriftLevel) -> _ForwardPass:
    grid = CircularGrid(2.0 * np.pi / number)
    along = grid.likelihood(sections.heading_rad, level.of_section, _OUTLIER_SHARE)
    walked = level.per_sqrt_s**2 * transitions.elapsed_s + (level.per_turn * transitions.quarter_turns) ** 2
    sigma = np.sqrt(walked + sections.sigma_change_rad[1:] ** 2)
    diagonal = _predictive_likelihoods(grid, along, sigma, transitions.new_leg)
    likelihood = np.stack([along, np.broadcast_to(diagonal[:, None], along.shape)], axis=1)
    belief = _LEG_PRIOR[:, None] * grid.uniform()
    log_evidence = 0.0
    forward = np.empty_like(likelihood)
    for i, row in enumerate(likelihood):
        if i:
            belief = grid.diffuse(belief, sigma[i - 1])
            if transitions.new_leg[i - 1]:
                belief = _LEG_PRIOR[:, None] * belief.sum(axis=0)
        belief = belief * row
        evidence = float(belief.sum(axis=0).mean())
        log_evidence += np.log(evidence)
        forward[i] = belief = belief / evidence
    log_evidence_of_none = float(np.log(_predictive_likelihoods(grid, along, sigma, transitions.informative)).sum())
    return _ForwardPass(
        grid, level, likelihood, forward, sigma, transitions.new_leg, log_evidence, log_evidence_of_none
    )


def _predictive_likelihoods(grid: CircularGrid, along: Array, sigma: Array, resets: NDArray[np.bool_]) -> Array:
    """Compute the likelihoods (n,) of the sections given those before, relative to the uniform density.

    `resets` (n - 1,) marks the transitions after which the direction may be any.
    """
    probability = np.empty(len(along))
    belief = grid.uniform()
    for i, row in enumerate(along):
        if i:
            belief = grid.uniform() if resets[i - 1] else grid.diffuse(belief, sigma[i - 1])
        belief = belief * row
        probability[i] = belief.mean()
        belief = belief / probability[i]
    return probability


def _log_mean_over_levels(logs: Sequence[float]) -> float:
    """Compute the log of the mean probability over the levels of drift."""
    weights = np.log([level.probability for level in _DRIFT_LEVELS])
    return float(np.logaddexp.reduce(np.array(logs) + weights))


def _smooth(
    sections: LegSections, fitted: _ForwardPass, number: int, log_odds: float, used: bool
) -> DominantDirections:
    """Compute the directions of the sections given all sections, by a backward pass."""
    belief = fitted.forward * _futures(fitted)
    mean, sigma = fitted.grid.mean_and_sigma(belief.sum(axis=1))
    straight = belief[:, 0].sum(axis=1) / belief.sum(axis=(1, 2))
    spacing = fitted.grid.spacing_rad
    drift = np.unwrap(mean, period=spacing)
    along = spacing * np.round((sections.heading_rad - drift) / spacing)
    error = (sections.heading_rad - drift - along) / fitted.level.of_section
    gaussian = (
        (1.0 - _OUTLIER_SHARE) * np.exp(-0.5 * error**2) * spacing / (fitted.level.of_section * np.sqrt(2.0 * np.pi))
    )
    return DominantDirections(
        number=number,
        log_odds=log_odds,
        used=used,
        spacing_rad=spacing,
        drift_per_sqrt_s=fitted.level.per_sqrt_s,
        drift_rad=drift - drift[0],
        sigma_rad=sigma,
        path_heading_rad=along + drift[0],
        follows=straight * gaussian / (gaussian + _OUTLIER_SHARE),
    )


def _futures(fitted: _ForwardPass) -> Array:
    """Compute the likelihood (n, 2, cells) of all later sections given the drift and the kind of leg of each section."""
    futures = np.ones_like(fitted.forward)
    for i in range(len(futures) - 1, 0, -1):
        future = futures[i] * fitted.likelihood[i]
        if fitted.new_leg[i - 1]:
            future = np.broadcast_to(_LEG_PRIOR @ future, future.shape)
        future = fitted.grid.diffuse(future, fitted.sigma[i - 1])
        futures[i - 1] = future / future.mean()
    return futures
