"""Keys of the variables of a walk's factor graph."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import gtsam
import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.timeline import SAME_S, Timeline
from pdr_est.frames import Array


@dataclass(frozen=True)
class GraphKeys:
    """Keys of the poses, the reference headings and the wandering errors of fixes in a walk's graph.

    The nodes of the first device have the keys 0, 1, 2, …, those of the next device follow, the references come after
    all poses, and the wandering errors after these. The auxiliary variables of a tether that ends between two poses
    (`tether_factors`) have GTSAM symbols for keys: ``p`` and the tether's number for the place, ``c`` for the copied
    positions.

    Attributes
    ----------
    devices : tuple of str
        Names of the devices.
    times_s : tuple of (n,) arrays
        Times of the nodes of each device, s.
    first : tuple of int
        Key of the first pose of each device.
    references : tuple of int or None
        Key of each device's reference, a Pose2 whose heading relative heading priors count from; None for a device
        without such priors.
    poses : int
        Number of poses of all devices.
    fix_errors : tuple of (str, float)
        Source and time, s, of each wandering error of position fixes, source by source in order of time. They have
        the keys from `first_fix_error` on.
    """

    devices: tuple[str, ...]
    times_s: tuple[Array, ...] = field(repr=False)
    first: tuple[int, ...]
    references: tuple[int | None, ...]
    poses: int
    fix_errors: tuple[tuple[str, float], ...] = field(repr=False)

    @classmethod
    def of_timelines(cls, timelines: Sequence[Timeline]) -> "GraphKeys":
        """Assign keys to the nodes of all devices, one device after the other."""
        times_s = tuple(np.array([node.time_s for node in timeline.nodes]) for timeline in timelines)
        counts = [len(timeline.nodes) for timeline in timelines]
        first = tuple(int(n) for n in np.cumsum([0, *counts[:-1]]))
        references: list[int | None] = []
        next_key = sum(counts)
        for timeline in timelines:
            relative = any(prior.relative for prior in timeline.priors)
            references.append(next_key if relative else None)
            next_key += relative
        wandering = {(fix.source, fix.time_s) for one in timelines for fix in one.fixes if fix.sigma_wander_m > 0.0}
        devices = tuple(one.device for one in timelines)
        return cls(devices, times_s, first, tuple(references), sum(counts), tuple(sorted(wandering)))

    def of(self, device: str, time_s: float) -> int:
        """Return the key of a device's pose at a time.

        Parameters
        ----------
        device : str
            Name of the device.
        time_s : float
            Time, s, on the clock of the measurements.

        Returns
        -------
        int
            Key of the pose at `time_s`, or of the last one before it.

        Raises
        ------
        EstimationError
            For an unknown device, or a time before its first pose.
        """
        number = self._number_of(device)
        node = int(np.searchsorted(self.times_s[number], time_s + SAME_S, side="right")) - 1
        if node < 0:
            raise EstimationError(
                f"pose of {device} at {time_s} s: its walk begins at {self.times_s[number][0]} s, give a later time"
            )
        return self.first[number] + node

    def of_device(self, device: str) -> range:
        """Return the keys of all poses of a device, in order of time."""
        number = self._number_of(device)
        return range(self.first[number], self.first[number] + len(self.times_s[number]))

    def reference_of(self, device: str) -> int | None:
        """Return the key of a device's reference heading, or None if it has no relative heading priors."""
        return self.references[self._number_of(device)]

    def of_fix_error(self, source: str, time_s: float) -> int:
        """Return the key of the wandering error of a source at the time of one of its fixes.

        Raises
        ------
        EstimationError
            If the source gave no fix with a wandering error at that time.
        """
        found = [
            i for i, (name, at_s) in enumerate(self.fix_errors) if name == source and abs(at_s - time_s) <= SAME_S
        ]
        if not found:
            raise EstimationError(
                f"wandering error of {source!r} at {time_s} s: it gave no fix with one then, "
                "give source and time of a fix whose sigma_wander_m is not 0"
            )
        return self.first_fix_error + found[0]

    @property
    def present_references(self) -> list[int]:
        """Keys of the references of those devices that have one."""
        return [key for key in self.references if key is not None]

    @property
    def first_fix_error(self) -> int:
        """Key of the first wandering error, if there are any."""
        return self.poses + len(self.present_references)

    def _number_of(self, device: str) -> int:
        if device not in self.devices:
            raise EstimationError(f"unknown device {device!r}: name one of {', '.join(self.devices)}")
        return self.devices.index(device)


def position_copies(number: int) -> tuple[int, int]:
    """Return the keys of the copied positions that the place of the tether of that number lies between."""
    return int(gtsam.symbol("c", 2 * number)), int(gtsam.symbol("c", 2 * number + 1))


def tethered_place(number: int) -> int:
    """Return the key of the place between two poses that the tether of that number holds."""
    return int(gtsam.symbol("p", number))


def is_auxiliary(key: int) -> bool:
    """Tell whether a key is that of an auxiliary variable of a tether."""
    return chr(gtsam.symbolChr(key)) in ("c", "p")


def pose_array(values: gtsam.Values, count: int) -> NDArray[np.float64]:
    """Return the poses with the keys 0 … count - 1 as (count, 3): east m, north m, heading rad."""
    return np.asarray(gtsam.utilities.extractPose2(values)[:count])


def values_of_poses(pose: NDArray[np.float64]) -> gtsam.Values:
    """Return values that hold poses (count, 3) under the keys 0 … count - 1."""
    values = gtsam.Values()
    for key, (east_m, north_m, heading_rad) in enumerate(pose.tolist()):
        values.insert(key, gtsam.Pose2(east_m, north_m, heading_rad))
    return values
