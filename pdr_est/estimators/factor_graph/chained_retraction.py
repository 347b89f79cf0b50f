"""Changes of the poses of a walk, carried out by walking it again.

The linear change of a pose says where it goes to first order. Where the walk bends by an angle, all that comes later
swings: a pose that simply moved by its own change would go along the tangent and not the arc, an error that grows
with the square of the angle and the length of the walk. Between one pose and the next the changes are small however
long the walk is. So the changes of the motion from pose to pose are taken, and the poses composed of these anew.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.timeline import Timeline
from pdr_est.frames import Array, rotate_vectors


@dataclass(frozen=True)
class ChainedRetraction:
    """From which other pose each one is reached: on the first device from the one before, on another device from the
    first device's last one by then. leading: number of the first device's poses; led_by: (n - leading,)."""

    leading: int
    led_by: NDArray[np.int64]

    @classmethod
    def of(cls, timelines: Sequence[Timeline]) -> "ChainedRetraction":
        """Of devices whose poses are numbered one device after the other."""
        times_s = [np.array([node.time_s for node in timeline.nodes]) for timeline in timelines]
        leader_s = times_s[0]
        led_by = [np.searchsorted(leader_s, own_s, side="right") - 1 for own_s in times_s[1:]]
        return cls(len(leader_s), np.maximum(np.concatenate([np.zeros(0, dtype=np.int64), *led_by]), 0))

    def walked(self, pose: Array, change: Array) -> Array:
        """Poses (n, 3) after changes (n, 3) of theirs, forward, left and heading."""
        shift, turn = rotate_vectors(change[:, :2], pose[:, 2]), change[:, 2]
        seen_from = np.concatenate([np.maximum(np.arange(self.leading) - 1, 0), self.led_by])
        base_rad = pose[seen_from, 2]
        ahead = rotate_vectors(pose[:, :2] - pose[seen_from, :2], -base_rad)
        across = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
        ahead = ahead + rotate_vectors(shift - shift[seen_from], -base_rad) - turn[seen_from, None] * across
        heading_rad = pose[:, 2] + turn
        moved = rotate_vectors(ahead, heading_rad[seen_from])
        moved[0] = pose[0, :2] + shift[0]
        place = np.cumsum(moved[: self.leading], axis=0)
        return np.column_stack([np.concatenate([place, place[self.led_by] + moved[self.leading :]]), heading_rad])
