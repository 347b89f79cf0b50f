"""Rauch-Tung-Striebel smoother of the filter, for one device and for all devices jointly."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from pdr_est.estimators.common.motion_model import (
    JITTER_VARIANCE,
    SOURCE_STATES,
    STATES,
    GaussianState,
    linearise,
    linearise_each,
    move,
)
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.kalman.fix_sources import source_prior
from pdr_est.estimators.kalman.offline_filter import FilteredSegment, JointPosterior, filter_walk
from pdr_est.estimators.kalman.predict_and_update import rows_of
from pdr_est.estimators.reckoned_poses import reckon
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose


def smooth_segments(segments: Sequence[FilteredSegment]) -> list[GaussianState]:
    """Smooth the states at all nodes of one device.

    Before the heading became known, the states are dead-reckoned backwards from the node at which it did.
    """
    states: list[GaussianState] = []
    for segment in segments:
        k = segment.aligned_from
        if k is None:
            states += reckon(segment.nodes, *segment.open_anchor())
        else:
            tail = smooth(segment.nodes[k:], segment.states)
            states += reckon(segment.nodes[: k + 1], k, tail[0])[:-1] + tail
    return states


def smooth(nodes: tuple[Node, ...], filtered: tuple[GaussianState, ...]) -> list[GaussianState]:
    """Smooth filtered states of one device.

    Parameters
    ----------
    nodes
        Nodes (n); the motion to node k leads to the state k.
    filtered
        Filtered states (n) at these nodes.
    """
    if len(filtered) == 1:
        return list(filtered)
    complete = with_all_sources(filtered)
    mean = np.array([state.mean for state in complete])
    covariance = np.array([state.covariance for state in complete])
    moved, jacobian, noise = linearise_each(mean[:-1], nodes[1:])
    _let_errors_wander(complete, STATES, moved, jacobian, noise)
    predicted = jacobian @ covariance[:-1] @ jacobian.transpose(0, 2, 1) + noise
    regular = predicted + JITTER_VARIANCE * np.eye(mean.shape[1])
    gain = np.linalg.solve(regular, jacobian @ covariance[:-1]).transpose(0, 2, 1)
    for k in range(len(gain) - 1, -1, -1):
        mean[k] += gain[k] @ (mean[k + 1] - moved[k])
        covariance[k] += gain[k] @ (covariance[k + 1] - predicted[k]) @ gain[k].T
    covariance = 0.5 * (covariance + covariance.transpose(0, 2, 1))
    smoothed = zip(complete, mean, covariance, strict=True)
    return [replace(state, mean=own, covariance=spread) for state, own, spread in smoothed]


def with_all_sources(states: Sequence[GaussianState]) -> list[GaussianState]:
    """Return states that all have the sources of the last one, with the prior of their error before the first fix."""
    last = states[-1].sources
    padded = []
    for state in states:
        missing = [replace(source, jump_variance=0.0) for source in last[len(state.sources) :]]
        if missing:
            known, size = len(state.mean), len(state.mean) + SOURCE_STATES * len(missing)
            covariance = np.zeros((size, size))
            for i, source in enumerate(missing):
                own = slice(known + SOURCE_STATES * i, known + SOURCE_STATES * (i + 1))
                covariance[own, own] = source_prior(source)
            covariance[:known, :known] = state.covariance
            mean = np.concatenate([state.mean, np.zeros(SOURCE_STATES * len(missing))])
            state = GaussianState(mean, covariance, (*state.sources, *missing), state.trusts)
        padded.append(state)
    return padded


def _let_errors_wander(
    states: Sequence[GaussianState], first: int, moved: Array, jacobian: Array, noise: Array
) -> None:
    """Set the part of the wandering errors, from row `first` on, in the transitions between successive states."""
    for k, (before, after) in enumerate(pairwise(states)):
        for row, earlier, later in zip(
            range(first, moved.shape[1], SOURCE_STATES), before.sources, after.sources, strict=True
        ):
            decay, own = later.correlation_with(earlier), slice(row, row + 2)
            moved[k, own] *= decay
            jacobian[k, own, own] = decay * np.eye(2)
            usual = (1.0 - decay**2) * later.usual_variance
            noise[k, own, own] = (usual + later.jump_variance - earlier.jump_variance) * np.eye(2)


def smooth_walk(
    timelines: Sequence[Timeline],
    node_tethers: Sequence[NodeTether],
    starts: Sequence[StartPose],
    sigma_length_scale: float,
) -> list[list[GaussianState]]:
    """Smooth the states at all nodes of each device with the measurements of all devices.

    Where the heading of a device is unknown, only its own measurements count.

    Parameters
    ----------
    timelines
        Measurements of each device.
    node_tethers
        Tethers in order of time.
    starts
        Start pose of each device.
    sigma_length_scale
        Standard deviation of the walker's length scale around 1.
    """
    walk = filter_walk(timelines, node_tethers, starts, sigma_length_scale)
    # Where the heading of a device is known throughout, all of its states are replaced below.
    states = [
        smooth_segments(own) if len(own) > 1 or own[0].aligned_from != 0 else list(own[0].states)
        for own in walk.segments
    ]
    if not walk.posteriors:
        return states
    smoothed = walk.posteriors[-1]
    for before, posterior in zip([None, *walk.posteriors[:-1]][::-1], walk.posteriors[::-1], strict=True):
        device, node = posterior.touched[0]
        states[device][node] = smoothed.state_of(device)
        if before is not None:
            smoothed = _smoothed(before, posterior, timelines, smoothed)
    return states


def _smoothed(
    before: JointPosterior, after: JointPosterior, timelines: Sequence[Timeline], smoothed: JointPosterior
) -> JointPosterior:
    """Smooth the joint state at a node, given the smoothed joint state at the next one."""
    device, node = after.touched[0]
    own = rows_of(device)
    earlier, later = with_all_sources([before.joint, smoothed.joint])
    size = len(earlier.mean)
    jacobian, noise, moved = np.eye(size), np.zeros((size, size)), earlier.mean.copy()
    _let_errors_wander((earlier, later), STATES * before.devices, moved[None], jacobian[None], noise[None])
    if after.entered is None:
        step = timelines[device].nodes[node]
        jacobian[own, own], noise[own, own] = linearise(earlier.mean[own], step)
        moved[own] = move(earlier.mean[own], step)
    else:
        entered = after.entered
        jacobian[own, own] = 0.0
        noise[own, own], moved[own] = entered.covariance[:STATES, :STATES], entered.mean[:STATES]
    predicted = jacobian @ earlier.covariance @ jacobian.T + noise
    regular = predicted + JITTER_VARIANCE * np.eye(size)
    gain = np.linalg.solve(regular, jacobian @ earlier.covariance).T
    covariance = earlier.covariance + gain @ (later.covariance - predicted) @ gain.T
    mean = earlier.mean + gain @ (later.mean - moved)
    joint = GaussianState(mean, 0.5 * (covariance + covariance.T), earlier.sources, earlier.trusts)
    return replace(before, joint=joint)
