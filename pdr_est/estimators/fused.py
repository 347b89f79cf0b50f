"""The track of the person from those of the devices on the body.

Errors of devices on one body depend on each other in a way that their marginals do not tell: their tethers and the
fixes are common. The tracks are therefore joined by covariance intersection (Julier and Uhlmann 1997) with equal
weights, which is honest for any dependence: the information is the mean of theirs, so that a bad device has little
say, and nothing is counted twice. A step of the person is one that devices agree on, or that one of them saw where
the rhythm of the others leaves room for it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.person_heading import heading_of_person
from pdr_est.estimators.person_steps import SAME_STEP_S, present_at, steps_of_person
from pdr_est.frames import Array, wrap_angle
from pdr_est.track import Track

NAME = "fused"
_LEAST_VARIANCE = 1e-8  # keeps what is known exactly invertible


def fuse(track: Track) -> Track:
    """The track of the person, with device `NAME`, from the track of several devices; one row a step."""
    tracks = [track.of_device(device) for device in track.devices]
    begin_s = min(float(one.time_s[0]) for one in tracks)
    steps = steps_of_person(tracks)
    time_s = np.concatenate([[begin_s], steps.time_s])
    present = present_at(tracks, time_s, SAME_STEP_S)
    at_times = [one.at(time_s) for one in tracks]
    position, covariance = _intersect(
        np.stack([place for place, _ in at_times]), np.stack([spread for _, spread in at_times]), present
    )
    heading, variance = heading_of_person(tracks, time_s, present)
    surest = min(tracks, key=lambda one: float(np.mean(one.sigma_heading_rad)))
    rows = np.minimum(np.searchsorted(surest.time_s, time_s - 1e-9), len(surest) - 1)
    lengths = [np.interp(time_s, one.time_s, one.step_length_m) for one in tracks]
    return Track(
        time_s=time_s,
        moving_from_s=np.concatenate([[begin_s], steps.moving_from_s]),
        device=np.array([NAME] * len(time_s)),
        position_m=position,
        heading_rad=np.asarray(wrap_angle(heading)),
        covariance_m2=covariance,
        sigma_heading_rad=np.sqrt(variance),
        mode=surest.mode[rows],
        step_length_m=np.mean(lengths, axis=0),
        kind=track.kind,
        estimator=track.estimator,
        length_scale=track.length_scale,
        sigma_length_scale=track.sigma_length_scale,
    )


def carried(track: Track, offset_m: tuple[float, float]) -> Track:
    """The track of a device that sits offset_m, forward and left, from the centre of the body whose track it is."""
    if offset_m == (0.0, 0.0):
        return track
    ahead, aside = offset_m
    c, s = np.cos(track.heading_rad), np.sin(track.heading_rad)
    moved = np.stack([c * ahead - s * aside, s * ahead + c * aside], axis=1)
    return replace(track, position_m=track.position_m + moved)


def _intersect(mean: Array, covariance: Array, present: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Covariance intersection with equal weights of the estimates (d, n, k) with covariances (d, n, k, k) that are
    present (d, n)."""
    weights = present / present.sum(axis=0)
    information = weights[..., None, None] * np.linalg.inv(covariance + _LEAST_VARIANCE * np.eye(mean.shape[-1]))
    joined = np.linalg.inv(information.sum(axis=0))
    weighted = np.einsum("dnij,dnj->ni", information, mean)
    return np.einsum("nij,nj->ni", joined, weighted), joined
