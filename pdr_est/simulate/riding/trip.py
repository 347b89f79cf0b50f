"""Trip of a vehicle: speed and stops over time, and the route."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PPoly

from pdr_est.frames import Array
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal, evaluate_curve, quintic_curve
from pdr_est.simulate.riding.vehicles import VehicleParams
from pdr_est.simulate.walker.walking_path import PathParams, WalkingPath

_PEAK_OF_MEAN = 1.875  # greatest over mean rate of a quintic from rest to rest


@dataclass(frozen=True)
class TripMotion:
    """Motion of a vehicle at sampled times, in axes that begin where it departs, x in its direction there.

    Attributes
    ----------
    ahead, left, up : DifferentiableSignal
        Position, m.
    turn : DifferentiableSignal
        Turn since the departure, rad, counter-clockwise, continuous.
    speed_share : DifferentiableSignal
        Speed over that between stops, 0 to 1.
    """

    ahead: DifferentiableSignal
    left: DifferentiableSignal
    up: DifferentiableSignal
    turn: DifferentiableSignal
    speed_share: DifferentiableSignal


class Trip:
    """Motion of a vehicle over a time, as an exact function of it.

    Parameters
    ----------
    vehicle : VehicleParams
        The vehicle.
    start_s, end_s : float
        Departure and arrival, s.
    rng : numpy.random.Generator
        Source of the route's turns.
    """

    def __init__(self, vehicle: VehicleParams, start_s: float, end_s: float, rng: np.random.Generator) -> None:
        self._vehicle = vehicle
        self._share, self._way_share = _speed_shares(vehicle, start_s, end_s)
        self._way = self._way_share.antiderivative()
        self._begin = float(self._way(start_s))
        length_m = (float(self._way(end_s)) - self._begin) * vehicle.speed_mps
        self._route = WalkingPath(_route(vehicle, length_m * np.cos(vehicle.grade_rad), rng))

    def at(self, time_s: Array) -> TripMotion:
        """Compute the motion at times (n,), s; the vehicle stands before and after the trip."""
        way = (evaluate_curve(self._way, time_s) - self._begin) * self._vehicle.speed_mps
        ahead, left, turn = self._route.follow(way * float(np.cos(self._vehicle.grade_rad)))
        up = way * float(np.sin(self._vehicle.grade_rad))
        return TripMotion(ahead, left, up, turn, evaluate_curve(self._share, time_s))


def _speed_shares(vehicle: VehicleParams, start_s: float, end_s: float) -> tuple[PPoly, PPoly]:
    """Compute the speed over that between stops, over time: without and with the sign of the direction."""
    cycle_s = vehicle.leg_s + vehicle.stop_s
    legs = max(int((end_s - start_s + vehicle.stop_s) // cycle_s), 1)
    leg_s = (end_s - start_s - (legs - 1) * vehicle.stop_s) / legs
    rise_s, fall_s = (
        min(_PEAK_OF_MEAN * vehicle.speed_mps / limit, 0.5 * leg_s)
        for limit in (vehicle.acceleration_mps2, vehicle.braking_mps2)
    )
    time_s, share, signed = [start_s - 3600.0], [0.0], [0.0]
    for leg in range(legs):
        begin_s = start_s + leg * (leg_s + vehicle.stop_s)
        # A short leg does not reach the full speed.
        top = min(rise_s, fall_s) / (_PEAK_OF_MEAN * vehicle.speed_mps)
        top = min(1.0, top * max(vehicle.acceleration_mps2, vehicle.braking_mps2))
        time_s += [begin_s, begin_s + rise_s, begin_s + leg_s - fall_s, begin_s + leg_s]
        share += [0.0, top, top, 0.0]
        signed += [0.0] + [-top if vehicle.returns and leg % 2 else top] * 2 + [0.0]
    columns = np.array([[*time_s, end_s + 36000.0], [*share, 0.0], [*signed, 0.0]])
    # Legs without a stop, or without a time at full speed, have two equal times.
    kept = np.concatenate([[True], np.diff(columns[0]) > 1e-6])
    columns = columns[:, kept]
    still = np.zeros(columns.shape[1])
    return quintic_curve(columns[0], columns[1], still), quintic_curve(columns[0], columns[2], still)


def _route(vehicle: VehicleParams, length_m: float, rng: np.random.Generator) -> PathParams:
    """Draw a route: legs of equal length with turns to either side, or none, and no corner at the beginning."""
    corners = int(max(length_m, 0.0) // vehicle.corner_m) if vehicle.corner_rad else 0
    turns = vehicle.corner_rad * rng.integers(-1, 2, corners)
    headings = np.concatenate([[0.0], np.cumsum(turns)])
    # A leg more than needed: the last corner is behind the arrival, and the length of the corners does not matter.
    legs_m = np.full(corners + 1, vehicle.corner_m)
    legs_m[-1] += max(length_m, 0.0)
    ends = np.cumsum(legs_m[:, None] * np.stack([np.cos(headings), np.sin(headings)], axis=1), axis=0)
    vertices = tuple((float(x), float(y)) for x, y in np.concatenate([np.zeros((1, 2)), ends]))
    return PathParams(vertices_m=vertices, corner_radius_m=vehicle.corner_radius_m)
