"""Changes of the carrying mode: a hand that takes a phone from one place on the body to the next."""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from pydantic import Field

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.params import Fraction, NonNegative, params
from pdr_est.simulate.carrying.device_pose import Carry, DevicePose, MountPath, move
from pdr_est.simulate.carrying.held import HeldPhone
from pdr_est.simulate.carrying.pocket import PocketPhone
from pdr_est.simulate.carrying.swinging import SwingingPhone
from pdr_est.simulate.motion.differentiable_signal import Jet, jet_of, joined, smooth_curve
from pdr_est.simulate.motion.rigid_body import RigidMotion
from pdr_est.simulate.motion.rotation import joined_turnings
from pdr_est.simulate.walker.trunk import Body, BodyMotion
from pdr_est.types.ground_truth import TrueModes
from pdr_est.types.steps import CarryingMode

AnyPhone = Annotated[HeldPhone | SwingingPhone | PocketPhone, Field(discriminator="mode")]

_MODES = {"holding": CarryingMode.HOLDING, "swing": CarryingMode.SWING, "pocket": CarryingMode.POCKET}


@params
class ModeChange:
    """The hand takes the phone to another place.

    start_s, duration_s: when, on the true clock. carry: how the phone is carried from then on. turn_from, turn_to:
    shares of the duration between which the hand turns the phone; the position moves all the time. detour_m: how
    far out of the straight line, forward, left, up, the hand passes. flick_rad: how far the wrist turns the phone,
    about its own x, y and z axes, and back again on the way.
    """

    start_s: NonNegative
    carry: AnyPhone
    duration_s: Annotated[float, Ge(0.3), Le(5.0)] = 1.2
    turn_from: Fraction = 0.15
    turn_to: Fraction = 0.8
    detour_m: tuple[float, float, float] = (0.08, 0.0, 0.03)
    flick_rad: tuple[float, float, float] = (0.2, 0.4, 0.4)

    @property
    def end_s(self) -> float:
        """When the phone is in its new place."""
        return self.start_s + self.duration_s


@dataclass(frozen=True)
class _Stay:
    """One way of carrying with the interval, s, that it has a part in; the changes at its ends overlap others."""

    carry: Carry
    begin_s: float
    end_s: float


def check_changes(name: str, changes: tuple[ModeChange, ...]) -> None:
    """Raise ConfigError if the changes of a device are out of order or turn the phone backwards in time."""
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


def true_modes(first: AnyPhone, changes: tuple[ModeChange, ...]) -> TrueModes:
    """The carrying modes over time, TRANS while the hand moves the phone."""
    starts_s, modes = [0.0], [_MODES[first.mode]]
    for change in changes:
        starts_s += [change.start_s, change.end_s]
        modes += [CarryingMode.TRANS, _MODES[change.carry.mode]]
    return TrueModes(np.array(starts_s), np.array(modes, dtype=np.int8))


def carried_motion(
    body: Body, time_s: Array, first: AnyPhone, changes: tuple[ModeChange, ...], rngs: list[np.random.Generator]
) -> RigidMotion:
    """The device's motion at rising times (n,). rngs: one for each way of carrying, in order of time."""
    trunk = body.at(time_s)
    stays = _stays(first, changes)
    parts = [_between(time_s, stay.begin_s, stay.end_s) for stay in stays]
    changing = [_between(time_s, change.start_s, change.end_s) for change in changes]
    poses = [stay.carry.pose(trunk.part(part), rng) for stay, part, rng in zip(stays, parts, rngs, strict=True)]

    pieces = []
    for number, (part, pose) in enumerate(zip(parts, poses, strict=True)):
        alone = slice(
            changing[number - 1].stop if number > 0 else part.start,
            changing[number].start if number < len(changes) else part.stop,
        )
        pieces.append(move(trunk.part(alone), pose.part(_from(alone, part.start))))
        if number < len(changes):
            both = changing[number]
            old, new = pose.part(_from(both, part.start)), poses[number + 1].part(_from(both, both.start))
            pieces.append(_taken(trunk.part(both), old, new, changes[number]))
    return _joined([piece for piece in pieces if len(piece.time_s)])


def _stays(first: AnyPhone, changes: tuple[ModeChange, ...]) -> list[_Stay]:
    carries: list[Carry] = [first, *(change.carry for change in changes)]
    begins = [-np.inf, *(change.start_s for change in changes)]
    ends = [*(change.end_s for change in changes), np.inf]
    return [_Stay(*stay) for stay in zip(carries, begins, ends, strict=True)]


def _taken(trunk: BodyMotion, old: DevicePose, new: DevicePose, change: ModeChange) -> RigidMotion:
    """The motion while a hand takes the phone from its old pose to its new one."""
    turn_from_s = change.start_s + change.turn_from * change.duration_s
    turn_to_s = change.start_s + change.turn_to * change.duration_s
    path = MountPath(
        way=(old.mount.inv() * new.mount).as_rotvec(),
        flick=np.array(change.flick_rad),
        done=_rise(trunk.time_s, turn_from_s, turn_to_s),
        flicked=_bump(trunk.time_s, turn_from_s, turn_to_s),
    )
    aside = _bump(trunk.time_s, change.start_s, change.end_s)
    straight = old.blended(new, _rise(trunk.time_s, change.start_s, change.end_s))
    forward_m, left_m, up_m = change.detour_m
    hand = replace(
        straight,
        forward=straight.forward + aside * forward_m,
        left=straight.left + aside * left_m,
        up=straight.up + aside * up_m,
    )
    return move(trunk, hand, path)


def _rise(time_s: Array, begin_s: float, end_s: float) -> Jet:
    """From 0 to 1 with continuous acceleration."""
    still = np.zeros(4)
    outer_s = np.array([begin_s - 1.0, begin_s, end_s, end_s + 1.0])
    return jet_of(smooth_curve(outer_s, np.array([0.0, 0.0, 1.0, 1.0]), still), time_s)


def _bump(time_s: Array, begin_s: float, end_s: float) -> Jet:
    """From 0 to 1 half-way and back, with continuous acceleration."""
    rise = _rise(time_s, begin_s, end_s)
    return rise * (-rise + 1.0) * 4.0


def _between(time_s: Array, begin_s: float, end_s: float) -> slice:
    first, last = np.searchsorted(time_s, [begin_s, end_s])
    return slice(int(first), int(last))


def _from(part: slice, start: int) -> slice:
    return slice(part.start - start, part.stop - start)


def _joined(pieces: list[RigidMotion]) -> RigidMotion:
    return RigidMotion(
        time_s=np.concatenate([piece.time_s for piece in pieces]),
        east=joined([piece.east for piece in pieces]),
        north=joined([piece.north for piece in pieces]),
        up=joined([piece.up for piece in pieces]),
        turning=joined_turnings([piece.turning for piece in pieces]),
    )
