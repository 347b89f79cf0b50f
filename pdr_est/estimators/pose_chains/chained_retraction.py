"""Retraction of pose changes along the walk instead of pose by pose.

The linear change of a pose is exact to first order only. Where a walk is bent by an angle, everything after it
swings, and a pose that is moved by its own change goes along the tangent instead of the arc: an error that grows with
the square of the angle and with the length of the walk. The change of the motion from one pose to the next, however,
is small however long the walk is. The changes are therefore converted to changes of these motions, and the poses are
composed anew. For two devices of 10 000 steps each this needs 18 Newton steps instead of 49, of 50 000 steps each 20
instead of 220 and an eighth of the time.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.timeline import Timeline
from pdr_est.frames import Array, rotate_vectors


@dataclass(frozen=True)
class ChainedRetraction:
    """Chains of the poses of several devices.

    A pose of the first device is composed from the pose before it. A pose of another device is composed from the last
    pose of the first device by then.

    Attributes
    ----------
    leading : int
        Number of poses of the first device.
    leader : (n - leading,) array of int
        Pose of the first device for each pose of the other devices.
    """

    leading: int
    leader: NDArray[np.int64]

    @classmethod
    def of_timelines(cls, timelines: Sequence[Timeline]) -> "ChainedRetraction":
        """Chain the poses of devices, which are numbered one device after the other."""
        times_s = [np.array([node.time_s for node in timeline.nodes]) for timeline in timelines]
        leader_s = times_s[0]
        leader = [np.searchsorted(leader_s, own_s, side="right") - 1 for own_s in times_s[1:]]
        return cls(len(leader_s), np.maximum(np.concatenate([np.zeros(0, dtype=np.int64), *leader]), 0))

    @property
    def count(self) -> int:
        """Number of poses."""
        return self.leading + len(self.leader)

    def moved(self, pose: Array, change: Array) -> Array:
        """Apply changes to poses along the chains.

        Parameters
        ----------
        pose : (n, 3) array
            East m, north m, heading rad.
        change : (n, 3) array
            Changes along the poses' own axes: forward m, left m, heading rad.

        Returns
        -------
        (n, 3) array
            Poses after the change, to first order `pose` moved by `change`.
        """
        shift, turn = rotate_vectors(change[:, :2], pose[:, 2]), change[:, 2]
        seen_from = np.concatenate([np.maximum(np.arange(self.leading) - 1, 0), self.leader])
        base_rad = pose[seen_from, 2]
        ahead = rotate_vectors(pose[:, :2] - pose[seen_from, :2], -base_rad)
        across = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
        ahead = ahead + rotate_vectors(shift - shift[seen_from], -base_rad) - turn[seen_from, None] * across
        heading_rad = pose[:, 2] + turn
        moved = rotate_vectors(ahead, heading_rad[seen_from])
        moved[0] = pose[0, :2] + shift[0]
        place = np.cumsum(moved[: self.leading], axis=0)
        return np.column_stack([np.concatenate([place, place[self.leader] + moved[self.leading :]]), heading_rad])
