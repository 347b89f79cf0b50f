"""Dead reckoning of all poses of a walk at once."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pdr_est.estimators.common.motion_model import LOG_SCALE, GaussianState
from pdr_est.estimators.common.nodes import Node
from pdr_est.frames import Array


class _Motions(NamedTuple):
    """Motions that lead to n nodes: turns and lengths (n,), covariances (n, 3, 3) in the body frame."""

    turn_rad: Array
    length_m: Array
    covariance: Array

    @classmethod
    def to(cls, nodes: Sequence[Node]) -> "_Motions":
        return cls(*_turns_and_lengths(nodes), np.array([node.covariance for node in nodes]))


class _Path(NamedTuple):
    """Way of k states along n nodes: headings (n, k), and displacements (n, k) from the node where they are given."""

    heading_rad: Array
    cos: Array
    sin: Array
    east: Array
    north: Array

    @classmethod
    def of(cls, turn_rad: Array, length_m: Array, anchor: int, means: Array) -> "_Path":
        """Follow the motions to n nodes from the means (k, s) at one of them, in both directions."""
        turned_rad = np.cumsum(turn_rad)
        heading_rad = means[:, 2] + (turned_rad - turned_rad[anchor])[:, None]
        cos, sin = np.cos(heading_rad), np.sin(heading_rad)
        scaled_m = np.exp(means[:, LOG_SCALE]) * length_m[:, None]
        place_m = np.cumsum(np.stack([scaled_m * cos, scaled_m * sin]), axis=1)
        east, north = place_m - place_m[:, anchor, None]
        return cls(heading_rad, cos, sin, east, north)

    def means(self, means: Array) -> Array:
        """Return the means (n, k, s) at the nodes."""
        found = np.tile(means, (len(self.east), 1, 1))
        found[:, :, 0] += self.east
        found[:, :, 1] += self.north
        found[:, :, 2] = self.heading_rad
        return found


def reckon_means(nodes: Sequence[Node], first: Array) -> Array:
    """Compute the means (n, 5) at all nodes by dead reckoning from the mean (5,) at the first node."""
    turn_rad, length_m = _turns_and_lengths(nodes)
    return _Path.of(turn_rad, length_m, 0, first[None]).means(first[None])[:, 0]


def reckon_poses(nodes: Sequence[Node], anchor: int, state: GaussianState) -> tuple[Array, Array]:
    """Compute the poses at all nodes by dead reckoning from the state at one of them.

    The parameters are those of `reckon`.

    Returns
    -------
    Array
        Poses (n, 3).
    Array
        Their covariances (n, 3, 3).
    """
    device = slice(0, LOG_SCALE + 1)
    mean, covariance = _reckoned(
        _Motions.to(nodes), anchor, state.mean[None, device], state.covariance[None, device, device]
    )
    return mean[:, 0, :LOG_SCALE], covariance[:, 0, :LOG_SCALE, :LOG_SCALE]


def reckon(nodes: Sequence[Node], anchor: int, state: GaussianState) -> list[GaussianState]:
    """Compute the states at all nodes by dead reckoning from the state at one of them.

    Parameters
    ----------
    nodes
        Nodes in order of time.
    anchor
        Index of the node whose state is given.
    state
        State at that node.
    """
    mean, covariance = _reckoned(_Motions.to(nodes), anchor, state.mean[None], state.covariance[None])
    return [
        replace(state, mean=own, covariance=spread) for own, spread in zip(mean[:, 0], covariance[:, 0], strict=True)
    ]


def _reckoned(motions: _Motions, anchor: int, means: Array, covariances: Array) -> tuple[Array, Array]:
    """Compute k states at n nodes from those at one of them, without a loop.

    Means are (n, k, s) and covariances (n, k, s, s), from (k, s) and (k, s, s).

    The heading noise of motion j, of variance v, turns the rest of the way about the place p of node j. With J a
    quarter turn, its share of the position covariance at node k is v J(p_k - p_j) (J(p_k - p_j))ᵀ, and its covariance
    c with the displacement adds c (J(p_k - p_j))ᵀ and the transpose. Multiplied out, all of it follows from running
    sums over j of v, c - v J p_j, and what has no p_k.
    """
    path = _Path.of(motions.turn_rad, motions.length_m, anchor, means)
    east, north = path.east[:, :, None], path.north[:, :, None]
    spread = np.tile(covariances, (len(path.east), 1, 1, 1))
    of_heading, of_scale = covariances[:, 2, :], covariances[:, LOG_SCALE, :]
    spread[:, :, 0, :] += east * of_scale - north * of_heading
    spread[:, :, 1, :] += north * of_scale + east * of_heading
    of_heading, of_scale = spread[:, :, :, 2].copy(), spread[:, :, :, LOG_SCALE].copy()
    spread[:, :, :, 0] += east * of_scale - north * of_heading
    spread[:, :, :, 1] += north * of_scale + east * of_heading
    _add_noise(spread, _in_map(motions.covariance, path.cos, path.sin), -path.north, path.east, anchor)
    return path.means(means), spread


def _turns_and_lengths(nodes: Sequence[Node]) -> tuple[Array, Array]:
    """Return the turns (n,) and lengths (n,) of the motions that lead to some nodes."""
    turn_rad, length_m = np.array([(node.heading_change_rad, node.length_m) for node in nodes]).T
    return turn_rad, length_m


def _in_map(covariance: Array, c: Array, s: Array) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Turn covariances (n, 3, 3) into the map: ee, en, nn, eh, nh, hh, each (n, k), of east, north and heading."""
    ff, fl, fh, _, ll, lh, _, _, hh = covariance.reshape(-1, 9).T[:, :, None]
    cc, cs, ss = c * c, c * s, s * s
    ee, nn = cc * ff - 2.0 * cs * fl + ss * ll, ss * ff + 2.0 * cs * fl + cc * ll
    return ee, cs * (ff - ll) + (cc - ss) * fl, nn, c * fh - s * lh, s * fh + c * lh, hh + 0.0 * c


def _add_noise(
    spread: Array,
    noise: tuple[Array, Array, Array, Array, Array, Array],
    across_east: Array,
    across_north: Array,
    anchor: int,
) -> None:
    """Add the noise of the motions between the anchor and each node; see `_reckoned`, where `across` is J p."""
    ee, en, nn, eh, nh, hh = noise
    turned_east, turned_north = hh * across_east, hh * across_north
    both_east, both_north = 0.5 * turned_east - eh, 0.5 * turned_north - nh
    sums = np.cumsum(
        [
            ee + 2.0 * both_east * across_east,
            en + both_east * across_north + both_north * across_east,
            nn + 2.0 * both_north * across_north,
            eh - turned_east,
            nh - turned_north,
            hh,
        ],
        axis=1,
    )
    sums -= sums[:, anchor, None]
    sums[:, :anchor] *= -1.0  # backwards in time the noise adds as well
    ee, en, nn, aside_east, aside_north, hh = sums
    half_east, half_north = aside_east + 0.5 * hh * across_east, aside_north + 0.5 * hh * across_north
    en = en + half_east * across_north + half_north * across_east
    eh, nh = aside_east + hh * across_east, aside_north + hh * across_north
    for row, column, value in (
        (0, 0, ee + 2.0 * half_east * across_east),
        (0, 1, en),
        (1, 0, en),
        (1, 1, nn + 2.0 * half_north * across_north),
        (0, 2, eh),
        (2, 0, eh),
        (1, 2, nh),
        (2, 1, nh),
        (2, 2, hh),
    ):
        spread[:, :, row, column] += value
