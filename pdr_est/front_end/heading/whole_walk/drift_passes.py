"""Forward and backward pass over the drift of the headings, on a circle of the angle between two directions."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.whole_walk.circular_grid import CircularGrid
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
class ForwardPass:
    """Forward pass for one number of directions and one drift.

    `heading_rad`: (n,) of the sections without the constant rate. `likelihood`, `forward`: (n, 2, cells) of each
    section and drift, if its leg follows a direction and if it is a diagonal. `sigma`: (n - 1,) of the drift between
    sections. `log_evidence`, `log_evidence_of_none`: log probability of the headings with dominant directions, and if
    each turn leads anywhere.
    """

    grid: CircularGrid
    drift: Drift
    heading_rad: Array
    likelihood: Array
    forward: Array
    sigma: Array
    new_leg: NDArray[np.bool_]
    log_evidence: float
    log_evidence_of_none: float


def forward_passes(
    sections: LegSections, transitions: SectionTransitions, number: int, drifts: Sequence[Drift]
) -> list[ForwardPass]:
    """Compute the density of each drift at each section given the sections up to it, all drifts side by side.

    Parameters
    ----------
    sections : LegSections
        Sections of the straight legs, at least one.
    transitions : SectionTransitions
        Transitions between them.
    number : int
        Number of directions.
    drifts : sequence of Drift
        Drifts of the headings.
    """
    grid = CircularGrid(2.0 * np.pi / number)
    rate = np.array([drift.rate_radps for drift in drifts])
    of_section = np.array([drift.level.of_section for drift in drifts])
    heading = sections.since_first_rad[:, None] - rate * (sections.time_s - sections.time_s[0])[:, None]
    along = grid.likelihood(heading, of_section, OUTLIER_SHARE)  # (n, drifts, cells)
    sigma = np.stack([_sigma_between(sections, transitions, drift.level) for drift in drifts], axis=1)
    damping = grid.damping(sigma)
    diagonal, of_none = _predictive_likelihoods(grid, along, damping, transitions)
    likelihood = np.stack([along, np.broadcast_to(diagonal[..., None], along.shape)], axis=2)
    belief = np.broadcast_to(LEG_PRIOR[:, None] * grid.uniform(), likelihood.shape[1:])
    log_evidence = np.zeros(len(drifts))
    forward = np.empty_like(likelihood)
    for i, row in enumerate(likelihood):
        if i:
            belief = grid.damp(belief, damping[i - 1][:, None])
            if transitions.new_leg[i - 1]:
                belief = LEG_PRIOR[:, None] * (belief[:, 0] + belief[:, 1])[:, None]
        belief = belief * row
        evidence = np.add.reduce(belief[:, 0] + belief[:, 1], axis=-1) / grid.cells
        log_evidence += np.log(evidence)
        forward[i] = belief = belief / evidence[:, None, None]
    log_of_none = np.log(of_none).sum(axis=0)
    return [
        ForwardPass(
            grid,
            drift,
            heading[:, k],
            likelihood[:, k],
            forward[:, k],
            sigma[:, k],
            transitions.new_leg,
            float(log_evidence[k]),
            float(log_of_none[k]),
        )
        for k, drift in enumerate(drifts)
    ]


def _sigma_between(sections: LegSections, transitions: SectionTransitions, level: DriftLevel) -> Array:
    """Compute the standard deviations (n - 1,), rad, of the drift between sections."""
    walked = level.per_sqrt_s**2 * transitions.elapsed_s + (level.per_turn * transitions.quarter_turns) ** 2
    sigma: Array = np.sqrt(walked + sections.sigma_change_rad[1:] ** 2)
    return sigma


def _predictive_likelihoods(
    grid: CircularGrid, along: Array, damping: Array, transitions: SectionTransitions
) -> tuple[Array, Array]:
    """Compute the likelihoods (n, drifts) of the sections given those before, relative to the uniform density.

    The first ones are those of directions that may be any in each leg, the second ones those of directions that may
    be any after each turn that is evidence.
    """
    of_leg, of_turn = np.empty(along.shape[:2]), np.empty(along.shape[:2])
    anywhere = np.ones(along.shape[1:])
    in_leg = since_turn = anywhere
    for i, row in enumerate(along):
        alike = since_turn is in_leg
        if i and transitions.new_leg[i - 1]:
            turn = transitions.informative[i - 1]
            since_turn = anywhere if turn else grid.damp(since_turn, damping[i - 1])
            in_leg = anywhere
        elif i:
            in_leg = grid.damp(in_leg, damping[i - 1])
            since_turn = in_leg if alike else grid.damp(since_turn, damping[i - 1])
        alike = since_turn is in_leg
        in_leg, of_leg[i] = _normalised(in_leg * row, grid.cells)
        if alike:
            since_turn, of_turn[i] = in_leg, of_leg[i]
        else:
            since_turn, of_turn[i] = _normalised(since_turn * row, grid.cells)
    return of_leg, of_turn


def _normalised(belief: Array, cells: int) -> tuple[Array, Array]:
    """Return densities (drifts, cells) over their means, and the means."""
    mean = np.add.reduce(belief, axis=-1) / cells
    return belief / mean[:, None], mean


def backward_pass(fitted: ForwardPass) -> Array:
    """Compute the likelihood (n, 2, cells) of all later sections given drift and kind of leg at each section."""
    futures = np.ones_like(fitted.forward)
    for i in range(len(futures) - 1, 0, -1):
        future = futures[i] * fitted.likelihood[i]
        if fitted.new_leg[i - 1]:
            future = np.broadcast_to(LEG_PRIOR @ future, future.shape)
        future = fitted.grid.diffuse(future, fitted.sigma[i - 1])
        futures[i - 1] = future / future.mean()
    return futures
