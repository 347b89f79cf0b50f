"""Tethers between the devices of a walk: their violation at given poses, their cost, and their linearisation.

A tether costs nothing while its ends are within its length, and half the square of the violation in standard
deviations beyond. Where it is violated it is active, and has the same cost as a range measurement of its length
(`tether_factors`).

Gauss-Newton neglects that a tether under tension also resists displacements across its direction; the missing
stiffness is tension over length. But a tether that turns together with the poses at its ends is not stretched, so
only displacements across it relative to the headings of these poses count. With the full stiffness, which is right
for a tether between two free points, bending a long walk as a whole would appear far too expensive, and the number of
Newton steps would grow with the length of the walk.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.motion_model import MIN_SIGMA
from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.pose_chains.linear_rows import LinearRows, to_map
from pdr_est.frames import Array

_MIN_DISTANCE_M = 1e-9


@dataclass(frozen=True)
class TetherConstraints:
    """Upper bounds of the distances between m pairs of places.

    The two places of a tether lie on straight lines from one pose to another pose of the same device. A place at a
    pose has that pose for both; at least one of the two places is at a pose.

    Attributes
    ----------
    earlier, later : (m, 2) arrays of int
        Keys of the poses that the lines lead from and to.
    share : (m, 2) array
        Share of the way from the earlier to the later pose, 0 … 1; 1 for a place at a pose.
    max_distance_m : (m,) array
        Lengths of the tethers, m.
    sigma_m : (m,) array
        Standard deviation with which the length is exceeded, m.
    """

    earlier: NDArray[np.int64]
    later: NDArray[np.int64]
    share: Array
    max_distance_m: Array
    sigma_m: Array

    @classmethod
    def between_nodes(cls, node_tethers: Sequence[NodeTether], first: Sequence[int]) -> "TetherConstraints":
        """Make the constraints of tethers whose two places are at poses; `first`: number of each device's first."""
        ends = np.array(
            [(first[one.device_a] + one.node_a, first[one.device_b] + one.node_b) for one in node_tethers],
            dtype=np.int64,
        ).reshape(-1, 2)
        limits = np.array([[one.max_distance_m, one.sigma_m] for one in node_tethers]).reshape(-1, 2)
        return cls.between_places(ends, ends, np.ones(ends.shape), limits[:, 0], limits[:, 1])

    @classmethod
    def between_places(
        cls,
        earlier: NDArray[np.int64],
        later: NDArray[np.int64],
        share: Array,
        max_distance_m: Array,
        sigma_m: Array,
    ) -> "TetherConstraints":
        """Make constraints with shares and standard deviations that the elimination can work with."""
        at_pose = np.where(earlier == later, 1.0, share)
        return cls(earlier, later, at_pose, max_distance_m, np.maximum(sigma_m, MIN_SIGMA))

    def __len__(self) -> int:
        """Return the number of tethers."""
        return len(self.max_distance_m)

    @property
    def ends(self) -> Array:
        """Poses and shares (m, 6) that define the places; equal rows are the same tether."""
        return np.concatenate([self.earlier, self.later, self.share], axis=1)

    def __add__(self, others: "TetherConstraints") -> "TetherConstraints":
        """Append other tethers."""
        return TetherConstraints(
            np.concatenate([self.earlier, others.earlier]),
            np.concatenate([self.later, others.later]),
            np.concatenate([self.share, others.share]),
            np.concatenate([self.max_distance_m, others.max_distance_m]),
            np.concatenate([self.sigma_m, others.sigma_m]),
        )

    def only(self, chosen: NDArray[np.int64]) -> "TetherConstraints":
        """Select some tethers by number."""
        return TetherConstraints(
            self.earlier[chosen],
            self.later[chosen],
            self.share[chosen],
            self.max_distance_m[chosen],
            self.sigma_m[chosen],
        )

    def softened(self, factor: float) -> "TetherConstraints":
        """Multiply the standard deviations by a factor."""
        return replace(self, sigma_m=factor * self.sigma_m)

    def error(self, pose: Array) -> float:
        """Return the cost of all tethers at poses (n, 3): half the sum of the squared violations in sigmas."""
        apart = self.separation(pose[:, :2])
        violation_m = np.maximum(np.hypot(apart[:, 0], apart[:, 1]) - self.max_distance_m, 0.0)
        return 0.5 * float(np.sum((violation_m / self.sigma_m) ** 2))

    def linearised(self, pose: Array) -> "LinearTethers":
        """Linearise the distances at poses (n, 3)."""
        apart = self.separation(pose[:, :2])
        distance_m = np.maximum(np.hypot(apart[:, 0], apart[:, 1]), _MIN_DISTANCE_M)
        return LinearTethers(self, apart / distance_m[:, None], distance_m, to_map(pose[:, 2])[:, :2, :2])

    def separation(self, position: Array) -> Array:
        """Return the vectors (m, 2) from the second to the first place, for positions (n, 2) of the poses."""
        ends = position[self.earlier] + self.share[..., None] * (position[self.later] - position[self.earlier])
        between: Array = ends[:, 0] - ends[:, 1]
        return between


@dataclass(frozen=True)
class LinearTethers:
    """Tethers linearised at n poses.

    Attributes
    ----------
    tethers : TetherConstraints
        The m tethers.
    along : (m, 2) array
        Unit vectors from the second to the first place, in the map frame.
    distance_m : (m,) array
        Distances of the places, m.
    to_map : (n, 2, 2) array
        Rotations of the poses, from their own frames into the map frame.
    """

    tethers: TetherConstraints
    along: Array
    distance_m: Array
    to_map: Array

    @property
    def violation_m(self) -> Array:
        """Distance minus length of each tether (m,), m; negative for tethers that hold."""
        violation: Array = self.distance_m - self.tethers.max_distance_m
        return violation

    def displacements(self, change: Array) -> tuple[Array, Array]:
        """Return by how much the tethers get longer, and how far their ends move across them.

        Parameters
        ----------
        change : (n, 3) array
            Changes of the poses along their own axes: forward m, left m, heading rad.

        Returns
        -------
        along_m, across_m : (m,) arrays
            Change of the distance, and displacement across the tether relative to the headings at its ends, m.
        """
        apart = self.tethers.separation(np.einsum("nij,nj->ni", self.to_map, change[:, :2]))
        across = self.along[:, 0] * apart[:, 1] - self.along[:, 1] * apart[:, 0]
        turned = 0.5 * change[self.tethers.earlier, 2].sum(axis=1)
        return np.sum(self.along * apart, axis=1), across - self.distance_m * turned

    def error(self, change: Array, expected_violation_m: Array) -> float:
        """Return the cost after changes (n, 3) of the poses, with the stiffness across the tethers included."""
        longer, across = self.displacements(change)
        violation_m = np.maximum(self.violation_m + longer, 0.0)
        resisting = self._stiffness(expected_violation_m) * across
        return 0.5 * float(np.sum((violation_m / self.tethers.sigma_m) ** 2 + resisting**2))

    def rows(self, active: NDArray[np.bool_], expected_violation_m: Array) -> list[LinearRows]:
        """Return the rows of active tethers, and those of their stiffness across their direction.

        Parameters
        ----------
        active : (m,) array of bool
            Tethers that are violated.
        expected_violation_m : (m,) array
            Violation that is expected at the optimum, m, which gives the tension; zero leaves the stiffness out.
        """
        chosen = np.flatnonzero(active)
        along = self.along[chosen] / self.tethers.sigma_m[chosen, None]
        wanted = -self.violation_m[chosen] / self.tethers.sigma_m[chosen]
        stiffness = self._stiffness(expected_violation_m)
        stiff = np.flatnonzero(active & (stiffness > 0.0))
        x, y = self.along[stiff].T
        across = np.stack([-y, x], axis=1) * stiffness[stiff, None]
        turned = -0.5 * stiffness[stiff] * self.distance_m[stiff]
        return [
            self._rows_of(chosen, along, np.zeros(len(chosen)), wanted),
            self._rows_of(stiff, across, turned, np.zeros(len(stiff))),
        ]

    def _rows_of(self, chosen: NDArray[np.int64], direction: Array, turned: Array, right: Array) -> LinearRows:
        """Make a row for each chosen tether, of displacements along a direction and of the turns of its ends."""
        earlier, later = self.tethers.earlier[chosen], self.tethers.later[chosen]
        share = self.tethers.share[chosen]
        jacobian = np.zeros((len(chosen), 1, 4, 3))
        for end, sign in ((0, 1.0), (1, -1.0)):
            for place, pose, part in ((0, earlier, 1.0 - share), (1, later, share)):
                weight = sign * part[:, end, None]
                jacobian[:, 0, 2 * end + place, :2] = weight * np.einsum(
                    "mi,mij->mj", direction, self.to_map[pose[:, end]]
                )
            jacobian[:, 0, 2 * end, 2] = turned
        pose = np.stack([earlier[:, 0], later[:, 0], earlier[:, 1], later[:, 1]], axis=1)
        return LinearRows(pose, jacobian.reshape(len(chosen), 1, 12), right[:, None])

    def _stiffness(self, expected_violation_m: Array) -> Array:
        """Return the square root of tension over length (m,), 1/m."""
        stiffness: Array = np.sqrt(np.maximum(expected_violation_m, 0.0) / self.distance_m) / self.tethers.sigma_m
        return stiffness
