"""Fuse the tracks of the devices on a body into the track of the person.

Errors of devices on one body are correlated, because tethers and fixes are common, and their marginal covariances do
not show by how much. The tracks are therefore fused by covariance intersection (Julier and Uhlmann 1997) with equal
weights, which is consistent for any correlation: the information is the mean of the devices' information, so that an
uncertain device has little weight and nothing is counted twice. `person.steps` selects the steps and `person.heading`
fuses the headings. Both look a few steps ahead, so that the last rows of an unfinished walk may still change; heading
weights depend on the whole given track.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.timeline import SAME_S
from pdr_est.estimators.person.heading import LEAST_VARIANCE, heading_of_person, intersected_headings
from pdr_est.estimators.person.steps import SAME_STEP_S, present_at, steps_of_person
from pdr_est.frames import Array, rotate_vectors, wrap_angle
from pdr_est.types.region import PoseRegion, joined_regions
from pdr_est.types.track import Track

NAME = "fused"


def fuse(track: Track) -> Track:
    """Fuse the tracks of several devices into the track of the person.

    Parameters
    ----------
    track
        Track of all devices, whose order makes no difference. Each takes part from its first to its last pose only.

    Returns
    -------
    Track
        Track of the device `NAME`: a row for the start, then one for each step.
    """
    tracks = [track.of_device(device) for device in sorted(track.devices)]
    begin_s = min(float(one.time_s[0]) for one in tracks)
    steps = steps_of_person(tracks)
    time_s = np.concatenate([[begin_s], steps.time_s])
    present = present_at(tracks, time_s, SAME_STEP_S)
    at_times = [one.at(time_s) for one in tracks]
    position, covariance = _intersect(
        np.stack([place for place, _ in at_times]), np.stack([spread for _, spread in at_times]), present
    )
    heading, variance = heading_of_person(tracks, time_s, present)
    lengths = np.stack([np.interp(time_s, one.time_s, one.step_length_m) for one in tracks])
    return Track(
        time_s=time_s,
        moving_from_s=np.concatenate([[begin_s], steps.moving_from_s]),
        device=np.array([NAME] * len(time_s)),
        position_m=position,
        heading_rad=np.asarray(wrap_angle(heading)),
        covariance_m2=covariance,
        sigma_heading_rad=np.sqrt(variance),
        mode=_modes(tracks, time_s, present),
        step_length_m=np.sum(lengths * present, axis=0) / present.sum(axis=0),
        kind=track.kind,
        estimator=track.estimator,
        length_scale=track.length_scale,
        sigma_length_scale=track.sigma_length_scale,
        on_plan=track.on_plan,
        region=_region(tracks, time_s, present, position, covariance),
    )


def fuse_at_one_time(poses: Array, covariances: Array) -> tuple[Array, Array, float, float]:
    """Fuse the poses of several devices at one time as `fuse` does tracks of one pose each, at a tenth of the cost.

    Parameters
    ----------
    poses
        East m, north m and heading rad of each device, (d, 3).
    covariances
        Their covariances, (d, 3, 3).

    Returns
    -------
    position_m : Array
        (2,).
    covariance_m2 : Array
        (2, 2).
    heading_rad : float
        In [-pi, pi).
    sigma_heading_rad : float
        Its standard deviation.
    """
    present = np.ones((len(poses), 1), dtype=np.bool_)
    position, covariance = _intersect(poses[:, None, :2], covariances[:, None, :2, :2], present)
    variances = np.square(np.sqrt(covariances[:, 2, 2, None]))  # by the standard deviations, as those of a track
    heading, variance = intersected_headings(poses[:, 2, None], variances, present)
    return position[0], covariance[0], float(wrap_angle(heading)[0]), float(np.sqrt(variance[0]))


def at_lever_arm(track: Track, offset_m: tuple[float, float]) -> Track:
    """Move the track of the body centre to the place of a device on the body.

    Parameters
    ----------
    track
        Track of the body centre.
    offset_m
        Position of the device relative to the body centre, forward and left, m.

    Returns
    -------
    Track
        Track of the device.
    """
    if offset_m == (0.0, 0.0):
        return track
    return track.moved(rotate_vectors(np.array(offset_m), track.heading_rad))


def _intersect(mean: Array, covariance: Array, present: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Fuse present (d, n) estimates (d, n, k) with covariances (d, n, k, k) by covariance intersection."""
    weights = present / present.sum(axis=0)
    information = weights[..., None, None] * np.linalg.inv(covariance + LEAST_VARIANCE * np.eye(mean.shape[-1]))
    joined = np.linalg.inv(information.sum(axis=0))
    weighted = np.einsum("dnij,dnj->ni", information, mean)
    return np.einsum("nij,nj->ni", joined, weighted), joined


def _region(
    tracks: Sequence[Track], time_s: Array, present: NDArray[np.bool_], position_m: Array, covariance_m2: Array
) -> PoseRegion | None:
    """Return the region of the person: that of the present device (d, n) which is known best there.

    Regions of several devices cannot be intersected, because nothing tells how far their errors depend on each other.
    Where one normal distribution is enough, it has the position (n, 2) and covariance (n, 2, 2) of the person.
    """
    found, areas = [], []
    for one in tracks:
        if one.region is None:
            return None
        row = np.clip(np.searchsorted(one.time_s, time_s - SAME_S), 0, len(one) - 1)
        found.append(one.region.rows(row).shifted(one.at(time_s)[0] - one.position_m[row]))
        areas.append(np.linalg.det(one.covariance_m2[row]))
    whose = np.argmin(np.where(present, areas, np.inf), axis=0)
    best = joined_regions(found).rows(whose * len(time_s) + np.arange(len(time_s)))
    return best.with_gaussians(position_m, covariance_m2)


def _modes(tracks: Sequence[Track], time_s: Array, present: NDArray[np.bool_]) -> NDArray[np.int8]:
    """Return the carrying mode (n,) of the present device (d, n) with the smallest heading uncertainty."""
    sigma = np.array([float(np.mean(one.sigma_heading_rad)) for one in tracks])
    whose = np.argmin(np.where(present, sigma[:, None], np.inf), axis=0)
    rows = [np.minimum(np.searchsorted(one.time_s, time_s - SAME_S), len(one) - 1) for one in tracks]
    modes = np.stack([one.mode[row] for one, row in zip(tracks, rows, strict=True)])
    return np.asarray(modes[whose, np.arange(len(time_s))])
