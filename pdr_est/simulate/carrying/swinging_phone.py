"""Model of a phone in a hand that hangs beside the body and swings with the arm."""

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from annotated_types import Le
from scipy.spatial.transform import Rotation

from pdr_est.params import NonNegative, Positive, params
from pdr_est.simulate.carrying.device_pose import DevicePose, LimbPose
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal, constant_signal
from pdr_est.simulate.motion.random_signals import AMPLITUDE_HZ, WANDER_HZ, BandlimitedNoise, BroadbandNoise
from pdr_est.simulate.walker.walking_body import BodyMotion, Side


@params
class SwingingPhone:
    """Parameters of a phone in a hanging hand, palm towards the thigh, screen away from the palm (MMPDR, Fig. 1(c)).

    At rest the x axis is vertical, up in the right hand and down in the left one, and the y axis points forward.
    """

    mode: Literal["swing"] = "swing"
    """Name of the carrying mode."""
    hand: Side = "right"
    """Hand that holds the phone."""
    grip_rad: float = 0.1
    """Angle of the y axis below the walking direction, rad."""
    palm_rad: float = 0.1
    """Rotation of the palm towards the rear, rad."""
    tip_rad: float = 0.0
    """Rotation of the screen upwards about the y axis, rad."""
    amplitude_rad: Annotated[NonNegative, Le(1.0)] = 0.22
    """Amplitude of the upper arm's swing about the shoulder, rad."""
    forward_rad: float = 0.0
    """Mean angle of the upper arm ahead of hanging, rad."""
    elbow_rad: Annotated[NonNegative, Le(1.0)] = 0.13
    """Amplitude of the elbow's flexion, rad; the elbow bends as the arm comes forward."""
    bend_rad: NonNegative = 0.4
    """Mean flexion of the elbow, rad."""
    lag: float = 0.14
    """Delay of the arm's foremost position after the heel strike of the opposite leg, as a fraction of a stride."""
    second: NonNegative = 0.015
    """Ratio of the second harmonic of the swing to the first; it makes the forward and backward swing differ."""
    third: float = 0.015
    """Ratio of the third harmonic of the swing to the first; it makes the turns at both ends quicker."""
    twist_rad: NonNegative = 0.12
    """Amplitude of the forearm's rotation about the vertical, rad."""
    spread_rad: NonNegative = 0.04
    """Amplitude of the arm's sideways swing, rad."""
    upper_m: Positive = 0.29
    """Length of the upper arm from shoulder to elbow, m."""
    fore_m: Positive = 0.34
    """Length from elbow to phone, m."""
    shoulder_left_m: NonNegative = 0.22
    """Distance of each shoulder from the body's middle, m."""
    shoulder_up_m: float = 0.42
    """Height of the shoulders above the trunk's centre, m."""
    uneven: Annotated[NonNegative, Le(0.2)] = 0.06
    """Relative root mean square of the variation of the swing from stride to stride."""
    wander_rad: NonNegative = 0.02
    """Root mean square of slow attitude changes about each axis, rad."""
    unrest_radps: NonNegative = 0.25
    """Root mean square of the irregular rotation rate about each axis while walking, rad/s."""
    unrest_mps2: NonNegative = 0.3
    """Root mean square of the irregular acceleration along each axis while walking, m/s^2."""

    def pose(self, body: BodyMotion, rng: np.random.Generator) -> DevicePose:
        """Compute the phone's pose on the body; `rng` draws all irregular motion."""
        swell = BandlimitedNoise(self.uneven, AMPLITUDE_HZ, rng).at(body.time_s) + 1.0
        wander = [BandlimitedNoise(self.wander_rad, WANDER_HZ, rng).at(body.time_s) for _ in range(3)]
        turn = [body.activity * BroadbandNoise(self.unrest_radps, 1, rng).at(body.time_s) for _ in range(3)]
        jerk = [body.activity * BroadbandNoise(self.unrest_mps2, 2, rng).at(body.time_s) for _ in range(3)]
        outward = 1.0 if self.hand == "left" else -1.0
        beat = self._beat(body) * swell
        upper_arm, forearm = self._arm(body, beat, outward)
        elbow = upper_arm.point_offset((0.0, 0.0, -self.upper_m))
        forward, left, up = (
            joint + beyond
            for joint, beyond in zip(elbow, forearm.point_offset((0.0, 0.0, -self.fore_m)), strict=True)
        )
        # the palm turns in as the arm comes forward; the phone is on the forearm's axis and stays where it is
        twist = beat * (-outward * self.twist_rad)
        return DevicePose(
            forward=forward + jerk[0],
            left=left + outward * self.shoulder_left_m + jerk[1],
            up=up + self.shoulder_up_m + jerk[2],
            limb=replace(forearm, twist=twist + wander[0] + turn[0]),
            mount=self._mount(),
            pitch=wander[1] + turn[1],
            roll=wander[2] + turn[2],
        )

    def _beat(self, body: BodyMotion) -> DifferentiableSignal:
        """Compute the rhythm of the arm: near 1 foremost, near -1 hindmost, 0 when standing."""
        across: Side = "left" if self.hand == "right" else "right"
        angle = (body.stride_of(across) - self.lag) * (2.0 * np.pi)
        return body.activity * (angle.cos() + (angle * 2.0).cos() * self.second + (angle * 3.0).cos() * self.third)

    def _arm(self, body: BodyMotion, beat: DifferentiableSignal, outward: float) -> tuple[LimbPose, LimbPose]:
        """Compute the attitudes of upper arm and forearm."""
        none = constant_signal(0.0, len(body.time_s))
        spread = beat * (-outward * self.spread_rad)
        shoulder = beat * self.amplitude_rad + body.activity * self.forward_rad
        elbow = beat * self.elbow_rad + body.activity * self.bend_rad
        return LimbPose(none, shoulder, spread), LimbPose(none, shoulder + elbow, spread)

    def _mount(self) -> Rotation:
        """Compute the phone's orientation in the hanging hand."""
        inward = 1.0 if self.hand == "right" else -1.0
        up, ahead, screen = (0.0, 0.0, inward), (1.0, 0.0, 0.0), (0.0, inward, 0.0)
        hanging = Rotation.from_matrix(np.column_stack([up, ahead, screen]))
        palm = Rotation.from_euler("z", inward * self.palm_rad)
        return palm * hanging * Rotation.from_euler("ZY", [inward * self.grip_rad, inward * self.tip_rad])
