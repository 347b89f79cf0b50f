"""Rts smoother."""

from collections.abc import Sequence

import numpy as np

from pdr_est.estimators.common.motion_model import STATES, GaussianState, linearise, linearise_each, move, reckon
from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Node, Timeline
from pdr_est.estimators.kalman.multi_device import JointPosterior, _of_device, follow
from pdr_est.estimators.kalman.single_device import JITTER_VARIANCE, FilteredSegment, run_filter, undecided_anchor
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose


def alone_smoothed(stretches: Sequence[FilteredSegment]) -> list[GaussianState]:
    """States at all nodes of one device: the smoothed filter, and before the direction was known back from there."""
    states: list[GaussianState] = []
    for stretch in stretches:
        k = stretch.aligned_from
        if k is None:
            states += reckon(stretch.nodes, *undecided_anchor(stretch))
        else:
            tail = smooth(stretch.nodes[k:], stretch.moments)
            states += reckon(stretch.nodes[: k + 1], k, tail[0])[:-1] + tail
    return states


def smooth(nodes: tuple[Node, ...], filtered: tuple[GaussianState, ...]) -> list[GaussianState]:
    """Rauch-Tung-Striebel smoother over filtered states; nodes[k] leads to filtered[k]."""
    if len(filtered) == 1:
        return list(filtered)
    mean = np.array([state.mean for state in filtered])
    covariance = np.array([state.covariance for state in filtered])
    moved, jacobian, noise = linearise_each(mean[:-1], nodes[1:])
    predicted = jacobian @ covariance[:-1] @ jacobian.transpose(0, 2, 1) + noise
    gain = np.linalg.solve(predicted + JITTER_VARIANCE * np.eye(STATES), jacobian @ covariance[:-1]).transpose(
        0, 2, 1
    )
    for k in range(len(gain) - 1, -1, -1):
        mean[k] += gain[k] @ (mean[k + 1] - moved[k])
        covariance[k] += gain[k] @ (covariance[k + 1] - predicted[k]) @ gain[k].T
    covariance = 0.5 * (covariance + covariance.transpose(0, 2, 1))
    return [GaussianState(*moments) for moments in zip(mean, covariance, strict=True)]


def smoothed_states(
    timelines: Sequence[Timeline],
    node_tethers: Sequence[NodeTether],
    starts: Sequence[StartPose],
    sigma_length_scale: float,
) -> list[list[GaussianState]]:
    """States at all nodes of each device by what all of them tell before and after; where the direction of a device
    is open, by what it tells itself."""
    alone = [run_filter(timeline, one, sigma_length_scale) for timeline, one in zip(timelines, starts, strict=True)]
    # Where the direction of a device is known throughout, all of its states are replaced below.
    states = [
        alone_smoothed(own) if len(own) > 1 or own[0].aligned_from != 0 else list(own[0].moments) for own in alone
    ]
    moments = list(follow(timelines, alone, node_tethers))
    if not moments:
        return states
    mean, covariance = moments[-1].mean, moments[-1].covariance
    for k in range(len(moments) - 1, -1, -1):
        for device, node in moments[k].touched[:1]:
            states[device][node] = _of_device(mean, covariance, device)
        if k:
            mean, covariance = _back(moments[k - 1], moments[k], timelines, mean, covariance)
    return states


def _back(
    before: JointPosterior, after: JointPosterior, timelines: Sequence[Timeline], mean: Array, covariance: Array
) -> tuple[Array, Array]:
    """Smoothed mean and covariance at `before` from those at `after`."""
    device, node = after.touched[0]
    own = slice(STATES * device, STATES * (device + 1))
    jacobian, noise, moved = np.eye(len(mean)), np.zeros_like(covariance), before.mean.copy()
    if after.entered is None:
        step = timelines[device].nodes[node]
        jacobian[own, own], noise[own, own] = linearise(before.mean[own], step)
        moved[own] = move(before.mean[own], step)
    else:
        jacobian[own, own], noise[own, own], moved[own] = 0.0, after.entered.covariance, after.entered.mean
    predicted = jacobian @ before.covariance @ jacobian.T + noise
    gain = np.linalg.solve(predicted + JITTER_VARIANCE * np.eye(len(mean)), jacobian @ before.covariance).T
    smoothed = before.covariance + gain @ (covariance - predicted) @ gain.T
    return before.mean + gain @ (mean - moved), 0.5 * (smoothed + smoothed.T)
