"""Update of weighted states by a position fix of whose error, and of whose clock, several things may be true.

The filter of one Gaussian state and the bank of hypotheses share it; they differ in how a state takes a fix.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import log, sqrt

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.measurement_checks import is_repeated
from pdr_est.estimators.common.motion_model import CLOCK, LOG_SCALE, STATES, GaussianState
from pdr_est.estimators.kalman.fix_sources import fix_rows, place_of_source, with_jump, with_source_at
from pdr_est.estimators.kalman.source_clock import (
    PRIOR_VARIANCES_S2,
    RecentPath,
    clock_variance,
    repriored,
    variance_after,
    wrong_after,
)
from pdr_est.estimators.kalman.source_trust import (
    FixHypotheses,
    hypotheses_about,
    log_density,
    mixture_of,
    trust_in,
    with_mixed_error,
    with_repeated,
    with_trust,
)
from pdr_est.frames import Array
from pdr_est.types.measurements import START_SOURCE, PositionFix

Correction = Callable[[Array, Array, Array, Array, Array], tuple[Array, Array, Array]]
"""Update of states (k, n) with covariances (k, n, n) by positions (k, 2) with Jacobians (k, 2, n) and noise
(k, 2, 2): the new states and covariances, and the log-likelihoods (k,)."""

_LEAST_VARIANCE_S2 = 1e-4  # of a clock, for the slope of the path


@dataclass(frozen=True)
class _Expected:
    """Expectation of each of k states about a fix.

    observed_m: (k, 2) position of the fix less what the Jacobian does not describe. rows: (k, 2, n) Jacobians.
    residual: (k, 2) innovations. noise: (k, 2, 2) covariance of the fix without its independent error.
    """

    observed_m: Array
    rows: Array
    residual: Array
    noise: Array


def updated_by_fix(
    weights: Array,
    states: GaussianState,
    fix: PositionFix,
    correction: Correction | None = None,
    device: int = 0,
    devices: int = 1,
) -> tuple[Array, GaussianState]:
    """Update k weighted states with a position fix; one that repeats an earlier one of its source changes nothing.

    Parameters
    ----------
    weights
        Weights (k,) of the states.
    states
        The states, with mean (k, n) and covariance (k, n, n).
    fix
        The fix.
    correction
        Update of states by a fix; by default that of the Kalman filter.
    device, devices
        Number of the device that the fix belongs to, and number of devices in a state.

    Returns
    -------
    Array
        Weights (k,) after the fix.
    GaussianState
        States after the fix, each with the moments of the mixture of hypotheses about it.
    """
    trust = trust_in(states.trusts, fix, device)
    if is_repeated(trust.given, fix):
        return weights, replace(states, trusts=with_repeated(states.trusts, fix, device))
    if fix.source != START_SOURCE:
        states = with_source_at(states, devices, fix)
    taken = _FixOfDevice.of_states(states, fix, device, devices)
    about = hypotheses_about(fix, trust, float(np.hypot(*(fix.position_m - states.mean @ taken.rows.T).T).min()))
    states = taken.with_clock_weighed(weights, states, about)
    expected = taken.expected_by(weights, states.mean, states.covariance)
    shown = taken.as_seen(weights, expected, states)
    weights, mean, covariance, probabilities = taken.corrected(weights, states, expected, about, correction)
    trusts = with_trust(states.trusts, trust, fix, probabilities)
    sources = states.sources
    if taken.place is not None:
        kept = np.where(about.negligible(probabilities), 0.0, probabilities)
        sources = with_jump(sources, fix.source, float(kept @ about.jump) / float(kept.sum()))
    all_taken = (*states.taken, with_mixed_error(shown, about, probabilities))
    return weights, replace(states, mean=mean, covariance=covariance, sources=sources, trusts=trusts, taken=all_taken)


def _linear_correction(
    means: Array, covariances: Array, observed_m: Array, rows: Array, noise: Array
) -> tuple[Array, Array, Array]:
    """Update states by positions with the equations of the Kalman filter; see `Correction`."""
    residual = observed_m - np.einsum("kij,kj->ki", rows, means)
    across = covariances @ rows.transpose(0, 2, 1)
    spread = rows @ across + noise
    gain = np.linalg.solve(spread, across.transpose(0, 2, 1)).transpose(0, 2, 1)
    after = covariances - gain @ across.transpose(0, 2, 1)
    return means + np.einsum("kij,kj->ki", gain, residual), after, log_density(spread, residual)


@dataclass(frozen=True)
class _FixOfDevice:
    """A fix of a device, and what its update needs of the states.

    rows: Jacobian (2, n) of the fix without the clock. place: row of its source; None for the end of a closed walk.
    clock: row of the correction of the clock; None for one that is certainly right. path: path of the device so far.
    """

    fix: PositionFix
    device: int
    rows: Array
    place: int | None
    clock: int | None
    path: RecentPath

    @classmethod
    def of_states(cls, states: GaussianState, fix: PositionFix, device: int, devices: int) -> "_FixOfDevice":
        """Find the rows of a fix in the states, which have its source, and the path of its device."""
        place = place_of_source(states.sources, devices, fix)
        doubted = any(one.name == fix.source and one.clock_wrong > 0.0 for one in states.sources)
        clock = place + CLOCK if place is not None and doubted else None
        trail = states.trails[device] if clock is not None and device < len(states.trails) else ()
        rows = fix_rows(states, devices, fix, device)
        return cls(fix, device, rows, place, clock, RecentPath(trail, fix.time_s))

    def expected_by(self, weights: Array, means: Array, covariances: Array) -> _Expected:
        """Return what states (k, n) expect of the fix."""
        rows = np.tile(self.rows, (len(means), 1, 1))
        observed_m = np.tile(np.asarray(self.fix.position_m, dtype=np.float64), (len(means), 1))
        noise = np.zeros((len(means), 2, 2))
        if (clock := self.clock) is not None:
            correction_s = float(weights @ means[:, clock])
            sigma_s = sqrt(max(float(weights @ covariances[:, clock, clock]), _LEAST_VARIANCE_S2))
            shifted, to_map = self.path.shifted(correction_s, sigma_s), self._to_map(means)
            rows[:, :, clock] = to_map @ shifted.per_s
            observed_m = observed_m - to_map @ shifted.offset_m + correction_s * rows[:, :, clock]
            noise = to_map @ shifted.noise_m2 @ to_map.transpose(0, 2, 1)
        return _Expected(observed_m, rows, observed_m - np.einsum("kij,kj->ki", rows, means), noise)

    def as_seen(self, weights: Array, expected: _Expected, states: GaussianState) -> PositionFix:
        """Return the fix at the place where the walker was at its stated time, with the error of the clock."""
        if (clock := self.clock) is None:
            return self.fix
        per_s = expected.rows[:, :, clock]
        moved = expected.observed_m - per_s * (weights @ states.mean[:, clock])
        of_clock = states.covariance[:, clock, clock][:, None, None] * _outer(per_s)
        position_m, spread = mixture_of(weights, moved, expected.noise + of_clock)
        return replace(self.fix, position_m=position_m, covariance_m2=np.asarray(self.fix.covariance_m2) + spread)

    def with_clock_weighed(self, weights: Array, states: GaussianState, about: FixHypotheses) -> GaussianState:
        """Weigh by the fix whether the clock of its source is wrong, and set the prior of its correction."""
        if self.clock is None:
            return states
        source = next(one for one in states.sources if one.name == self.fix.source)
        before = clock_variance(source.clock_wrong)
        likelihoods = self._log_likelihoods_of_clocks(weights, states, before, about)
        wrong = wrong_after(source.clock_wrong, likelihoods)
        mean, covariance = repriored(states.mean, states.covariance, self.clock, before, clock_variance(wrong))
        sources = tuple(replace(one, clock_wrong=wrong) if one is source else one for one in states.sources)
        return replace(states, mean=mean, covariance=covariance, sources=sources)

    def corrected(
        self,
        weights: Array,
        states: GaussianState,
        expected: _Expected,
        about: FixHypotheses,
        correction: Correction | None,
    ) -> tuple[Array, Array, Array, Array]:
        """Correct states (k) under each hypothesis (m) about the fix.

        The likelihoods of the Kalman filter need no update under those hypotheses that turn out to be negligible.

        Returns
        -------
        weights, means, covariances
            Those of the states, moments over the hypotheses that are not negligible.
        probabilities
            Probabilities (m,) of all hypotheses.
        """
        tried = np.arange(len(about))
        if correction is None:
            spread = expected.rows @ states.covariance @ expected.rows.transpose(0, 2, 1) + expected.noise
            log_likelihood = self._log_densities(expected.residual, spread, about)
            log_weight = _log(weights)[:, None] + _log(about.weights) + log_likelihood
            tried = np.flatnonzero(~about.negligible(_shares(log_weight).sum(axis=0)))
            means, covariances, _ = self._corrected_under(states, expected, about, tried, _linear_correction)
        else:
            means, covariances, log_likelihood = self._corrected_under(states, expected, about, tried, correction)
            log_weight = _log(weights)[:, None] + _log(about.weights) + log_likelihood
        joint = _shares(log_weight)
        probabilities = joint.sum(axis=0)
        kept = ~about.negligible(probabilities)
        chosen = kept[tried]
        share = log_weight[:, kept] - log_weight[:, kept].max(axis=1, keepdims=True)
        share = np.exp(share) / np.exp(share).sum(axis=1, keepdims=True)
        mixed = [mixture_of(*one) for one in zip(share, means[:, chosen], covariances[:, chosen], strict=True)]
        after = joint[:, kept].sum(axis=1)
        covariance = np.array([one[1] for one in mixed])
        covariance = 0.5 * (covariance + covariance.transpose(0, 2, 1))
        return after / after.sum(), np.array([one[0] for one in mixed]), covariance, probabilities

    def _corrected_under(
        self,
        states: GaussianState,
        expected: _Expected,
        about: FixHypotheses,
        tried: NDArray[np.intp],
        correction: Correction,
    ) -> tuple[Array, Array, Array]:
        """Correct states (k, n) under some hypotheses (t): means (k, t, n), covariances, log-likelihoods (k, t)."""
        (count, size), kinds = states.mean.shape, len(tried)
        prior = np.repeat(states.covariance, kinds, axis=0)
        first = STATES * self.device
        for row, added in ((first, about.lost_m2[tried]), (self.place, about.jump[tried])):
            if row is not None:
                prior[:, [row, row + 1], [row, row + 1]] += np.tile(added, count)[:, None]
        noise = (expected.noise[:, None] + about.noise[tried]).reshape(-1, 2, 2)
        means, observed_m, rows = (
            np.repeat(one, kinds, axis=0) for one in (states.mean, expected.observed_m, expected.rows)
        )
        moved, spread, log_likelihood = correction(means, prior, observed_m, rows, noise)
        spread = spread.reshape(count, kinds, size, size)
        return moved.reshape(count, kinds, size), spread, log_likelihood.reshape(count, kinds)

    def _log_densities(self, residual: Array, spread: Array, about: FixHypotheses) -> Array:
        """Return the log-likelihoods (k, m) of residuals (k, 2) with covariances (k, 2, 2) under all hypotheses."""
        wander_m2 = 0.0 if self.place is None else float(self.rows[0, self.place]) ** 2
        added = about.jump * wander_m2 + about.lost_m2
        each = spread[:, None] + about.noise + added[:, None, None] * np.eye(2)
        found = log_density(each.reshape(-1, 2, 2), np.repeat(residual, len(about), axis=0))
        return found.reshape(len(residual), len(about))

    def _log_likelihoods_of_clocks(
        self, weights: Array, states: GaussianState, before: float, about: FixHypotheses
    ) -> Array:
        """Return the log-likelihoods (2,) of the fix for a right and a wrong clock, to first order.

        They follow from the position, its covariance and that with the correction of the clock under the prior
        variance so far. before: that variance, s².
        """
        clock, across = self.clock, self.rows @ states.covariance
        correction_s, variance = states.mean[:, clock], states.covariance[:, clock, clock]
        residual, spread = self.fix.position_m - states.mean @ self.rows.T, across @ self.rows.T
        per_s, to_map, found = across[:, :, clock] / variance[:, None], self._to_map(states.mean), []
        for prior in PRIOR_VARIANCES_S2:
            new = variance_after(variance, before, prior)
            now_s = correction_s * new / variance
            mean_s = float(weights @ now_s)
            shifted = self.path.shifted(mean_s, sqrt(max(float(weights @ new), _LEAST_VARIANCE_S2)))
            slope = to_map @ shifted.per_s
            off = residual - per_s * (now_s - correction_s)[:, None]
            off = off - to_map @ shifted.offset_m + (mean_s - now_s)[:, None] * slope
            both = per_s + slope
            total = spread - variance[:, None, None] * _outer(per_s) + new[:, None, None] * _outer(both)
            total = total + to_map @ shifted.noise_m2 @ to_map.transpose(0, 2, 1)
            log_weight = _log(weights)[:, None] + _log(about.weights) + self._log_densities(off, total, about)
            largest = float(log_weight.max())
            found.append(largest + log(float(np.exp(log_weight - largest).sum())))
        return np.array(found)

    def _to_map(self, means: Array) -> Array:
        """Return the matrices (k, 2, 2) that turn and scale the walker's frame into the map."""
        heading_rad, log_scale = means[:, STATES * self.device + 2], means[:, STATES * self.device + LOG_SCALE]
        c, s = np.exp(log_scale) * np.cos(heading_rad), np.exp(log_scale) * np.sin(heading_rad)
        return np.stack([np.stack([c, -s], axis=1), np.stack([s, c], axis=1)], axis=1)


def _log(weights: Array) -> Array:
    return np.log(np.maximum(weights, 1e-300))


def _shares(log_weight: Array) -> Array:
    """Return weights that add up to 1 from logarithms."""
    weight = np.exp(log_weight - log_weight.max())
    return np.asarray(weight / weight.sum())


def _outer(vectors: Array) -> Array:
    return np.asarray(np.einsum("ki,kj->kij", vectors, vectors))
