"""Initial headings of the chain: those of the Kalman smoother, by scalars where nothing is open."""

from collections.abc import Sequence
from math import pi, sqrt

import numpy as np

from pdr_est.estimators.common.huber import HUBER
from pdr_est.estimators.common.initial_state import VAGUE_SIGMA_RAD, start_prior
from pdr_est.estimators.common.motion_model import JITTER_VARIANCE
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.factor_graph.initial_values import initial_states
from pdr_est.estimators.heading_chain.chain import HeadingChain, NodePriors
from pdr_est.estimators.kalman.device_filter_step import loses_heading
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose


def initial_headings(timeline: Timeline, start: StartPose) -> tuple[Array, float]:
    """Return initial headings (n,) and the initial reference direction.

    Parameters
    ----------
    timeline
        Measurements of the device.
    start
        Start pose, with the heading to linearise at where it is not known.
    """
    prior, nodes = start_prior(timeline, start, 0.0), timeline.nodes
    if prior.heading_open or any(loses_heading(node) or node.turn_hypotheses for node in nodes):
        (states,) = initial_states([timeline], (), [start], 0.0)
        return np.array([state.mean[2] for state in states]), float(states[-1].mean[4])
    heading_rad, variance = float(prior.state.mean[2]), float(prior.state.covariance[2, 2])
    turn_rad = np.array([node.heading_change_rad for node in nodes[1:]])
    if not any(node.priors for node in nodes):
        return np.cumsum(np.concatenate([[heading_rad], turn_rad])), 0.0
    turn_variance = np.array([node.covariance[2, 2] for node in nodes[1:]])
    target, information = _filtered(nodes, heading_rad, variance)
    chain = HeadingChain(
        heading_rad,
        variance + JITTER_VARIANCE,
        0.0,
        turn_rad,
        turn_variance + JITTER_VARIANCE,
        NodePriors.of_nodes(nodes),
    )
    return chain.solve(heading_rad, turn_rad, information, target, 0.0)


def _filtered(nodes: Sequence[Node], heading: float, variance: float) -> tuple[Array, Array]:
    """Filter heading and reference direction with the weights of Huber at the innovations, as the Kalman filter does.

    Returns
    -------
    Array
        What each prior says of heading minus reference (m,), unwrapped near the prediction.
    Array
        Its information (m,) with the weight that it gets.
    """
    reference, across, of_reference = 0.0, 0.0, VAGUE_SIGMA_RAD**2
    target, information = [], []
    for i, node in enumerate(nodes):
        if i:
            heading += node.heading_change_rad
            variance += float(node.covariance[2, 2])
        for prior in node.priors:
            # Covariances of heading and reference with what is expected of the prior.
            own = variance - across if prior.relative else variance
            other = across - of_reference if prior.relative else across
            expected = heading - reference if prior.relative else heading
            spread = own - other if prior.relative else own
            residual = (prior.heading_rad - expected + pi) % (2.0 * pi) - pi
            noise = prior.sigma_rad**2
            if prior.robust:
                noise *= max(1.0, abs(residual) / sqrt(spread + noise) / HUBER)
            target.append(expected + residual)
            information.append(1.0 / max(noise, JITTER_VARIANCE))
            gain, gain_reference = own / (spread + noise), other / (spread + noise)
            heading += gain * residual
            reference += gain_reference * residual
            variance, across, of_reference = (
                variance - gain * own,
                across - gain * other,
                of_reference - gain_reference * other,
            )
    return np.array(target), np.array(information)
