"""Model of a phone in a front trouser pocket: on the swinging thigh, shaken by heel strikes."""

from typing import Annotated, Literal

import numpy as np
from annotated_types import Le
from scipy.spatial.transform import Rotation

from pdr_est.params import NonNegative, params
from pdr_est.simulate.carrying.device_pose import DevicePose, LimbPose
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal, oscillation_burst
from pdr_est.simulate.motion.random_signals import AMPLITUDE_HZ, WANDER_HZ, BandlimitedNoise, BroadbandNoise
from pdr_est.simulate.walker.walking_body import BodyMotion, Side

# Harmonics of the thigh's flexion over the stride from heel strike to heel strike: size over the first one, phase
# in rad. They have the shape of the hip's angle: flexed by 23 degrees at the heel strike, furthest back (16) at 0.53
# of the stride, furthest forward (26) at 0.84; so it moves back for longer than it moves forward. Higher harmonics
# and the jolts below were fitted to real pockets, as `simulate.people.person` says.
_THIGH = ((1.0, 0.267), (0.28, 2.57), (0.13, -1.29))
# Jolts behind a heel strike: how long, share of a stride, how many swings, and their phase in the middle; and their
# motion forward over that downward.
_GIVE, _SHOCK = (0.6, 1.03, 0.84), (0.17, 1.2, 1.03)
_GIVE_FORWARD, _SHOCK_FORWARD = 1.5, 0.47
_SITTING_RAD = 1.4  # flexion of the thigh of somebody who sits
_MIDDLE = 0.44  # middle of the flexion over the first harmonic


@params
class PocketPhone:
    """Parameters of a phone in a front trouser pocket (MMPDR, Fig. 1(d)).

    The angles facing_rad, spin_rad and tip_rad together reach any mount.
    """

    mode: Literal["pocket"] = "pocket"
    """Name of the carrying mode."""
    side: Side = "right"
    """Side of the pocket."""
    facing_rad: float = 2.6
    """Azimuth to which the screen points, rad, counter-clockwise from the walking direction seen from above; pi is
    against the thigh.
    """
    spin_rad: float = np.pi
    """Rotation in the plane of the screen, rad: 0 with the upper edge up, pi upside down."""
    tip_rad: float = 0.0
    """Inclination of the upper edge against the vertical, rad, away from the screen."""
    amplitude_rad: Annotated[NonNegative, Le(0.8)] = 0.33
    """Amplitude of the first harmonic of the thigh's flexion, rad; nearly half of the range of motion."""
    twist_rad: NonNegative = 0.22
    """Amplitude of the thigh's rotation about the vertical once a stride, rad."""
    spread_rad: NonNegative = 0.06
    """Amplitude of the thigh's sideways swing once a stride, rad."""
    lag: float = 0.065
    """Delay of the rotation about the vertical, as a fraction of a stride."""
    circling_rad: float = 0.07
    """Phase by which the sideways swing leads the flexion, rad. A thigh that circles rotates the phone about its long
    axis more and more.
    """
    give_m: NonNegative = 0.045
    """Size of the slow downward and forward motion as this leg takes the load, m."""
    give_rad: NonNegative = 0.03
    """Size of the slow rotation about the thigh's axes as this leg takes the load, rad."""
    shock_m: NonNegative = 0.007
    """Size of the fast downward displacement after the heel strike of this leg, m."""
    shock_rad: NonNegative = 0.06
    """Size of the fast rotation about the phone's own axes after the heel strike of this leg, rad."""
    other_leg: NonNegative = 0.3
    """Ratio of the loading and heel-strike motion caused by the other leg to that of this leg."""
    uneven: Annotated[NonNegative, Le(0.2)] = 0.12
    """Relative root mean square of the variation of the leg's motion from stride to stride."""
    from_hip_m: tuple[float, float, float] = (0.09, 0.03, -0.2)
    """Position of the phone at rest from the hip joint: forward, outward, up, m."""
    hip_left_m: NonNegative = 0.09
    """Distance of each hip joint from the body's middle, m."""
    hip_up_m: float = -0.06
    """Height of the hip joints above the trunk's centre, m."""
    wander_rad: NonNegative = 0.015
    """Root mean square of slow attitude changes in the pocket about each axis, rad."""
    unrest_radps: NonNegative = 0.14
    """Root mean square of the irregular rotation rate about each axis while walking, rad/s."""
    unrest_mps2: NonNegative = 0.2
    """Root mean square of the irregular acceleration along each axis while walking, m/s^2."""

    def pose(self, body: BodyMotion, rng: np.random.Generator) -> DevicePose:
        """Compute the phone's pose on the body; `rng` draws all irregular motion."""
        swell, jolted = (BandlimitedNoise(self.uneven, AMPLITUDE_HZ, rng).at(body.time_s) + 1.0 for _ in range(2))
        wander = [BandlimitedNoise(self.wander_rad, WANDER_HZ, rng).at(body.time_s) for _ in range(3)]
        turn = [body.activity * BroadbandNoise(self.unrest_radps, 1, rng).at(body.time_s) for _ in range(3)]
        jerk = [body.activity * BroadbandNoise(self.unrest_mps2, 2, rng).at(body.time_s) for _ in range(3)]
        outward = 1.0 if self.side == "left" else -1.0
        give, shock = self._jolt(body, _GIVE) * jolted, self._jolt(body, _SHOCK) * jolted
        thigh, rattle = self._thigh(body, swell, give * self.give_rad), shock * self.shock_rad
        ahead, out, above = self.from_hip_m
        forward, left, up = thigh.point_offset((ahead, outward * out, above))
        sunk, shaken = give * self.give_m, shock * self.shock_m
        return DevicePose(
            forward=forward + sunk * _GIVE_FORWARD + shaken * _SHOCK_FORWARD + jerk[0],
            left=left + outward * self.hip_left_m + jerk[1],
            up=up - sunk - shaken + self.hip_up_m + jerk[2],
            limb=LimbPose(thigh.twist + rattle + wander[0] + turn[0], thigh.flexion, thigh.abduction),
            mount=self.mount(),
            pitch=rattle + wander[1] + turn[1],
            roll=rattle + wander[2] + turn[2],
        )

    def _thigh(self, body: BodyMotion, swell: DifferentiableSignal, jolt: DifferentiableSignal) -> LimbPose:
        """Compute the thigh's attitude from its swing with variation `swell` and the loading motion `jolt`."""
        outward = 1.0 if self.side == "left" else -1.0
        angle = body.stride_of(self.side) * (2.0 * np.pi)
        first, *higher = ((angle * (k + 1.0) + phase).cos() * size for k, (size, phase) in enumerate(_THIGH))
        curve = first + _MIDDLE
        for harmonic in higher:
            curve = curve + harmonic
        active = body.activity * swell
        late = (angle - 2.0 * np.pi * self.lag).cos()
        flexion = active * curve * self.amplitude_rad + jolt
        if body.seated is not None:
            flexion = flexion + body.seated * _SITTING_RAD
        return LimbPose(
            # the leg turns in as it comes forward, and out under the load
            twist=active * late * (-outward * self.twist_rad) + jolt * outward,
            flexion=flexion,
            abduction=active * (angle + _THIGH[0][1] + self.circling_rad).cos() * (outward * self.spread_rad)
            + jolt * (0.5 * outward),
        )

    def _jolt(self, body: BodyMotion, shape: tuple[float, float, float]) -> DifferentiableSignal:
        """Compute the bursts of one shape after the heel strikes of both legs, 1 for this leg's, while walking."""
        other: Side = "left" if self.side == "right" else "right"
        own_leg, other_leg = (oscillation_burst(body.stride_of(side), *shape) for side in (self.side, other))
        return body.activity * (own_leg + other_leg * self.other_leg)

    def mount(self) -> Rotation:
        """Compute the phone's orientation on the hanging thigh."""
        left, up, ahead = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
        upright = Rotation.from_matrix(np.column_stack([left, up, ahead]))
        facing = Rotation.from_euler("z", self.facing_rad)
        return facing * upright * Rotation.from_euler("XZ", [-self.tip_rad, self.spin_rad])
