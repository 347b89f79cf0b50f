"""The moving trunk of a walker who rides during some of the pauses of the walk."""

from dataclasses import fields, replace
from typing import Annotated

import numpy as np
from annotated_types import Ge
from scipy.interpolate import PPoly

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.params import params
from pdr_est.simulate.motion.differentiable_signal import (
    DifferentiableSignal,
    concatenate_signals,
    constant_signal,
    evaluate_curve,
    quintic_curve,
)
from pdr_est.simulate.riding.trip import Trip
from pdr_est.simulate.riding.vehicles import VehicleParams
from pdr_est.simulate.riding.vibration import PassengerVibration, Posture, Vibration
from pdr_est.simulate.walker.step_schedule import SETTLE_S, StepSchedule
from pdr_est.simulate.walker.walking_body import BodyMotion, BodyParams, WalkingBody
from pdr_est.simulate.walker.walking_path import WalkingPath

_SIT_DOWN_S = 1.5  # from standing to sitting
_BOARD_S = SETTLE_S + _SIT_DOWN_S + 0.5  # from the last step to the departure, and from the arrival to the next step
_SEAT_M = 0.4  # by which a sitting trunk is lower
LEAST_RIDE_S = 2.0 * _BOARD_S + 4.0


@params
class Ride:
    """A ride during a pause of the walk; the walker faces the direction of the vehicle."""

    pause: Annotated[int, Ge(0)]
    """Number of the pause, from 0; it lasts at least `LEAST_RIDE_S`."""
    vehicle: VehicleParams
    """What carries the walker."""
    posture: Posture = "standing"
    """Whether the walker sits or stands; "rigid" for a phone that lies on a seat or sits in a holder."""


class RidingBody(WalkingBody):
    """Motion of the trunk of a walker who rides, as an exact function of time.

    What the walker does after a ride is where the vehicle brought it: all later motion is shifted and turned by the
    trip. The points of the path and its length stay those of the walk alone.

    Parameters
    ----------
    path, steps, height_m, parameters
        As for `WalkingBody`.
    rides : tuple of Ride
        Rides in order of the pauses.
    rngs : list of numpy.random.Generator
        One generator for each ride.

    Raises
    ------
    ConfigError
        If a ride has no pause, or one that is too short.
    """

    def __init__(
        self,
        path: WalkingPath,
        steps: StepSchedule,
        height_m: float,
        parameters: BodyParams,
        rides: tuple[Ride, ...],
        rngs: list[np.random.Generator],
    ) -> None:
        super().__init__(path, steps, height_m, parameters)
        spans_s = [_span_s(ride, steps) for ride in rides]
        self._rides = [
            _RideMotion(ride, *span_s, *self._stop_at(span_s[0]), rng)
            for ride, span_s, rng in zip(rides, spans_s, rngs, strict=True)
        ]
        self.ride_spans_s = tuple(spans_s)

    def at(self, time_s: Array) -> BodyMotion:
        """Compute the motion at times (n,), s."""
        body = super().at(time_s)
        for ride in reversed(self._rides):  # a later trip begins on the ground that the earlier ones moved
            body = ride.carried(body)
        return body

    def on_path_at(self, time_s: Array) -> tuple[Array, Array]:
        """Compute position (n, 2), m, and direction (n,), rad, of the point beside the trunk, moved by the trips."""
        time_s = np.asarray(time_s, dtype=np.float64)
        position_m, heading_rad = super().on_path_at(time_s)
        for ride in reversed(self._rides):
            position_m, heading_rad = ride.moved(time_s, position_m, heading_rad)
        return position_m, heading_rad

    def _stop_at(self, time_s: float) -> tuple[Array, float]:
        position_m, heading_rad = super().on_path_at(np.array([time_s]))
        return position_m[0], float(heading_rad[0])


class _RideMotion:
    """A trip from a point of the path in a direction, and the vibration on it."""

    def __init__(
        self, ride: Ride, start_s: float, end_s: float, pivot_m: Array, facing_rad: float, rng: np.random.Generator
    ) -> None:
        self._pivot_m, self._facing_rad = pivot_m, facing_rad
        self._trip = Trip(ride.vehicle, start_s, end_s, rng)
        self._vibration = PassengerVibration(ride.vehicle, ride.posture, rng)
        self._aboard = _switch(start_s - _SIT_DOWN_S, start_s, end_s, end_s + _SIT_DOWN_S)
        self._sits = ride.posture == "sitting"

    def carried(self, body: BodyMotion) -> BodyMotion:
        """Carry the body along."""
        trip, aboard = self._trip.at(body.time_s), evaluate_curve(self._aboard, body.time_s)
        shaken = self._shaken(body.time_s, trip.speed_share, aboard)
        east, north = self._ground(trip.ahead, trip.left, None)
        shaken_east, shaken_north = self._ground(shaken.forward, shaken.left, trip.turn)
        cosine, sine = trip.turn.cos(), trip.turn.sin()
        from_east, from_north = body.east - float(self._pivot_m[0]), body.north - float(self._pivot_m[1])
        up = body.up + trip.up + shaken.up
        seated = body.seated
        if self._sits:
            up = up - aboard * _SEAT_M
            seated = aboard if seated is None else seated + aboard
        pitch, roll = body.lean or (shaken.pitch * 0.0, shaken.roll * 0.0)
        return replace(
            body,
            east=east + shaken_east + cosine * from_east - sine * from_north,
            north=north + shaken_north + sine * from_east + cosine * from_north,
            up=up,
            heading=body.heading + trip.turn,
            seated=seated,
            lean=(pitch + shaken.pitch, roll + shaken.roll),
        )

    def _shaken(self, time_s: Array, speed_share: DifferentiableSignal, aboard: DifferentiableSignal) -> Vibration:
        """Compute the vibration, which is zero before and after the ride: many tones need not be summed up there."""
        first, last = np.searchsorted(time_s, [self._aboard.x[1], self._aboard.x[-2]])
        part = slice(int(first), int(last))
        during = self._vibration.at(time_s[part], speed_share[part], aboard[part])
        before, after = constant_signal(0.0, part.start), constant_signal(0.0, len(time_s) - part.stop)
        names = (field.name for field in fields(Vibration))
        return Vibration(*(concatenate_signals([before, getattr(during, name), after]) for name in names))

    def moved(self, time_s: Array, position_m: Array, heading_rad: Array) -> tuple[Array, Array]:
        """Move points (n, 2), m, and directions (n,), rad, at times (n,), s, along with the vehicle."""
        trip = self._trip.at(time_s)
        east, north = self._ground(trip.ahead, trip.left, None)
        cosine, sine = np.cos(trip.turn.value), np.sin(trip.turn.value)
        x, y = (position_m - self._pivot_m).T
        moved = np.stack([east.value + cosine * x - sine * y, north.value + sine * x + cosine * y], axis=1)
        return moved, heading_rad + trip.turn.value

    def _ground(
        self, ahead: DifferentiableSignal, left: DifferentiableSignal, turn: DifferentiableSignal | None
    ) -> tuple[DifferentiableSignal, DifferentiableSignal]:
        """Turn axes of the vehicle into east and north; without a turn, those of the departure, from the stop."""
        if turn is None:
            c, s = float(np.cos(self._facing_rad)), float(np.sin(self._facing_rad))
            east, north = float(self._pivot_m[0]), float(self._pivot_m[1])
            return ahead * c - left * s + east, ahead * s + left * c + north
        cosine, sine = (turn + self._facing_rad).cos(), (turn + self._facing_rad).sin()
        return cosine * ahead - sine * left, sine * ahead + cosine * left


def _span_s(ride: Ride, steps: StepSchedule) -> tuple[float, float]:
    """Find departure and arrival, s, of a ride."""
    bouts = steps.bouts
    if ride.pause + 1 >= len(bouts):
        raise ConfigError(f"ride {ride.vehicle.name} in pause {ride.pause}: the walk has {len(bouts) - 1} pauses")
    start_s, end_s = (
        float(steps.time_s[bouts[ride.pause].stop - 1]),
        float(steps.start_s[bouts[ride.pause + 1].start]),
    )
    if end_s - start_s < LEAST_RIDE_S:
        raise ConfigError(
            f"ride {ride.vehicle.name} in pause {ride.pause}: the pause lasts {end_s - start_s:g} s, a ride needs "
            f"{LEAST_RIDE_S:g} s at least"
        )
    return start_s + _BOARD_S, end_s - _BOARD_S


def _switch(*edge_s: float) -> PPoly:
    """Rise from 0 to 1 between the first two times and fall back between the last two, with smooth acceleration."""
    before, after = edge_s[0] - 1.0, edge_s[-1] + 1.0
    return quintic_curve(np.array([before, *edge_s, after]), np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0]), np.zeros(6))
