"""Forward and backward pass over the drift of the headings, on a circle of the angle between two directions."""

from collections.abc import Iterator, Sequence
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
_MOST_KEPT = 6  # drifts whose forward passes are kept: those of all drifts of a long walk take much memory
_AT_ONCE = 32  # sections: their likelihoods fit into the cache of a processor
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


@dataclass(frozen=True)
class ForwardPass:
    """Forward pass for one number of directions and one drift.

    `heading_rad`: (n,) of the sections without the constant rate. `likelihood`, `forward`: (n, 2, cells) of each
    section and drift, if its leg follows a direction and if it is a diagonal. `sigma`: (n - 1,) of the drift between
    sections.
    """

    grid: CircularGrid
    drift: Drift
    heading_rad: Array
    likelihood: Array
    forward: Array
    sigma: Array
    new_leg: NDArray[np.bool_]


@dataclass(frozen=True)
class _Observed:
    """Sections as several drifts, side by side, have them.

    `heading_rad` (n, drifts); `along` (n, drifts, cells): likelihood of each section if its leg follows a direction;
    `diagonal` (n, drifts): that if it does not; `sigma`, `damping` (n - 1, levels) and (n - 1, levels, 2 * frequencies):
    of the drift between sections for each level, of which `level` (drifts,) is the number.
    """

    heading_rad: Array
    along: Array
    diagonal: Array
    sigma: Array
    damping: Array
    level: NDArray[np.int64]


class DriftPasses:
    """Forward passes with several drifts, side by side, for one number of directions.

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

    Attributes
    ----------
    evidences : list of DriftEvidence
        How probable the headings are with each drift.
    """

    def __init__(
        self, sections: LegSections, transitions: SectionTransitions, number: int, drifts: Sequence[Drift]
    ) -> None:
        self._grid = grid = CircularGrid(2.0 * np.pi / number)
        self._transitions, self._drifts = transitions, list(drifts)
        self._observed = observed = _observed(grid, sections, transitions, drifts)
        means = np.empty((len(sections), len(drifts)))
        kept = len(sections) if len(drifts) <= _MOST_KEPT else 0
        self._forward = np.empty((kept, 2, len(drifts), grid.cells))
        for i, (belief, mean) in enumerate(_passed(grid, observed, transitions)):
            means[i] = mean
            if kept:
                self._forward[i] = belief
        steady = np.flatnonzero([not drift.rate_radps for drift in drifts])
        of_none = np.full(len(drifts), np.nan)
        if len(steady):
            along, level = observed.along[:, steady], observed.level[steady]
            predicted = _predictive_likelihoods(grid, along, observed.damping, level, transitions.informative)
            of_none[steady] = np.log(predicted).sum(axis=0)
        logs = zip(drifts, np.log(means).sum(axis=0).tolist(), of_none.tolist(), strict=True)
        self.evidences = [DriftEvidence(*one) for one in logs]

    def has_forward(self, drift: Drift) -> bool:
        """Return True if the forward pass of a drift is kept, as that of few drifts is."""
        return bool(len(self._forward)) and drift in self._drifts

    def forward_pass(self, drift: Drift) -> ForwardPass:
        """Return the density of a drift at each section given the sections up to it, where it is kept."""
        place, observed = self._drifts.index(drift), self._observed
        along, diagonal = observed.along[:, place], observed.diagonal[:, place, None]
        return ForwardPass(
            grid=self._grid,
            drift=drift,
            heading_rad=observed.heading_rad[:, place],
            likelihood=np.stack([along, np.broadcast_to(diagonal, along.shape)], axis=1),
            forward=self._forward[:, :, place],
            sigma=observed.sigma[:, observed.level[place]],
            new_leg=self._transitions.new_leg,
        )


def _observed(
    grid: CircularGrid, sections: LegSections, transitions: SectionTransitions, drifts: Sequence[Drift]
) -> _Observed:
    rate = np.array([drift.rate_radps for drift in drifts])
    of_section = np.array([drift.level.of_section for drift in drifts])
    heading = sections.since_first_rad[:, None] - rate * (sections.time_s - sections.time_s[0])[:, None]
    along = np.empty((*heading.shape, grid.cells))
    for begin in range(0, len(heading), _AT_ONCE):
        part = slice(begin, begin + _AT_ONCE)
        along[part] = grid.likelihood(heading[part], of_section, OUTLIER_SHARE)
    levels = list(dict.fromkeys(drift.level for drift in drifts))
    level = np.array([levels.index(drift.level) for drift in drifts])
    sigma = np.stack([sigma_between(sections, transitions, one) for one in levels], axis=1)
    damping = grid.damping(sigma)
    diagonal = _predictive_likelihoods(grid, along, damping, level, transitions.new_leg)
    return _Observed(heading, along, diagonal, sigma, damping, level)


def _passed(
    grid: CircularGrid, observed: _Observed, transitions: SectionTransitions
) -> Iterator[tuple[Array, Array]]:
    """Yield the density (2, drifts, cells) given the sections so far, and the likelihood (drifts,) of each section.

    The first densities are those in legs that follow a direction, the second ones those in diagonals. They are
    changed in place.
    """
    prior = LEG_PRIOR[:, None, None]
    belief = np.empty((2, *observed.along.shape[1:]))
    belief[:] = prior
    new_leg, diagonal = transitions.new_leg.tolist(), observed.diagonal[..., None]
    for i, along in enumerate(observed.along):
        if i:
            belief = grid.damp(belief, observed.damping[i - 1].take(observed.level, axis=0))
            if new_leg[i - 1]:
                np.multiply(prior, belief[0] + belief[1], out=belief)
        follows, off = belief
        follows *= along
        off *= diagonal[i]
        mean = np.add.reduce(follows + off, axis=-1) / grid.cells
        belief /= mean[:, None]
        yield belief, mean


def sigma_between(sections: LegSections, transitions: SectionTransitions, level: DriftLevel) -> Array:
    """Compute the standard deviations (n - 1,), rad, of the drift between sections."""
    walked = level.per_sqrt_s**2 * transitions.elapsed_s + (level.per_turn * transitions.quarter_turns) ** 2
    sigma: Array = np.sqrt(walked + sections.sigma_change_rad[1:] ** 2)
    return sigma


def _predictive_likelihoods(
    grid: CircularGrid, along: Array, damping: Array, level: NDArray[np.int64], anew: NDArray[np.bool_]
) -> Array:
    """Compute the likelihood (n, drifts) of the sections given those before, relative to the uniform density.

    Where `anew` (n - 1,), the next section may have any direction: so the sections fall into runs, which are passed
    side by side.
    """
    likelihood = np.empty(along.shape[:2])
    begin = np.concatenate([[0], np.flatnonzero(anew) + 1])
    length = np.diff(begin, append=len(along))
    order = np.argsort(-length, kind="stable")
    begin, length = begin[order], length[order]
    belief = np.ones((len(begin), *along.shape[1:]))
    for k in range(int(length[0])):
        at = begin[: np.count_nonzero(length > k)] + k
        if k:
            belief = grid.damp(belief[: len(at)], damping[(at - 1)[:, None], level])
        belief = belief * along[at]
        likelihood[at] = mean = np.add.reduce(belief, axis=-1) / grid.cells
        belief /= mean[..., None]
    return likelihood


def backward_pass(fitted: ForwardPass) -> Array:
    """Compute the likelihood (n, 2, cells) of all later sections given drift and kind of leg at each section."""
    futures = np.ones_like(fitted.forward)
    damping = fitted.grid.damping(fitted.sigma)
    for i in range(len(futures) - 1, 0, -1):
        future = futures[i] * fitted.likelihood[i]
        if fitted.new_leg[i - 1]:
            future = (LEG_PRIOR @ future)[None]
        future = fitted.grid.damp(future, damping[i - 1])
        futures[i - 1] = future * (future.size / np.add.reduce(future, axis=None))
    return futures
