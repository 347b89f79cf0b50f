"""Prediction and updates of the extended Kalman filter: the states of some devices side by side."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from pdr_est.estimators.common.huber import huber_inflation
from pdr_est.estimators.common.initial_state import SIGMA_INITIAL_HEADING_RAD
from pdr_est.estimators.common.motion_model import LOG_SCALE, SOURCE_STATES, STATES, GaussianState, linearise, move
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.kalman.fix_mixture import updated_by_fix
from pdr_est.estimators.kalman.source_clock import with_node
from pdr_est.frames import Array, wrap_angle
from pdr_est.types.measurements import HeadingPrior, PositionFix

_HEADING = np.array([[0.0, 0.0, 1.0, 0.0, 0.0]])
_RELATIVE_HEADING = np.array([[0.0, 0.0, 1.0, 0.0, -1.0]])
_SIGMA_WITHIN_STEP_M = 0.5  # ours; the donor's pose is that of its last step
_ALONE = np.ones(1)  # weight of a single state
_TETHER_ITERATIONS = 3  # a distance is not linear in the positions


class NodeFilter:
    """Extended Kalman filter with the motion model of `motion_model.py`; x is one-dimensional throughout.

    A device takes part once its state has been set; before that its state and covariance are zero. The wandering
    errors of sources of fixes follow, each from its first fix on. The arrays x and P are replaced by every operation
    and never changed in place, so that `load` and `dump` need no copies.

    Parameters
    ----------
    devices
        Number of devices.
    """

    def __init__(self, devices: int = 1) -> None:
        self._devices = devices
        self.load(GaussianState(np.zeros(STATES * devices), np.zeros((STATES * devices, STATES * devices))))

    def __getstate__(self) -> tuple[int, GaussianState]:
        return self._devices, self.dump()

    def __setstate__(self, state: tuple[int, GaussianState]) -> None:
        devices, joint = state
        self.__init__(devices)  # type: ignore[misc]
        self.load(joint)

    def load(self, state: GaussianState) -> None:
        """Set the states of all devices and sources to what `dump` returned."""
        self.x, self.P, self._sources, self._trusts = state.mean, state.covariance, state.sources, state.trusts
        self._trails, self._taken = state.trails or ((),) * self._devices, state.taken
        self._I = _unit(len(self.x))

    def dump(self) -> GaussianState:
        """Return the states of all devices and sources; the covariance is symmetric only up to rounding."""
        return GaussianState(self.x, self.P, self._sources, self._trusts, self._trails, self._taken)

    def set_state(self, state: GaussianState, device: int = 0) -> None:
        """Set the state of a device, uncorrelated with the others.

        The wandering errors of the state come along if the filter does not have them from another device.
        """
        joint = _without_device(self.dump(), device, self._devices)
        names, first = {source.name for source in joint.sources}, len(joint.mean)
        new = [i for i, source in enumerate(state.sources) if source.name not in names]
        size = first + SOURCE_STATES * len(new)
        rows = [*range(STATES), *(STATES + SOURCE_STATES * i + k for i in new for k in range(SOURCE_STATES))]
        own = [*range(STATES * device, STATES * (device + 1)), *range(first, size)]
        mean, covariance = np.zeros(size), np.zeros((size, size))
        mean[:first], covariance[:first, :first] = joint.mean, joint.covariance
        mean[own] = state.mean[rows]
        covariance[np.ix_(own, own)] = state.covariance[np.ix_(rows, rows)]
        trusts = (*joint.trusts, *(replace(trust, device=device) for trust in state.trusts))
        trails = (*joint.trails[:device], *(state.trails or ((),)), *joint.trails[device + 1 :])
        sources = (*joint.sources, *(state.sources[i] for i in new))
        self.load(GaussianState(mean, covariance, sources, trusts, trails))

    def add_device(self, state: GaussianState, node: Node, device: int, donor: int | None) -> GaussianState:
        """Let a device take part from a node on.

        Parameters
        ----------
        state
            State of the device at the node by its own measurements.
        node
            Node with which it enters.
        device
            Number of the device.
        donor
            Number of the device whose pose it takes over, if it began to record while the walk was under way: by its
            own measurements it would begin where the walk did. It then has the donor's position within a step and
            the donor's heading within the spread of initial headings, and the fixes at the node apply.

        Returns
        -------
        GaussianState
            State with which the device enters.
        """
        if donor is None:
            self.set_state(state, device)
            return state
        beside = self.state_of(donor)
        mean, covariance = state.mean[:STATES].copy(), state.covariance[:STATES, :STATES].copy()
        mean[:3] = beside.mean[:3]
        covariance[:3, :], covariance[:, :3] = 0.0, 0.0
        spread = np.array([_SIGMA_WITHIN_STEP_M, _SIGMA_WITHIN_STEP_M, SIGMA_INITIAL_HEADING_RAD])
        covariance[:3, :3] = beside.covariance[:3, :3] + np.diag(spread**2)
        self.set_state(GaussianState(mean, covariance), device)
        for fix in node.fixes:
            self.update_position(fix, device)
        return self.state_of(device)

    def state_of(self, device: int = 0) -> GaussianState:
        """Return the state of a device; of a single device with the wandering errors."""
        return marginal_of(self.dump(), device, self._devices)

    def predict_node(self, node: Node, device: int = 0) -> None:
        """Predict the motion of a device to a node; the other devices do not move."""
        self.predict_motion(node, device)
        trail = with_node(self._trails[device], node)
        self._trails, self._taken = (*self._trails[:device], trail, *self._trails[device + 1 :]), ()

    def predict_motion(self, node: Node, device: int = 0) -> None:
        """Predict mean and covariance only, and keep no trail for late fixes."""
        own, first = rows_of(device), STATES * device
        before = self.x[own]
        jacobian, noise = linearise(before, node)
        self.x = self.x.copy()
        self.x[own] = move(before, node)
        if len(self.x) == STATES:
            self.P = np.dot(jacobian, self.P).dot(jacobian.T) + noise
            return
        whole = self._I.copy()
        whole[first : first + 2, own] = jacobian[:2]
        self.P = np.dot(whole, self.P).dot(whole.T)
        self.P[first : first + 3, first : first + 3] += noise[:3, :3]

    def update_node(self, node: Node, device: int = 0) -> None:
        """Update with all measurements at a node of a device."""
        for fix in node.fixes:
            self.update_position(fix, device)
        for prior in node.priors:
            self.update_heading(prior, device)

    def update_position(self, fix: PositionFix, device: int = 0) -> None:
        """Update with a position fix by the mixture of hypotheses about it (`fix_mixture`)."""
        state = self.dump()
        stacked = replace(state, mean=state.mean[None], covariance=state.covariance[None])
        _, after = updated_by_fix(_ALONE, stacked, fix, None, device, self._devices)
        self.load(replace(after, mean=after.mean[0], covariance=after.covariance[0]))

    def update_heading(self, prior: HeadingPrior, device: int = 0) -> None:
        """Update with a heading prior, absolute or relative, Huber-weighted if it is robust."""
        jacobian = self._of_device(_RELATIVE_HEADING if prior.relative else _HEADING, device)
        noise = np.array([[prior.sigma_rad**2]])
        if prior.robust:
            residual = wrap_angle(prior.heading_rad - jacobian @ self.x)
            noise = noise * huber_inflation(residual, jacobian @ self.P @ jacobian.T + noise)
        self._correct(np.array([prior.heading_rad]), jacobian, noise, lambda a, b: wrap_angle(np.subtract(a, b)))

    def update_tether(self, device_a: int, device_b: int, max_distance_m: float, sigma_m: float) -> None:
        """Update with the inequality that two devices are no farther apart than a distance.

        Devices within that distance are left as they are. Otherwise the largest distance is used as a measurement of
        their distance, linearised anew at each result (iterated EKF).

        A tether tells how the length scales of the devices differ, and nothing about what they have in common: tracks
        that disagree are nearer to each other when both are smaller, whatever the truth is. The mean over all devices
        that take part is therefore removed from the gain of the length scales; among all gains with that property
        this one gives the smallest sum of variances. The covariance is that of the gain which is used (Joseph form).

        Parameters
        ----------
        device_a, device_b
            Numbers of the devices.
        max_distance_m
            Largest distance between them.
        sigma_m
            Standard deviation of that distance.
        """
        a, b = rows_of(device_a), rows_of(device_b)
        before, at = self.x.copy(), self.x.copy()
        if np.hypot(*(at[a][:2] - at[b][:2])) <= max_distance_m:
            return
        for _ in range(_TETHER_ITERATIONS):
            apart = at[a][:2] - at[b][:2]
            distance_m = float(np.hypot(*apart))
            if distance_m < 1e-9:
                break
            jacobian = np.zeros((1, len(at)))
            jacobian[0, a.start : a.start + 2] = apart / distance_m
            jacobian[0, b.start : b.start + 2] = -apart / distance_m
            residual_m = max_distance_m - distance_m - float(jacobian[0] @ (before - at))
            gain = self.P @ jacobian[0] / float(jacobian[0] @ self.P @ jacobian[0] + sigma_m**2)
            at = before + gain * residual_m
        scales = np.arange(LOG_SCALE, STATES * self._devices, STATES)
        scales = scales[self.P[scales, scales] > 0.0]
        gain[scales] -= gain[scales].sum() / max(len(scales), 1)
        rest = np.eye(len(at)) - np.outer(gain, jacobian[0])
        self.x = before + gain * residual_m
        self.P = rest @ self.P @ rest.T + sigma_m**2 * np.outer(gain, gain)

    def _of_device(self, jacobian: Array, device: int) -> Array:
        """Embed the Jacobian (m, 5) of one device in that of all devices."""
        whole = np.zeros((len(jacobian), len(self.x)))
        whole[:, rows_of(device)] = jacobian
        return whole

    def _correct(self, z: Array, jacobian: Array, noise: Array, residual: Callable[[Array, Array], Array]) -> None:
        """Update by one number, with the covariance in Joseph form."""
        across = np.dot(self.P, jacobian.T)
        gain = across / (np.dot(jacobian, across) + noise)
        self.x = self.x + np.dot(gain, residual(z, jacobian @ self.x))
        rest = self._I - np.dot(gain, jacobian)
        self.P = np.dot(rest, self.P).dot(rest.T) + np.dot(gain, noise).dot(gain.T)


def marginal_of(state: GaussianState, device: int, devices: int) -> GaussianState:
    """Return the state of one of several devices, with a symmetric covariance; of a single one all that is known."""
    if devices == 1:
        covariance = 0.5 * (state.covariance + state.covariance.T)
        return GaussianState(state.mean.copy(), covariance, state.sources, state.trusts, state.trails, state.taken)
    own = rows_of(device)
    covariance = state.covariance[own, own]
    trails = state.trails[device : device + 1]
    return GaussianState(state.mean[own].copy(), 0.5 * (covariance + covariance.T), trails=trails)


def _without_device(state: GaussianState, device: int, devices: int) -> GaussianState:
    """Return a joint state without one of the devices; without any there are no wandering errors either."""
    own, poses = rows_of(device), STATES * devices
    mean, covariance = state.mean.copy(), state.covariance.copy()
    mean[own], covariance[own, :], covariance[:, own] = 0.0, 0.0, 0.0
    if covariance[:poses, :poses].any():
        trusts = tuple(one for one in state.trusts if one.device != device)
        return replace(state, mean=mean, covariance=covariance, trusts=trusts)
    return GaussianState(mean[:poses], covariance[:poses, :poses], trails=state.trails)


@cache
def _unit(size: int) -> Array:
    """Return the unit matrix, which nobody may change."""
    unit = np.eye(size)
    unit.flags.writeable = False
    return unit


def rows_of(device: int) -> slice:
    """Return the rows of a device in the state of all devices."""
    return slice(STATES * device, STATES * (device + 1))
