"""A phone in a front trouser pocket: on the thigh, which swings about the hip and is shaken by heel strikes."""

from typing import Annotated, Literal

import numpy as np
from annotated_types import Le
from scipy.spatial.transform import Rotation

from pdr_est.params import NonNegative, params
from pdr_est.simulate.carrying.device_pose import DevicePose, LimbPose
from pdr_est.simulate.motion.differentiable_signal import Jet, pulse
from pdr_est.simulate.motion.tremor import AMPLITUDE_HZ, WANDER_HZ, Tremor, Unrest
from pdr_est.simulate.walker.trunk import BodyMotion, Side

# Harmonics of the thigh's flexion over the stride from heel strike to heel strike: size over the first one, phase
# in rad. They follow the usual shape of the hip's angle: 20 degrees flexed at the heel strike, furthest back (11) at
# 0.54 of the stride, furthest forward (22) at 0.88; so it moves back for longer than it moves forward.
_THIGH = ((1.0, 0.267), (0.2, 2.537), (0.08, -1.557))
# Jolts behind a heel strike: how long, share of a stride, how many swings, and their phase in the middle.
_GIVE, _SHOCK = (0.5, 1.3, -np.pi / 2.0), (0.25, 2.0, 0.0)
_MIDDLE = 0.44  # middle of the flexion over the first harmonic


@params
class PocketPhone:
    """A phone in a front pocket: MMPDR Fig. 1(d).

    side: of the pocket. facing_rad: where the screen points, counter-clockwise from ahead, seen from above; pi is
    against the thigh. spin_rad: turn in the plane of the screen, 0 with the upper edge up, pi upside down.
    tip_rad: how far the upper edge leans out of the vertical, away from the screen. Together they reach any mount.
    amplitude_rad: of the thigh's first harmonic, half of its range nearly. twist_rad, spread_rad: amplitudes
    about the vertical and sideways, once a stride. lag: of the twist, share of a stride. circling_rad: phase of the
    sideways swing before the flexion; a thigh that circles turns the phone about its long axis, on and on.
    give_m, give_rad: size of the slow jolt as this leg takes the load, downwards and about the thigh's axes.
    shock_m, shock_rad: of the fast jolt of its heel strike, in which the phone rattles about its own axes.
    other_leg: jolts of the other leg over these. uneven: relative rms of the changes of all these from stride to
    stride.
    from_hip_m: of the phone at rest from the hip joint, forward, outward, up. hip_left_m: of the left hip, the
    right one opposite; hip_up_m: above the trunk's centre. wander_rad: slow shifting in the pocket. unrest_radps,
    unrest_mps2: rms of the irregular rotation and acceleration about and along each axis while walking.
    """

    mode: Literal["pocket"] = "pocket"
    side: Side = "right"
    facing_rad: float = 2.6
    spin_rad: float = np.pi
    tip_rad: float = 0.0
    amplitude_rad: Annotated[NonNegative, Le(0.8)] = 0.37
    twist_rad: NonNegative = 0.22
    spread_rad: NonNegative = 0.06
    lag: float = 0.065
    circling_rad: float = 0.07
    give_m: NonNegative = 0.024
    give_rad: NonNegative = 0.06
    shock_m: NonNegative = 0.005
    shock_rad: NonNegative = 0.04
    other_leg: NonNegative = 0.3
    uneven: Annotated[NonNegative, Le(0.2)] = 0.12
    from_hip_m: tuple[float, float, float] = (0.09, 0.03, -0.2)
    hip_left_m: NonNegative = 0.09
    hip_up_m: float = -0.06
    wander_rad: NonNegative = 0.015
    unrest_radps: NonNegative = 0.35
    unrest_mps2: NonNegative = 0.8

    def pose(self, body: BodyMotion, rng: np.random.Generator) -> DevicePose:
        """The phone on the body; `rng` draws how uneven the leg's motion is and the phone's shifting."""
        swell, jolted = (Tremor(self.uneven, AMPLITUDE_HZ, rng).at(body.time_s) + 1.0 for _ in range(2))
        wander = [Tremor(self.wander_rad, WANDER_HZ, rng).at(body.time_s) for _ in range(3)]
        turn = [body.activity * Unrest(self.unrest_radps, 1, rng).at(body.time_s) for _ in range(3)]
        jerk = [body.activity * Unrest(self.unrest_mps2, 2, rng).at(body.time_s) for _ in range(3)]
        outward = 1.0 if self.side == "left" else -1.0
        give, shock = self._jolt(body, _GIVE) * jolted, self._jolt(body, _SHOCK) * jolted
        thigh, rattle = self._thigh(body, swell, give * self.give_rad), shock * self.shock_rad
        ahead, out, above = self.from_hip_m
        forward, left, up = thigh.point((ahead, outward * out, above))
        jolt = give * self.give_m + shock * self.shock_m
        return DevicePose(
            forward=forward + jolt + jerk[0],
            left=left + outward * self.hip_left_m + jerk[1],
            up=up - jolt + self.hip_up_m + jerk[2],
            limb=LimbPose(thigh.twist + rattle + wander[0] + turn[0], thigh.flexion, thigh.abduction),
            mount=self._mount(),
            pitch=rattle + wander[1] + turn[1],
            roll=rattle + wander[2] + turn[2],
        )

    def _thigh(self, body: BodyMotion, swell: Jet, jolt: Jet) -> LimbPose:
        outward = 1.0 if self.side == "left" else -1.0
        angle = body.stride_of(self.side) * (2.0 * np.pi)
        first, *higher = ((angle * (k + 1.0) + phase).cos() * size for k, (size, phase) in enumerate(_THIGH))
        curve = first + _MIDDLE
        for harmonic in higher:
            curve = curve + harmonic
        active = body.activity * swell
        late = (angle - 2.0 * np.pi * self.lag).cos()
        return LimbPose(
            # the leg turns in as it comes forward, and out under the load
            twist=active * late * (-outward * self.twist_rad) + jolt * outward,
            flexion=active * curve * self.amplitude_rad + jolt,
            abduction=active * (angle + _THIGH[0][1] + self.circling_rad).cos() * (outward * self.spread_rad)
            + jolt * (0.5 * outward),
        )

    def _jolt(self, body: BodyMotion, shape: tuple[float, float, float]) -> Jet:
        """The jolts of one kind behind the heel strikes of both legs, 1 for this leg's, while walking."""
        other: Side = "left" if self.side == "right" else "right"
        own_leg, other_leg = (pulse(body.stride_of(side), *shape) for side in (self.side, other))
        return body.activity * (own_leg + other_leg * self.other_leg)

    def _mount(self) -> Rotation:
        left, up, ahead = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
        upright = Rotation.from_matrix(np.column_stack([left, up, ahead]))
        facing = Rotation.from_euler("z", self.facing_rad)
        return facing * upright * Rotation.from_euler("XZ", [-self.tip_rad, self.spin_rad])
