"""Marginal covariances of a walk whose positions nothing measures."""

from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.common.initial_state import VAGUE_SIGMA_RAD
from pdr_est.estimators.heading_chain.chain import HeadingChain, sums_by_node
from pdr_est.frames import Array


@dataclass(frozen=True)
class PositionChain:
    """Linear dependence of the positions of n nodes on their headings, in the map frame.

    The move to a node is `before` times the heading at its begin, plus `after` times the heading at its end, plus
    noise.

    Attributes
    ----------
    start_covariance
        Covariance (2, 2) of the first position, m².
    before, after
        Derivatives (n - 1, 2) of the moves, m/rad.
    noise
        Covariances (n - 1, 2, 2) of the moves for given headings, m².
    """

    start_covariance: Array
    before: Array
    after: Array
    noise: Array


def marginals(chain: HeadingChain, weight: Array, positions: PositionChain) -> Array:
    """Compute the covariances (n, 3, 3) of east, north and heading.

    Parameters
    ----------
    chain
        The headings.
    weight
        Information (m,) of the heading priors at the optimum.
    positions
        The positions.
    """
    factor, of_reference, rest, variance, across, vague = _backwards(chain, weight)
    size = len(factor) + 1
    own, joint, referred = [variance], [across], []
    for k in range(size - 1):
        g, h = factor[k], of_reference[k]
        referred.append(g * own[k] + h * joint[k])  # covariance of two successive headings
        own.append(g * g * own[k] + 2.0 * g * h * joint[k] + h * h * vague + rest[k])
        joint.append(g * joint[k] + h * vague)
    spread, with_reference, successive = np.array(own), np.array(joint), np.array(referred)
    before, after = positions.before, positions.after
    moved = before * with_reference[:-1, None] + after * with_reference[1:, None]
    position_reference = np.concatenate([np.zeros((1, 2)), np.cumsum(moved, axis=0)])
    added = (
        np.array(of_reference).reshape(-1, 1) * position_reference[:-1]
        + before * successive[:, None]
        + after * spread[1:, None]
    )
    position_heading = _recursion(factor, added)
    # Covariance of the position before a move with the headings at its begin and its end.
    with_begin = position_heading[:-1]
    with_end = position_heading[1:] - before * successive[:, None] - after * spread[1:, None]
    grown = _outer(with_begin, before) + _outer(with_end, after)
    grown = grown + grown.transpose(0, 2, 1) + positions.noise
    both = successive[:, None, None] * _outer(before, after)
    grown += both + both.transpose(0, 2, 1)
    grown += spread[:-1, None, None] * _outer(before, before) + spread[1:, None, None] * _outer(after, after)
    covariance = np.zeros((size, 3, 3))
    covariance[:, :2, :2] = positions.start_covariance
    covariance[1:, :2, :2] += np.cumsum(grown, axis=0)
    covariance[:, :2, 2] = covariance[:, 2, :2] = position_heading
    covariance[:, 2, 2] = spread
    return covariance


def _backwards(
    chain: HeadingChain, weight: Array
) -> tuple[list[float], list[float], list[float], float, float, float]:
    """Eliminate the headings from the last one to the first one.

    Given all measurements, a heading is a factor times the one before, plus a factor times the reference direction,
    plus noise. Returns these factors and the variances of the noise, and then the variance of the first heading, its
    covariance with the reference, and the variance of the reference.
    """
    size, at = len(chain.turn_rad) + 1, chain.priors
    information = sums_by_node(at.node, weight, size).tolist()
    relative = sums_by_node(at.node, weight * at.relative, size).tolist()
    own, joint, of_reference = information[-1], -relative[-1], relative[-1]
    factor, referred, rest = [], [], []
    for k, variance in zip(range(size - 2, -1, -1), reversed(chain.turn_variance.tolist()), strict=True):
        share = 1.0 / (1.0 + variance * own)
        factor.append(share)
        referred.append(-variance * share * joint)
        rest.append(variance * share)
        of_reference += relative[k] - variance * share * joint * joint
        own = own * share + information[k]
        joint = joint * share - relative[k]
    own += 1.0 / chain.start_variance
    of_reference += 1.0 / VAGUE_SIGMA_RAD**2
    volume = own * of_reference - joint * joint
    return factor[::-1], referred[::-1], rest[::-1], of_reference / volume, -joint / volume, own / volume


def _recursion(factor: list[float], added: Array) -> Array:
    """Return the sums (n, 2), from zero on, of which each is a factor times the one before plus what is added."""
    east, north = 0.0, 0.0
    sums = [(east, north)]
    for share, (of_east, of_north) in zip(factor, added.tolist(), strict=True):
        east, north = share * east + of_east, share * north + of_north
        sums.append((east, north))
    return np.array(sums)


def _outer(one: Array, other: Array) -> Array:
    return np.asarray(one[:, :, None] * other[:, None, :])
