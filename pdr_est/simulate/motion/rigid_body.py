"""The motion of a rigid device, and the readings of ideal inertial sensors fixed to it."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.simulate.motion.attitude_signal import AttitudeSignal
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal


@dataclass(frozen=True)
class RigidMotion:
    """Motion of a rigid device at sampled times.

    Attributes
    ----------
    time_s : Array
        Sampling times, (n,), s.
    east, north, up : DifferentiableSignal
        Position of the device in the map frame, m.
    attitude : AttitudeSignal
        Orientation from device to map axes. At the identity, x points east, y north and z up.
    """

    time_s: Array
    east: DifferentiableSignal
    north: DifferentiableSignal
    up: DifferentiableSignal
    attitude: AttitudeSignal

    @property
    def position_m(self) -> Array:
        """Return the position (n, 3) in m: east, north, up."""
        return np.stack([self.east.value, self.north.value, self.up.value], axis=1)

    @property
    def quaternion(self) -> Array:
        """Return the orientation (n, 4) from device to map, scalar first."""
        return self.attitude.quaternion

    @property
    def specific_force_mps2(self) -> Array:
        """Return the reading of an ideal accelerometer, (n, 3), m/s^2, device axes.

        It is the acceleration of the device plus gravity, upwards.
        """
        felt = np.stack([self.east.acceleration, self.north.acceleration, self.up.acceleration], axis=1)
        felt[:, 2] += STANDARD_GRAVITY_MPS2
        return self.in_device(felt)

    @property
    def rotation_rate_radps(self) -> Array:
        """Return the reading of an ideal gyroscope, (n, 3), rad/s, device axes."""
        return self.attitude.rotation_rate_radps

    def in_device(self, vector: Array) -> Array:
        """Express vectors (n, 3) or (3,) of the map frame in device axes, (n, 3)."""
        seen: Array = Rotation.from_quat(self.quaternion, scalar_first=True).apply(vector, inverse=True)
        return seen
