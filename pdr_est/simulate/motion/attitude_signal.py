"""Orientations over time: unit quaternions of differentiable signals, so that rotation rates are exact."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from pdr_est.frames import Array
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal, concatenate_signals, constant_signal


@dataclass(frozen=True)
class AttitudeSignal:
    """Orientation from device to map axes over time, as a unit quaternion.

    An attitude is built by successive rotations about the device's own axes. This needs no limits of angles and has
    no singular attitude.

    Attributes
    ----------
    w, x, y, z : DifferentiableSignal
        Components of the quaternion (device to map, scalar first) at the sampled times, (n,) each.
    """

    w: DifferentiableSignal
    x: DifferentiableSignal
    y: DifferentiableSignal
    z: DifferentiableSignal

    def rotate_about_x(self, angle: DifferentiableSignal) -> "AttitudeSignal":
        """Rotate further about the device's x axis by an angle, rad."""
        c, s = (angle * 0.5).cos(), (angle * 0.5).sin()
        return AttitudeSignal(
            self.w * c - self.x * s, self.x * c + self.w * s, self.y * c + self.z * s, self.z * c - self.y * s
        )

    def rotate_about_y(self, angle: DifferentiableSignal) -> "AttitudeSignal":
        """Rotate further about the device's y axis by an angle, rad."""
        c, s = (angle * 0.5).cos(), (angle * 0.5).sin()
        return AttitudeSignal(
            self.w * c - self.y * s, self.x * c - self.z * s, self.y * c + self.w * s, self.z * c + self.x * s
        )

    def rotate_about_z(self, angle: DifferentiableSignal) -> "AttitudeSignal":
        """Rotate further about the device's z axis by an angle, rad."""
        c, s = (angle * 0.5).cos(), (angle * 0.5).sin()
        return AttitudeSignal(
            self.w * c - self.z * s, self.x * c + self.y * s, self.y * c - self.x * s, self.z * c + self.w * s
        )

    def rotate_by(self, rotation: Rotation) -> "AttitudeSignal":
        """Rotate further by a constant rotation, given in device axes."""
        w, x, y, z = (float(part) for part in rotation.as_quat(scalar_first=True))
        return AttitudeSignal(
            self.w * w - self.x * x - self.y * y - self.z * z,
            self.w * x + self.x * w + self.y * z - self.z * y,
            self.w * y - self.x * z + self.y * w + self.z * x,
            self.w * z + self.x * y - self.y * x + self.z * w,
        )

    def rotate_partly(self, rotation_vector: Array, share: DifferentiableSignal) -> "AttitudeSignal":
        """Rotate further by a fraction of a rotation about a fixed axis.

        Parameters
        ----------
        rotation_vector : Array
            Full rotation as a rotation vector (3,), rad, device axes.
        share : DifferentiableSignal
            Fraction of the full rotation over time.
        """
        angle_rad = float(np.linalg.norm(rotation_vector))
        if angle_rad == 0.0:
            return self
        onto_axis = _from_z(np.asarray(rotation_vector) / angle_rad)
        return self.rotate_by(onto_axis).rotate_about_z(share * angle_rad).rotate_by(onto_axis.inv())

    @property
    def quaternion(self) -> Array:
        """Return the orientation (n, 4) from device to map, scalar first."""
        return np.stack([part.value for part in self._parts], axis=1)

    @property
    def rotation_rate_radps(self) -> Array:
        """Return the reading of an ideal gyroscope, (n, 3), rad/s, device axes.

        It is twice the vector part of conj(q) dq/dt.
        """
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
    def _parts(self) -> tuple[DifferentiableSignal, DifferentiableSignal, DifferentiableSignal, DifferentiableSignal]:
        return self.w, self.x, self.y, self.z


def level_attitude(yaw: DifferentiableSignal) -> AttitudeSignal:
    """Make the attitude of a level device: its x axis along a heading, rad, and its z axis up."""
    zero = constant_signal(0.0, len(yaw.value))
    return AttitudeSignal((yaw * 0.5).cos(), zero, zero, (yaw * 0.5).sin())


def concatenate_attitudes(parts: list[AttitudeSignal]) -> AttitudeSignal:
    """Join consecutive pieces of one attitude.

    Since q and -q are the same attitude, their signs are made to agree.
    """
    signs = [1.0]
    ends = [part.quaternion[[0, -1]] for part in parts]
    for before, after in pairwise(ends):
        signs.append(signs[-1] if before[1] @ after[0] >= 0.0 else -signs[-1])
    return AttitudeSignal(
        *(
            concatenate_signals([getattr(part, name) * sign for part, sign in zip(parts, signs, strict=True)])
            for name in ("w", "x", "y", "z")
        )
    )


def _from_z(axis: Array) -> Rotation:
    """Find a rotation that takes the z axis to a unit vector (3,)."""
    across = np.array([-axis[1], axis[0], 0.0])
    sine = float(np.hypot(axis[0], axis[1]))
    if sine == 0.0:
        return Rotation.identity() if axis[2] > 0.0 else Rotation.from_rotvec([np.pi, 0.0, 0.0])
    return Rotation.from_rotvec(across / sine * np.arctan2(sine, axis[2]))
