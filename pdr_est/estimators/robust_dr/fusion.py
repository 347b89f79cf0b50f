"""Robust DR fusion of devices on one body, step by step: `map-closed-form` and `map-general`.

Each device dead-reckons by itself (eqs. 1, 2); whenever two are farther apart than a body allows, all move to the
most probable positions within that distance. Headings and step lengths of a device are not changed. Fixes serve to
find an unknown start, as in dead reckoning, and are ignored after that.

Differences from the paper:

* In the paper the k-th steps of both devices end at the same time. Here each device has its own step times and may
  miss steps. At the end of a step of any device, the positions of the others are interpolated on the straight line
  of the step they are making. The end of that step must be known: positions are delayed by at most one step.
* A device that takes no step for `silent_s` after its last one takes no part any more, so that it does
  not hold the others back.
* More than two devices: all tethers hold at once (`constrained_map.general_many`), with equal covariances in
  `map-closed-form`, because eq. 21 is all that the closed form assumes.
* Covariances are reported (`DeviceGroup.covariance`); the paper has none.

References
----------
Y. Jin et al., A Robust Dead-Reckoning Pedestrian Tracking System with Low Cost Sensors, section IV.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import EstimationError
from pdr_est.estimators import dead_reckoning
from pdr_est.estimators.common.initial_state import start_prior
from pdr_est.estimators.common.motion_model import STATES, GaussianState
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.reckoned_poses import reckon
from pdr_est.estimators.robust_dr.constrained_map import closed_form, general_many
from pdr_est.estimators.robust_dr.device_group import DeviceGroup, group_devices
from pdr_est.estimators.robust_dr.params import MapFusionParams
from pdr_est.frames import Array
from pdr_est.types.measurements import DeviceTether, StartPose
from pdr_est.types.track import Track, concatenate

CLOSED_FORM, GENERAL = "map-closed-form", "map-general"


def estimate_closed_form(
    timelines: Sequence[Timeline],
    tethers: Sequence[DeviceTether],
    start: StartPose,
    sigma_length_scale: float,
    parameters: MapFusionParams,
) -> Track:
    """Estimate the tracks of all devices, fused as if their errors had equal sizes in all directions.

    Parameters
    ----------
    timelines
        Nodes of each device.
    tethers
        Largest distances between pairs of devices; the largest one of a pair holds for the whole walk.
    start
        Start pose; unknown parts are found from fixes and heading priors.
    sigma_length_scale
        Standard deviation of the walker's length scale.
    parameters
        Settings of the fusion.

    Returns
    -------
    Track
        Filtered poses of all devices.

    Raises
    ------
    EstimationError
        If there is no device, a name is used twice, or a tether names a device that is not there.

    References
    ----------
    Jin et al., eqs. 21-28.
    """
    return _estimate(timelines, tethers, start, sigma_length_scale, parameters, CLOSED_FORM)


def estimate_general(
    timelines: Sequence[Timeline],
    tethers: Sequence[DeviceTether],
    start: StartPose,
    sigma_length_scale: float,
    parameters: MapFusionParams,
) -> Track:
    """Estimate the tracks of all devices, fused with the covariances of their own dead reckoning.

    These covariances also weight positions that were fed back. Parameters, result and errors are those of
    `estimate_closed_form`.

    References
    ----------
    Jin et al., eqs. 8-20.
    """
    return _estimate(timelines, tethers, start, sigma_length_scale, parameters, GENERAL)


@dataclass(frozen=True)
class _Reckoned:
    """Dead reckoning of each device by itself, at the times at which any of them ends a step.

    Attributes
    ----------
    time_s : Array
        Ends of steps of any device, (t,), s.
    position_m : Array
        Positions of the n devices, (t, n, 2), m.
    covariance_m2 : Array
        Their covariances, (t, n, 2, 2), m^2.
    independent_m2 : Array
        The part of the covariances that no other device shares, (t, n, 2, 2), m^2.
    present : NDArray[np.bool_]
        True where a device takes part, (t, n).
    """

    time_s: Array
    position_m: Array
    covariance_m2: Array
    independent_m2: Array
    present: NDArray[np.bool_]


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
    """Return the largest distance of each tethered pair, by indices of the devices."""
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
    """Return the track with only the part of its covariance that comes from this device's own steps.

    If measurements had to find the start, no part is known to be independent: other devices used the same ones.
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
    """Fuse all times in order; return positions (t, n, 2) and covariances (t, n, 2, 2)."""
    position_m, covariance_m2 = reckoned.position_m.copy(), reckoned.covariance_m2.copy()
    patterns, pattern_of = np.unique(reckoned.present, axis=0, return_inverse=True)
    groups = [group_devices(pattern, limits_m) for pattern in patterns]
    fed_back_m = np.zeros(position_m.shape[1:])
    for k, pattern in enumerate(pattern_of.ravel()):
        group = groups[pattern]
        rows, own = group.rows, reckoned.covariance_m2[k, group.rows]
        weighting = own if by_covariance else np.tile(np.eye(2), (len(rows), 1, 1))
        before = reckoned.position_m[k] + fed_back_m
        position_m[k] = before
        position_m[k, rows] = _fuse(before[rows], weighting, group, by_covariance)
        covariance_m2[k, rows] = group.covariance(weighting, own, reckoned.independent_m2[k, rows])
        if feedback:
            # Eq. 1 adds displacements: to continue from a fused position is to add the displacement of the fusion.
            fed_back_m = fed_back_m + position_m[k] - before
    return position_m, covariance_m2


def _fuse(estimates_m: Array, weighting_m2: Array, group: DeviceGroup, by_covariance: bool) -> Array:
    if len(estimates_m) == 2 and group.pairs and not by_covariance:
        return closed_form(estimates_m, float(group.max_distance_m[0]))
    return general_many(estimates_m, weighting_m2, group.pairs, group.max_distance_m)
