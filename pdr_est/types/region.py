"""Mixtures of normal distributions for the position at each pose of a track.

Behind a fork, or round a corner, the positions that are possible lie at several places or on a bent line. Mean and
covariance then describe an ellipse that reaches through walls, with its centre where nobody can be.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array

MOST_COMPONENTS = 3
"""Number of components that a region has room for."""

_OUTSIDE = 0.05  # probability that the position lies outside of the region
_CHI_SQUARED_95 = -2.0 * math.log(_OUTSIDE)  # 95 % quantile with two degrees of freedom
_LEAST_VARIANCE_M2 = 1e-8  # of a component along each axis: below the digits of a file


@dataclass(frozen=True)
class RegionEllipses:
    """Ellipses that together make up the 95 % regions of poses, at least one for each pose.

    Attributes
    ----------
    pose
        (m,) index of the pose, ascending.
    weight
        (m,) probability of the component that the ellipse stands for.
    centre_m
        (m, 2) east and north, m.
    covariance_m2
        (m, 2, 2) m², of the normal distribution whose own 95 % ellipse it is.
    """

    pose: NDArray[np.int64]
    weight: Array
    centre_m: Array
    covariance_m2: Array

    def of_poses(self, chosen: Sequence[int]) -> list[tuple[Array, Array]]:
        """List centre (2,), m, and covariance (2, 2), m², of the ellipses of chosen poses."""
        return [(self.centre_m[k], self.covariance_m2[k]) for k in np.flatnonzero(np.isin(self.pose, chosen))]


@dataclass(frozen=True)
class PoseRegion:
    """Mixtures of normal distributions for the position at n poses, with up to k components each.

    Where one component is enough, it has the position and the covariance of the pose itself. A component that is not
    needed has the weight 0, and NaN as mean and covariance.

    The region that holds 95 % is the union of one ellipse for each component. The borders of all ellipses have the
    same density, each for its own component. Where ellipses overlap, their union holds a little more than 95 %.

    Attributes
    ----------
    weight
        (n, k) probability of each component, the largest first; they add up to 1.
    mean_m
        (n, k, 2) mean of each component, east and north, m, map frame.
    covariance_m2
        (n, k, 2, 2) covariance of each component, m².
    """

    weight: Array
    mean_m: Array
    covariance_m2: Array

    def __len__(self) -> int:
        return len(self.weight)

    @classmethod
    def of_gaussians(cls, position_m: Array, covariance_m2: Array) -> "PoseRegion":
        """Make the region of poses that a single normal distribution describes.

        Parameters
        ----------
        position_m
            (n, 2) m.
        covariance_m2
            (n, 2, 2) m².
        """
        count = len(position_m)
        weight = np.zeros((count, MOST_COMPONENTS))
        mean_m = np.full((count, MOST_COMPONENTS, 2), np.nan)
        covariance = np.full((count, MOST_COMPONENTS, 2, 2), np.nan)
        weight[:, 0], mean_m[:, 0], covariance[:, 0] = 1.0, position_m, covariance_m2
        return cls(weight, mean_m, covariance)

    def with_gaussians(self, position_m: Array, covariance_m2: Array) -> "PoseRegion":
        """Replace single components by positions (n, 2), m, and covariances (n, 2, 2), m², of the poses."""
        single = self.components == 1
        mean, covariance = self.mean_m.copy(), self.covariance_m2.copy()
        mean[single, 0], covariance[single, 0] = position_m[single], covariance_m2[single]
        return replace(self, mean_m=mean, covariance_m2=covariance)

    @property
    def components(self) -> NDArray[np.int64]:
        """Number of components of each pose (n,); 1 where the pose and its covariance say everything."""
        found: NDArray[np.int64] = (self.weight > 0.0).sum(axis=1)
        return found

    def rows(self, chosen: NDArray[np.bool_] | NDArray[np.int64] | NDArray[np.intp] | slice) -> "PoseRegion":
        """Select poses by their indices, a mask or a slice."""
        return PoseRegion(self.weight[chosen], self.mean_m[chosen], self.covariance_m2[chosen])

    def shifted(self, shift_m: Array, covariance_m2: Array | None = None) -> "PoseRegion":
        """Move the region of each pose by (n, 2), or that of all by (2,), m, which may have an error of its own.

        Parameters
        ----------
        shift_m
            East and north, m.
        covariance_m2
            (2, 2) m², covariance of the error of the shift; None if it has none.
        """
        shift = np.broadcast_to(np.asarray(shift_m, dtype=np.float64), (len(self), 2))
        added = np.zeros((2, 2)) if covariance_m2 is None else covariance_m2
        return replace(self, mean_m=self.mean_m + shift[:, None], covariance_m2=self.covariance_m2 + added)

    def squared_reach(self, sigma_m: float = 0.0) -> Array:
        """Compute the sizes of the ellipses that together hold 95 %.

        Parameters
        ----------
        sigma_m
            Standard deviation, m, along each axis, of an independent error that is added, such as that of a
            reference position.

        Returns
        -------
        Array
            (n, k) squared Mahalanobis distance from the mean of a component to the border of its ellipse: 5.99 for a
            component that stands alone, 0 for one that is too improbable to be part of the region, NaN where a
            covariance is not finite.
        """
        used = self.weight > 0.0
        (xx, xy), (_, yy) = np.moveaxis(self._covariance(sigma_m), (2, 3), (0, 1))
        area = np.where(used, np.sqrt(np.maximum(xx * yy - xy * xy, 0.0)), 0.0)
        with np.errstate(invalid="ignore", divide="ignore"):
            while True:
                # A component has the share c area outside of its ellipse, whose border has the density c / (2 pi).
                left = _OUTSIDE - np.where(used, 0.0, self.weight).sum(axis=1)
                outside = (left / np.where(used, area, 0.0).sum(axis=1))[:, None] * area
                improbable = used & (outside >= self.weight)
                if not improbable.any():
                    return np.where(used, 2.0 * np.log(self.weight / outside), 0.0)
                used &= ~improbable

    def contains(self, position_m: Array, sigma_m: float = 0.0) -> NDArray[np.bool_]:
        """Tell whether the 95 % region of each pose contains a position.

        Parameters
        ----------
        position_m
            (n, 2) m, one position for each pose.
        sigma_m
            Standard deviation of the positions along each axis, m.

        Returns
        -------
        NDArray[np.bool_]
            (n,); false where the region is not finite.
        """
        (xx, xy), (_, yy) = np.moveaxis(self._covariance(sigma_m), (2, 3), (0, 1))
        x, y = np.moveaxis(np.asarray(position_m, dtype=np.float64)[:, None] - self.mean_m, 2, 0)
        distance = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy)
        reach = self.squared_reach(sigma_m)
        inside: NDArray[np.bool_] = ((reach > 0.0) & (distance <= reach)).any(axis=1)
        return inside

    def ellipses(self) -> "RegionEllipses":
        """List the ellipses of the 95 % regions, pose by pose."""
        reach = self.squared_reach()
        pose, component = np.nonzero((self.weight > 0.0) & ~(reach == 0.0))
        scale = reach[pose, component] / _CHI_SQUARED_95
        covariance = self.covariance_m2[pose, component] * scale[:, None, None]
        return RegionEllipses(pose, self.weight[pose, component], self.mean_m[pose, component], covariance)

    def _covariance(self, sigma_m: float) -> Array:
        return self.covariance_m2 + (sigma_m**2 + _LEAST_VARIANCE_M2) * np.eye(2)


def joined_regions(regions: Sequence[PoseRegion]) -> PoseRegion:
    """Join the regions of the poses of several tracks, one after the other."""
    return PoseRegion(
        np.concatenate([one.weight for one in regions]),
        np.concatenate([one.mean_m for one in regions]),
        np.concatenate([one.covariance_m2 for one in regions]),
    )


def ellipses_of_poses(position_m: Array, covariance_m2: Array, region: PoseRegion | None) -> RegionEllipses:
    """List the ellipses of the 95 % regions of poses (n, 2) with covariances (n, 2, 2), and perhaps a region."""
    if region is None or not (region.components > 1).any():
        count = len(position_m)
        return RegionEllipses(np.arange(count), np.ones(count), position_m, covariance_m2)
    return region.ellipses()
