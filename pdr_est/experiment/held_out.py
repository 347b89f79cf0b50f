"""Selection of the true positions that an estimator gets as fixes; the others judge its track."""

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pdr_est.evaluate.held_out_fixes import EVERY, WAYPOINT_SIGMA_M, fixes_at, given_points
from pdr_est.evaluate.time_association import Association
from pdr_est.experiment.config import FixesParams
from pdr_est.frames import Array
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.measurements import PositionFix

POSES_APART_M = 5.0
"""Way, m, between the poses of a dense ground truth that take the place of waypoints; every third is a fix, so that a
track is on its own for 15 m.
"""


@dataclass(frozen=True)
class HeldOut:
    """Division of the true positions of one walk into fixes and held-out points.

    Attributes
    ----------
    every : int
        Every so-many-th point and the last one are given as fixes.
    sigma_m : float
        Standard deviation of a fix per axis, m.
    truth_sigma_m : float
        Standard deviation of the held-out points per axis, m.
    noise : Callable or None
        Draws the errors (n, 2), m, that are added to the n fixes of a ground truth without errors.
    apart_m : float
        Least way between two points that count when every so-many-th is given, m; of recorded poses nothing would be
        left to hold out otherwise. All points that are not given are held out.
    """

    every: int = EVERY
    sigma_m: float = WAYPOINT_SIGMA_M
    truth_sigma_m: float = WAYPOINT_SIGMA_M
    noise: Callable[[int], Array] | None = None
    apart_m: float = 0.0

    def given(self, pairs: Association) -> NDArray[np.bool_]:
        """Return a mask (n,) of the pairs that are given as fixes."""
        waypoints = self.waypoints(pairs)
        given = np.zeros(len(pairs), dtype=np.bool_)
        given[waypoints[given_points(len(waypoints), self.every)]] = True
        return given

    def waypoints(self, pairs: Association) -> NDArray[np.intp]:
        """Return the indices of the pairs among which those that are given are counted off."""
        return spaced_along_way(pairs.truth_m, self.apart_m)

    def fixes(self, pairs: Association) -> tuple[PositionFix, ...]:
        """Make fixes of the pairs that are given."""
        given = self.given(pairs)
        position_m = pairs.truth_m[given]
        if self.noise is not None:
            position_m = position_m + self.noise(len(position_m))
        return fixes_at(pairs.time_s[given], position_m, self.sigma_m)


@dataclass(frozen=True)
class HeldOutProtocol:
    """Rule that selects the fixes of every walk.

    Attributes
    ----------
    fixes : FixesParams
        Section `fixes` of the experiment.
    seed, walk : int, str
        Seed of the errors of the fixes on a walk whose ground truth has no errors.
    """

    fixes: FixesParams
    seed: int = 0
    walk: str = ""

    def held_out(self, truth: TruePositions) -> HeldOut | None:
        """Divide the true positions of a walk; None if no fixes are given."""
        if self.fixes.protocol == "none":
            return None
        own = self.fixes.protocol == "every"
        every, sigma_m = (self.fixes.every, self.fixes.sigma_m) if own else (HeldOut.every, HeldOut.sigma_m)
        apart_m = 0.0 if own or not truth.dense else POSES_APART_M
        if truth.sigma_m == 0.0:
            return HeldOut(every, sigma_m, 0.0, partial(_noise, self.seed, self.walk, sigma_m), apart_m)
        if truth.sigma_m > WAYPOINT_SIGMA_M and not own:
            return HeldOut(every, truth.sigma_m, truth.sigma_m, apart_m=apart_m)
        return HeldOut(every, sigma_m, truth.sigma_m if own else WAYPOINT_SIGMA_M, apart_m=apart_m)


def spaced_along_way(points_m: Array, apart_m: float) -> NDArray[np.intp]:
    """Return the indices of the first point, (n, 2), and of each next one apart_m of way after the last one kept."""
    if apart_m <= 0.0 or not len(points_m):
        return np.arange(len(points_m), dtype=np.intp)
    way_m = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points_m, axis=0), axis=1))])
    kept = [0]
    for i in range(1, len(way_m)):
        if way_m[i] - way_m[kept[-1]] >= apart_m:
            kept.append(i)
    return np.array(kept, dtype=np.intp)


def _noise(seed: int, walk: str, sigma_m: float, count: int) -> Array:
    """Draw errors (count, 2), m, of fixes, the same for every variant of a walk."""
    rng = np.random.default_rng([seed, zlib.crc32(walk.encode())])
    return sigma_m * rng.standard_normal((count, 2))
