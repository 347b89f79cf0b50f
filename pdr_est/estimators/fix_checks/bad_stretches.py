"""Search for stretches of bad fixes: a common error of a source that begins and ends, such as between high houses."""

from collections.abc import Iterator
from dataclasses import replace
from math import log

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.fix_checks.explanations import LEAST_FIXES, BadStretch, Explained, Explanation, spread_m2
from pdr_est.estimators.fix_checks.outlier_weights import outlier_cost
from pdr_est.frames import Array
from pdr_est.types.measurements import START_SOURCE

_LOG_STRETCH = log(0.1)  # probability that a section has a bad stretch (our choice)
_MOST_STRETCHES = 3
_LARGEST_SHARE = 0.6  # of the fixes of a source
_SIGMAS = np.array([3.0, 8.0, 25.0])  # of the stated error
_GROWTH = 1.4  # of the lengths that are tried


def likely_stretches(now: Explained) -> list[Explanation]:
    """Return the explanation with one more stretch that promises most; none if none promises anything."""
    blocks = list(_blocks(now))
    if not blocks or len(now.explanation.stretches) >= _MOST_STRETCHES:
        return []
    cost = _LOG_STRETCH - log(len(blocks) * len(_SIGMAS))
    sigma_m = now.fixes.sigma_m
    gains = np.array([_gains(now, block, _SIGMAS * np.median(sigma_m[block])) for block in blocks])
    best, sigma = np.unravel_index(int(np.argmax(gains)), gains.shape)
    if gains[best, sigma] + cost <= 0.0:
        return []
    stretch = _stretch(now, blocks[best], float(_SIGMAS[sigma] * np.median(sigma_m[blocks[best]])), cost)
    return [replace(now.explanation, stretches=(*now.explanation.stretches, stretch))]


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


def _gains(now: Explained, block: NDArray[np.int64], sigma_m: Array) -> Array:
    """Compute how much the evidence grows, as a logarithm, if a block has a common error of each of k sigmas (k,).

    Outliers in the block are then none any longer.
    """
    solved, weighed, fixes = now.weighed.regression, now.weighed, now.fixes
    rows = np.stack([2 * block, 2 * block + 1], axis=1).ravel()
    information, pulled = solved.information[np.ix_(rows, rows)], solved.pulled[rows]
    present = np.asarray(np.linalg.inv(information), dtype=np.float64)
    residual = present @ pulled
    rest = present - np.diag(np.repeat(weighed.more_m2[block], 2))
    apart = np.abs(fixes.time_s[block][:, None] - fixes.time_s[block]) / fixes.wander_time_s[block][:, None]
    then = rest + sigma_m[:, None, None] ** 2 * spread_m2(np.exp(-apart))
    of_each = np.broadcast_to(residual[:, None], (len(sigma_m), len(rows), 1))
    squared = np.linalg.solve(then, of_each)[:, :, 0] @ residual
    squared_now, log_now = float(residual @ pulled), -float(np.linalg.slogdet(information)[1])
    saved = float(outlier_cost(weighed.outlier[block], fixes.outlier_prior[block]).sum())
    return np.asarray(saved - 0.5 * (squared + np.linalg.slogdet(then)[1] - squared_now - log_now))


def _stretch(now: Explained, block: NDArray[np.int64], sigma_m: float, log_prior: float) -> BadStretch:
    """Return the stretch of a block, up to half way to the fixes around it."""
    fixes = now.fixes
    source = int(fixes.source[block[0]])
    time_s = fixes.time_s[fixes.source == source]
    before, after = time_s[time_s < fixes.time_s[block[0]]], time_s[time_s > fixes.time_s[block[-1]]]
    begin_s = 0.5 * (before[-1] + fixes.time_s[block[0]]) if len(before) else -np.inf
    end_s = 0.5 * (after[0] + fixes.time_s[block[-1]]) if len(after) else np.inf
    return BadStretch(source, float(begin_s), float(end_s), sigma_m, log_prior)
