"""A phone held in front of the body, screen up, as one who reads it while walking."""

from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from pdr_est.params import NonNegative, params
from pdr_est.simulate.carrying.device_pose import DevicePose, LimbPose
from pdr_est.simulate.motion.differentiable_signal import constant
from pdr_est.simulate.motion.tremor import TREMOR_HZ, WANDER_HZ, Tremor, Unrest
from pdr_est.simulate.walker.trunk import BodyMotion


@params
class HeldPhone:
    """A phone in the hand, screen up, its y axis near the walking direction.

    tilt_rad: how far the upper edge is lifted above the horizontal. heading_offset_rad: where the y axis points,
    counter-clockwise from the walking direction. forward_m, left_m, up_m: from the trunk's centre.
    rock_pitch_rad: amplitude of nodding once a step; rock_yaw_rad, rock_roll_rad: of turning and leaning once a
    stride, all while walking. wander_rad: rms of slow changes of the attitude about each axis. tremor_rad,
    tremor_m: rms of the fast unrest of the hand, each axis, standing too. unrest_radps, unrest_mps2: rms of the
    irregular rotation and acceleration about and along each axis while walking; 0 for a hand that walks like a clock.
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
    unrest_radps: NonNegative = 0.0
    unrest_mps2: NonNegative = 0.0

    def pose(self, body: BodyMotion, rng: np.random.Generator) -> DevicePose:
        """The phone on the body; `rng` draws the hand's unrest."""
        wander = [Tremor(self.wander_rad, WANDER_HZ, rng).at(body.time_s) for _ in range(3)]
        shake = [Tremor(self.tremor_rad, TREMOR_HZ, rng).at(body.time_s) for _ in range(3)]
        drift = [Tremor(self.tremor_m, TREMOR_HZ, rng).at(body.time_s) for _ in range(3)]
        turn = [body.activity * Unrest(self.unrest_radps, 1, rng).at(body.time_s) for _ in range(3)]
        jerk = [body.activity * Unrest(self.unrest_mps2, 2, rng).at(body.time_s) for _ in range(3)]
        step, stride = body.phase * (2.0 * np.pi), body.phase * np.pi
        still = constant(0.0, len(body.time_s))
        facing_rad = self.heading_offset_rad - np.pi / 2.0  # the y axis, not the x axis, points ahead
        return DevicePose(
            forward=drift[0] + jerk[0] + self.forward_m,
            left=drift[1] + jerk[1] + self.left_m,
            up=drift[2] + jerk[2] + self.up_m,
            limb=LimbPose(
                twist=body.activity * stride.cos() * self.rock_yaw_rad + wander[0] + shake[0] + turn[0],
                flexion=still,
                abduction=still,
            ),
            mount=Rotation.from_euler("ZX", [facing_rad, self.tilt_rad]),
            pitch=body.activity * step.sin() * self.rock_pitch_rad + wander[1] + shake[1] + turn[1],
            roll=body.activity * stride.sin() * self.rock_roll_rad + wander[2] + shake[2] + turn[2],
        )
