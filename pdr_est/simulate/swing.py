"""A phone in a hand that hangs beside the body and swings with the arm."""

from typing import Annotated, Literal

import numpy as np
from annotated_types import Le
from scipy.spatial.transform import Rotation

from pdr_est.params import NonNegative, Positive, params
from pdr_est.simulate.body import BodyMotion, Side
from pdr_est.simulate.jet import Jet, constant
from pdr_est.simulate.pose import DevicePose, LimbPose
from pdr_est.simulate.tremor import AMPLITUDE_HZ, TREMOR_HZ, WANDER_HZ, Tremor


@params
class SwingingPhone:
    """A phone in a hanging hand, palm towards the thigh, screen away from the palm: MMPDR Fig. 1(c).

    At rest the x axis is vertical, up in the right hand and down in the left one, and the y axis points ahead.
    hand: which one. grip_rad: how far the y axis points below ahead. palm_rad: how far the palm is turned to
    face backwards. tip_rad: how far the screen is turned up about the y axis.
    amplitude_rad, forward_rad: of the arm's swing about the shoulder, and its middle ahead of hanging; the arm is
    foremost when the leg of the other side strikes, lag of a stride later. wrist: rotation of elbow and
    wrist over that of the shoulder. second: amplitude of the second harmonic over the first; it makes the way
    forward differ from the way back. twist_rad, spread_rad: amplitudes about the vertical and sideways.
    arm_m: from shoulder to phone; shoulder_left_m: of the left shoulder, the right one opposite; shoulder_up_m:
    above the trunk's centre. uneven: relative rms of the amplitude's slow changes.
    wander_rad, tremor_rad, tremor_m: as of a held phone.
    """

    mode: Literal["swing"] = "swing"
    hand: Side = "right"
    grip_rad: float = 0.1
    palm_rad: float = 0.1
    tip_rad: float = 0.0
    amplitude_rad: Annotated[NonNegative, Le(1.2)] = 0.32
    forward_rad: float = 0.18
    lag: float = 0.03
    wrist: NonNegative = 0.25
    second: NonNegative = 0.08
    twist_rad: NonNegative = 0.12
    spread_rad: NonNegative = 0.04
    arm_m: Positive = 0.62
    shoulder_left_m: NonNegative = 0.22
    shoulder_up_m: float = 0.42
    uneven: Annotated[NonNegative, Le(0.2)] = 0.06
    wander_rad: NonNegative = 0.02
    tremor_rad: NonNegative = 0.002
    tremor_m: NonNegative = 0.0001

    def pose(self, body: BodyMotion, rng: np.random.Generator) -> DevicePose:
        """The phone on the body; `rng` draws how uneven the swing is and the hand's unrest."""
        swell = Tremor(self.uneven, AMPLITUDE_HZ, rng).at(body.time_s) + 1.0
        wander = [Tremor(self.wander_rad, WANDER_HZ, rng).at(body.time_s) for _ in range(3)]
        shake = [Tremor(self.tremor_rad, TREMOR_HZ, rng).at(body.time_s) for _ in range(3)]
        drift = [Tremor(self.tremor_m, TREMOR_HZ, rng).at(body.time_s) for _ in range(3)]
        swing, twist, spread = self._swing(body, swell)
        arm = LimbPose(constant(0.0, len(body.time_s)), swing, spread)
        forward, left, up = arm.point((0.0, 0.0, -self.arm_m))
        outward = 1.0 if self.hand == "left" else -1.0
        return DevicePose(
            forward=forward + drift[0],
            left=left + outward * self.shoulder_left_m + drift[1],
            up=up + self.shoulder_up_m + drift[2],
            limb=LimbPose(
                twist=twist + wander[0] + shake[0],
                flexion=swing * (1.0 + self.wrist),
                abduction=spread,
            ),
            mount=self._mount(),
            pitch=wander[1] + shake[1],
            roll=wander[2] + shake[2],
        )

    def _swing(self, body: BodyMotion, swell: Jet) -> tuple[Jet, Jet, Jet]:
        """Angles of the arm: forward, about the vertical, to the left."""
        across: Side = "left" if self.hand == "right" else "right"
        angle = (body.stride_of(across) - self.lag) * (2.0 * np.pi)
        active = body.activity * swell
        swing = active * (angle.cos() + (angle * 2.0).cos() * self.second) * self.amplitude_rad
        inward = 1.0 if self.hand == "right" else -1.0
        return (
            swing + body.activity * self.forward_rad,
            active * angle.cos() * (inward * self.twist_rad),  # the palm turns in as the arm comes forward
            active * angle.cos() * (inward * self.spread_rad),
        )

    def _mount(self) -> Rotation:
        inward = 1.0 if self.hand == "right" else -1.0
        up, ahead, screen = (0.0, 0.0, inward), (1.0, 0.0, 0.0), (0.0, inward, 0.0)
        hanging = Rotation.from_matrix(np.column_stack([up, ahead, screen]))
        palm = Rotation.from_euler("z", inward * self.palm_rad)
        return palm * hanging * Rotation.from_euler("ZY", [inward * self.grip_rad, inward * self.tip_rad])
