"""The motion of a rigid device, and what ideal inertial sensors fixed to it feel."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, quaternion_from_core_motion
from pdr_est.simulate.jet import Jet


@dataclass(frozen=True)
class RigidMotion:
    """One rigid-body motion at some times (n,), seconds.

    east, north, up: position of the device, m. The orientation device -> map is Rz(yaw) Rx(pitch) Ry(roll),
    rad; with all three zero the device's x axis points east, y north, z up.
    """

    time_s: Array
    east: Jet
    north: Jet
    up: Jet
    yaw: Jet
    pitch: Jet
    roll: Jet

    @property
    def position_m(self) -> Array:
        """Position (n, 3): east, north, up."""
        return np.stack([self.east.value, self.north.value, self.up.value], axis=1)

    @property
    def quaternion(self) -> Array:
        """Orientation (n, 4), w first, device -> map."""
        return quaternion_from_core_motion(self.roll.value, self.pitch.value, self.yaw.value)

    @property
    def specific_force_mps2(self) -> Array:
        """What an accelerometer feels, (n, 3), device axes: acceleration plus gravity upwards."""
        felt = np.stack([self.east.acceleration, self.north.acceleration, self.up.acceleration], axis=1)
        felt[:, 2] += STANDARD_GRAVITY_MPS2
        in_device: Array = Rotation.from_quat(self.quaternion, scalar_first=True).apply(felt, inverse=True)
        return in_device

    @property
    def rotation_rate_radps(self) -> Array:
        """What a gyroscope feels, (n, 3), device axes: the three angle rates, each about its turned axis."""
        cos_pitch, sin_pitch = np.cos(self.pitch.value), np.sin(self.pitch.value)
        cos_roll, sin_roll = np.cos(self.roll.value), np.sin(self.roll.value)
        return np.stack(
            [
                self.pitch.rate * cos_roll - self.yaw.rate * cos_pitch * sin_roll,
                self.roll.rate + self.yaw.rate * sin_pitch,
                self.pitch.rate * sin_roll + self.yaw.rate * cos_pitch * cos_roll,
            ],
            axis=1,
        )
