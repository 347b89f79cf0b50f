"""Changes of the carrying mode: a hand takes the phone from one place on the body to the next."""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from pydantic import Field
from scipy.spatial.transform import Rotation

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.params import Fraction, NonNegative, params
from pdr_est.simulate.carrying.device_pose import CarryingModel, DevicePose, MountTransition, device_motion
from pdr_est.simulate.carrying.held_phone import HeldPhone
from pdr_est.simulate.carrying.pocket_phone import PocketPhone
from pdr_est.simulate.carrying.swinging_phone import SwingingPhone
from pdr_est.simulate.motion.attitude_signal import concatenate_attitudes
from pdr_est.simulate.motion.differentiable_signal import (
    DifferentiableSignal,
    concatenate_signals,
    evaluate_curve,
    quintic_curve,
)
from pdr_est.simulate.motion.rigid_body import RigidMotion
from pdr_est.simulate.walker.walking_body import BodyMotion, WalkingBody
from pdr_est.types.ground_truth import TrueModes
from pdr_est.types.steps import CarryingMode

CarriedPhone = Annotated[HeldPhone | SwingingPhone | PocketPhone, Field(discriminator="mode")]

_MODES = {"holding": CarryingMode.HOLDING, "swing": CarryingMode.SWING, "pocket": CarryingMode.POCKET}


@params
class ModeChange:
    """Parameters of a movement of the hand that takes the phone to another place."""

    start_s: NonNegative
    """Start of the movement on the true clock, s."""
    carry: CarriedPhone
    """Carrying model from then on."""
    duration_s: Annotated[float, Ge(0.3), Le(5.0)] = 1.2
    """Duration of the movement, s."""
    turn_from: Fraction = 0.15
    """Fraction of the duration at which the hand starts to rotate the phone; its position moves all the time."""
    turn_to: Fraction = 0.8
    """Fraction of the duration at which the rotation ends."""
    detour_m: tuple[float, float, float] = (0.08, 0.0, 0.03)
    """Largest distance of the hand from the straight line between both places: forward, left, up, m."""
    flick_rad: tuple[float, float, float] = (0.2, 0.4, 0.4)
    """Rotation of the wrist about the phone's x, y and z axes, rad, that is undone during the movement."""

    @property
    def end_s(self) -> float:
        """Return the time at which the phone is in its new place, s."""
        return self.start_s + self.duration_s


@dataclass(frozen=True)
class _CarryingInterval:
    """Carrying model and the interval (s) in which it takes part; intervals overlap in the mode changes."""

    carry: CarryingModel
    begin_s: float
    end_s: float


def sideways_gravity(before: Rotation, after: Rotation, flick_rad: tuple[float, float, float]) -> float:
    """Compute the largest share of gravity along the phone's x axis while a hand turns it to another mount.

    Parameters
    ----------
    before, after : Rotation
        Orientations of the phone, device to body, at both ends.
    flick_rad : tuple of float
        Rotation of the wrist about the phone's axes that is undone on the way, rad.
    """
    share = np.linspace(0.0, 1.0, 21)
    turn = Rotation.from_rotvec(np.outer(share, (before.inv() * after).as_rotvec()))
    flick = Rotation.from_rotvec(np.outer(4.0 * share * (1.0 - share), flick_rad))
    upwards = (before * turn * flick).inv().apply([0.0, 0.0, 1.0])
    return float(np.abs(upwards[:, 0]).max())


def check_mode_changes(name: str, changes: tuple[ModeChange, ...]) -> None:
    """Raise ConfigError if the mode changes of a device overlap or have turn_from after turn_to."""
    for change in changes:
        if not change.turn_from < change.turn_to:
            raise ConfigError(
                f"scenario device {name}: turn_from {change.turn_from} to turn_to {change.turn_to}: swap the shares"
            )
    for one, other in pairwise(changes):
        if other.start_s < one.end_s:
            raise ConfigError(
                f"scenario device {name}: the mode change at {other.start_s} s begins before the one at "
                f"{one.start_s} s ends ({one.end_s} s): start it later"
            )


def true_modes(first: CarriedPhone, changes: tuple[ModeChange, ...]) -> TrueModes:
    """Compute the true carrying modes over time; the mode is TRANS while the hand moves the phone."""
    starts_s, modes = [0.0], [_MODES[first.mode]]
    for change in changes:
        starts_s += [change.start_s, change.end_s]
        modes += [CarryingMode.TRANS, _MODES[change.carry.mode]]
    return TrueModes(np.array(starts_s), np.array(modes, dtype=np.int8))


def carried_motion(
    body: WalkingBody,
    time_s: Array,
    first: CarriedPhone,
    changes: tuple[ModeChange, ...],
    rngs: list[np.random.Generator],
) -> RigidMotion:
    """Compute the motion of a carried device.

    Parameters
    ----------
    body : WalkingBody
        The walking body that carries it.
    time_s : Array
        Ascending times, (n,), s.
    first : CarriedPhone
        Carrying model at the start.
    changes : tuple of ModeChange
        Mode changes in order of time.
    rngs : list of numpy.random.Generator
        One generator for each carrying model, in order of time.
    """
    trunk = body.at(time_s)
    stays = _carrying_intervals(first, changes)
    parts = [_between(time_s, stay.begin_s, stay.end_s) for stay in stays]
    changing = [_between(time_s, change.start_s, change.end_s) for change in changes]
    poses = [stay.carry.pose(trunk.select(part), rng) for stay, part, rng in zip(stays, parts, rngs, strict=True)]

    pieces = []
    for number, (part, pose) in enumerate(zip(parts, poses, strict=True)):
        alone = slice(
            changing[number - 1].stop if number > 0 else part.start,
            changing[number].start if number < len(changes) else part.stop,
        )
        pieces.append(device_motion(trunk.select(alone), pose.select(_from(alone, part.start))))
        if number < len(changes):
            both = changing[number]
            old, new = pose.select(_from(both, part.start)), poses[number + 1].select(_from(both, both.start))
            pieces.append(_transfer_motion(trunk.select(both), old, new, changes[number]))
    return _joined([piece for piece in pieces if len(piece.time_s)])


def _carrying_intervals(first: CarriedPhone, changes: tuple[ModeChange, ...]) -> list[_CarryingInterval]:
    carries: list[CarryingModel] = [first, *(change.carry for change in changes)]
    begins = [-np.inf, *(change.start_s for change in changes)]
    ends = [*(change.end_s for change in changes), np.inf]
    return [_CarryingInterval(*stay) for stay in zip(carries, begins, ends, strict=True)]


def _transfer_motion(trunk: BodyMotion, old: DevicePose, new: DevicePose, change: ModeChange) -> RigidMotion:
    """Compute the motion while a hand takes the phone from its old pose to its new one."""
    turn_from_s = change.start_s + change.turn_from * change.duration_s
    turn_to_s = change.start_s + change.turn_to * change.duration_s
    path = MountTransition(
        rotation_vector=(old.mount.inv() * new.mount).as_rotvec(),
        flick=np.array(change.flick_rad),
        progress=_smooth_step_signal(trunk.time_s, turn_from_s, turn_to_s),
        flick_progress=_smooth_bump(trunk.time_s, turn_from_s, turn_to_s),
    )
    aside = _smooth_bump(trunk.time_s, change.start_s, change.end_s)
    straight = old.interpolate(new, _smooth_step_signal(trunk.time_s, change.start_s, change.end_s))
    forward_m, left_m, up_m = change.detour_m
    hand = replace(
        straight,
        forward=straight.forward + aside * forward_m,
        left=straight.left + aside * left_m,
        up=straight.up + aside * up_m,
    )
    return device_motion(trunk, hand, path)


def _smooth_step_signal(time_s: Array, begin_s: float, end_s: float) -> DifferentiableSignal:
    """Rise from 0 to 1 between two times with continuous acceleration."""
    still = np.zeros(4)
    outer_s = np.array([begin_s - 1.0, begin_s, end_s, end_s + 1.0])
    return evaluate_curve(quintic_curve(outer_s, np.array([0.0, 0.0, 1.0, 1.0]), still), time_s)


def _smooth_bump(time_s: Array, begin_s: float, end_s: float) -> DifferentiableSignal:
    """Rise from 0 to 1 in the middle between two times and fall back, with continuous acceleration."""
    rise = _smooth_step_signal(time_s, begin_s, end_s)
    return rise * (-rise + 1.0) * 4.0


def _between(time_s: Array, begin_s: float, end_s: float) -> slice:
    """Find the range of samples between two times."""
    first, last = np.searchsorted(time_s, [begin_s, end_s])
    return slice(int(first), int(last))


def _from(part: slice, start: int) -> slice:
    """Count a range of samples from another origin."""
    return slice(part.start - start, part.stop - start)


def _joined(pieces: list[RigidMotion]) -> RigidMotion:
    """Join consecutive pieces of one motion."""
    return RigidMotion(
        time_s=np.concatenate([piece.time_s for piece in pieces]),
        east=concatenate_signals([piece.east for piece in pieces]),
        north=concatenate_signals([piece.north for piece in pieces]),
        up=concatenate_signals([piece.up for piece in pieces]),
        attitude=concatenate_attitudes([piece.attitude for piece in pieces]),
    )
