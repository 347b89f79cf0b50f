"""Bank of extended Kalman filters, one for each hypothesis about the heading, weighed by the measurements.

One Gaussian cannot describe a heading of which nothing is known, nor one that is either this or that: after the phone
was put elsewhere, the walker went straight on or round a corner. The bank holds a mixture of Gaussians. Each of its
hypotheses is an extended Kalman filter with the motion model of all estimators; all are computed at once. A
measurement changes the weights by its likelihood. Hypotheses that are improbable are dropped, and those that have
become alike are merged, so that the cost is bounded.

References
----------
A. R. Runnalls, "Kullback-Leibler approach to Gaussian mixture reduction", IEEE Trans. Aerosp. Electron. Syst. 43
(2007), for the cost of a merger.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.huber import HUBER
from pdr_est.estimators.common.motion_model import STATES, GaussianState, SourceState, SourceTrust, linearise_motions
from pdr_est.estimators.common.nodes import Node, with_heading_variance
from pdr_est.estimators.kalman.fix_mixture import updated_by_fix
from pdr_est.estimators.kalman.similarity_update import similarity_update
from pdr_est.estimators.kalman.source_clock import with_node
from pdr_est.frames import Array, wrap_angle
from pdr_est.records import changed
from pdr_est.types.measurements import HeadingPrior, PositionFix

UNKNOWN_HEADINGS = 36
"""Number of hypotheses about a heading of which nothing is known."""

MOST_HYPOTHESES = 36
"""Largest number of hypotheses that are kept."""

_MOST_AT_ONCE = (
    2 * MOST_HYPOTHESES
)  # after a split; of an open heading with many turns the least probable are dropped
_SIGMA_OVER_SPACING = 0.8  # of hypotheses round the circle, whose sum is then uniform within 0.1 %
_LEAST_WEIGHT = 1e-4  # of a hypothesis that is kept
_ANGLES = (2, 4)  # rows of the state: heading and reference direction
_MERGING_COST = 0.02  # nats by which a merger may change the distribution of the two

Lineage = tuple[tuple[int, int], ...]
"""Turns that a hypothesis chose: number of the node and of the turn hypothesis there."""


@dataclass(frozen=True)
class HypothesisBank:
    """Mixture of Gaussian states of one device.

    Attributes
    ----------
    weights
        Probabilities (k,) of the hypotheses.
    means
        Their means (k, n).
    covariances
        Their covariances (k, n, n).
    sources
        Sources of fixes with wandering errors, as in `GaussianState`.
    lineages
        For each hypothesis, the turns that it chose. A merged one has those of its more probable part.
    trusts
        What was learnt of the accuracy of the sources, as in `GaussianState`.
    trail, taken
        Last nodes of the device, and the fixes of the last one as they were taken.
    """

    weights: Array
    means: Array
    covariances: Array
    sources: tuple[SourceState, ...]
    lineages: tuple[Lineage, ...]
    trusts: tuple[SourceTrust, ...] = ()
    trail: tuple[Node, ...] = ()
    taken: tuple[PositionFix, ...] = ()

    def __len__(self) -> int:
        return len(self.weights)

    @classmethod
    def of_state(cls, state: GaussianState, lineage: Lineage = ()) -> "HypothesisBank":
        """Return the bank of a single hypothesis."""
        mean, covariance = state.mean[None], state.covariance[None]
        return cls(np.ones(1), mean, covariance, state.sources, (lineage,), state.trusts, _trail_of(state))

    @classmethod
    def of_unknown_heading(cls, state: GaussianState, lineage: Lineage = ()) -> "HypothesisBank":
        """Return the bank of a state whose heading may be any, and is independent of the other states."""
        count, spacing = UNKNOWN_HEADINGS, 2.0 * np.pi / UNKNOWN_HEADINGS
        means, covariances = np.tile(state.mean, (count, 1)), np.tile(state.covariance, (count, 1, 1))
        means[:, 2] = wrap_angle(spacing * np.arange(count))
        covariances[:, 2, :], covariances[:, :, 2] = 0.0, 0.0
        covariances[:, 2, 2] = (_SIGMA_OVER_SPACING * spacing) ** 2
        weights, lineages = np.full(count, 1.0 / count), (lineage,) * count
        return cls(weights, means, covariances, state.sources, lineages, state.trusts, _trail_of(state))

    def moments(self) -> GaussianState:
        """Return mean and covariance of the mixture; headings are averaged on the circle."""
        mean, covariance = self.moments_of(self.means[None], self.covariances[None])
        return self._state(mean[0], 0.5 * (covariance[0] + covariance[0].T))

    def moments_of(self, means: Array, covariances: Array) -> tuple[Array, Array]:
        """Return means (m, n) and covariances (m, n, n) of mixtures of the hypotheses in m states of theirs.

        Parameters
        ----------
        means, covariances
            Means (m, k, n) and covariances (m, k, n, n) of the hypotheses; headings are averaged on the circle.
        """
        near = means.copy()
        for angle in _ANGLES:
            vector = (self.weights * np.exp(1j * means[:, :, angle])).sum(axis=1)
            centre = np.where(np.abs(vector) > 1e-9, np.angle(vector), means[:, self.likeliest, angle])[:, None]
            near[:, :, angle] = centre + wrap_angle(means[:, :, angle] - centre)
        mean = self.weights @ near
        apart = near - mean[:, None]
        within = (self.weights[:, None, None] * covariances).sum(axis=1)
        return mean, within + (self.weights[:, None] * apart).transpose(0, 2, 1) @ apart

    @property
    def likeliest(self) -> int:
        """Number of the most probable hypothesis."""
        return int(np.argmax(self.weights))

    def state_of_hypothesis(self, number: int) -> GaussianState:
        """Return the state of one hypothesis."""
        return self._state(self.means[number], self.covariances[number])

    def predicted(self, node: Node, number: int) -> "HypothesisBank":
        """Predict the motion to a node, which is the device's `number`-th one, with each of its turn hypotheses."""
        trail = with_node(self.trail, node)
        if not node.turn_hypotheses:
            turn_rad = np.full(len(self), node.heading_change_rad)
            moved = self._moved(turn_rad, node.length_m, np.tile(node.covariance, (len(self), 1, 1)))
            return changed(moved, trail=trail, taken=())
        turns = node.turn_hypotheses
        prior = np.array([turn.probability for turn in turns])
        likeliest = np.argsort(-np.outer(self.weights, prior).ravel(), kind="stable")[:_MOST_AT_ONCE]
        parent, chosen = np.divmod(np.sort(likeliest), len(turns))
        turn_rad = np.array([turn.heading_change_rad for turn in turns])
        covariance = np.array([with_heading_variance(node.covariance, turn.sigma_rad**2) for turn in turns])
        lineages = tuple((*self.lineages[i], (number, int(j))) for i, j in zip(parent, chosen, strict=True))
        split = HypothesisBank(
            self.weights[parent] * prior[chosen] / np.sum(self.weights[parent] * prior[chosen]),
            self.means[parent],
            self.covariances[parent],
            self.sources,
            lineages,
            self.trusts,
            trail,
        )
        return split._moved(turn_rad[chosen], node.length_m, covariance[chosen])._reduced()

    def updated(self, node: Node) -> "HypothesisBank":
        """Update with all measurements at a node, and drop and merge hypotheses."""
        if not node.fixes and not node.priors:
            return self
        bank = self
        for fix in node.fixes:
            bank = bank._with_fix(fix)
        for prior in node.priors:
            bank = bank._with_heading(prior)
        return bank._reduced()

    def _state(self, mean: Array, covariance: Array) -> GaussianState:
        return GaussianState(mean, covariance, self.sources, self.trusts, (self.trail,), self.taken)

    def _moved(self, turn_rad: Array, length_m: float, covariance: Array) -> "HypothesisBank":
        moved, jacobian, noise = linearise_motions(self.means, turn_rad, np.full(len(self), length_m), covariance)
        covariances = jacobian @ self.covariances @ jacobian.transpose(0, 2, 1) + noise
        return changed(self, means=moved, covariances=covariances)

    def _with_fix(self, fix: PositionFix) -> "HypothesisBank":
        """Update with a position fix, for each hypothesis by the mixture of hypotheses about the fix."""
        states = self._state(self.means, self.covariances)
        weights, after = updated_by_fix(self.weights, states, fix, similarity_update)
        return replace(
            self,
            weights=weights,
            means=after.mean,
            covariances=after.covariance,
            sources=after.sources,
            trusts=after.trusts,
            taken=after.taken,
        )

    def _with_heading(self, prior: HeadingPrior) -> "HypothesisBank":
        """Update each hypothesis with a heading prior, and its weight by the likelihood."""
        expected, across = self.means[:, 2], self.covariances[:, :, 2]
        variance = across[:, 2]
        if prior.relative:
            expected, across = expected - self.means[:, STATES - 1], across - self.covariances[:, :, STATES - 1]
            variance = across[:, 2] - across[:, STATES - 1]
        residual, noise = wrap_angle(prior.heading_rad - expected), prior.sigma_rad**2
        innovation = variance + noise
        if prior.robust:
            innovation = innovation + (np.maximum(np.abs(residual) / np.sqrt(innovation) / HUBER, 1.0) - 1.0) * noise
        gain = across / innovation[:, None]
        covariances = self.covariances - gain[:, :, None] * across[:, None, :]
        log_weight = np.log(np.maximum(self.weights, 1e-300)) - 0.5 * (residual**2 / innovation + np.log(innovation))
        weights = np.exp(log_weight - log_weight.max())
        return changed(
            self,
            weights=weights / weights.sum(),
            means=self.means + gain * residual[:, None],
            covariances=0.5 * (covariances + covariances.transpose(0, 2, 1)),
        )

    def _reduced(self) -> "HypothesisBank":
        """Drop improbable hypotheses, merge those that are alike, and keep no more than the largest number."""
        probable = self.weights >= _LEAST_WEIGHT * self.weights.max()
        bank = self if probable.all() else self._selected(np.flatnonzero(probable))
        costs, pairs = np.full((len(bank), len(bank)), np.inf), np.triu_indices(len(bank), 1)
        costs[pairs] = bank._merging_costs(*pairs)
        while len(bank) > 1:
            i, j = (int(number) for number in np.unravel_index(int(np.argmin(costs)), costs.shape))
            if costs[i, j] > _MERGING_COST and len(bank) <= MOST_HYPOTHESES:
                break
            bank = bank._merged(i, j)
            others, last = np.delete(np.arange(len(costs)), [i, j]), len(bank) - 1
            costs = np.pad(costs[np.ix_(others, others)], (0, 1), constant_values=np.inf)
            costs[:last, last] = bank._merging_costs(np.arange(last), np.full(last, last))
        return bank

    def _selected(self, kept: NDArray[np.intp]) -> "HypothesisBank":
        weights = self.weights[kept]
        return HypothesisBank(
            weights / weights.sum(),
            self.means[kept],
            self.covariances[kept],
            self.sources,
            tuple(self.lineages[i] for i in kept),
            self.trusts,
            self.trail,
            self.taken,
        )

    def _merging_costs(self, first: NDArray[np.intp], second: NDArray[np.intp]) -> Array:
        """Return the costs (m,) of merging pairs of hypotheses (m,) by their poses.

        They are Runnalls' bounds, over the probability of the two.
        """
        own = self.covariances[:, :3, :3] + 1e-9 * np.eye(3)
        both = self.weights[first] + self.weights[second]
        share = self.weights[first] / both
        apart = self.means[first, :3] - self.means[second, :3]
        apart[:, 2] = wrap_angle(apart[:, 2])
        merged = (
            share[:, None, None] * own[first]
            + (1.0 - share)[:, None, None] * own[second]
            + (share * (1.0 - share))[:, None, None] * apart[:, :, None] * apart[:, None, :]
        )
        log_volume = np.linalg.slogdet(own)[1]
        log_volumes = share * log_volume[first] + (1.0 - share) * log_volume[second]
        return np.asarray(0.5 * (np.linalg.slogdet(merged)[1] - log_volumes))

    def _merged(self, i: int, j: int) -> "HypothesisBank":
        """Merge two hypotheses into one with their moments."""
        pair = self._selected(np.array([i, j]))
        state, others = pair.moments(), np.array([k for k in range(len(self)) if k not in (i, j)], dtype=np.intp)
        likelier = i if self.weights[i] >= self.weights[j] else j
        return HypothesisBank(
            np.append(self.weights[others], self.weights[i] + self.weights[j]),
            np.concatenate([self.means[others], state.mean[None]]),
            np.concatenate([self.covariances[others], state.covariance[None]]),
            self.sources,
            (*(self.lineages[k] for k in others), self.lineages[likelier]),
            self.trusts,
            self.trail,
            self.taken,
        )


def _trail_of(state: GaussianState) -> tuple[Node, ...]:
    return state.trails[0] if state.trails else ()
