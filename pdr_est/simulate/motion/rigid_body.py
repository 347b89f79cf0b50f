"""The motion of a rigid device, and what ideal inertial sensors fixed to it feel."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.simulate.motion.differentiable_signal import Jet
from pdr_est.simulate.motion.rotation import Turning


@dataclass(frozen=True)
class RigidMotion:
    """One rigid-body motion at some times (n,), seconds.

    east, north, up: position of the device, m. turning: its orientation device -> map; a device that is not
    turned has its x axis to the east, y north, z up.
    """

    time_s: Array
    east: Jet
    north: Jet
    up: Jet
    turning: Turning

    @property
    def position_m(self) -> Array:
        """Position (n, 3): east, north, up."""
        return np.stack([self.east.value, self.north.value, self.up.value], axis=1)

    @property
    def quaternion(self) -> Array:
        """Orientation (n, 4), w first, device -> map."""
        return self.turning.quaternion

    @property
    def specific_force_mps2(self) -> Array:
        """What an accelerometer feels, (n, 3), device axes: acceleration plus gravity upwards."""
        felt = np.stack([self.east.acceleration, self.north.acceleration, self.up.acceleration], axis=1)
        felt[:, 2] += STANDARD_GRAVITY_MPS2
        return self.in_device(felt)

    @property
    def rotation_rate_radps(self) -> Array:
        """What a gyroscope feels, (n, 3), device axes."""
        return self.turning.rotation_rate_radps

    def in_device(self, vector: Array) -> Array:
        """Vectors of the map (n, 3) or (3,), seen in the device's axes, (n, 3)."""
        seen: Array = Rotation.from_quat(self.quaternion, scalar_first=True).apply(vector, inverse=True)
        return seen
