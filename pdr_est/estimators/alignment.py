"""Where and in which direction a walk began, found from fixes on the way.

While the start heading is unknown, the pose is far from Gaussian in angle, but exactly linear in the heading vector
(u, v) = scale (cos heading, sin heading): a turn rotates the vector and a step adds L (u, v) to the position. A
uniform heading has the moments (u, v) ~ N(0, I/2), so a linear Kalman filter follows the walk honestly from the
first step, and hands over to the pose once fixes have fixed the direction.
"""

import numpy as np
from filterpy.kalman import KalmanFilter

from pdr_est.estimators.motion import Moments
from pdr_est.estimators.timeline import Node
from pdr_est.frames import Array
from pdr_est.records import PositionFix, StartPose

ALIGNED_SIGMA_RAD = 0.2  # below this the pose is close enough to Gaussian for an EKF
_UNIFORM_VARIANCE = 0.5  # of each component of a unit vector of uniform direction
_FAR_M = 1e3  # sigma of an unknown position around the first fix


class HeadingAlignment:
    """Linear Kalman filter over (east, north, u, v)."""

    def __init__(self, start: StartPose, first_fix: PositionFix) -> None:
        self._filter = KalmanFilter(dim_x=4, dim_z=2)
        known = start.position_m is not None
        sigma = max(start.sigma_position_m, 1e-3) if known else _FAR_M
        origin = start.position_m if start.position_m is not None else first_fix.position_m
        self._filter.x = np.array([*origin, 0.0, 0.0], dtype=np.float64)
        self._filter.P = np.diag([sigma**2, sigma**2, _UNIFORM_VARIANCE, _UNIFORM_VARIANCE])
        self._filter.H = np.eye(2, 4)

    def advance(self, node: Node) -> None:
        """The motion that leads to `node`; its noise is spread evenly over the directions it may have."""
        c, s = np.cos(node.heading_change_rad), np.sin(node.heading_change_rad)
        turn = np.array([[c, -s], [s, c]])
        transition = np.eye(4)
        transition[:2, 2:] = node.length_m * turn
        transition[2:, 2:] = turn
        position = 0.5 * (node.covariance[0, 0] + node.covariance[1, 1])
        direction = 0.5 * node.covariance[2, 2]
        self._filter.predict(F=transition, Q=np.diag([position, position, direction, direction]))

    def update(self, fix: PositionFix) -> None:
        self._filter.update(np.asarray(fix.position_m, dtype=np.float64), R=fix.covariance_m2)

    def pose(self) -> tuple[Array, Array]:
        """Mean (x, y, heading) and covariance (3, 3) for the track; an unknown heading has sigma pi / sqrt 3."""
        x, y, u, v = self._filter.x
        covariance = np.zeros((3, 3))
        covariance[:2, :2] = self._filter.P[:2, :2]
        sigma = min(self._sigma_heading(), np.pi / np.sqrt(3.0))
        covariance[2, 2] = sigma**2
        return np.array([x, y, np.arctan2(v, u)]), covariance

    def aligned(self, sigma_length_scale: float) -> Moments | None:
        """The state for the EKF once the direction is known well enough, else None."""
        if self._sigma_heading() > ALIGNED_SIGMA_RAD:
            return None
        mean, covariance = self._without_uniform_prior()
        x, y, u, v = mean
        norm = np.hypot(u, v)
        jacobian = np.eye(4)
        jacobian[2, 2:] = [-v / norm**2, u / norm**2]
        jacobian[3, 2:] = [u / norm, v / norm]
        state = np.array([x, y, np.arctan2(v, u), norm])
        return _with_scale_prior(Moments(state, jacobian @ covariance @ jacobian.T), sigma_length_scale)

    def _sigma_heading(self) -> float:
        u, v = self._filter.x[2:]
        norm = np.hypot(u, v)
        if norm < 1e-6:
            return np.inf
        across = np.array([-v, u]) / norm
        return float(np.sqrt(across @ self._filter.P[2:, 2:] @ across) / norm)

    def _without_uniform_prior(self) -> tuple[Array, Array]:
        """Take the prior of the heading vector, centred at zero, out again: it would shorten the vector."""
        information = np.linalg.inv(self._filter.P)
        weighted = information @ self._filter.x
        information[2:, 2:] -= np.eye(2) / _UNIFORM_VARIANCE
        covariance = np.linalg.inv(information)
        return covariance @ weighted, covariance


def _with_scale_prior(moments: Moments, sigma: float) -> Moments:
    """The walker's length scale is 1 +- sigma before any measurement: one Kalman update of the last state."""
    gain = moments.covariance[:, 3] / (moments.covariance[3, 3] + sigma**2)
    mean = moments.mean + gain * (1.0 - moments.mean[3])
    return Moments(mean, moments.covariance - np.outer(gain, moments.covariance[3]))
