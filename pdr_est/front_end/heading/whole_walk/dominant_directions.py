"""Estimate the dominant directions of a building from the walk itself.

In a building the straight legs of a walk follow a few directions at equal angles: four in most, any number in others,
none in a park. The heading of a leg, modulo the spacing of the directions, then is the same all over the walk but for
the drift of the heading. Here that drift has a constant rate, by the bias of the gyroscope, and a random walk on a
circle of the spacing, whose steps are larger across turns; it is estimated by a forward and a backward pass over the
sections of the legs.

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

from pdr_est.front_end.heading.whole_walk.constant_rate import rate_candidates
from pdr_est.front_end.heading.whole_walk.drift_passes import (
    DRIFT_LEVELS,
    OUTLIER_SHARE,
    Drift,
    DriftEvidence,
    ForwardPass,
    SectionTransitions,
    backward_pass,
    drift_evidences,
    forward_pass,
)
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections, StraightLegParams
from pdr_est.params import params
from pdr_est.types.analysis import DominantDirections

# Prior probability of each number of directions; the rest is that there are none.
_NUMBER_PRIOR: Mapping[int, float] = MappingProxyType({2: 0.1, 3: 0.04, 4: 0.5, 5: 0.02, 6: 0.04, 8: 0.1})
_PRIOR_OF_NONE = 1.0 - sum(_NUMBER_PRIOR.values())


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
    least_log_odds: float = 0.5
    """Log odds of dominant directions that the headings are steady enough to tell, against all else, from which on
    they are used; above the 0.2 of a straight walk, which has no evidence of any.
    """
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
    best = best_fit(sections, parameters)
    used = parameters.given_number is not None or best.log_odds >= parameters.least_log_odds
    return _smooth(sections, best, bool(used))


@dataclass(frozen=True)
class BestFit:
    """The most probable number of directions, and how the headings drift with it.

    Attributes
    ----------
    number : int
        Number of directions.
    log_odds : float
        Its log odds against all else.
    fitted : ForwardPass
        Forward pass of the most probable drift.
    mean_rate_radps : float
        Mean of the constant rate, rad/s, over the drifts with this number and over all else, where it is zero.
    """

    number: int
    log_odds: float
    fitted: ForwardPass
    mean_rate_radps: float


def best_fit(sections: LegSections, parameters: DominantParams) -> BestFit:
    """Find the most probable number of directions and drift of the headings.

    Parameters
    ----------
    sections : LegSections
        Sections of the straight legs, at least one.
    parameters : DominantParams
        Parameters of the search.
    """
    given = parameters.given_number
    numbers = _NUMBER_PRIOR if given is None else {given: 1.0 - _PRIOR_OF_NONE}
    transitions = SectionTransitions.of(sections, parameters.turn_rad)
    passes = {number: drift_evidences(sections, transitions, number, _drifts(sections, number)) for number in numbers}
    usable = {
        number: [run for run in runs if given is not None or run.drift.level.tells_directions]
        for number, runs in passes.items()
    }
    log_odds = {
        number: _log_probability(usable[number]) + np.log(prior) - _log_probability_else(passes[number], prior)
        for number, prior in numbers.items()
    }
    number = max(log_odds, key=lambda one: log_odds[one])
    best = max(usable[number], key=lambda run: run.log_evidence + run.drift.log_prior)
    weight = np.exp([run.log_evidence + run.drift.log_prior - best.log_evidence for run in usable[number]])
    rate = weight @ [run.drift.rate_radps for run in usable[number]] / weight.sum()
    fitted = forward_pass(sections, transitions, number, best.drift)
    return BestFit(number, float(log_odds[number]), fitted, float(rate / (1.0 + np.exp(-log_odds[number]))))


def _drifts(sections: LegSections, number: int) -> list[Drift]:
    """List the drifts that are compared: each level of the random walk with each constant rate."""
    rates = rate_candidates(sections, number)
    return [
        Drift(level, rate, log_prior + float(np.log(level.probability)))
        for level in DRIFT_LEVELS
        for rate, log_prior in rates
    ]


def _log_probability(passes: Sequence[DriftEvidence]) -> float:
    """Compute the log probability of the headings with dominant directions, over the drifts."""
    return float(np.logaddexp.reduce([run.log_evidence + run.drift.log_prior for run in passes]))


def _log_probability_else(passes: Sequence[DriftEvidence], prior: float) -> float:
    """Compute the log probability of all else: no dominant directions, or headings that drift too much to tell them.

    Without directions a constant rate changes nothing.
    """
    steady = [run for run in passes if not run.drift.rate_radps]
    none = [run.log_evidence_of_none + np.log(run.drift.level.probability) + np.log(_PRIOR_OF_NONE) for run in steady]
    drifting = [
        run.log_evidence + run.drift.log_prior + np.log(prior)
        for run in passes
        if not run.drift.level.tells_directions
    ]
    return float(np.logaddexp.reduce([*none, *drifting]))


def _smooth(sections: LegSections, best: BestFit, used: bool) -> DominantDirections:
    """Compute the directions of the sections given all sections, by a backward pass."""
    fitted = best.fitted
    belief = fitted.forward * backward_pass(fitted)
    mean, sigma = fitted.grid.mean_and_sigma(belief.sum(axis=1))
    straight = belief[:, 0].sum(axis=1) / belief.sum(axis=(1, 2))
    spacing = fitted.grid.spacing_rad
    drift = np.unwrap(mean, period=spacing)
    heading = fitted.heading_rad
    along = spacing * np.round((heading - drift) / spacing)
    error = (heading - drift - along) / fitted.drift.level.of_section
    gaussian = (
        (1.0 - OUTLIER_SHARE)
        * np.exp(-0.5 * error**2)
        * spacing
        / (fitted.drift.level.of_section * np.sqrt(2.0 * np.pi))
    )
    return DominantDirections(
        number=best.number,
        log_odds=best.log_odds,
        used=used,
        spacing_rad=spacing,
        drift_per_sqrt_s=fitted.drift.level.per_sqrt_s,
        drift_rad=drift - drift[0],
        rate_radps=fitted.drift.rate_radps if used else best.mean_rate_radps,
        sigma_rad=sigma,
        path_heading_rad=along + drift[0] + sections.heading_rad[0],
        follows=straight * gaussian / (gaussian + OUTLIER_SHARE),
    )
