"""How a carried device sits on the walking body: on a limb that moves, in the axes of the walking direction."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.spatial.transform import Rotation

from pdr_est.frames import Array
from pdr_est.simulate.motion.differentiable_signal import Jet
from pdr_est.simulate.motion.rigid_body import RigidMotion
from pdr_est.simulate.motion.rotation import Turning, heading_up
from pdr_est.simulate.walker.trunk import BodyMotion


@dataclass(frozen=True)
class LimbPose:
    """Attitude of a limb against the body, rad: three turns, one after the other.

    twist: counter-clockwise about the vertical. flexion: of a hanging limb, forward. abduction: of a hanging
    limb, to the left.
    """

    twist: Jet
    flexion: Jet
    abduction: Jet

    def point(self, on_limb_m: tuple[float, float, float]) -> tuple[Jet, Jet, Jet]:
        """Where a point of the limb is against its joint: forward, left, up, m. on_limb_m: the same of the
        limb at rest."""
        x, y, z = on_limb_m
        cos_a, sin_a = self.abduction.cos(), self.abduction.sin()
        cos_f, sin_f = self.flexion.cos(), self.flexion.sin()
        cos_t, sin_t = self.twist.cos(), self.twist.sin()
        left, below = cos_a * y - sin_a * z, sin_a * y + cos_a * z
        forward = cos_f * x - sin_f * below
        return cos_t * forward - sin_t * left, sin_t * forward + cos_t * left, sin_f * x + cos_f * below


@dataclass(frozen=True)
class DevicePose:
    """A device on a body at some times (n,).

    forward, left, up: from the trunk's centre along the walking direction, m. limb: attitude of what carries
    it. mount: the device at rest, its axes -> forward, left, up. pitch, roll: unrest about its own x and y axes.
    """

    forward: Jet
    left: Jet
    up: Jet
    limb: LimbPose
    mount: Rotation
    pitch: Jet
    roll: Jet

    def part(self, part: slice) -> "DevicePose":
        """The pose at some of the times."""
        limb, own = ([signal[part] for signal in signals] for signals in self._signals)
        return self._like(limb, own)

    def blended(self, other: "DevicePose", share: Jet) -> "DevicePose":
        """On the way to another pose, but for the mount: all else by a share of the way."""
        limb, own = (
            [one + (two - one) * share for one, two in zip(mine, theirs, strict=True)]
            for mine, theirs in zip(self._signals, other._signals, strict=True)
        )
        return self._like(limb, own)

    @property
    def _signals(self) -> tuple[list[Jet], list[Jet]]:
        limb = [self.limb.twist, self.limb.flexion, self.limb.abduction]
        return limb, [self.forward, self.left, self.up, self.pitch, self.roll]

    def _like(self, limb: list[Jet], own: list[Jet]) -> "DevicePose":
        forward, left, up, pitch, roll = own
        return DevicePose(forward, left, up, LimbPose(*limb), self.mount, pitch, roll)


class Carry(Protocol):
    """How a device is carried: puts it on the moving body."""

    def pose(self, body: BodyMotion, rng: np.random.Generator) -> DevicePose:
        """The device's pose at the times of `body`; the same function of time for every choice of times."""
        ...


def move(body: BodyMotion, pose: DevicePose, mounted: "MountPath | None" = None) -> RigidMotion:
    """The motion of a device on a body; `mounted` replaces the fixed mount by one that changes."""
    cosine, sine = body.heading.cos(), body.heading.sin()
    turning = heading_up(body.heading + pose.limb.twist).about_y(-pose.limb.flexion).about_x(pose.limb.abduction)
    turning = turning.by(pose.mount)
    if mounted is not None:
        turning = mounted.turn(turning)
    return RigidMotion(
        time_s=body.time_s,
        east=body.east + cosine * pose.forward - sine * pose.left,
        north=body.north + sine * pose.forward + cosine * pose.left,
        up=body.up + pose.up,
        turning=turning.about_x(pose.pitch).about_y(pose.roll),
    )


@dataclass(frozen=True)
class MountPath:
    """How a hand turns a device from one mount to the next: the shortest way, with flicks of the wrist.

    way: (3,) rotation vector from mount to mount; flick: (3,) of a turn that is undone on the way, rad, device
    axes. done, flicked: shares of both over time.
    """

    way: Array
    flick: Array
    done: Jet
    flicked: Jet

    def turn(self, turning: Turning) -> Turning:
        """A turning at the first mount, turned on."""
        return turning.along(self.way, self.done).along(self.flick, self.flicked)
