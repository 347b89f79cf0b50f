"""Pose of a carried device on the walking body: on a moving limb, in axes of the walking direction."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.spatial.transform import Rotation

from pdr_est.frames import Array
from pdr_est.simulate.motion.attitude_signal import AttitudeSignal, level_attitude
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal
from pdr_est.simulate.motion.rigid_body import RigidMotion
from pdr_est.simulate.walker.walking_body import BodyMotion


@dataclass(frozen=True)
class LimbPose:
    """Attitude of a limb against the body: three rotations, one after the other.

    Attributes
    ----------
    twist : DifferentiableSignal
        Rotation about the vertical, rad, counter-clockwise.
    flexion : DifferentiableSignal
        Forward rotation of a hanging limb, rad.
    abduction : DifferentiableSignal
        Rotation of a hanging limb to the left, rad.
    """

    twist: DifferentiableSignal
    flexion: DifferentiableSignal
    abduction: DifferentiableSignal

    def point_offset(
        self, on_limb_m: tuple[float, float, float]
    ) -> tuple[DifferentiableSignal, DifferentiableSignal, DifferentiableSignal]:
        """Compute the position of a point of the limb against its joint.

        Parameters
        ----------
        on_limb_m : tuple of float
            Position of the point on the limb at rest: forward, left, up, m.

        Returns
        -------
        tuple of DifferentiableSignal
            Forward, left and up, m, on the moved limb.
        """
        x, y, z = on_limb_m
        cos_a, sin_a = self.abduction.cos(), self.abduction.sin()
        cos_f, sin_f = self.flexion.cos(), self.flexion.sin()
        cos_t, sin_t = self.twist.cos(), self.twist.sin()
        left, below = cos_a * y - sin_a * z, sin_a * y + cos_a * z
        forward = cos_f * x - sin_f * below
        return cos_t * forward - sin_t * left, sin_t * forward + cos_t * left, sin_f * x + cos_f * below


@dataclass(frozen=True)
class DevicePose:
    """Pose of a device on the body at sampled times.

    Attributes
    ----------
    forward, left, up : DifferentiableSignal
        Position from the trunk's centre in axes of the walking direction, m.
    limb : LimbPose
        Attitude of the limb that carries the device.
    mount : Rotation
        Rotation from device axes to forward, left, up, when the limb is at rest.
    pitch, roll : DifferentiableSignal
        Small rotations about the device's own x and y axes, rad.
    """

    forward: DifferentiableSignal
    left: DifferentiableSignal
    up: DifferentiableSignal
    limb: LimbPose
    mount: Rotation
    pitch: DifferentiableSignal
    roll: DifferentiableSignal

    def select(self, part: slice) -> "DevicePose":
        """Select the pose at a range of the sampled times."""
        limb, own = ([signal[part] for signal in signals] for signals in self._signals)
        return self._like(limb, own)

    def interpolate(self, other: "DevicePose", share: DifferentiableSignal) -> "DevicePose":
        """Interpolate all but the mount towards another pose, by a fraction `share` of the difference."""
        limb, own = (
            [one + (two - one) * share for one, two in zip(mine, theirs, strict=True)]
            for mine, theirs in zip(self._signals, other._signals, strict=True)
        )
        return self._like(limb, own)

    @property
    def _signals(self) -> tuple[list[DifferentiableSignal], list[DifferentiableSignal]]:
        """Signals of the limb and of the device itself."""
        limb = [self.limb.twist, self.limb.flexion, self.limb.abduction]
        return limb, [self.forward, self.left, self.up, self.pitch, self.roll]

    def _like(self, limb: list[DifferentiableSignal], own: list[DifferentiableSignal]) -> "DevicePose":
        """Build the pose with the same mount from its signals."""
        forward, left, up, pitch, roll = own
        return DevicePose(forward, left, up, LimbPose(*limb), self.mount, pitch, roll)


class CarryingModel(Protocol):
    """Way of carrying a device: puts it on the moving body."""

    def pose(self, body: BodyMotion, rng: np.random.Generator) -> DevicePose:
        """Compute the device's pose at the times of `body`, as the same function of time for any choice of times."""
        ...


def device_motion(body: BodyMotion, pose: DevicePose, transition: "MountTransition | None" = None) -> RigidMotion:
    """Compute the motion of a device on a body; a `transition` replaces the constant mount by one that changes."""
    cosine, sine = body.heading.cos(), body.heading.sin()
    if body.lean is None:
        limb = level_attitude(body.heading + pose.limb.twist)
    else:
        pitch, roll = body.lean
        leaning = level_attitude(body.heading).rotate_about_y(pitch).rotate_about_x(roll)
        limb = leaning.rotate_about_z(pose.limb.twist)
    limb = limb.rotate_about_y(-pose.limb.flexion).rotate_about_x(pose.limb.abduction)
    attitude = limb.rotate_by(pose.mount)
    if transition is not None:
        attitude = transition.apply(attitude)
    return RigidMotion(
        time_s=body.time_s,
        east=body.east + cosine * pose.forward - sine * pose.left,
        north=body.north + sine * pose.forward + cosine * pose.left,
        up=body.up + pose.up,
        attitude=attitude.rotate_about_x(pose.pitch).rotate_about_y(pose.roll),
    )


@dataclass(frozen=True)
class MountTransition:
    """Rotation of a device by a hand from one mount to the next: the shortest rotation, with a flick of the wrist.

    Attributes
    ----------
    rotation_vector : Array
        Rotation from the old mount to the new one, (3,), rad, device axes.
    flick : Array
        Rotation vector (3,), rad, device axes, of an additional rotation that is undone on the way.
    progress, flick_progress : DifferentiableSignal
        Fractions of both rotations over time.
    """

    rotation_vector: Array
    flick: Array
    progress: DifferentiableSignal
    flick_progress: DifferentiableSignal

    def apply(self, attitude: AttitudeSignal) -> AttitudeSignal:
        """Apply the transition to an attitude with the first mount."""
        return attitude.rotate_partly(self.rotation_vector, self.progress).rotate_partly(
            self.flick, self.flick_progress
        )
