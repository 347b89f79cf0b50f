"""Initial values of the factor graph."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.estimators.common.initial_state import start_prior
from pdr_est.estimators.common.motion_model import STATES, GaussianState
from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.kalman.known_heading import known_headings
from pdr_est.estimators.kalman.offline_filter import run_filter
from pdr_est.estimators.kalman.rts_smoother import smooth_segments, smooth_walk
from pdr_est.estimators.reckoned_poses import reckon_means
from pdr_est.types.measurements import StartPose

_NO_COVARIANCE = np.zeros((STATES, STATES))
_SIGMA_GUESS_RAD = 0.2  # of a start heading to linearise at


def with_headings(starts: Sequence[StartPose], headings_rad: Sequence[float | None]) -> list[StartPose]:
    """Return start poses with approximate headings where there are any, for the initial values only."""
    given = headings_rad or [None] * len(starts)
    return [
        start if one is None else replace(start, heading_rad=one, sigma_heading_rad=_SIGMA_GUESS_RAD)
        for start, one in zip(starts, given, strict=True)
    ]


def initial_states(
    timelines: Sequence[Timeline],
    node_tethers: Sequence[NodeTether],
    starts: Sequence[StartPose],
    sigma_length_scale: float,
) -> list[list[GaussianState]]:
    """Return initial states at all nodes of each device, of which only the means count.

    They are those of the Kalman smoother, or dead reckoning where nothing is measured on the way.
    """
    if node_tethers:
        known = known_headings(timelines, node_tethers, starts, sigma_length_scale)
        if known is not None:
            smoothed = known.smoothed_means(timelines)
            return [[GaussianState(mean, _NO_COVARIANCE) for mean in own] for own in smoothed]
        return smooth_walk(timelines, node_tethers, starts, sigma_length_scale)
    states = []
    for timeline, start in zip(timelines, starts, strict=True):
        prior = start_prior(timeline, start, sigma_length_scale)
        measured = timeline.fixes or timeline.priors or timeline.closure_sigma_m is not None
        if measured or prior.position_open or prior.heading_open:
            states.append(smooth_segments(run_filter(timeline, start, sigma_length_scale)))
        else:
            means = reckon_means(timeline.nodes, prior.state.mean)
            states.append([GaussianState(mean, prior.state.covariance) for mean in means])
    return states
