"""Search for stretches of bad fixes: a common error of a source that begins and ends, such as between high houses."""

from collections.abc import Iterator
from dataclasses import replace
from math import log

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.fix_checks.explanations import LEAST_FIXES, BadStretch, Explained, Explanation
from pdr_est.estimators.fix_checks.outlier_weights import outlier_cost
from pdr_est.frames import Array
from pdr_est.types.measurements import START_SOURCE

_LOG_STRETCH = log(0.1)  # probability that a section has a bad stretch (our choice)
_MOST_STRETCHES = 3
_LARGEST_SHARE = 0.6  # of the fixes of a source
_SIGMAS = (3.0, 8.0, 25.0)  # of the stated error
_GROWTH = 1.4  # of the lengths that are tried


def likely_stretches(now: Explained) -> list[Explanation]:
    """Return the explanation with one more stretch that promises most; none if none promises anything."""
    candidates = [(block, sigma) for block in _blocks(now) for sigma in _SIGMAS]
    if not candidates or len(now.explanation.stretches) >= _MOST_STRETCHES:
        return []
    cost = _LOG_STRETCH - log(len(candidates))
    gains = [_gain(now, block, sigma) for block, sigma in candidates]
    best = int(np.argmax(gains))
    if gains[best] + cost <= 0.0:
        return []
    known = now.explanation
    stretch = _stretch(now, *candidates[best])
    return [replace(known, stretches=(*known.stretches, stretch), log_prior=known.log_prior + cost)]


def _blocks(now: Explained) -> Iterator[NDArray[np.int64]]:
    """Yield runs of fixes of a source, by their numbers."""
    for source, name in enumerate(now.fixes.names):
        own = np.flatnonzero(now.fixes.source == source)
        if name == START_SOURCE or len(own) < LEAST_FIXES:
            continue
        length = 2
        while length <= _LARGEST_SHARE * len(own):
            for begin in range(0, len(own) - length + 1, max(length // 4, 1)):
                yield own[begin : begin + length]
            length = max(length + 1, int(length * _GROWTH))


def _gain(now: Explained, block: NDArray[np.int64], sigma: float) -> float:
    """Compute how much the evidence grows, as a logarithm, if a block has a common error of some sigmas.

    Outliers in the block are then none any longer.
    """
    solved, weighed, fixes = now.weighed.regression, now.weighed, now.fixes
    rows = np.stack([2 * block, 2 * block + 1], axis=1).ravel()
    present: Array = np.asarray(np.linalg.inv(solved.information[np.ix_(rows, rows)]), dtype=np.float64)
    residual = present @ solved.pulled[rows]
    more_m2 = np.repeat(weighed.more_m2[block], 2)
    apart = np.abs(fixes.time_s[block][:, None] - fixes.time_s[block]) / fixes.wander_time_s[block][:, None]
    variance = (sigma * float(np.median(fixes.sigma_m[block]))) ** 2
    then: Array = present - np.diag(more_m2) + np.kron(variance * np.exp(-apart), np.eye(2))
    saved = float(outlier_cost(weighed.outlier[block], fixes.outlier_prior[block]).sum())
    return saved + _log_density(residual, then) - _log_density(residual, present)


def _log_density(residual: Array, covariance: Array) -> float:
    """Return the logarithm of a Gaussian density up to a constant."""
    return -0.5 * float(residual @ np.linalg.solve(covariance, residual) + np.linalg.slogdet(covariance)[1])


def _stretch(now: Explained, block: NDArray[np.int64], sigma: float) -> BadStretch:
    """Return the stretch of a block, up to half way to the fixes around it."""
    fixes = now.fixes
    source = int(fixes.source[block[0]])
    time_s = fixes.time_s[fixes.source == source]
    before, after = time_s[time_s < fixes.time_s[block[0]]], time_s[time_s > fixes.time_s[block[-1]]]
    begin_s = 0.5 * (before[-1] + fixes.time_s[block[0]]) if len(before) else -np.inf
    end_s = 0.5 * (after[0] + fixes.time_s[block[-1]]) if len(after) else np.inf
    return BadStretch(source, float(begin_s), float(end_s), sigma * float(np.median(fixes.sigma_m[block])))
