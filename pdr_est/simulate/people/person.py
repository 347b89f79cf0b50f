"""People differ: height, gender, gait, and how they hold, swing, pocket and move their phone."""

from dataclasses import replace
from typing import Literal

import numpy as np

from pdr_est.params import params
from pdr_est.simulate.carrying.held_phone import HeldPhone
from pdr_est.simulate.carrying.mode_changes import CarriedPhone, ModeChange, sideways_gravity
from pdr_est.simulate.carrying.pocket_phone import PocketPhone
from pdr_est.simulate.carrying.swinging_phone import SwingingPhone
from pdr_est.simulate.walker.step_schedule import WalkerGaitParams
from pdr_est.simulate.walker.walking_body import BodyParams, Side

_MEAN_HEIGHT_M = {"male": 1.75, "female": 1.62}
_USUAL_CADENCE_HZ = 1.85
_MOST_FLICK_RAD = 1.5  # about the y axis; no wrist and forearm turn further and back in half of a second
_TIPPED_TO = 0.03  # as near to the drawn share of gravity a flick brings the phone, if one does


@params
class SimulatedPerson:
    """Gait, trunk motion and carrying models of one walker."""

    gait: WalkerGaitParams
    """Steps of this person."""
    body: BodyParams
    """Motion of this person's trunk."""
    held: HeldPhone
    """Model of the phone in the hand, in front of the body."""
    swing: SwingingPhone
    """Model of the phone in the swinging hand."""
    pocket: PocketPhone
    """Model of the phone in the trouser pocket."""
    change_s: float
    """Usual duration of moving the phone to another place, s."""

    def change(
        self, before: CarriedPhone, carry: CarriedPhone, start_s: float, rng: np.random.Generator
    ) -> ModeChange:
        """Draw a mode change of this person; each one differs a little.

        The pose of the phone in a pocket differs a little each time, too. The flicks of the wrist are such that the
        fastest rotation of most changes is above the threshold of MMPDR section IV-B, and that of a few below. On its
        way from the hand into a pocket the phone is tipped sideways as far as real ones are.

        Parameters
        ----------
        before, carry : CarriedPhone
            Carrying models before and after the change.
        start_s : float
            Start of the change on the true clock, s.
        rng : numpy.random.Generator
            Source of the differences.
        """
        if isinstance(carry, PocketPhone):
            carry = replace(
                carry,
                facing_rad=carry.facing_rad + 0.15 * _normal(rng),
                spin_rad=carry.spin_rad + 0.1 * _normal(rng),
                tip_rad=carry.tip_rad + 0.05 * _normal(rng),
            )
        turn_share = rng.uniform(0.45, 0.65)  # the wrist turns the phone in about half of the time
        turn_from = rng.uniform(0.1, 0.85 - turn_share)
        return ModeChange(
            start_s=start_s,
            carry=carry,
            duration_s=float(np.clip(self.change_s * rng.uniform(0.85, 1.15), 0.8, 1.6)),
            turn_from=turn_from,
            turn_to=turn_from + turn_share,
            detour_m=(0.08 + 0.03 * _normal(rng), 0.03 * _normal(rng), 0.03 + 0.03 * _normal(rng)),
            flick_rad=_flick(before, carry, rng),
        )


def sample_person(rng: np.random.Generator) -> SimulatedPerson:
    """Draw an adult at random; what does not differ between people keeps its default."""
    gender: Literal["male", "female"] = "male" if rng.random() < 0.5 else "female"
    height_m = _MEAN_HEIGHT_M[gender] + 0.065 * _normal(rng)
    # tall people take fewer steps a second: the leg is a pendulum
    cadence_hz = _USUAL_CADENCE_HZ * np.sqrt(1.7 / height_m) * (1.0 + 0.06 * _normal(rng))
    briskness = cadence_hz / _USUAL_CADENCE_HZ
    size = height_m / 1.73
    return SimulatedPerson(
        gait=_gait(gender, height_m, cadence_hz, rng),
        body=_body(rng),
        held=_held(size, rng),
        swing=_swing(size, briskness, rng),
        pocket=_pocket(size, briskness, rng),
        change_s=rng.uniform(0.9, 1.45),
    )


def _gait(
    gender: Literal["male", "female"], height_m: float, cadence_hz: float, rng: np.random.Generator
) -> WalkerGaitParams:
    return WalkerGaitParams(
        height_m=height_m,
        gender=gender,
        cadence_hz=cadence_hz,
        length_habit=1.0 + 0.05 * _normal(rng),
        cadence_variation=rng.uniform(0.012, 0.03),
        length_variation=rng.uniform(0.015, 0.04),
        cadence_drift=rng.uniform(0.01, 0.03),
        length_drift=rng.uniform(0.005, 0.02),
        boundary_step_share=rng.uniform(0.5, 0.75),
        first_foot="R" if rng.random() < 0.5 else "L",
        lead_in_s=rng.uniform(2.0, 4.0),
        lead_out_s=rng.uniform(1.5, 3.0),
    )


def _body(rng: np.random.Generator) -> BodyParams:
    return BodyParams(
        bounce_share=rng.uniform(0.6, 1.2),
        impact=(rng.uniform(0.15, 0.45), rng.uniform(0.05, 0.18)),
        speed_ripple=rng.uniform(0.04, 0.09),
        sway_m=rng.uniform(0.01, 0.028),
    )


def _held(size: float, rng: np.random.Generator) -> HeldPhone:
    return HeldPhone(
        tilt_rad=rng.uniform(0.0, 1.0),
        heading_offset_rad=0.06 * _normal(rng),
        forward_m=size * rng.uniform(0.28, 0.42),
        left_m=rng.uniform(-0.12, 0.12),
        up_m=size * rng.uniform(0.1, 0.3),
        rock_pitch_rad=rng.uniform(0.01, 0.06),
        rock_yaw_rad=rng.uniform(0.02, 0.05),
        rock_roll_rad=rng.uniform(0.01, 0.03),
        wander_rad=rng.uniform(0.01, 0.04),
        unrest_radps=rng.uniform(0.1, 0.25),
        unrest_mps2=rng.uniform(0.4, 1.0),
    )


def _swing(size: float, briskness: float, rng: np.random.Generator) -> SwingingPhone:
    """Draw how an arm swings: from a little to a lot, and the less it swings, the less smoothly.

    Real arms accelerate a phone forward by 9 m/s^2 once a stride and by 0.05 to 0.12 of that twice a stride
    (phone-gps, four walks of one person), by 5 m/s^2 and 0.17 of it (fm2 of `walks`) or by 2 m/s^2 and 0.39 of it
    (Oxford steps), because what happens twice a stride is mostly the trunk's. The ranges of size and shape were found
    by search: simulated people cover these numbers, the vertical acceleration of the same walks, and the steps that
    MMPDR's detector counts in them, 0.97 to 1.05 of those taken.
    """
    amplitude_rad = max(0.14, briskness**2 * rng.uniform(0.14, 0.36))  # less is a hand that hangs
    return SwingingPhone(
        hand=_side(rng),
        grip_rad=0.1 + 0.15 * _normal(rng),
        palm_rad=0.1 + 0.15 * _normal(rng),
        tip_rad=0.12 * _normal(rng),
        amplitude_rad=amplitude_rad,
        forward_rad=0.05 * _normal(rng),
        elbow_rad=amplitude_rad * rng.uniform(0.4, 0.8),
        bend_rad=rng.uniform(0.25, 0.55),
        lag=rng.uniform(0.1, 0.18),
        second=rng.uniform(0.0, 0.02),
        third=0.012 + 0.07 * amplitude_rad**2,
        twist_rad=rng.uniform(0.05, 0.2),
        spread_rad=rng.uniform(0.02, 0.07),
        upper_m=size * 0.29,
        fore_m=size * 0.34,
        shoulder_left_m=size * 0.22,
        shoulder_up_m=size * 0.42,
        unrest_radps=rng.uniform(0.15, 0.35),
        unrest_mps2=rng.uniform(0.15, 0.35),
    )


def _pocket(size: float, briskness: float, rng: np.random.Generator) -> PocketPhone:
    """Draw a pocket and the leg beneath it; a calm leg swings less and strikes the floor more softly.

    Fitted by search to 16 people of MotionSense: median, 15th and 85th percentile of the first six harmonics of the
    acceleration along the phone's y and z axes and the vertical, of the rotation rate by harmonics and of what is not
    periodic, the mean cosine of the tilt (0.952 to 0.993), and the steps that MMPDR's detector counts along +z and -z
    (0.54 to 1.17 of those taken). The length model `harmonic`, fitted to real walks, finds simulated steps as long as
    they are. One simulated person in ten loses half of the steps to MMPDR's detector, as both people with a pocket
    in OxIOD do, two of 18. Of 30 people with a phone in a pocket nobody had it sideways, and one in three upright.
    """
    side = _side(rng)
    outward = 1.0 if side == "left" else -1.0
    against_thigh = rng.random() < 0.6
    facing_rad = outward * rng.uniform(0.0, 0.9) + (np.pi if against_thigh else 0.0)
    calm = rng.random()
    jolt = briskness**2 * (1.1 - 0.5 * calm)
    return PocketPhone(
        side=side,
        facing_rad=facing_rad,
        spin_rad=float(rng.choice([0.0, np.pi, np.pi])) + 0.15 * _normal(rng),
        tip_rad=0.12 * _normal(rng),
        amplitude_rad=briskness * (0.41 - 0.28 * calm**2),
        twist_rad=rng.uniform(0.13, 0.35),
        spread_rad=rng.uniform(0.03, 0.12),
        lag=rng.uniform(0.0, 0.13),
        circling_rad=0.07 + 0.3 * _normal(rng.spawn(1)[0]),  # a stream of its own: the other draws stay
        give_m=0.054 * jolt,
        give_rad=0.04 * jolt,
        shock_m=0.0086 * jolt,
        shock_rad=0.1 * jolt,
        other_leg=rng.uniform(0.04, 0.12),
        from_hip_m=(size * 0.09, size * rng.uniform(0.0, 0.06), size * rng.uniform(-0.24, -0.14)),
        hip_left_m=size * 0.09,
        unrest_radps=0.2 * jolt,
        unrest_mps2=0.25 * jolt,
    )


def _flick(before: CarriedPhone, carry: CarriedPhone, rng: np.random.Generator) -> tuple[float, float, float]:
    """Draw the flick of the wrist: out of a pocket in the plane of the screen, otherwise about the forearm."""
    about_x, about_y, about_z = (0.3 * _normal(rng) for _ in range(3))
    turned_rad = rng.uniform(0.6, 1.4) * rng.choice([-1.0, 1.0])
    if isinstance(before, PocketPhone):
        return about_x, about_y, about_z + turned_rad
    flick_rad = about_x, about_y + 0.6 * turned_rad, about_z
    if isinstance(before, HeldPhone) and isinstance(carry, PocketPhone):
        return _tipped(before, carry, flick_rad, rng.spawn(1)[0])  # a stream of its own: the other draws stay
    return flick_rad


def _tipped(
    before: HeldPhone, carry: PocketPhone, flick_rad: tuple[float, float, float], rng: np.random.Generator
) -> tuple[float, float, float]:
    """Change the flick about the y axis until the phone is tipped sideways as far as on its way into a real pocket.

    In ten recordings of four people (Oxford steps, hyperimu of `walks`, Sensor Logger) at most 0.58 to 0.86 of
    gravity are along the x axis meanwhile, mean 0.73 and standard deviation 0.1.
    """
    about_x, about_y, about_z = flick_rad
    wanted = 0.73 + 0.1 * _normal(rng)
    mounts = before.mount(), carry.mount()
    others = np.linspace(-_MOST_FLICK_RAD, _MOST_FLICK_RAD, 61)
    off = [abs(sideways_gravity(*mounts, (about_x, other, about_z)) - wanted) for other in others]
    near = [float(other) for other, by in zip(others, off, strict=True) if by < _TIPPED_TO]
    chosen = min(near, key=lambda other: abs(other - about_y)) if near else float(others[int(np.argmin(off))])
    return about_x, chosen, about_z


def _side(rng: np.random.Generator) -> Side:
    return "right" if rng.random() < 0.8 else "left"


def _normal(rng: np.random.Generator) -> float:
    """Draw a standard normal number cut at 2.5, so that nobody is a giant."""
    return float(np.clip(rng.standard_normal(), -2.5, 2.5))
