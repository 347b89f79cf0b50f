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

from pdr_est.frames import Array, wrap_angle
from pdr_est.track import Track

NAME = "fused"
_SAME_STEP_S = 0.35  # furthest apart that two devices see one step
_ROOM = 0.9  # of the usual time between steps, that must be free about a step that one device alone saw
_LEAST_VARIANCE = 1e-8  # keeps what is known exactly invertible


def fuse(track: Track) -> Track:
    """The track of the person, with device `NAME`, from the track of several devices; one row a step."""
    tracks = [track.of_device(device) for device in track.devices]
    begin_s = min(float(one.time_s[0]) for one in tracks)
    step_s, from_s = _steps_of_person(tracks)
    time_s = np.concatenate([[begin_s], step_s])
    at_times = [one.at(time_s) for one in tracks]
    position, covariance = _intersect(
        np.stack([place for place, _ in at_times]), np.stack([spread for _, spread in at_times])
    )
    heading, variance = _headings(tracks, time_s)
    surest = min(tracks, key=lambda one: float(np.mean(one.sigma_heading_rad)))
    rows = np.minimum(np.searchsorted(surest.time_s, time_s - 1e-9), len(surest) - 1)
    lengths = [np.interp(time_s, one.time_s, one.step_length_m) for one in tracks]
    return Track(
        time_s=time_s,
        moving_from_s=np.concatenate([[begin_s], from_s]),
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


def _intersect(mean: Array, covariance: Array) -> tuple[Array, Array]:
    """Covariance intersection with equal weights of estimates (d, n, k) with covariances (d, n, k, k)."""
    information = np.linalg.inv(covariance + _LEAST_VARIANCE * np.eye(mean.shape[-1]))
    joined = np.linalg.inv(information.mean(axis=0))
    weighted = np.einsum("dnij,dnj->ni", information, mean) / len(mean)
    return np.einsum("nij,nj->ni", joined, weighted), joined


def _headings(tracks: Sequence[Track], time_s: Array) -> tuple[Array, Array]:
    """Heading and variance (n,) of the person: those of the devices likewise, each unwrapped beside the first."""
    headings: list[Array] = []
    variances: list[Array] = []
    for one in tracks:
        own = np.interp(time_s, one.time_s, np.unwrap(one.heading_rad))
        beside = own if not headings else headings[0] + wrap_angle(own - headings[0])
        headings.append(np.asarray(beside))
        variances.append(np.interp(time_s, one.time_s, one.sigma_heading_rad) ** 2)
    mean, variance = _intersect(np.stack(headings)[..., None], np.stack(variances)[..., None, None])
    return mean[:, 0], variance[:, 0, 0]


def _steps_of_person(tracks: Sequence[Track]) -> tuple[Array, Array]:
    """Times (n,) of the person's steps, and when the movement to each began (n,)."""
    seen = sorted(
        (float(time), number, float(begin))
        for number, one in enumerate(tracks)
        for time, begin in zip(one.time_s[1:], one.moving_from_s[1:], strict=True)
    )
    groups: list[list[tuple[float, int, float]]] = []
    for event in seen:
        same = groups and event[0] - groups[-1][0][0] <= _SAME_STEP_S
        if same and all(event[1] != other[1] for other in groups[-1]):
            groups[-1].append(event)
        else:
            groups.append([event])
    times = np.array([np.mean([time for time, _, _ in group]) for group in groups])
    begins = np.array([np.mean([begin for _, _, begin in group]) for group in groups])
    agreed = np.array([len(group) > 1 for group in groups], dtype=np.bool_)
    if not agreed.any():
        return times, begins
    usual_s = float(np.median(np.diff(times[agreed]))) if agreed.sum() > 1 else _SAME_STEP_S
    agreed_s = np.append(times[agreed], np.inf)
    next_agreed_s = agreed_s[np.cumsum(agreed)]  # behind each group
    kept: list[int] = []
    for i, next_agreed in enumerate(next_agreed_s):
        free_before = not kept or times[i] - times[kept[-1]] >= _ROOM * usual_s
        if agreed[i] or (free_before and next_agreed - times[i] >= _ROOM * usual_s):
            kept.append(i)
    return times[kept], begins[kept]
