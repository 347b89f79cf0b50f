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
from math import exp, inf
from types import MappingProxyType
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le

from pdr_est.front_end.heading.whole_walk.collapsed_passes import collapsed_evidences
from pdr_est.front_end.heading.whole_walk.constant_rate import rate_candidates
from pdr_est.front_end.heading.whole_walk.drift_model import (
    DRIFT_LEVELS,
    OUTLIER_SHARE,
    Drift,
    DriftEvidence,
    SectionTransitions,
)
from pdr_est.front_end.heading.whole_walk.drift_passes import DriftPasses, ForwardPass, backward_pass
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections, StraightLegParams
from pdr_est.params import params
from pdr_est.types.analysis import DominantDirections

# Prior probability of each number of directions; the rest is that there are none.
_NUMBER_PRIOR: Mapping[int, float] = MappingProxyType({2: 0.1, 3: 0.04, 4: 0.5, 5: 0.02, 6: 0.04, 8: 0.1})
_PRIOR_OF_NONE = 1.0 - sum(_NUMBER_PRIOR.values())
# Doubt in the log odds by `collapsed_passes`: of a walk, and of each of its legs. What stays out is less probable by
# as much, at least by e^10. Ours.
_DOUBT, _DOUBT_OF_LEG = 10.0, 0.5


@params
class DominantParams:
    """Parameters of the search for dominant directions."""

    enabled: bool = True
    """True to look for dominant directions."""
    number: Annotated[int, Ge(1), Le(16)] | None = None
    """Given number of directions at equal angles; null estimates it, and whether there are any."""
    direction_rad: Annotated[float, Ge(-6.3), Le(6.3)] | None = None
    """One of the directions in the map, rad, null where unknown; given without a number, there are four."""
    certain: bool = True
    """True if the walk follows the given directions from the first step on; false for directions of the building
    that are known, such as those of the walls on a floor plan, while the walk shows whether it follows them.
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

    @property
    def followed(self) -> bool:
        """Tell whether directions are given that the walk certainly follows."""
        return self.certain and self.given_number is not None


def dominant_directions(sections: LegSections, parameters: DominantParams) -> DominantDirections | None:
    """Estimate the most probable dominant directions of a walk; None for one without straight legs."""
    if not len(sections):
        return None
    best = best_fit(sections, parameters)
    used = parameters.followed or best.log_odds >= parameters.least_log_odds
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


class _Compared:
    """Compare the drifts with one number of directions, and all else: no directions, or too much drift to tell them.

    Parameters
    ----------
    passes : sequence of DriftEvidence
        Evidence of each drift.
    prior : float
        Prior probability of the number.
    any_level : bool
        True if directions are to be found whatever the level of the drift.

    Attributes
    ----------
    log_odds : float
        Log odds of directions that the headings are steady enough to tell, against all else.
    """

    def __init__(self, passes: Sequence[DriftEvidence], prior: float, any_level: bool) -> None:
        self._passes, self._prior, self._any_level = passes, prior, any_level
        log_evidence = np.array([run.log_evidence + run.drift.log_prior for run in passes])
        tells = np.array([run.drift.level.tells_directions for run in passes])
        self._usable = np.where(tells | any_level, log_evidence, -np.inf)
        self._drifting = np.where(tells, -np.inf, log_evidence + np.log(prior))
        # Without directions a constant rate changes nothing.
        of_none = np.array([run.log_evidence_of_none + np.log(run.drift.level.probability) for run in passes])
        self._none = np.where(np.isnan(of_none), -np.inf, of_none + np.log(_PRIOR_OF_NONE))
        log_else = np.logaddexp.reduce(np.concatenate([self._none, self._drifting]))
        self.log_odds = float(np.logaddexp.reduce(self._usable) + np.log(prior) - log_else)

    @property
    def most_probable(self) -> Drift:
        """Return the most probable drift."""
        return self._passes[int(np.argmax(self._usable))].drift

    @property
    def mean_rate_radps(self) -> float:
        """Mean of the constant rate, rad/s, given directions."""
        weight = np.exp(self._usable - self._usable.max())
        return float(weight @ [run.drift.rate_radps for run in self._passes] / weight.sum())

    def likely(self, within: float) -> list[Drift]:
        """List the drifts that are no less probable, by the log, than the best with directions or of all else."""
        others = np.maximum(self._none, self._drifting)
        near = (self._usable >= self._usable.max() - within) | (others >= others.max() - within)
        return [run.drift for run, chosen in zip(self._passes, near.tolist(), strict=True) if chosen]

    def updated(self, passes: Sequence[DriftEvidence]) -> "_Compared":
        """Return the same with other evidence of some drifts."""
        other = {run.drift: run for run in passes}
        return _Compared([other.get(run.drift, run) for run in self._passes], self._prior, self._any_level)


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
    found = {
        number: _Compared(passes, numbers[number], any_level=parameters.followed)
        for number, passes in collapsed_evidences(
            sections, transitions, {number: _drifts(sections, number) for number in numbers}
        ).items()
    }
    number, best, passes = _most_probable(sections, transitions, found)
    log_odds, drift = best.log_odds, best.most_probable
    if not passes.has_forward(drift):
        passes = DriftPasses(sections, transitions, number, [drift])
    return BestFit(number, log_odds, passes.forward_pass(drift), best.mean_rate_radps / (1.0 + exp(-log_odds)))


def _most_probable(
    sections: LegSections, transitions: SectionTransitions, found: Mapping[int, "_Compared"]
) -> tuple[int, "_Compared", DriftPasses]:
    """Find the most probable number of directions, with exact evidence of all that may matter for it.

    Numbers that are less probable than the best one, whatever the error of their approximate evidence, stay out.
    """
    doubt = _DOUBT + _DOUBT_OF_LEG * np.count_nonzero(transitions.new_leg)

    def exact(number: int, within: float) -> tuple[int, _Compared, DriftPasses]:
        drifts = found[number].likely(within)
        passes = DriftPasses(sections, transitions, number, drifts)
        compared = found[number].updated(passes.evidences)
        misled = not set(drifts).issuperset(compared.likely(within))
        return exact(number, inf) if misled else (number, compared, passes)

    def best_of(number: int) -> tuple[int, _Compared, DriftPasses]:
        return exact(number, doubt if found[number].log_odds > doubt else inf)

    first, *others = sorted(found, key=lambda number: -found[number].log_odds)
    best = best_of(first)
    for number in others:
        if found[number].log_odds + doubt >= best[1].log_odds:
            best = max(best, best_of(number), key=lambda one: one[1].log_odds)
    return best


def _drifts(sections: LegSections, number: int) -> list[Drift]:
    """List the drifts that are compared: each level of the random walk with each constant rate."""
    rates = rate_candidates(sections, number)
    return [
        Drift(level, rate, log_prior + float(np.log(level.probability)))
        for level in DRIFT_LEVELS
        for rate, log_prior in rates
    ]


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
