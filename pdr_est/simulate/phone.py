"""A phone held in front of the body. Other ways to carry one are files beside this one with the same method."""

from typing import Literal, Protocol

import numpy as np

from pdr_est.params import NonNegative, params
from pdr_est.simulate.body import BodyMotion
from pdr_est.simulate.rigid_body import RigidMotion
from pdr_est.simulate.tremor import Tremor

_WANDER_HZ = (0.02, 0.25)
_TREMOR_HZ = (4.0, 10.0)


class Carry(Protocol):
    """How a device is carried: turns the motion of the trunk into that of the device."""

    def motion(self, body: BodyMotion, rng: np.random.Generator) -> RigidMotion:
        """The device's motion at the times of `body`; the same function of time for every choice of times."""
        ...


@params
class HeldPhone:
    """A phone in the hand, screen up, its y axis near the walking direction.

    tilt_rad: how far the upper edge is lifted above the horizontal. heading_offset_rad: where the y axis points,
    counter-clockwise from the walking direction. forward_m, left_m, up_m: from the trunk's centre.
    rock_pitch_rad: amplitude of nodding once a step; rock_yaw_rad, rock_roll_rad: of turning and leaning once a
    stride, all while walking. wander_rad: rms of slow changes of the attitude about each axis. tremor_rad,
    tremor_m: rms of the fast unrest of the hand, each axis, standing too.
    """

    mode: Literal["holding"] = "holding"
    tilt_rad: float = 0.6
    heading_offset_rad: float = 0.0
    forward_m: float = 0.35
    left_m: float = 0.0
    up_m: float = 0.2
    rock_pitch_rad: NonNegative = 0.02
    rock_yaw_rad: NonNegative = 0.03
    rock_roll_rad: NonNegative = 0.015
    wander_rad: NonNegative = 0.01
    tremor_rad: NonNegative = 0.0005
    tremor_m: NonNegative = 0.00003

    def motion(self, body: BodyMotion, rng: np.random.Generator) -> RigidMotion:
        """The phone's motion at the times of `body`; `rng` draws the hand's unrest."""
        wander = [Tremor(self.wander_rad, _WANDER_HZ, rng).at(body.time_s) for _ in range(3)]
        shake = [Tremor(self.tremor_rad, _TREMOR_HZ, rng).at(body.time_s) for _ in range(3)]
        drift = [Tremor(self.tremor_m, _TREMOR_HZ, rng).at(body.time_s) for _ in range(3)]
        step, stride = body.phase * (2.0 * np.pi), body.phase * np.pi
        forward_east, forward_north = body.heading.cos(), body.heading.sin()
        facing = self.heading_offset_rad - np.pi / 2.0  # the y axis, not the x axis, points ahead
        return RigidMotion(
            time_s=body.time_s,
            east=body.east + forward_east * self.forward_m - forward_north * self.left_m + drift[0],
            north=body.north + forward_north * self.forward_m + forward_east * self.left_m + drift[1],
            up=body.up + self.up_m + drift[2],
            yaw=body.heading + facing + body.activity * stride.cos() * self.rock_yaw_rad + wander[0] + shake[0],
            pitch=body.activity * step.sin() * self.rock_pitch_rad + self.tilt_rad + wander[1] + shake[1],
            roll=body.activity * stride.sin() * self.rock_roll_rad + wander[2] + shake[2],
        )
