"""Dead reckoning: apply MMPDR eq. 1 step by step, with the covariance of the motion model."""

from pdr_est.estimators.common.initial_state import StartPrior, start_prior
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.timeline import Timeline, track_from_nodes
from pdr_est.estimators.kalman.device_filter_step import filtered_states
from pdr_est.estimators.kalman.offline_filter import run_filter
from pdr_est.estimators.kalman.rts_smoother import smooth
from pdr_est.estimators.reckoned_poses import reckon_poses
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose
from pdr_est.types.track import Track

NAME = "dead-reckoning"


def estimate(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> Track:
    """Estimate the track of a device from the start pose and the odometry alone.

    Fixes and heading priors are used for one thing only: where the start is not given, they determine position and
    heading of one pose, and the other poses are dead-reckoned from it, forwards and backwards.

    Parameters
    ----------
    timeline
        Measurements of the device.
    start
        Start pose as far as it is known.
    sigma_length_scale
        Standard deviation of the walker's length scale around 1.
    """
    mean, covariance, scale = _poses(timeline, start, sigma_length_scale)
    return track_from_nodes(timeline, mean[:, :2], mean[:, 2], covariance, "filtered", NAME, scale)


def _poses(
    timeline: Timeline, start: StartPose, sigma_length_scale: float
) -> tuple[Array, Array, tuple[float, float]]:
    """Dead-reckon the poses (n, 3) at all nodes with their covariances (n, 3, 3), and the length scale."""
    prior, nodes = start_prior(timeline, start, sigma_length_scale), timeline.nodes
    if not prior.heading_open and not prior.position_open:
        return *reckon_poses(nodes, 0, prior.state), prior.state.length_scale
    begin, states = _until_known(timeline, prior)
    if not states:
        anchor, state = run_filter(timeline, start, sigma_length_scale)[0].open_anchor()
        return *reckon_poses(nodes, anchor, state), state.length_scale
    anchor, state = begin + len(states) - 1, states[-1]
    pose, covariance = reckon_poses(nodes, anchor, state)
    if begin == 0 and not prior.heading_open:
        # One fix can shift a walk but not bend it: the smoother gives the same poses as dead reckoning, and the
        # exact covariances of the poses before the fix.
        for i, earlier in enumerate(smooth(nodes[: anchor + 1], tuple(states))[:-1]):
            pose[i], covariance[i] = earlier.mean[:3], earlier.covariance[:3, :3]
    return pose, covariance, state.length_scale


def _until_known(timeline: Timeline, prior: StartPrior) -> tuple[int, list[GaussianState]]:
    """Filter up to the first node whose position and heading are known.

    Returns
    -------
    int
        Number of the first node of the segment in which it is.
    list of GaussianState
        Filtered states from that node on; none if position or heading are never known.
    """
    states: list[GaussianState] = []
    begin, fixed = 0, False
    for node, state in zip(timeline.nodes, filtered_states(timeline.nodes, prior), strict=True):
        if state.segment_begin != begin:
            states, begin, fixed = [], state.segment_begin, False
        states.append(state.state)
        fixed = fixed or bool(node.fixes)
        if state.heading_known and (fixed or not prior.position_open):
            return begin, states
    return 0, []
