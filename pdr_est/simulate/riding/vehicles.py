"""Vehicles, lifts and escalators: how they drive, and how they shake.

The unevenness of roads and the springs of the car are published; every other value is ours, chosen as typical, except
where its vehicle says what it was measured on.
"""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Annotated

from annotated_types import Ge, Gt, Le

from pdr_est.params import NonNegative, Positive, params


@params
class SuspensionParams:
    """Parameters of a body on springs above a wheel or bogie on springs, all over the mass of the body."""

    spring_ps2: Positive = 63.3
    """Stiffness of the body's springs, 1/s^2. The default values are those of the quarter of a car with which
    programs compute the International Roughness Index (Sayers, Gillespie and Queiroz 1986): the body bounces at 1.2
    Hz, the wheel at 11 Hz.
    """
    damper_ps: Positive = 6.0
    """Damping between body and wheel, 1/s."""
    tyre_ps2: Positive = 653.0
    """Stiffness below the wheel (tyres, or the primary springs of a bogie), 1/s^2."""
    wheel_share: Positive = 0.15
    """Mass of the wheels or bogies as a share of that of the body."""


@params
class VehicleParams:
    """Drive and vibration of something that carries a passenger."""

    name: str
    """Name, for messages."""
    speed_mps: Positive
    """Speed between two stops, m/s, along the way."""
    acceleration_mps2: Positive
    """Greatest acceleration along the way, m/s^2."""
    braking_mps2: Positive
    """Greatest deceleration along the way, m/s^2."""
    leg_s: Positive
    """Time from one departure to the next stop, s, about."""
    stop_s: NonNegative
    """Time at a stop, with open doors, s."""
    grade_rad: Annotated[float, Ge(0.0), Le(1.6)] = 0.0
    """Slope of the way, rad: half a turn over two (pi / 2) for a lift."""
    returns: bool = False
    """True for a vehicle that goes back on every other leg, as a lift does."""
    corner_m: Positive = 500.0
    """Length of way between two corners, m."""
    corner_radius_m: Positive = 100.0
    """Least radius of a corner, m."""
    corner_rad: Annotated[float, Ge(0.0), Le(1.6)] = 0.0
    """Turn at a corner, rad, to either side or none."""
    suspension: SuspensionParams | None = None
    """Suspension; None for a lift or an escalator, which `smooth_mps2` shakes alone."""
    roughness_m3: NonNegative = 0.0
    """Spectral density of the road's height at 0.1 cycles per metre, m^3 (ISO 8608)."""
    sideways_share: NonNegative = 0.6
    """Sideways vibration over the vertical one at full speed, both as root mean square."""
    lengthways_share: NonNegative = 0.4
    """Lengthways vibration over the vertical one at full speed, both as root mean square."""
    sway_hz: Positive = 0.9
    """Frequency at which the body sways sideways, Hz."""
    rock_radps: NonNegative = 0.0
    """Root mean square of the rates of pitching and rolling at full speed, rad/s."""
    smooth_mps2: NonNegative = 0.0
    """Root mean square of the vibration of guides, chains and motors at full speed, m/s^2, along each axis."""
    engine_mps2: NonNegative = 0.0
    """Root mean square of the vertical vibration of a running engine, m/s^2, also at stops."""
    engine_hz: Annotated[float, Gt(3.0)] = 12.0
    """Frequency of that vibration, Hz."""


# Unevenness by ISO 8608: good roads (class B) are from 32e-6 to 128e-6 m^3, average ones (C) above; limits as in
# Agostinacchio, Ciampa and Olita 2014. Here the geometric mean of class B, and its boundary to class C.
_ROAD_B_M3, _ROAD_BC_M3 = 64e-6, 128e-6


def bus(roughness_m3: float = _ROAD_BC_M3) -> VehicleParams:
    """Return a city bus on an ordinary street.

    The air springs let the body bounce at 1.2 Hz with 0.2 of the critical damping, and the wheels hop at 10 Hz; on
    this road the body shakes vertically by 0.55 m/s^2. All of it is ours, as are speeds, stops and accelerations.
    """
    return VehicleParams(
        name="bus",
        speed_mps=10.0,
        acceleration_mps2=1.1,
        braking_mps2=1.3,
        leg_s=45.0,
        stop_s=15.0,
        corner_m=350.0,
        corner_radius_m=60.0,
        corner_rad=1.2,
        suspension=SuspensionParams(spring_ps2=57.0, damper_ps=3.2, tyre_ps2=400.0, wheel_share=0.12),
        roughness_m3=roughness_m3,
        sideways_share=0.6,
        lengthways_share=0.4,
        sway_hz=0.8,
        rock_radps=0.035,
        engine_mps2=0.12,
        engine_hz=11.0,
    )


def car(roughness_m3: float = _ROAD_B_M3) -> VehicleParams:
    """Return a car in a town, on a good road; all but springs and road is ours."""
    return VehicleParams(
        name="car",
        speed_mps=14.0,
        acceleration_mps2=1.8,
        braking_mps2=2.0,
        leg_s=70.0,
        stop_s=20.0,
        corner_m=450.0,
        corner_radius_m=100.0,
        corner_rad=1.2,
        suspension=SuspensionParams(),
        roughness_m3=roughness_m3,
        sideways_share=0.5,
        lengthways_share=0.35,
        sway_hz=1.2,
        rock_radps=0.03,
        engine_mps2=0.05,
        engine_hz=24.0,
    )


def train(roughness_m3: float = _ROAD_B_M3) -> VehicleParams:
    """Return a suburban train on a track that is as uneven as a good road.

    Secondary springs under the body let it bounce at 1.1 Hz with 0.17 of the critical damping, and the bogies on
    primary springs at 7 Hz. For their bounce, trains sway more sideways here than road vehicles do. All is ours.
    """
    return VehicleParams(
        name="train",
        speed_mps=22.0,
        acceleration_mps2=0.9,
        braking_mps2=1.0,
        leg_s=120.0,
        stop_s=30.0,
        corner_m=1300.0,
        corner_radius_m=500.0,
        corner_rad=0.5,
        suspension=SuspensionParams(spring_ps2=48.0, damper_ps=2.4, tyre_ps2=450.0, wheel_share=0.25),
        roughness_m3=roughness_m3,
        sideways_share=0.8,
        lengthways_share=0.25,
        sway_hz=1.0,
        rock_radps=0.015,
    )


def lift() -> VehicleParams:
    """Return the lift of an office, which goes up and down.

    Speed, acceleration and jerk (1 m/s^3) are ours. It vibrates by 0.1 m/s^2, so that a phone in the hand has
    about the 0.14 m/s^2 over 2 Hz that were recorded in one real lift (data set ipin21).
    """
    return VehicleParams(
        name="lift",
        speed_mps=1.6,
        acceleration_mps2=1.0,
        braking_mps2=1.0,
        leg_s=12.0,
        stop_s=8.0,
        grade_rad=0.5 * math.pi,
        returns=True,
        smooth_mps2=0.1,
    )


def escalator() -> VehicleParams:
    """Return an escalator at 0.5 m/s and 30 degrees, on which the walker stands.

    Steps and chain shake it by about 0.2 m/s^2. The values are ours.
    """
    return VehicleParams(
        name="escalator",
        speed_mps=0.5,
        acceleration_mps2=0.6,
        braking_mps2=0.6,
        leg_s=3600.0,
        stop_s=0.0,
        grade_rad=math.pi / 6.0,
        smooth_mps2=0.2,
    )


VEHICLES: Mapping[str, Callable[[], VehicleParams]] = MappingProxyType(
    {"bus": bus, "car": car, "train": train, "lift": lift, "escalator": escalator}
)
"""Functions that make the vehicles, by name."""
