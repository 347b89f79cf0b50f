"""Robust DR's fusion of devices on one body, step by step: `map-closed-form` and `map-general`.

Y. Jin et al., A Robust Dead-Reckoning Pedestrian Tracking System with Low Cost Sensors, section IV. Each device
dead-reckons by itself (eqs. 1, 2); whenever two are farther apart than a body allows, all move to the most probable
positions within that distance. Headings and step lengths stay each device's own, and so does what a fix tells:
fixes find an unknown start, as in dead reckoning, and are ignored after that.

Where this differs from the paper:

* The paper's k-th steps of both devices happen at once. Here devices step each at its own times, and miss steps.
  At the end of a step of any device the others stand where they are by then on the straight line of the step they
  are about to make. That step's end must therefore be known: the positions come late by at most one step.
* A device that takes no step for `silent_s` after its last one is out, not a weight on the others' legs.
* More than two devices: all tethers hold at once (`map_constrained.general_many`), with equal covariances in
  `map-closed-form`, for eq. 21 is all that the closed form assumes.
* Covariances are reported (`_Group.covariance`); the paper has none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import shortest_path

from pdr_est.errors import EstimationError
from pdr_est.estimators import dead_reckoning
from pdr_est.estimators.common.initial_state import start_prior
from pdr_est.estimators.common.motion_model import STATES, GaussianState, reckon
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.robust_dr.constrained_map import closed_form, general_many, with_width
from pdr_est.frames import Array
from pdr_est.params import Positive, params
from pdr_est.types.measurements import DeviceTether, StartPose
from pdr_est.types.track import Track, concatenate

CLOSED_FORM, GENERAL = "map-closed-form", "map-general"

# Of D^2: the mean square per axis between a point on the rim of a disc of radius D and one anywhere in it.
_RIM = 0.75


@params
class MapFusionParams:
    """Fusion of several devices by Robust DR."""

    feedback: bool = False
    """True if dead reckoning goes on from the fused positions. False leaves each device its own reckoning, on which
    the fusion leaves no trace, as the paper's "estimates reported by the two sets of sensors independently" reads."""

    silent_s: Positive = 2.0
    """Time after its last step, s, from which a device takes no part in the fusion (ours)."""


def estimate_closed_form(
    timelines: Sequence[Timeline],
    tethers: Sequence[DeviceTether],
    start: StartPose,
    sigma_length_scale: float,
    parameters: MapFusionParams,
) -> Track:
    """Tracks of all devices, fused as if their errors had equal sizes in all directions: eqs. 21-28.

    tethers: the largest of a pair's distances counts, for the whole walk. Raises EstimationError for no or
    repeated devices and for a tether to a device that is not there.
    """
    return _estimate(timelines, tethers, start, sigma_length_scale, parameters, CLOSED_FORM)


def estimate_general(
    timelines: Sequence[Timeline],
    tethers: Sequence[DeviceTether],
    start: StartPose,
    sigma_length_scale: float,
    parameters: MapFusionParams,
) -> Track:
    """Tracks of all devices, fused by the covariances of their own dead reckoning: eqs. 8-20.

    These are also the weights of positions that were fed back. Arguments and errors as `estimate_closed_form`.
    """
    return _estimate(timelines, tethers, start, sigma_length_scale, parameters, GENERAL)


@dataclass(frozen=True)
class _Reckoned:
    """Devices' own dead reckoning at the times (t,) at which any of them ends a step.

    position_m: (t, n, 2); covariance_m2, independent_m2: (t, n, 2, 2), the latter the part of it that no other
    device shares; present: (t, n).
    """

    time_s: Array
    position_m: Array
    covariance_m2: Array
    independent_m2: Array
    present: NDArray[np.bool_]


@dataclass(frozen=True)
class _Group:
    """Devices that take part at some time. rows: (k,) theirs; pairs: of positions in rows; max_distance_m: (pairs,);
    reach_m: (k, k) how far apart two may be, over any chain of tethers, infinite without one."""

    rows: NDArray[np.int64]
    pairs: tuple[tuple[int, int], ...]
    max_distance_m: Array
    reach_m: Array

    def covariance(self, weighing_m2: Array, covariance_m2: Array, independent_m2: Array) -> Array:
        """Of the fused positions, (k, 2, 2), from those of the dead reckoning, and those that weigh it.

        While a tether is taut its devices share one position, up to its length: the mean of the estimates e_j with
        weights M_j by their covariances. Device i is then off by the sum of M_j times the errors of e_j, and by
        (I - M_i) times the error of the separation, which is that of a point on the rim for one within the disc.
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
            weights = _weights(weighing_m2[together])
            own = _through(weights, independent_m2[together]).sum(axis=0)
            common = _bound(_through(weights, covariance_m2[together] - independent_m2[together]))
            yields = np.eye(2) - weights[int(np.searchsorted(together, i))]
            slack_m2 = _RIM * float(reach_m[together].max()) ** 2
            result[i] = own + common + slack_m2 * yields @ yields.T
        return result


def _estimate(
    timelines: Sequence[Timeline],
    tethers: Sequence[DeviceTether],
    start: StartPose,
    sigma_length_scale: float,
    parameters: MapFusionParams,
    name: str,
) -> Track:
    limits_m = _limits([timeline.device for timeline in timelines], tethers)
    tracks = [dead_reckoning.estimate(timeline, start, sigma_length_scale) for timeline in timelines]
    alone = [_independent(timeline, start, track) for timeline, track in zip(timelines, tracks, strict=True)]
    reckoned = _at_all_steps(tracks, alone, parameters.silent_s)
    position_m, covariance_m2 = _fused(reckoned, limits_m, parameters.feedback, name == GENERAL)
    fused = []
    for number, track in enumerate(tracks):
        rows = np.searchsorted(reckoned.time_s, track.time_s)
        fused.append(
            replace(
                track,
                position_m=position_m[rows, number],
                covariance_m2=covariance_m2[rows, number],
                estimator=name,
            )
        )
    return concatenate(fused)


def _limits(devices: Sequence[str], tethers: Sequence[DeviceTether]) -> dict[tuple[int, int], float]:
    """Largest distance of each pair of devices, by their numbers."""
    if not devices or len(set(devices)) < len(devices):
        raise EstimationError(f"devices {list(devices)} to fuse: at least one, each with a name of its own")
    limits: dict[tuple[int, int], float] = {}
    for tether in tethers:
        ends = (tether.device_a, tether.device_b)
        unknown = [end for end in ends if end not in devices]
        if unknown or ends[0] == ends[1]:
            raise EstimationError(f"tether between {ends[0]!r} and {ends[1]!r}: name two of {list(devices)}")
        a, b = sorted(devices.index(end) for end in ends)
        limits[a, b] = max(limits.get((a, b), 0.0), tether.max_distance_m)
    return limits


def _independent(timeline: Timeline, start: StartPose, track: Track) -> Track:
    """The track with the part of its covariance that comes from this device's own steps.

    Where measurements found the start nothing is known to be independent: other devices used the same ones.
    """
    prior = start_prior(timeline, start, 0.0)
    covariance = np.zeros_like(track.covariance_m2)
    if not (prior.position_open or prior.heading_open):
        states = reckon(timeline.nodes, 0, GaussianState(prior.state.mean, np.zeros((STATES, STATES))))
        steps = (state for state, node in zip(states, timeline.nodes, strict=True) if node.is_step)
        covariance = np.array([state.covariance[:2, :2] for state in steps])
    return replace(track, covariance_m2=covariance)


def _at_all_steps(tracks: Sequence[Track], alone: Sequence[Track], silent_s: float) -> _Reckoned:
    time_s = np.unique(np.concatenate([track.time_s for track in tracks]))
    places = [track.at(time_s) for track in tracks]
    present = [(time_s >= track.time_s[0]) & (time_s <= track.time_s[-1] + silent_s) for track in tracks]
    return _Reckoned(
        time_s,
        np.stack([position for position, _ in places], axis=1),
        np.stack([covariance for _, covariance in places], axis=1),
        np.stack([track.at(time_s)[1] for track in alone], axis=1),
        np.stack(present, axis=1),
    )


def _fused(
    reckoned: _Reckoned, limits_m: Mapping[tuple[int, int], float], feedback: bool, by_covariance: bool
) -> tuple[Array, Array]:
    """Positions (t, n, 2) and covariances (t, n, 2, 2)."""
    position_m, covariance_m2 = reckoned.position_m.copy(), reckoned.covariance_m2.copy()
    patterns, pattern_of = np.unique(reckoned.present, axis=0, return_inverse=True)
    groups = [_group(pattern, limits_m) for pattern in patterns]
    fed_back_m = np.zeros(position_m.shape[1:])
    for k, pattern in enumerate(pattern_of.ravel()):
        group = groups[pattern]
        rows, own = group.rows, reckoned.covariance_m2[k, group.rows]
        weighing = own if by_covariance else np.tile(np.eye(2), (len(rows), 1, 1))
        before = reckoned.position_m[k] + fed_back_m
        position_m[k] = before
        position_m[k, rows] = _fuse(before[rows], weighing, group, by_covariance)
        covariance_m2[k, rows] = group.covariance(weighing, own, reckoned.independent_m2[k, rows])
        if feedback:
            # Eq. 1 adds displacements, so going on from a fused position is dead reckoning plus what it was moved.
            fed_back_m = fed_back_m + position_m[k] - before
    return position_m, covariance_m2


def _fuse(estimates_m: Array, weighing_m2: Array, group: _Group, by_covariance: bool) -> Array:
    if len(estimates_m) == 2 and group.pairs and not by_covariance:
        return closed_form(estimates_m, float(group.max_distance_m[0]))
    return general_many(estimates_m, weighing_m2, group.pairs, group.max_distance_m)


def _group(present: NDArray[np.bool_], limits_m: Mapping[tuple[int, int], float]) -> _Group:
    rows = np.flatnonzero(present)
    place = {int(row): i for i, row in enumerate(rows)}
    kept = {(place[a], place[b]): limit for (a, b), limit in limits_m.items() if a in place and b in place}
    apart_m = np.full((len(rows), len(rows)), np.inf)
    for (a, b), limit in kept.items():
        apart_m[a, b] = limit
    reach_m = shortest_path(apart_m, directed=False) if kept else np.where(np.eye(len(rows)) > 0, 0.0, np.inf)
    return _Group(rows, tuple(kept), np.array(list(kept.values())), reach_m)


def _weights(covariances_m2: Array) -> Array:
    """Matrices (k, 2, 2) that sum to the identity: each estimate's share in the mean by information."""
    if not covariances_m2.any():  # at the start everything is known, of all devices alike
        return np.tile(np.eye(2) / len(covariances_m2), (len(covariances_m2), 1, 1))
    information = np.linalg.inv(with_width(covariances_m2))
    weights: Array = np.linalg.solve(information.sum(axis=0)[None], information)
    return weights


def _through(weights: Array, covariances_m2: Array) -> Array:
    passed: Array = weights @ covariances_m2 @ np.swapaxes(weights, 1, 2)
    return passed


def _bound(covariances_m2: Array) -> Array:
    """Of a sum of errors with these covariances (k, 2, 2), however they depend on each other (2, 2)."""
    sizes_m = np.sqrt(np.maximum(np.trace(covariances_m2, axis1=1, axis2=2), 0.0))
    shares = sizes_m / max(float(sizes_m.sum()), 1e-300)
    bound: Array = np.sum(covariances_m2 / np.where(shares > 0.0, shares, 1.0)[:, None, None], axis=0)
    return bound
