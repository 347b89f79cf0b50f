"""Model of a phone held in front of the body, screen up, by somebody who reads it while walking."""

from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from pdr_est.params import NonNegative, params
from pdr_est.simulate.carrying.device_pose import DevicePose, LimbPose
from pdr_est.simulate.motion.differentiable_signal import constant_signal
from pdr_est.simulate.motion.random_signals import TREMOR_HZ, WANDER_HZ, BandlimitedNoise, BroadbandNoise
from pdr_est.simulate.walker.walking_body import BodyMotion


@params
class HeldPhone:
    """Parameters of a phone in the hand, screen up, its y axis near the walking direction."""

    mode: Literal["holding"] = "holding"
    """Name of the carrying mode."""
    tilt_rad: float = 0.6
    """Elevation of the phone's upper edge above the horizontal, rad."""
    heading_offset_rad: float = 0.0
    """Direction of the phone's y axis, rad, counter-clockwise from the walking direction."""
    forward_m: float = 0.35
    """Position ahead of the trunk's centre, m."""
    left_m: float = 0.0
    """Position to the left of the trunk's centre, m."""
    up_m: float = 0.2
    """Height above the trunk's centre, m."""
    rock_pitch_rad: NonNegative = 0.02
    """Amplitude of the pitch oscillation once a step while walking, rad."""
    rock_yaw_rad: NonNegative = 0.03
    """Amplitude of the yaw oscillation once a stride while walking, rad."""
    rock_roll_rad: NonNegative = 0.015
    """Amplitude of the roll oscillation once a stride while walking, rad."""
    wander_rad: NonNegative = 0.01
    """Root mean square of slow attitude changes about each axis, rad."""
    tremor_rad: NonNegative = 0.0005
    """Root mean square of the hand's tremor about each axis, rad, also while standing."""
    tremor_m: NonNegative = 0.00003
    """Root mean square of the hand's tremor along each axis, m, also while standing."""
    unrest_radps: NonNegative = 0.0
    """Root mean square of the irregular rotation rate about each axis while walking, rad/s; 0 for perfectly periodic
    motion.
    """
    unrest_mps2: NonNegative = 0.0
    """Root mean square of the irregular acceleration along each axis while walking, m/s^2; 0 for perfectly periodic
    motion.
    """

    def pose(self, body: BodyMotion, rng: np.random.Generator) -> DevicePose:
        """Compute the phone's pose on the body; `rng` draws the irregular motion of the hand."""
        wander = [BandlimitedNoise(self.wander_rad, WANDER_HZ, rng).at(body.time_s) for _ in range(3)]
        shake = [BandlimitedNoise(self.tremor_rad, TREMOR_HZ, rng).at(body.time_s) for _ in range(3)]
        drift = [BandlimitedNoise(self.tremor_m, TREMOR_HZ, rng).at(body.time_s) for _ in range(3)]
        turn = [body.activity * BroadbandNoise(self.unrest_radps, 1, rng).at(body.time_s) for _ in range(3)]
        jerk = [body.activity * BroadbandNoise(self.unrest_mps2, 2, rng).at(body.time_s) for _ in range(3)]
        step, stride = body.phase * (2.0 * np.pi), body.phase * np.pi
        still = constant_signal(0.0, len(body.time_s))
        return DevicePose(
            forward=drift[0] + jerk[0] + self.forward_m,
            left=drift[1] + jerk[1] + self.left_m,
            up=drift[2] + jerk[2] + self.up_m,
            limb=LimbPose(
                twist=body.activity * stride.cos() * self.rock_yaw_rad + wander[0] + shake[0] + turn[0],
                flexion=still,
                abduction=still,
            ),
            mount=self.mount(),
            pitch=body.activity * step.sin() * self.rock_pitch_rad + wander[1] + shake[1] + turn[1],
            roll=body.activity * stride.sin() * self.rock_roll_rad + wander[2] + shake[2] + turn[2],
        )

    def mount(self) -> Rotation:
        """Compute the phone's orientation in the hand."""
        facing_rad = self.heading_offset_rad - np.pi / 2.0  # the y axis, not the x axis, points ahead
        return Rotation.from_euler("ZX", [facing_rad, self.tilt_rad])
