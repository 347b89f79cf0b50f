"""A phone in a hand that hangs beside the body and swings with the arm."""

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from annotated_types import Le
from scipy.spatial.transform import Rotation

from pdr_est.params import NonNegative, Positive, params
from pdr_est.simulate.carrying.device_pose import DevicePose, LimbPose
from pdr_est.simulate.motion.differentiable_signal import Jet, constant
from pdr_est.simulate.motion.tremor import AMPLITUDE_HZ, WANDER_HZ, Tremor, Unrest
from pdr_est.simulate.walker.trunk import BodyMotion, Side


@params
class SwingingPhone:
    """A phone in a hanging hand, palm towards the thigh, screen away from the palm: MMPDR Fig. 1(c).

    At rest the x axis is vertical, up in the right hand and down in the left one, and the y axis points ahead.
    hand: which one. grip_rad: how far the y axis points below ahead. palm_rad: how far the palm is turned to
    face backwards. tip_rad: how far the screen is turned up about the y axis.
    amplitude_rad, forward_rad: of the upper arm's swing about the shoulder, and its middle ahead of hanging.
    elbow_rad, bend_rad: the same of the elbow, which bends as the arm comes forward. The arm is foremost when the
    leg of the other side strikes, lag of a stride later. second: amplitude of the second harmonic over the first;
    it makes the way forward differ from the way back. twist_rad, spread_rad: amplitudes about the vertical and
    sideways. upper_m, fore_m: from shoulder to elbow to phone; shoulder_left_m: of the left shoulder, the right one
    opposite; shoulder_up_m: above the trunk's centre. uneven: relative rms of the changes from stride to stride.
    wander_rad: rms of slow changes of the attitude about each axis. unrest_radps, unrest_mps2: rms of the irregular
    rotation and acceleration about and along each axis while walking.
    """

    mode: Literal["swing"] = "swing"
    hand: Side = "right"
    grip_rad: float = 0.1
    palm_rad: float = 0.1
    tip_rad: float = 0.0
    amplitude_rad: Annotated[NonNegative, Le(1.0)] = 0.22
    forward_rad: float = 0.0
    elbow_rad: Annotated[NonNegative, Le(1.0)] = 0.18
    bend_rad: NonNegative = 0.25
    lag: float = 0.05
    second: NonNegative = 0.08
    twist_rad: NonNegative = 0.12
    spread_rad: NonNegative = 0.04
    upper_m: Positive = 0.29
    fore_m: Positive = 0.34
    shoulder_left_m: NonNegative = 0.22
    shoulder_up_m: float = 0.42
    uneven: Annotated[NonNegative, Le(0.2)] = 0.06
    wander_rad: NonNegative = 0.02
    unrest_radps: NonNegative = 0.25
    unrest_mps2: NonNegative = 0.3

    def pose(self, body: BodyMotion, rng: np.random.Generator) -> DevicePose:
        """The phone on the body; `rng` draws how uneven the swing is and the hand's unrest."""
        swell = Tremor(self.uneven, AMPLITUDE_HZ, rng).at(body.time_s) + 1.0
        wander = [Tremor(self.wander_rad, WANDER_HZ, rng).at(body.time_s) for _ in range(3)]
        turn = [body.activity * Unrest(self.unrest_radps, 1, rng).at(body.time_s) for _ in range(3)]
        jerk = [body.activity * Unrest(self.unrest_mps2, 2, rng).at(body.time_s) for _ in range(3)]
        outward = 1.0 if self.hand == "left" else -1.0
        beat = self._beat(body) * swell
        upper_arm, forearm = self._arm(body, beat, outward)
        elbow = upper_arm.point((0.0, 0.0, -self.upper_m))
        forward, left, up = (
            joint + beyond for joint, beyond in zip(elbow, forearm.point((0.0, 0.0, -self.fore_m)), strict=True)
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

    def _beat(self, body: BodyMotion) -> Jet:
        """The rhythm of the arm: near 1 where it is foremost, near -1 where it is hindmost, 0 when standing."""
        across: Side = "left" if self.hand == "right" else "right"
        angle = (body.stride_of(across) - self.lag) * (2.0 * np.pi)
        return body.activity * (angle.cos() + (angle * 2.0).cos() * self.second)

    def _arm(self, body: BodyMotion, beat: Jet, outward: float) -> tuple[LimbPose, LimbPose]:
        """Upper arm and forearm."""
        none = constant(0.0, len(body.time_s))
        spread = beat * (-outward * self.spread_rad)
        shoulder = beat * self.amplitude_rad + body.activity * self.forward_rad
        elbow = beat * self.elbow_rad + body.activity * self.bend_rad
        return LimbPose(none, shoulder, spread), LimbPose(none, shoulder + elbow, spread)

    def _mount(self) -> Rotation:
        inward = 1.0 if self.hand == "right" else -1.0
        up, ahead, screen = (0.0, 0.0, inward), (1.0, 0.0, 0.0), (0.0, inward, 0.0)
        hanging = Rotation.from_matrix(np.column_stack([up, ahead, screen]))
        palm = Rotation.from_euler("z", inward * self.palm_rad)
        return palm * hanging * Rotation.from_euler("ZY", [inward * self.grip_rad, inward * self.tip_rad])
