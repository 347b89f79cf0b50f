"""Tethers between the devices of a walk: what they cost, and their linear factors for Newton's method.

A tether costs nothing within its length and the square of the excess beyond. Gauss and Newton's method leaves out
that a taut line also resists to be turned: the further its ends move across it, the longer it gets. The force in the
line over its length is the missing stiffness. But a line that turns along with the walkers who hold it is not
stretched: what the line resists on its own is taken back by the legs, which it pulls at, and only a turn relative to
the poses at its ends costs. Counting all of it, which is right for a single line, makes long walks far too stiff to
be bent as a whole, and Newton's method slower the longer they are.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import gtsam
import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.factor_graph.factors import LEAST_SIGMA, Keys
from pdr_est.estimators.factor_graph.marginals import to_map
from pdr_est.frames import Array

_LEAST_DISTANCE_M = 1e-9


@dataclass(frozen=True)
class TetherConstraints:
    """Distances between pairs of places that cost beyond max_distance_m (m,) by sigma_m (m,).

    The two places of each are on the straight lines between two poses: earlier, later (m, 2) by key, at a share
    (m, 2) of the way. A place at a pose has that pose for both; one of the two always is.
    """

    earlier: NDArray[np.int64]
    later: NDArray[np.int64]
    share: Array
    max_distance_m: Array
    sigma_m: Array

    @classmethod
    def of(cls, node_tethers: Sequence[NodeTether], keys: Keys) -> "TetherConstraints":
        """Of ties between nodes."""
        ends = np.array([keys.of_node_tether(node_tether) for node_tether in node_tethers], dtype=np.int64).reshape(
            -1, 2
        )
        limits = np.array(
            [[node_tether.max_distance_m, node_tether.sigma_m] for node_tether in node_tethers]
        ).reshape(-1, 2)
        return cls.between(ends, ends, np.ones(ends.shape), limits[:, 0], limits[:, 1])

    @classmethod
    def between(
        cls,
        earlier: NDArray[np.int64],
        later: NDArray[np.int64],
        share: Array,
        max_distance_m: Array,
        sigma_m: Array,
    ) -> "TetherConstraints":
        """With sigmas that do not make the elimination fail."""
        at_pose = np.where(earlier == later, 1.0, share)
        return cls(earlier, later, at_pose, max_distance_m, np.maximum(sigma_m, LEAST_SIGMA))

    def __len__(self) -> int:
        return len(self.max_distance_m)

    @property
    def ends(self) -> Array:
        """What tells their places (m, 6); two tethers with the same ones are one."""
        return np.concatenate([self.earlier, self.later, self.share], axis=1)

    def __add__(self, others: "TetherConstraints") -> "TetherConstraints":
        return TetherConstraints(
            np.concatenate([self.earlier, others.earlier]),
            np.concatenate([self.later, others.later]),
            np.concatenate([self.share, others.share]),
            np.concatenate([self.max_distance_m, others.max_distance_m]),
            np.concatenate([self.sigma_m, others.sigma_m]),
        )

    def only(self, chosen: NDArray[np.int64]) -> "TetherConstraints":
        """Some of them, by number."""
        return TetherConstraints(
            self.earlier[chosen],
            self.later[chosen],
            self.share[chosen],
            self.max_distance_m[chosen],
            self.sigma_m[chosen],
        )

    def softened(self, factor: float) -> "TetherConstraints":
        return replace(self, sigma_m=factor * self.sigma_m)

    def error(self, pose: Array) -> float:
        """Half the sum of squares of what poses (n, 3) exceed, in sigmas."""
        apart = self._between(pose[:, :2])
        violation_m = np.maximum(np.hypot(apart[:, 0], apart[:, 1]) - self.max_distance_m, 0.0)
        return 0.5 * float(np.sum((violation_m / self.sigma_m) ** 2))

    def near(self, pose: Array) -> "LinearTethers":
        """The tethers near poses (n, 3)."""
        apart = self._between(pose[:, :2])
        distance_m = np.maximum(np.hypot(apart[:, 0], apart[:, 1]), _LEAST_DISTANCE_M)
        return LinearTethers(self, apart / distance_m[:, None], distance_m, to_map(pose[:, 2])[:, :2, :2])

    def _between(self, place: Array) -> Array:
        """From the second place to the first (m, 2), or of any other vectors of the poses (n, 2)."""
        ends = place[self.earlier] + self.share[..., None] * (place[self.later] - place[self.earlier])
        between: Array = ends[:, 0] - ends[:, 1]
        return between


@dataclass(frozen=True)
class LinearTethers:
    """Tethers near some poses. along (m, 2): direction from the second place to the first, in the map; distance_m
    (m,); to_map: (n, 2, 2) from a pose's own axes."""

    tethers: TetherConstraints
    along: Array
    distance_m: Array
    to_map: Array

    @property
    def violation_m(self) -> Array:
        """(m,), negative for slack ones."""
        excess: Array = self.distance_m - self.tethers.max_distance_m
        return excess

    def moved(self, change: Array) -> tuple[Array, Array]:
        """By changes (n, 3) of the poses along their own axes: how much longer each tether gets (m,), and how far its
        ends move across it beyond what their own turns explain (m,), both in m."""
        apart = self.tethers._between(np.einsum("nij,nj->ni", self.to_map, change[:, :2]))
        across = self.along[:, 0] * apart[:, 1] - self.along[:, 1] * apart[:, 0]
        turned = 0.5 * change[self.tethers.earlier, 2].sum(axis=1)
        return np.sum(self.along * apart, axis=1), across - self.distance_m * turned

    def error(self, change: Array, expected_violation_m: Array) -> float:
        """What the tethers that are exceeded after a change cost then, with the stiffness of `factors`."""
        longer, across = self.moved(change)
        violation_m = np.maximum(self.violation_m + longer, 0.0)
        resisting = self._stiffness(expected_violation_m) * across
        return 0.5 * float(np.sum((violation_m / self.tethers.sigma_m) ** 2 + resisting**2))

    def factors(self, active: NDArray[np.bool_], expected_violation_m: Array) -> gtsam.GaussianFactorGraph:
        """Linear factors of the taut tethers (m,). pull_m: (m,) what they are expected to be exceeded by in the end,
        which is their force; 0 for Gauss and Newton's factors."""
        graph, chosen = gtsam.GaussianFactorGraph(), np.flatnonzero(active)
        if not len(chosen):
            return graph
        sigma_m, stiff = self.tethers.sigma_m[chosen], self._stiffness(expected_violation_m)[chosen]
        x, y = self.along[chosen].T
        rows = np.array([[x, y] / sigma_m, [-y, x] * stiff]).transpose(2, 0, 1)  # (chosen, 2, 2)
        turned = np.zeros((len(chosen), 2, 1))
        turned[:, 1, 0] = -0.5 * stiff * self.distance_m[chosen]
        short = np.stack([-self.violation_m[chosen] / sigma_m, np.zeros(len(chosen))], axis=1)
        earlier, later = self.tethers.earlier[chosen], self.tethers.later[chosen]
        share = self.tethers.share[chosen]
        blocks = []
        for end, sign in ((0, 1.0), (1, -1.0)):
            of_earlier = sign * (1.0 - share[:, end])[:, None, None] * rows @ self.to_map[earlier[:, end]]
            of_later = sign * share[:, end][:, None, None] * rows @ self.to_map[later[:, end]]
            blocks.append(np.concatenate([of_earlier, turned], axis=2))
            blocks.append(np.concatenate([of_later, np.zeros_like(turned)], axis=2))
        keys = np.stack([earlier[:, 0], later[:, 0], earlier[:, 1], later[:, 1]], axis=1).tolist()
        for own_keys, own_short, kept, *own in zip(
            keys, short, np.where(stiff > 0.0, 2, 1).tolist(), *blocks, strict=True
        ):
            graph.add(_factor(own_keys, [block[:kept] for block in own], own_short[:kept], _UNIT[kept]))
        return graph

    def _stiffness(self, expected_violation_m: Array) -> Array:
        """Root of the force over the length (m,), 1/m."""
        stiffness: Array = np.sqrt(np.maximum(expected_violation_m, 0.0) / self.distance_m) / self.tethers.sigma_m
        return stiffness


_UNIT = {rows: gtsam.noiseModel.Unit.Create(rows) for rows in (1, 2)}


def _factor(
    keys: Sequence[int], blocks: Sequence[Array], short: Array, noise: gtsam.noiseModel.Unit
) -> gtsam.JacobianFactor:
    """Of the four keys of two places, of which those of one place at least are the same."""
    i, j, k, m = keys
    if i == j and k == m:
        return gtsam.JacobianFactor(i, blocks[0] + blocks[1], k, blocks[2] + blocks[3], short, noise)
    if i == j:
        return gtsam.JacobianFactor(i, blocks[0] + blocks[1], k, blocks[2], m, blocks[3], short, noise)
    return gtsam.JacobianFactor(i, blocks[0], j, blocks[1], k, blocks[2] + blocks[3], short, noise)
