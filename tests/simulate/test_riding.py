"""Rides: the vehicle's motion is a real one, shakes as its road and springs say, and takes the walker along."""

from dataclasses import replace
from operator import attrgetter

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson
from scipy.signal import welch
from scipy.spatial.transform import Rotation

from pdr_est.errors import ConfigError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, up_in_device
from pdr_est.simulate import VEHICLES, Ride, SimulatedWalk, preset, riding_walk, simulate_walk
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal
from pdr_est.simulate.riding.riding_body import RidingBody
from pdr_est.simulate.riding.trip import Trip
from pdr_est.simulate.riding.vehicles import SuspensionParams, bus, car, escalator, lift, train
from pdr_est.simulate.riding.vibration import road_vibration_density

RATE_HZ = 100.0


@pytest.fixture(scope="module")
def bus_ride() -> SimulatedWalk:
    """A bus that stops twice on the way."""
    return simulate_walk(riding_walk(bus(), posture="sitting", ride_s=150.0, seed=3))


def ride_of(walk: SimulatedWalk) -> tuple[float, float]:
    assert isinstance(walk.body, RidingBody)
    return walk.body.ride_spans_s[0]


def level_acceleration(walk: SimulatedWalk) -> tuple[Array, Array]:
    """Acceleration of the first device in east, north, up, (n, 3), during the ride, with its times."""
    motion, (start_s, end_s) = walk.devices[0].motion, ride_of(walk)
    during = (motion.time_s > start_s) & (motion.time_s < end_s)
    turned = Rotation.from_quat(motion.quaternion, scalar_first=True).apply(motion.specific_force_mps2)
    return motion.time_s[during], (turned - [0.0, 0.0, STANDARD_GRAVITY_MPS2])[during]


def test_integrating_the_specific_force_twice_gives_the_position(bus_ride: SimulatedWalk) -> None:
    motion = bus_ride.devices[0].motion
    turned = Rotation.from_quat(motion.quaternion, scalar_first=True).apply(motion.specific_force_mps2)
    acceleration = turned - [0.0, 0.0, STANDARD_GRAVITY_MPS2]
    begin = [motion.east.rate[0], motion.north.rate[0], motion.up.rate[0]]
    velocity = begin + cumulative_simpson(acceleration, dx=1.0 / RATE_HZ, axis=0, initial=0.0)
    position = motion.position_m[0] + cumulative_simpson(velocity, dx=1.0 / RATE_HZ, axis=0, initial=0.0)
    np.testing.assert_allclose(position, motion.position_m, atol=0.15)  # Simpson's rule, 25 Hz, 600 m
    assert np.ptp(motion.position_m[:, 0]) > 300.0


@pytest.mark.parametrize("name", ["east", "north", "up", "attitude.w", "attitude.x", "attitude.y", "attitude.z"])
def test_rates_are_derivatives(bus_ride: SimulatedWalk, name: str) -> None:
    signal: DifferentiableSignal = attrgetter(name)(bus_ride.devices[0].motion)
    rate = (signal.value[2:] - signal.value[:-2]) * RATE_HZ / 2.0
    np.testing.assert_allclose(rate, signal.rate[1:-1], atol=0.02 * np.abs(signal.rate).max())


def test_the_spectrum_is_that_of_two_masses_on_springs() -> None:
    """The equations of motion of body and wheel, driven by the road's vertical velocity of constant density."""
    p, at_hz = SuspensionParams(), np.linspace(0.5, 25.0, 200)
    stiffness, damping = p.spring_ps2, p.damper_ps
    # States: suspension travel, body velocity, tyre travel, wheel velocity.
    from_travel = np.array([-stiffness, -damping, 0.0, damping])
    system = np.array(
        [
            [0.0, 1.0, 0.0, -1.0],
            from_travel,
            [0.0, 0.0, 0.0, 1.0],
            -from_travel / p.wheel_share - [0.0, 0.0, p.tyre_ps2 / p.wheel_share, 0.0],
        ]
    )
    road = np.array([0.0, 0.0, -1.0, 0.0])
    s = 2j * np.pi * at_hz
    gain = np.array([from_travel @ np.linalg.solve(value * np.eye(4) - system, road) for value in s])
    road_velocity_density = (2.0 * np.pi) ** 2 * 64e-6 * 0.1**2 * 14.0
    expected = np.abs(gain) ** 2 * road_velocity_density
    np.testing.assert_allclose(road_vibration_density(p, 64e-6, 14.0, at_hz), expected, rtol=1e-6)


@pytest.mark.parametrize(
    "name", ["bus", pytest.param("car", marks=pytest.mark.slow), pytest.param("train", marks=pytest.mark.slow)]
)
def test_passengers_are_shaken_as_iso_2631_says(name: str) -> None:
    """Between "a little" and "fairly" uncomfortable, most of it where people walk, and not at stops."""
    walk = simulate_walk(riding_walk(VEHICLES[name](), ride_s=200.0, seed=2))
    time_s, acceleration = level_acceleration(walk)
    vertical = acceleration[:, 2]
    speed_mps = np.hypot(walk.devices[0].motion.east.rate, walk.devices[0].motion.north.rate)
    speed_mps = np.interp(time_s, walk.devices[0].motion.time_s, speed_mps)
    moving, standing = speed_mps > 0.9 * VEHICLES[name]().speed_mps, speed_mps < 0.02
    assert 0.3 < vertical[moving].std() < 1.0
    at_hz, density = welch(vertical[moving], RATE_HZ, nperseg=512)
    band = (at_hz >= 1.0) & (at_hz <= 3.0)
    assert 0.2 < np.sqrt(density[band].sum() * at_hz[1]) < 0.45
    assert 0.9 < at_hz[4:25][density[4:25].argmax()] < 1.7  # the body on its springs
    if standing.any():
        assert vertical[standing].std() < 0.2


@pytest.mark.slow
def test_a_rougher_road_shakes_more() -> None:
    shaken = [
        level_acceleration(simulate_walk(riding_walk(car(roughness), ride_s=80.0)))[1][:, 2].std()
        for roughness in (16e-6, 64e-6)
    ]
    assert shaken[1] == pytest.approx(2.0 * shaken[0], rel=0.1)


@pytest.mark.parametrize("name", ["bus", "car", "train", "lift"])
def test_vehicles_keep_their_accelerations_and_stop(name: str) -> None:
    vehicle = VEHICLES[name]()
    time_s = np.arange(0.0, 420.0, 0.05)
    motion = Trip(vehicle, 10.0, 400.0, np.random.default_rng(1)).at(time_s)
    speed = motion.speed_share.value * vehicle.speed_mps
    along = motion.speed_share.rate * vehicle.speed_mps
    assert -1.001 * vehicle.braking_mps2 < along.min() < -0.8 * vehicle.braking_mps2
    assert 0.8 * vehicle.acceleration_mps2 < along.max() < 1.001 * vehicle.acceleration_mps2
    assert speed.max() == pytest.approx(vehicle.speed_mps)
    stops = np.flatnonzero((speed[1:] < 1e-9) & (speed[:-1] >= 1e-9))
    assert len(stops) == int((390.0 + vehicle.stop_s) // (vehicle.leg_s + vehicle.stop_s))
    sideways = np.abs(motion.turn.rate) * speed
    assert sideways.max() < 2.1
    assert (speed[(time_s < 10.0) | (time_s > 400.0)] == 0.0).all()


def test_who_gets_off_walks_on_where_the_vehicle_is(bus_ride: SimulatedWalk) -> None:
    start_s, end_s = ride_of(bus_ride)
    before, after = bus_ride.position_at(np.array([start_s, end_s]))
    assert np.linalg.norm(before - [20.0, 0.0]) < 1e-6
    assert np.linalg.norm(after - before) > 300.0
    goal = bus_ride.position_at(np.array([bus_ride.steps.end_s]))[0]
    facing_rad = bus_ride.heading_at(np.array([end_s]))[0]
    np.testing.assert_allclose(goal - after, 20.0 * np.array([np.cos(facing_rad), np.sin(facing_rad)]), atol=1e-6)
    assert not ((bus_ride.steps.time_s > start_s) & (bus_ride.steps.time_s < end_s)).any()
    assert bus_ride.distance_m == pytest.approx(40.0)
    motion = bus_ride.devices[0].motion
    ahead_m = np.hypot(motion.position_m[-1, 0] - goal[0], motion.position_m[-1, 1] - goal[1])
    assert ahead_m == pytest.approx(0.35, abs=0.01)  # the phone is in the hand that was there before


def test_lifts_and_escalators_rise() -> None:
    escalated = simulate_walk(riding_walk(escalator(), ride_s=40.0))
    start_s, end_s = ride_of(escalated)
    gone_m = np.linalg.norm(np.diff(escalated.position_at(np.array([start_s, end_s])), axis=0))
    up = escalated.devices[0].motion.up.value
    assert up[-1] - up[0] == pytest.approx(gone_m * np.tan(np.pi / 6.0), rel=1e-2)
    lifted = simulate_walk(riding_walk(lift(), ride_s=20.0))
    up = lifted.devices[0].motion.up.value
    assert 10.0 < up[-1] - up[0] < 20.0
    np.testing.assert_allclose(lifted.position_at(np.array(ride_of(lifted))), [[20.0, 0.0]] * 2, atol=1e-9)
    assert level_acceleration(lifted)[1][:, 2].max() == pytest.approx(1.0, abs=0.3)


def test_a_phone_in_the_pocket_lies_with_the_thigh_of_who_sits() -> None:
    sitting, standing = (
        simulate_walk(riding_walk(car(), posture=posture, place="pocket", ride_s=40.0))
        for posture in ("sitting", "standing")
    )
    turns = []
    for walk in (sitting, standing):
        motion, (start_s, end_s) = walk.devices[0].motion, ride_of(walk)
        before, during = np.searchsorted(motion.time_s, [1.0, 0.5 * (start_s + end_s)])
        up = up_in_device(motion.quaternion[[before, during]])
        turns.append(float(np.degrees(np.arccos(up[0] @ up[1]))))
    assert turns[0] == pytest.approx(80.0, abs=10.0)
    assert turns[1] < 10.0


def test_a_phone_on_a_seat_is_shaken_without_a_body() -> None:
    on_seat = simulate_walk(riding_walk(train(), place="seat", ride_s=60.0))
    assert on_seat.scenario.rides[0].posture == "rigid"
    motion, (start_s, end_s) = on_seat.devices[0].motion, ride_of(on_seat)
    riding = (motion.time_s > start_s) & (motion.time_s < end_s - 5.0)
    tilt_rad = np.arccos(np.clip(up_in_device(motion.quaternion[riding])[:, 2], -1.0, 1.0))
    assert np.median(tilt_rad) < 0.03


@pytest.mark.slow
def test_the_way_to_work_has_four_rides() -> None:
    walk = simulate_walk(preset("commute"))
    assert isinstance(walk.body, RidingBody)
    assert len(walk.body.ride_spans_s) == 4
    for start_s, end_s in walk.body.ride_spans_s:
        assert not ((walk.steps.time_s > start_s) & (walk.steps.time_s < end_s)).any()


@pytest.mark.parametrize(
    ("rides", "words"),
    [
        ((Ride(pause=1, vehicle=bus()),), "the walk has 1 pauses"),
        ((Ride(pause=0, vehicle=bus()), Ride(pause=0, vehicle=lift())), "must rise"),
    ],
)
def test_rides_without_a_pause_of_their_own_are_refused(rides: tuple[Ride, ...], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        simulate_walk(replace(riding_walk(bus(), ride_s=30.0), rides=rides))


def test_a_pause_too_short_for_a_ride_is_refused() -> None:
    with pytest.raises(ConfigError, match="needs"):
        simulate_walk(riding_walk(bus(), ride_s=5.0))
