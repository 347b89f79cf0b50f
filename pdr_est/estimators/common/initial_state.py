"""Initial state of a walk: what is known of pose and length scale at the start, the same for every estimator."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.estimators.common.motion_model import JITTER_VARIANCE, STATES, GaussianState
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.frames import SIGMA_UNIFORM_RAD
from pdr_est.types.measurements import LATE_START_S, START_SOURCE, PositionFix, StartPose

UNKNOWN_SIGMA_M = 1e3
"""Standard deviation of an unknown start position around the first fix, m."""

VAGUE_SIGMA_RAD = 30.0
"""Standard deviation of an unknown reference direction, rad: so large that its mean does not matter."""

SIGMA_INITIAL_HEADING_RAD = 0.2
"""Standard deviation of the first heading of one device against that of another, rad, where nothing but these
headings defines the frame."""


@dataclass(frozen=True)
class StartPrior:
    """Prior of the state at the start of a walk, or at the start of a segment after the heading was lost.

    Attributes
    ----------
    state
        Prior state. The mean of an unknown position is the first fix; that of an unknown heading has no meaning.
    position_open
        True if the position must be found from the measurements.
    heading_open
        True if the heading must be found from the measurements.
    """

    state: GaussianState
    position_open: bool
    heading_open: bool


def start_prior(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> StartPrior:
    """Return the prior at the start of a timeline.

    Unknown parts of the start pose are open if measurements can tell them; otherwise they are zero and define the
    frame.

    Parameters
    ----------
    timeline
        Measurements of the device.
    start
        Start pose as far as it is known.
    sigma_length_scale
        Standard deviation of the walker's length scale around 1, over the scale.
    """
    first = next((fix for node in timeline.nodes for fix in node.fixes), None)
    return start_prior_from(first, timeline.observes_heading, start, sigma_length_scale)


def start_prior_from(
    first_fix: PositionFix | None, heading_observed: bool, start: StartPose, sigma_length_scale: float
) -> StartPrior:
    """Return the prior at the start of a walk of which the first fix is known, if it has any.

    Parameters
    ----------
    first_fix
        Earliest position fix of the walk, or None.
    heading_observed
        True if any measurement of the walk helps to find its heading.
    start, sigma_length_scale
        As in `start_prior`.
    """
    position_open = start.position_m is None and first_fix is not None
    heading_open = start.heading_rad is None and heading_observed
    mean = np.zeros(STATES)
    sigma = np.array([0.0, 0.0, 0.0, sigma_length_scale, VAGUE_SIGMA_RAD])
    if start.position_m is not None:
        mean[:2], sigma[:2] = start.position_m, start.sigma_position_m
    elif first_fix is not None:
        mean[:2], sigma[:2] = first_fix.position_m, UNKNOWN_SIGMA_M
    if start.heading_rad is not None:
        mean[2], sigma[2] = start.heading_rad, start.sigma_heading_rad
    elif heading_open:
        sigma[2] = SIGMA_UNIFORM_RAD
    return StartPrior(GaussianState(mean, np.diag(sigma**2)), position_open, heading_open)


def prior_after_lost_heading(before: GaussianState, node: Node) -> StartPrior:
    """Return the prior at a node whose turn is too uncertain to leave any knowledge of the heading.

    Parameters
    ----------
    before
        State at the node before.
    node
        Node to which a motion in an unknown direction leads.
    """
    covariance = before.covariance.copy()
    covariance[2, :], covariance[:, 2] = 0.0, 0.0
    covariance[2, 2] = SIGMA_UNIFORM_RAD**2
    covariance[:2, :2] += 0.5 * (node.length_m**2 + node.covariance[0, 0] + node.covariance[1, 1]) * np.eye(2)
    return StartPrior(replace(before, covariance=covariance), position_open=False, heading_open=True)


def closing_fix(prior: StartPrior, time_s: float, sigma_m: float) -> PositionFix | None:
    """Return the start position as a fix at the end of a closed walk.

    Parameters
    ----------
    prior
        Prior at the start.
    time_s
        Time of the end of the walk.
    sigma_m
        Standard deviation of the distance between start and end in each coordinate.

    Returns
    -------
    PositionFix or None
        None if the start pose must itself be found from the measurements: at the end the filter no longer has what
        it learnt about the start on the way.
    """
    if prior.position_open or prior.heading_open:
        return None
    covariance = prior.state.covariance[:2, :2] + max(sigma_m, JITTER_VARIANCE) ** 2 * np.eye(2)
    return PositionFix(time_s, prior.state.mean[:2], covariance, source=START_SOURCE)


def starts_of(timelines: Sequence[Timeline], start: StartPose) -> list[StartPose]:
    """Return the start pose of each device; see `device_starts`."""
    return device_starts(len(timelines), any(timeline.observes_heading for timeline in timelines), start)


def device_starts(devices: int, heading_observed: bool, start: StartPose) -> list[StartPose]:
    """Return the start pose of each of several devices.

    Where the first headings define the frame, the heading of the first device is zero and the others differ from it
    by `SIGMA_INITIAL_HEADING_RAD`.

    Parameters
    ----------
    devices
        Number of devices.
    heading_observed
        True if any measurement of the walk helps to find its heading.
    start
        Start pose of the walk as far as it is known.
    """
    if start.heading_rad is not None or heading_observed:
        return [start] * devices
    other = replace(start, heading_rad=0.0, sigma_heading_rad=SIGMA_INITIAL_HEADING_RAD)
    return [start, *[other] * (devices - 1)]


def late_start_donor(number: int, time_s: float, begun_s: float, present: Collection[int]) -> int | None:
    """Choose the device whose pose a device takes over that begins to record while the walk is under way.

    Parameters
    ----------
    number
        Number of the node with which the device enters the joint filter.
    time_s
        Time of that node.
    begun_s
        Time at which the walk began.
    present
        Numbers of the devices that have entered the joint filter.

    Returns
    -------
    int or None
        Number of the donor; None for a device that starts with the walk.
    """
    late = number == 0 and time_s - begun_s > LATE_START_S
    return min(present, default=None) if late else None
