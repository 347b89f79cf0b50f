"""Forward and backward pass over the drift of the headings, on a circle of the angle between two directions."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.whole_walk.circular_grid import CircularGrid
from pdr_est.front_end.heading.whole_walk.drift_model import (
    LEG_PRIOR,
    OUTLIER_SHARE,
    Drift,
    DriftEvidence,
    SectionTransitions,
    sigma_between,
)
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections

_MOST_KEPT = 6  # drifts whose forward passes are kept: those of all drifts of a long walk take much memory
_AT_ONCE = 32  # sections: their likelihoods fit into the cache of a processor


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
    `diagonal` (n, drifts): that if it does not; `sigma` (n - 1, levels) and `damping` (n - 1, levels, waves): of the
    drift between sections for each level, of which `level` (drifts,) is the number.
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
