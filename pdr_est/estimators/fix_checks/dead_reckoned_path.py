"""Path that the steps alone describe, in the walker's own frame, and the covariance of its errors at two times."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.measurements import StepOdometry
from pdr_est.types.track import bracketing_poses

LEFT = np.array([[0.0, -1.0], [1.0, 0.0]])
"""Rotation by 90 degrees to the left."""

LOST_RAD = 0.7
"""Standard deviation of a turn, rad, after which a path is another one: no error of its heading is small."""


@dataclass(frozen=True)
class ReckonedPoints:
    """Points of a path at n times.

    Attributes
    ----------
    position_m
        (n, 2) positions in the walker's own frame.
    pose
        (n,) number of the pose that is nearest to each time.
    """

    position_m: Array
    pose: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.pose)

    @property
    def first_pose(self) -> int:
        """Number of the earliest pose, from which the errors of a section's path count."""
        return int(self.pose.min())

    def rows(self, chosen: NDArray[np.int64]) -> "ReckonedPoints":
        """Return some of the points."""
        return ReckonedPoints(self.position_m[chosen], self.pose[chosen])


class DeadReckonedPath:
    """Path of one device from its steps alone: from the origin along x, at the length scale 1.

    An error of the heading turns all that follows, to first order. The covariance between two points is that of all
    that happened up to the earlier one, which cumulative sums give at once for any two.

    Parameters
    ----------
    start_s
        Time of the start of the walk, s.
    steps
        Steps of the device in order of time.

    Attributes
    ----------
    time_s
        (n,) times of the poses: the start and the end of each step, s.
    position_m
        (n, 2) their positions, m.
    lost
        Numbers of the poses before which the heading was lost.
    """

    def __init__(self, start_s: float, steps: Sequence[StepOdometry]) -> None:
        ends_s = np.array([step.time_s for step in steps])
        self.time_s = np.array([min(start_s, ends_s[0]), *ends_s])
        begins_s = np.array([step.start_s for step in steps])
        self._moving_from_s = np.array([self.time_s[0], *np.maximum(begins_s, self.time_s[:-1])])
        heading_rad = np.cumsum([0.0, *(step.heading_change_rad for step in steps)])
        length_m = np.array([0.0, *(step.length_m for step in steps)])
        ahead = np.stack([np.cos(heading_rad), np.sin(heading_rad)], axis=1)
        self.position_m = np.cumsum(length_m[:, None] * ahead, axis=0)
        covariance = np.concatenate([np.zeros((1, 3, 3)), [step.covariance for step in steps]])
        turned = np.stack([ahead, ahead @ LEFT.T], axis=2)
        of_heading = covariance[:, 2, 2]
        self.lost = np.flatnonzero(of_heading > LOST_RAD**2)
        with_heading = np.einsum("kab,kb->ka", turned, covariance[:, :2, 2])
        q = self.position_m
        self._of_position = np.cumsum(turned @ covariance[:, :2, :2] @ turned.transpose(0, 2, 1), axis=0)
        self._with_heading = np.cumsum(with_heading, axis=0)
        self._with_heading_at = np.cumsum(with_heading[:, :, None] * q[:, None, :], axis=0)
        self._of_heading = np.cumsum(of_heading)
        self._of_heading_at = np.cumsum(of_heading[:, None] * q, axis=0)
        self._of_heading_at_twice = np.cumsum(of_heading[:, None, None] * q[:, :, None] * q[:, None, :], axis=0)

    def at(self, time_s: Array) -> ReckonedPoints:
        """Return the points at some times (n,); the walker stands before the first and after the last step."""
        before, after, share = bracketing_poses(self.time_s, self._moving_from_s, time_s)
        position = self.position_m[before] + share[:, None] * (self.position_m[after] - self.position_m[before])
        return ReckonedPoints(position, np.where(share > 0.5, after, before))

    def covariance(self, some: ReckonedPoints, others: ReckonedPoints, begin: int) -> Array:
        """Return the covariance of the errors of points, relative to the pose of the path at an earlier one.

        Parameters
        ----------
        some, others
            Points, n and k in number.
        begin
            Number of the pose that has no error.

        Returns
        -------
        Array
            (2 n, 2 k) m², the two coordinates of a point side by side.
        """
        n, k = len(some), len(others)
        first = np.minimum(some.pose[:, None], others.pose[None, :])
        blocks = self._blocks(some.position_m[:, None], others.position_m[None, :], first, begin)
        return np.asarray(blocks.transpose(0, 2, 1, 3).reshape(2 * n, 2 * k))

    def variance(self, points: ReckonedPoints, begin: int) -> Array:
        """Return the covariances (n, 2, 2) of the errors of each point, relative to the pose at an earlier one."""
        return self._blocks(points.position_m, points.position_m, points.pose, begin)

    def _blocks(self, some_m: Array, others_m: Array, pose: NDArray[np.int64], begin: int) -> Array:
        """Return the covariance (..., 2, 2) of two points (..., 2), of which the earlier one is at a pose."""
        a, b = (some_m - self.position_m[begin]) @ LEFT.T, (others_m - self.position_m[begin]) @ LEFT.T
        m = np.maximum(pose, begin) - begin
        of_position, with_heading, with_at, of_heading, at, twice = self._sums_since(begin, int(m.max()) + 1)
        constant = (of_position - with_at - with_at.transpose(0, 2, 1) + twice)[m]
        linear = (with_heading - at)[m]
        swing = of_heading[m][..., None, None] * a[..., :, None] * b[..., None, :]
        return np.asarray(
            constant + swing + linear[..., :, None] * b[..., None, :] + a[..., :, None] * linear[..., None, :]
        )

    def _sums_since(self, begin: int, count: int) -> tuple[Array, ...]:
        """Return the sums from a pose on, of points relative to it; those of heading errors turned to the left.

        They are at the pose and those after it, `count` in all.
        """
        own, q0 = slice(begin, begin + count), self.position_m[begin]
        of_heading = self._of_heading[own] - self._of_heading[begin]
        with_heading = self._with_heading[own] - self._with_heading[begin]
        at = self._of_heading_at[own] - self._of_heading_at[begin]
        twice = self._of_heading_at_twice[own] - self._of_heading_at_twice[begin]
        with_at = self._with_heading_at[own] - self._with_heading_at[begin] - with_heading[:, :, None] * q0
        across = at[:, :, None] * q0
        twice = twice - across - across.transpose(0, 2, 1) + of_heading[:, None, None] * np.outer(q0, q0)
        return (
            self._of_position[own] - self._of_position[begin],
            with_heading,
            with_at @ LEFT.T,
            of_heading,
            (at - of_heading[:, None] * q0) @ LEFT.T,
            LEFT @ twice @ LEFT.T,
        )
