"""The extended Kalman filter of all estimators (filterpy): the states of some devices side by side."""

from collections.abc import Callable

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from pdr_est.estimators.common.huber import huber_inflation
from pdr_est.estimators.common.motion_model import LENGTH_SCALE, STATES, GaussianState, linearise, move
from pdr_est.estimators.common.tethers import SIGMA_SET_OFF_RAD
from pdr_est.estimators.common.timeline import Node
from pdr_est.frames import Array, wrap_angle
from pdr_est.types.measurements import HeadingPrior, PositionFix

_POSITION = np.eye(2, STATES)
_HEADING = np.array([[0.0, 0.0, 1.0, 0.0, 0.0]])
_RELATIVE_HEADING = np.array([[0.0, 0.0, 1.0, 0.0, -1.0]])
_SIGMA_WITHIN_STEP_M = 0.5  # ours; the lender's pose is that of its last step
_TETHER_ROUNDS = 3  # a distance is not linear in the positions


class PoseFilter(ExtendedKalmanFilter):  # type: ignore[misc]
    """filterpy's EKF with the motion model of `motion.py`; x is one-dimensional throughout.

    A device takes part from `enter` on.
    """

    def __init__(self, devices: int = 1) -> None:
        super().__init__(dim_x=STATES * devices, dim_z=2)
        self.x = np.zeros(STATES * devices)
        self.P = np.zeros((STATES * devices, STATES * devices))
        self.F, self.Q = np.eye(STATES * devices), np.zeros((STATES * devices, STATES * devices))

    def enter(self, moments: GaussianState, device: int = 0) -> None:
        """Set the state of a device; nothing ties it to the others yet."""
        own = _rows(device)
        self.x[own] = moments.mean
        self.P[own, :], self.P[:, own] = 0.0, 0.0
        self.P[own, own] = moments.covariance

    def join(self, moments: GaussianState, node: Node, device: int, donor: int | None) -> GaussianState:
        """Set the state of a device that takes part from `node` on, and return it. moments: by itself.

        lender: given for a device that began to record while the walk was under way, and by itself would begin where
        the walk did. It is where the lender is by then, within a step, and heads as the lender does, within what
        directions differ by at the start; fixes at the node count.
        """
        if donor is None:
            self.enter(moments, device)
            return moments
        beside, mean, covariance = self.moments(donor), moments.mean.copy(), moments.covariance.copy()
        mean[:3] = beside.mean[:3]
        covariance[:3, :], covariance[:, :3] = 0.0, 0.0
        spread = np.array([_SIGMA_WITHIN_STEP_M, _SIGMA_WITHIN_STEP_M, SIGMA_SET_OFF_RAD])
        covariance[:3, :3] = beside.covariance[:3, :3] + np.diag(spread**2)
        self.enter(GaussianState(mean, covariance), device)
        for fix in node.fixes:
            self.update_position(fix, device)
        return self.moments(device)

    def moments(self, device: int = 0) -> GaussianState:
        own = _rows(device)
        covariance = self.P[own, own]
        return GaussianState(self.x[own].copy(), 0.5 * (covariance + covariance.T))

    def advance(self, node: Node, device: int = 0) -> None:
        """The motion of a device that leads to `node`; the others stay where they are."""
        own = _rows(device)
        self.F, self.Q = np.eye(len(self.x)), np.zeros_like(self.P)
        self.F[own, own], self.Q[own, own] = linearise(self.x[own], node)
        self.predict((node, own))

    def predict_x(self, u: tuple[Node, slice]) -> None:
        node, own = u
        self.x[own] = move(self.x[own], node)

    def measure(self, node: Node, device: int = 0) -> None:
        """What was measured at a node of a device."""
        for fix in node.fixes:
            self.update_position(fix, device)
        for prior in node.priors:
            self.update_heading(prior, device)

    def update_position(self, fix: PositionFix, device: int = 0) -> None:
        residual = np.asarray(fix.position_m) - self.x[_rows(device)][:2]
        noise = fix.covariance_m2
        if fix.robust:
            noise = noise * huber_inflation(residual, self.P[_rows(device), _rows(device)][:2, :2] + noise)
        jacobian = self._of_device(_POSITION, device)
        self._correct(np.asarray(fix.position_m, dtype=np.float64), jacobian, noise, np.subtract)

    def update_heading(self, prior: HeadingPrior, device: int = 0) -> None:
        jacobian = self._of_device(_RELATIVE_HEADING if prior.relative else _HEADING, device)
        noise = np.array([[prior.sigma_rad**2]])
        if prior.robust:
            residual = wrap_angle(prior.heading_rad - jacobian @ self.x)
            noise = noise * huber_inflation(residual, jacobian @ self.P @ jacobian.T + noise)
        self._correct(np.array([prior.heading_rad]), jacobian, noise, lambda a, b: wrap_angle(np.subtract(a, b)))

    def keep_together(self, device_a: int, device_b: int, max_distance_m: float, sigma_m: float) -> None:
        """Devices that are farther apart than they can be are brought to that distance; others are left alone.

        The distance is measured as the largest one, with sigma_m, and linearised anew where that led to (iterated
        EKF). It tells how the devices' length scales differ and nothing of what they have in common: tracks that
        disagree are nearer to each other when both are smaller, whatever the truth is. That much, the mean over the
        devices that have entered, is left out of the gain: of all gains that do so this one leaves the least sum of
        variances. The covariance is that of the gain which is used (Joseph's form).
        """
        a, b = _rows(device_a), _rows(device_b)
        before, at = self.x.copy(), self.x.copy()
        if np.hypot(*(at[a][:2] - at[b][:2])) <= max_distance_m:
            return
        for _ in range(_TETHER_ROUNDS):
            apart = at[a][:2] - at[b][:2]
            distance_m = float(np.hypot(*apart))
            if distance_m < 1e-9:
                break
            jacobian = np.zeros((1, len(at)))
            jacobian[0, a.start : a.start + 2] = apart / distance_m
            jacobian[0, b.start : b.start + 2] = -apart / distance_m
            seen = max_distance_m - distance_m - float(jacobian[0] @ (before - at))
            gain = self.P @ jacobian[0] / float(jacobian[0] @ self.P @ jacobian[0] + sigma_m**2)
            at = before + gain * seen
        scales = np.arange(LENGTH_SCALE, len(at), STATES)
        scales = scales[self.P[scales, scales] > 0.0]
        gain[scales] -= gain[scales].sum() / max(len(scales), 1)
        rest = np.eye(len(at)) - np.outer(gain, jacobian[0])
        self.x = before + gain * seen
        self.P = rest @ self.P @ rest.T + sigma_m**2 * np.outer(gain, gain)

    def _of_device(self, jacobian: Array, device: int) -> Array:
        whole = np.zeros((len(jacobian), len(self.x)))
        whole[:, _rows(device)] = jacobian
        return whole

    def _correct(self, z: Array, jacobian: Array, noise: Array, residual: Callable[[Array, Array], Array]) -> None:
        self.update(z, lambda _: jacobian, lambda x: jacobian @ x, R=noise, residual=residual)


def _rows(device: int) -> slice:
    return slice(STATES * device, STATES * (device + 1))
