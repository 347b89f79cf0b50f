"""Orientations that change over time: unit quaternions of jets, so that rotation rates are exact."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from pdr_est.frames import Array
from pdr_est.simulate.motion.differentiable_signal import Jet, constant, joined


@dataclass(frozen=True)
class Turning:
    """Orientation device -> map as a unit quaternion w, x, y, z at some times (n,).

    It is built by turning further and further about the device's own axes, which needs no angle limits and has
    no singular attitude.
    """

    w: Jet
    x: Jet
    y: Jet
    z: Jet

    def about_x(self, angle: Jet) -> "Turning":
        """Turned further about the device's x axis by an angle, rad."""
        c, s = (angle * 0.5).cos(), (angle * 0.5).sin()
        return Turning(
            self.w * c - self.x * s, self.x * c + self.w * s, self.y * c + self.z * s, self.z * c - self.y * s
        )

    def about_y(self, angle: Jet) -> "Turning":
        """Turned further about the device's y axis by an angle, rad."""
        c, s = (angle * 0.5).cos(), (angle * 0.5).sin()
        return Turning(
            self.w * c - self.y * s, self.x * c - self.z * s, self.y * c + self.w * s, self.z * c + self.x * s
        )

    def about_z(self, angle: Jet) -> "Turning":
        """Turned further about the device's z axis by an angle, rad."""
        c, s = (angle * 0.5).cos(), (angle * 0.5).sin()
        return Turning(
            self.w * c - self.z * s, self.x * c + self.y * s, self.y * c - self.x * s, self.z * c + self.w * s
        )

    def by(self, rotation: Rotation) -> "Turning":
        """Turned further by a fixed rotation in the device's axes."""
        w, x, y, z = (float(part) for part in rotation.as_quat(scalar_first=True))
        return Turning(
            self.w * w - self.x * x - self.y * y - self.z * z,
            self.w * x + self.x * w + self.y * z - self.z * y,
            self.w * y - self.x * z + self.y * w + self.z * x,
            self.w * z + self.x * y - self.y * x + self.z * w,
        )

    def along(self, rotation_vector: Array, share: Jet) -> "Turning":
        """Turned further by a share of a rotation about a fixed axis; rotation_vector: (3,), rad, device axes."""
        angle_rad = float(np.linalg.norm(rotation_vector))
        if angle_rad == 0.0:
            return self
        onto_axis = _from_z(np.asarray(rotation_vector) / angle_rad)
        return self.by(onto_axis).about_z(share * angle_rad).by(onto_axis.inv())

    @property
    def quaternion(self) -> Array:
        """Orientation (n, 4), w first, device -> map."""
        return np.stack([part.value for part in self._parts], axis=1)

    @property
    def rotation_rate_radps(self) -> Array:
        """What a gyroscope feels, (n, 3), device axes: twice the vector part of conj(q) dq/dt."""
        w, x, y, z = (part.value for part in self._parts)
        dw, dx, dy, dz = (part.rate for part in self._parts)
        return 2.0 * np.stack(
            [
                w * dx - x * dw - y * dz + z * dy,
                w * dy + x * dz - y * dw - z * dx,
                w * dz - x * dy + y * dx - z * dw,
            ],
            axis=1,
        )

    @property
    def _parts(self) -> tuple[Jet, Jet, Jet, Jet]:
        return self.w, self.x, self.y, self.z


def heading_up(yaw: Jet) -> Turning:
    """A level device whose x axis points along a heading, rad, and whose z axis points up."""
    zero = constant(0.0, len(yaw.value))
    return Turning((yaw * 0.5).cos(), zero, zero, (yaw * 0.5).sin())


def joined_turnings(parts: list[Turning]) -> Turning:
    """Consecutive pieces of one turning as one; q and -q are the same attitude, so signs are made to agree."""
    signs = [1.0]
    ends = [part.quaternion[[0, -1]] for part in parts]
    for before, after in pairwise(ends):
        signs.append(signs[-1] if before[1] @ after[0] >= 0.0 else -signs[-1])
    return Turning(
        *(
            joined([getattr(part, name) * sign for part, sign in zip(parts, signs, strict=True)])
            for name in ("w", "x", "y", "z")
        )
    )


def _from_z(axis: Array) -> Rotation:
    """A rotation that takes the z axis to a unit vector (3,)."""
    across = np.array([-axis[1], axis[0], 0.0])
    sine = float(np.hypot(axis[0], axis[1]))
    if sine == 0.0:
        return Rotation.identity() if axis[2] > 0.0 else Rotation.from_rotvec([np.pi, 0.0, 0.0])
    return Rotation.from_rotvec(across / sine * np.arctan2(sine, axis[2]))
