"""Model of the drift of headings over the sections of the straight legs: levels, rates, and the transitions."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections

_TELLING_PER_SQRT_S = 0.02  # drift of headings that tell no directions any more


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

    @property
    def tells_directions(self) -> bool:
        """Return True if headings that drift so little tell the directions of a building.

        With more drift any way fits some directions, which then bend it.
        """
        return self.per_sqrt_s < _TELLING_PER_SQRT_S


# From a phone in a steady hand to one that slips about in a pocket.
DRIFT_LEVELS = (
    DriftLevel(0.003, 0.045, 0.055, 0.25),
    DriftLevel(0.005, 0.07, 0.06, 0.3),
    DriftLevel(0.012, 0.14, 0.08, 0.25),
    DriftLevel(0.026, 0.2, 0.1, 0.15),
    DriftLevel(0.052, 0.26, 0.12, 0.05),
)
OUTLIER_SHARE = 0.1  # share of sections off their direction, such as the rest of a corner or a detour; ours
_DIAGONAL_SHARE = 0.02  # share of legs that follow no dominant direction; ours
LEG_PRIOR = np.array([1.0 - _DIAGONAL_SHARE, _DIAGONAL_SHARE])
LEG_PRIOR.flags.writeable = False
_QUARTER_RAD = 0.5 * np.pi
_MOST_TURN = 2.0  # quarter turns beyond which a turn adds no more uncertainty


@dataclass(frozen=True)
class SectionTransitions:
    """Transition from each section to the next one.

    `elapsed_s`; `quarter_turns`, 0 within a leg; `new_leg`, True if another leg begins; `informative`, True if so and
    by a turn that is evidence.
    """

    elapsed_s: Array
    quarter_turns: Array
    new_leg: NDArray[np.bool_]
    informative: NDArray[np.bool_]

    @classmethod
    def of(cls, sections: LegSections, turn_rad: float) -> "SectionTransitions":
        """Describe the transitions between sections; `turn_rad` is the least turn that is evidence."""
        change = np.abs(np.diff(sections.heading_rad))
        new_leg = np.diff(sections.leg) != 0
        quarter_turns = np.where(new_leg, np.minimum(change / _QUARTER_RAD, _MOST_TURN), 0.0)
        elapsed_s = np.maximum(np.diff(sections.time_s), 0.1)
        return cls(elapsed_s, quarter_turns, new_leg, new_leg & (change > turn_rad))


@dataclass(frozen=True)
class Drift:
    """Drift of the headings of a walk: a random walk, and a constant rate by the gyroscope's bias.

    Attributes
    ----------
    level : DriftLevel
        The random walk.
    rate_radps : float
        The constant rate, rad/s.
    log_prior : float
        Log of the prior probability of both.
    """

    level: DriftLevel
    rate_radps: float
    log_prior: float


@dataclass(frozen=True)
class DriftEvidence:
    """Evidence of one drift for one number of directions.

    Attributes
    ----------
    drift : Drift
        The drift.
    log_evidence : float
        Log probability of the headings with dominant directions.
    log_evidence_of_none : float
        The same if each turn leads anywhere; NaN for a drift with a constant rate, which changes nothing there.
    """

    drift: Drift
    log_evidence: float
    log_evidence_of_none: float


def sigma_between(sections: LegSections, transitions: SectionTransitions, level: DriftLevel) -> Array:
    """Compute the standard deviations (n - 1,), rad, of the drift between sections."""
    walked = level.per_sqrt_s**2 * transitions.elapsed_s + (level.per_turn * transitions.quarter_turns) ** 2
    sigma: Array = np.sqrt(walked + sections.sigma_change_rad[1:] ** 2)
    return sigma
