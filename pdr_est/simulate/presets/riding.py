"""Walks with a ride in the middle, and a way to work with several."""

from typing import Literal

from pdr_est.simulate.carrying.held_phone import HeldPhone
from pdr_est.simulate.carrying.mode_changes import CarriedPhone, ModeChange
from pdr_est.simulate.carrying.pocket_phone import PocketPhone
from pdr_est.simulate.riding.riding_body import Ride
from pdr_est.simulate.riding.vehicles import VehicleParams, bus, escalator, lift, train
from pdr_est.simulate.riding.vibration import Posture
from pdr_est.simulate.scenario import DeviceParams, Scenario
from pdr_est.simulate.walker.step_schedule import Pause, WalkerGaitParams, mean_speed_mps
from pdr_est.simulate.walker.walking_path import PathParams

Place = Literal["hand", "pocket", "seat"]

_PUT_DOWN_S = 0.5  # after the walker has stopped

# A phone that lies on a seat beside the passenger.
_LYING = HeldPhone(tilt_rad=0.0, left_m=0.5, up_m=-0.1, wander_rad=0.0, tremor_rad=0.0, tremor_m=0.0)


def riding_walk(
    vehicle: VehicleParams,
    posture: Posture = "standing",
    place: Place = "hand",
    ride_s: float = 120.0,
    walk_m: float = 20.0,
    seed: int = 0,
) -> Scenario:
    """Make a walk to a vehicle, a ride, and a walk away from it.

    Parameters
    ----------
    vehicle : VehicleParams
        What carries the walker.
    posture : Posture
        Whether the walker sits or stands.
    place : Place
        Where the phone is: in the hand, in a trouser pocket, or put on a seat for the time of the ride.
    ride_s : float
        Duration of the standstill in which the ride takes place, s.
    walk_m : float
        Length of each of the two walks, m.
    seed : int
        Seed of the walk.
    """
    gait = WalkerGaitParams(pauses=(Pause(at_m=walk_m, duration_s=ride_s),))
    arrival_s = gait.lead_in_s + walk_m / mean_speed_mps(gait) + 3.0  # a second or two into the standstill
    carry: CarriedPhone = PocketPhone() if place == "pocket" else HeldPhone()
    changes: tuple[ModeChange, ...] = ()
    if place == "seat":
        put_down_s = arrival_s + _PUT_DOWN_S
        changes = (
            ModeChange(start_s=put_down_s, carry=_LYING),
            ModeChange(start_s=arrival_s + ride_s - 5.0, carry=HeldPhone()),
        )
    return Scenario(
        name=f"ride_{vehicle.name}",
        path=PathParams(vertices_m=((0.0, 0.0), (2.0 * walk_m, 0.0))),
        gait=gait,
        devices=(DeviceParams(carry=carry, changes=changes),),
        rides=(Ride(pause=0, vehicle=vehicle, posture="rigid" if place == "seat" else posture),),
        seed=seed,
    )


def commute() -> Scenario:
    """Make a way to work: down in a lift, a bus, an escalator, a train, and walks between them."""
    pauses = (
        Pause(at_m=30.0, duration_s=30.0),
        Pause(at_m=110.0, duration_s=180.0),
        Pause(at_m=150.0, duration_s=30.0),
        Pause(at_m=190.0, duration_s=240.0),
    )
    rides = (
        Ride(pause=0, vehicle=lift()),
        Ride(pause=1, vehicle=bus()),
        Ride(pause=2, vehicle=escalator()),
        Ride(pause=3, vehicle=train(), posture="sitting"),
    )
    corners = ((0.0, 0.0), (50.0, 0.0), (50.0, 130.0), (120.0, 130.0))
    return Scenario(
        name="commute",
        path=PathParams(vertices_m=corners),
        gait=WalkerGaitParams(pauses=pauses),
        rides=rides,
    )
