"""Trust in a source of fixes: a mixture of hypotheses about the error of a fix, weighed by Bayes' rule.

A fix may be as good as stated, worse by some factor, or grossly wrong; or the fix is right and the track is lost. The
probability that the source is worse than it says persists from fix to fix: a stretch of bad positions has one cause.
No hypothesis is chosen. The state after the fix has the mean and the covariance of the mixture of all updates.

References
----------
H. A. P. Blom, Y. Bar-Shalom, "The interacting multiple model algorithm for systems with Markovian switching
coefficients", IEEE Trans. Autom. Control 33 (1988).
"""

from dataclasses import dataclass, replace
from math import exp

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.measurement_checks import with_given
from pdr_est.estimators.common.motion_model import SourceTrust
from pdr_est.frames import Array
from pdr_est.types.measurements import START_SOURCE, PositionFix

_FACTORS = np.array([1.0, 2.0, 4.0, 8.0, 16.0, 1.0, 1.0])  # on the stated standard deviation; ours
_PRIOR = np.array([0.95, 0.01, 0.01, 0.01, 0.01, 0.01])  # of these factors, the last for a gross error; ours
_GROSS, _LOST = 5, 6  # numbers of the hypotheses of a gross error and of a lost track
_GROSS_ROBUST = 0.07  # probability that a fix is grossly wrong whose source says that some may be; ours
_LOST_PRIOR = 0.002  # probability that the track was lost since the fix before; ours
_GROSS_M = 30.0  # least standard deviation of a gross error, m; ours
_NEGLIGIBLE = 0.03  # weight below which a hypothesis is left out, too little for a 95 % region
# Probability of the same error at the next fix (ours). Good fixes do not tell that the next one is good: a stretch of
# bad ones begins anywhere.
_KEPT = np.array([0.0, 0.95, 0.95, 0.95, 0.95, 0.5])
_MEMORY_S = 120.0  # time in which that falls to 37 %; ours


@dataclass(frozen=True)
class FixHypotheses:
    """Hypotheses about a fix and the track, before the fix is seen.

    Attributes
    ----------
    weights
        Their probabilities (k,).
    noise
        Covariances (k, 2, 2) of the independent error of the fix.
    jump
        Variances (k,) added to the wandering error of the source, which is in units of its standard deviation.
    lost_m2
        Variances (k,) added to the position of the track.
    """

    weights: Array
    noise: Array
    jump: Array
    lost_m2: Array

    def __len__(self) -> int:
        return len(self.weights)

    def negligible(self, weights: Array) -> NDArray[np.bool_]:
        """Tell which hypotheses (k,) are negligible with these weights; the most probable one never is."""
        return np.asarray(weights < min(_NEGLIGIBLE, weights.max()))


def hypotheses_about(fix: PositionFix, trust: SourceTrust, distance_m: float) -> FixHypotheses:
    """Return the hypotheses about a fix.

    Parameters
    ----------
    fix
        The fix.
    trust
        What is known of its source before it.
    distance_m
        Distance of the fix from where it is expected. The size of a gross error is not known; that which suits best
        is half of the distance.
    """
    gross_m2 = max(_GROSS_M, 0.5 * distance_m) ** 2
    noise = _FACTORS[:, None, None] ** 2 * np.asarray(fix.covariance_m2)
    noise[_GROSS] += gross_m2 * np.eye(2)
    lost_m2 = np.zeros(len(_FACTORS))
    lost_m2[_LOST] = gross_m2
    if fix.source == START_SOURCE:
        return _of_closure(noise, lost_m2)
    weights = np.append((1.0 - trust.lost) * np.array(trust.probabilities), trust.lost)
    return FixHypotheses(weights, noise, _FACTORS**2 - 1.0, lost_m2)


def _of_closure(noise: Array, lost_m2: Array) -> FixHypotheses:
    """Return the hypotheses about the end of a walk that is known to be closed: it is right, whatever the track."""
    weights = np.zeros(len(_FACTORS))
    weights[[0, _LOST]] = 1.0 - _LOST_PRIOR, _LOST_PRIOR
    return FixHypotheses(weights, noise, np.zeros(len(_FACTORS)), lost_m2)


def log_density(spread: Array, residual: Array) -> Array:
    """Return the logarithms (k,) of Gaussian densities (k, 2, 2) at residuals (2,) or (k, 2), up to a constant."""
    (a, b), (c, d) = spread[:, 0].T, spread[:, 1].T
    east, north = residual.T
    volume = a * d - b * c
    squared = (d * east**2 - (b + c) * east * north + a * north**2) / volume
    return np.asarray(-0.5 * (squared + np.log(volume)))


def trust_in(trusts: tuple[SourceTrust, ...], fix: PositionFix, device: int) -> SourceTrust:
    """Return what is known of the source of a fix at its time, before the fix."""
    own = [one for one in trusts if one.device == device]
    lost = (own[-1].lost if own else 0.0) + _LOST_PRIOR
    earlier = next((one for one in own if one.name == fix.source), None)
    if earlier is None:
        earlier = SourceTrust(fix.source, device, fix.time_s, tuple(_PRIOR), lost)
    kept = _KEPT * exp(-max(fix.time_s - earlier.time_s, 0.0) / _MEMORY_S) * np.array(earlier.probabilities)
    gross = _GROSS_ROBUST if fix.robust else _PRIOR[_GROSS]
    mixed = (1.0 - gross) * (kept + (1.0 - kept.sum()) * _PRIOR)
    mixed[_GROSS] += gross  # good fixes do not tell that the next one cannot be gross
    return replace(earlier, probabilities=tuple(mixed), lost=lost)


def with_repeated(trusts: tuple[SourceTrust, ...], fix: PositionFix, device: int) -> tuple[SourceTrust, ...]:
    """Return what is known of all sources after a fix that repeats an earlier one."""
    own = next(one for one in trusts if (one.name, one.device) == (fix.source, device))
    return tuple(replace(one, given=with_given(one.given, fix)) if one is own else one for one in trusts)


def with_trust(
    trusts: tuple[SourceTrust, ...], before: SourceTrust, fix: PositionFix, probabilities: Array
) -> tuple[SourceTrust, ...]:
    """Return what is known of all sources after a fix.

    Parameters
    ----------
    trusts
        What was known before.
    before
        What `trust_in` returned for the fix.
    fix
        The fix.
    probabilities
        Probabilities (k,) of the hypotheses after it. That the track was lost is no fault of the source.
    """
    shares = probabilities[:_LOST] / max(1.0 - probabilities[_LOST], 1e-300)
    neglected = float(sum(one for one in probabilities[_GROSS:] if one < _NEGLIGIBLE))
    given = with_given(before.given, fix)
    after = SourceTrust(fix.source, before.device, fix.time_s, tuple(shares), neglected, given)
    others = tuple(one for one in trusts if (one.name, one.device) != (after.name, after.device))
    return (*others, after)


def with_mixed_error(fix: PositionFix, about: FixHypotheses, probabilities: Array) -> PositionFix:
    """Return a fix with an error of the mean entropy that it has under the hypotheses, for smoothers.

    Parameters
    ----------
    fix
        The fix, with what the clock of its source adds to its error.
    about
        Hypotheses (k) about it.
    probabilities
        Their probabilities (k,) after the fix.
    """
    probabilities = np.where(about.negligible(probabilities), 0.0, probabilities)
    probabilities = probabilities / probabilities.sum()
    if probabilities[0] == 1.0:
        return fix
    factor = 1.0 + about.jump
    own = np.asarray(fix.covariance_m2) - about.noise[0] + about.noise
    if fix.sigma_wander_m <= 0.0:
        own = own + about.jump[:, None, None] * about.noise[0]
    log_ratio = 0.5 * np.linalg.slogdet(own)[1] - 0.5 * np.linalg.slogdet(np.asarray(fix.covariance_m2))[1]
    return replace(
        fix,
        covariance_m2=np.asarray(fix.covariance_m2) * exp(float(probabilities @ log_ratio)),
        sigma_wander_m=fix.sigma_wander_m * exp(0.5 * float(probabilities @ np.log(factor))),
    )


def mixture_of(weights: Array, means: Array, covariances: Array) -> tuple[Array, Array]:
    """Return mean (n,) and covariance (n, n) of a mixture of Gaussians (k)."""
    mean: Array = weights @ means
    apart = means - mean
    within = np.einsum("k,kij->ij", weights, covariances)
    return mean, within + (weights[:, None] * apart).T @ apart
