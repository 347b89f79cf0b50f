"""Compute the covariances of the fused positions of devices that tethers hold together."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import shortest_path

from pdr_est.estimators.robust_dr.constrained_map import with_least_variance
from pdr_est.frames import Array

# Mean square per axis, in units of D^2, of the distance from a point on the edge of a disc of radius D to a point
# uniformly distributed in it.
_EDGE_TO_DISC = 0.75


@dataclass(frozen=True)
class DeviceGroup:
    """Devices that take part at some time, and their tethers.

    Attributes
    ----------
    rows : NDArray[np.int64]
        Indices of the k devices among all.
    pairs : tuple[tuple[int, int], ...]
        Tethered pairs, as positions in `rows`.
    max_distance_m : Array
        Largest distance of each pair, m.
    reach_m : Array
        Largest distance of any two devices over any chain of tethers, (k, k), m; infinite without one.
    """

    rows: NDArray[np.int64]
    pairs: tuple[tuple[int, int], ...]
    max_distance_m: Array
    reach_m: Array

    def covariance(self, weighting_m2: Array, covariance_m2: Array, independent_m2: Array) -> Array:
        """Compute the covariances of the fused positions, (k, 2, 2), m^2.

        While a tether is active its devices share one position, up to its length: the mean of the estimates e_j with
        weights M_j by their covariances. Device i is then off by the sum of M_j times the errors of e_j, and by
        (I - M_i) times the error of the separation, which is the distance from a point on the edge of a disc to one
        within it.
        Independent errors of the estimates average out. Errors from the start and from the walker's step length
        are common to the devices and do not; they are combined by the bound that holds whatever their
        correlation. Fed back, each step adds to the mean with the weights of its time, so that this is exact
        where the weights stay the same, as those of the closed form do.
        """
        result = covariance_m2.copy()
        for i, reach_m in enumerate(self.reach_m):
            together = np.flatnonzero(np.isfinite(reach_m))
            if len(together) < 2:
                continue
            weights = _weights(weighting_m2[together])
            own = _propagated(weights, independent_m2[together]).sum(axis=0)
            common = _bound(_propagated(weights, covariance_m2[together] - independent_m2[together]))
            own_share = np.eye(2) - weights[int(np.searchsorted(together, i))]
            slack_m2 = _EDGE_TO_DISC * float(reach_m[together].max()) ** 2
            result[i] = own + common + slack_m2 * own_share @ own_share.T
        return result


def group_devices(present: NDArray[np.bool_], limits_m: Mapping[tuple[int, int], float]) -> DeviceGroup:
    """Collect the devices that take part and the tethers between them.

    Parameters
    ----------
    present
        True for the devices that take part, (n,).
    limits_m
        Largest distance of each tethered pair of devices, by their indices, m.

    Returns
    -------
    DeviceGroup
        The devices and their tethers.
    """
    rows = np.flatnonzero(present)
    place = {int(row): i for i, row in enumerate(rows)}
    kept = {(place[a], place[b]): limit for (a, b), limit in limits_m.items() if a in place and b in place}
    apart_m = np.full((len(rows), len(rows)), np.inf)
    for (a, b), limit in kept.items():
        apart_m[a, b] = limit
    reach_m = shortest_path(apart_m, directed=False) if kept else np.where(np.eye(len(rows)) > 0, 0.0, np.inf)
    return DeviceGroup(rows, tuple(kept), np.array(list(kept.values())), reach_m)


def _weights(covariances_m2: Array) -> Array:
    """Return the information-weighted share of each estimate in the mean, (k, 2, 2); shares sum to the identity."""
    if not covariances_m2.any():  # at a known start all covariances are zero
        return np.tile(np.eye(2) / len(covariances_m2), (len(covariances_m2), 1, 1))
    information = np.linalg.inv(with_least_variance(covariances_m2))
    weights: Array = np.linalg.solve(information.sum(axis=0)[None], information)
    return weights


def _propagated(weights: Array, covariances_m2: Array) -> Array:
    passed: Array = weights @ covariances_m2 @ np.swapaxes(weights, 1, 2)
    return passed


def _bound(covariances_m2: Array) -> Array:
    """Bound the covariance (2, 2) of a sum of errors with covariances (k, 2, 2) and unknown correlation."""
    sizes_m = np.sqrt(np.maximum(np.trace(covariances_m2, axis1=1, axis2=2), 0.0))
    shares = sizes_m / max(float(sizes_m.sum()), 1e-300)
    bound: Array = np.sum(covariances_m2 / np.where(shares > 0.0, shares, 1.0)[:, None, None], axis=0)
    return bound
