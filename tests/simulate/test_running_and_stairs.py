"""Running and stairs: speeds, steps, forces on the ground, heights, and how they join walking and standing."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.errors import ConfigError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.simulate import (
    PHONE_BAROMETER,
    DeviceParams,
    GaitStretch,
    PacedStretch,
    PathParams,
    Pause,
    PocketPhone,
    RunningStretch,
    Scenario,
    SensorParams,
    SimulatedWalk,
    StairStretch,
    WalkerGaitParams,
    simulate_walk,
    uptime_trip,
)
from pdr_est.simulate.walker.gait_stretches import flight_share, running_cadence_hz
from pdr_est.simulate.walker.walking_body import BodyMotion
from pdr_est.types.steps import Gait

RATE_HZ = 1000.0


def run(speed_mps: float, from_m: float = 30.0, to_m: float = 90.0) -> RunningStretch:
    return RunningStretch(kind="jogging", from_m=from_m, to_m=to_m, speed_mps=speed_mps)


def trip(*stretches: GaitStretch, length_m: float = 120.0, seed: int = 1, **gait: object) -> SimulatedWalk:
    walker = replace(WalkerGaitParams(stretches=stretches), **gait)  # type: ignore[arg-type]
    path = PathParams(vertices_m=((0.0, 0.0), (length_m, 0.0)))
    return simulate_walk(Scenario(path=path, gait=walker, seed=seed))


def trunk(walk: SimulatedWalk) -> BodyMotion:
    return walk.body.at(np.arange(0.0, walk.steps.end_s, 1.0 / RATE_HZ))


def steady(walk: SimulatedWalk, chosen: Array, cut: int = 8) -> BodyMotion:
    """Motion of the trunk over whole steps, without the first and last ones of those chosen."""
    inner = np.flatnonzero(chosen)[cut:-cut]
    begin_s, end_s = walk.steps.start_s[inner[0]], walk.steps.time_s[inner[-1]]
    return walk.body.at(np.arange(begin_s, end_s, 1.0 / RATE_HZ))


@pytest.mark.parametrize("speed_mps", [2.2, 3.0, 5.0])
def test_a_runner_has_the_speed_cadence_and_flight_that_were_asked_for(speed_mps: float) -> None:
    walk = trip(run(speed_mps, to_m=150.0), length_m=180.0)
    steps, running = walk.steps, walk.steps.gait == Gait.JOGGING
    motion = steady(walk, running)
    speed = motion.on_path.value[-1] - motion.on_path.value[0]
    assert speed / (motion.time_s[-1] - motion.time_s[0]) == pytest.approx(speed_mps, rel=0.02)
    period_s = (steps.time_s - steps.start_s)[running]
    assert 1.0 / period_s.mean() == pytest.approx(running_cadence_hz(speed_mps), rel=0.01)
    aloft = np.abs(motion.up.acceleration + STANDARD_GRAVITY_MPS2) < 1e-6
    assert aloft.mean() == pytest.approx(float(flight_share(np.array([speed_mps]))[0]), abs=0.01)
    assert steps.length_m[running].sum() == pytest.approx(120.0)


def test_published_laws_of_running() -> None:
    assert running_cadence_hz(4.12) / running_cadence_hz(3.15) == pytest.approx(1.04, abs=0.005)  # Cavanagh and Kram
    force = 1.0 / (1.0 - flight_share(np.array([3.0, 5.0])))  # mean of a contact, body weights: Munro et al.
    np.testing.assert_allclose(force, [1.40, 1.70])


@pytest.mark.parametrize("speed_mps", [2.2, 3.0, 5.0])
def test_the_ground_carries_the_runner_and_never_pulls(speed_mps: float) -> None:
    walk = trip(run(speed_mps))
    motion = trunk(walk)
    force = 1.0 + motion.up.acceleration / STANDARD_GRAVITY_MPS2  # body weights
    assert force.min() > -1e-9
    running = steady(walk, walk.steps.gait == Gait.JOGGING)
    running_force = 1.0 + running.up.acceleration / STANDARD_GRAVITY_MPS2
    assert running_force.mean() == pytest.approx(1.0, abs=0.01)
    peak = 1.72 / (1.0 - float(flight_share(np.array([speed_mps]))[0]))
    assert np.percentile(running_force, 99) == pytest.approx(peak, rel=0.06)
    assert 0.06 < np.ptp(running.up.value) < 0.11  # vertical oscillation, m


def test_energy_in_flight_is_kept_and_each_flight_ends_where_it_began() -> None:
    walk = trip(run(3.2))
    steps = walk.steps
    for k in np.flatnonzero(steps.flight_s > 0.0)[3:-3]:
        time_s = np.linspace(steps.time_s[k] - steps.flight_s[k] + 1e-9, steps.time_s[k] - 1e-9, 40)
        up = walk.body.at(time_s).up
        energy = STANDARD_GRAVITY_MPS2 * up.value + 0.5 * up.rate**2
        np.testing.assert_allclose(energy, energy[0], rtol=1e-6)
        assert up.value[0] == pytest.approx(up.value[-1], abs=1e-6)


@pytest.mark.parametrize(
    "walk",
    [
        trip(run(2.5, 30.0, 60.0), run(4.5, 60.0, 90.0)),
        trip(run(3.0, 0.0, 50.0), length_m=50.0, lead_in_s=1.0),
        trip(StairStretch(from_m=5.0, to_m=8.0, direction="up"), run(2.4, 8.0, 30.0), length_m=30.0),
        trip(run(3.0, 10.0, 40.0), length_m=50.0, pauses=(Pause(at_m=25.0, duration_s=1.0),)),
    ],
    ids=["walk, jog, run", "from standing to standing", "from stairs", "with a stop"],
)
def test_the_trunk_moves_smoothly_through_all_changes_of_gait(walk: SimulatedWalk) -> None:
    motion = trunk(walk)
    for signal in (motion.on_path, motion.up, motion.east, motion.north):
        rate, acceleration = (np.gradient(part, 1.0 / RATE_HZ)[2:-2] for part in (signal.value, signal.rate))
        np.testing.assert_allclose(rate, signal.rate[2:-2], atol=1e-3)
        np.testing.assert_allclose(acceleration, signal.acceleration[2:-2], atol=0.12)
        assert np.abs(np.diff(signal.acceleration)).max() < 1.5  # m/s^2 within 1 ms
    assert motion.on_path.rate.min() > -1e-9
    standing = motion.time_s > walk.steps.time_s[-1] + 1.0
    np.testing.assert_allclose(motion.up.acceleration[standing], 0.0, atol=1e-9)


def test_stairs_take_one_step_a_tread_and_end_at_their_height() -> None:
    up = StairStretch(from_m=20.0, to_m=20.0 + 12 * 0.29, direction="up", rise_m=0.165)
    down = StairStretch(from_m=40.0, to_m=40.0 + 7 * 0.29, direction="down")
    walk = trip(up, down, length_m=60.0)
    steps = walk.steps
    assert (np.sum(steps.rise_m > 0.0), np.sum(steps.rise_m < 0.0)) == (12, 7)
    np.testing.assert_allclose(steps.length_m[steps.rise_m != 0.0], 0.29)
    assert (steps.gait == Gait.WALKING).all()
    motion = trunk(walk)
    assert motion.up.value[-1] == pytest.approx(12 * 0.165 - 7 * 0.17, abs=1e-9)
    period_s = steps.time_s - steps.start_s
    assert 1.0 / period_s[steps.rise_m > 0.0].mean() == pytest.approx(0.9 * 1.8, rel=0.03)
    on_stairs = (motion.on_path.value > 21.0) & (motion.on_path.value < 23.0)
    assert motion.on_path.rate[on_stairs].mean() == pytest.approx(0.29 * 0.9 * 1.8, rel=0.05)  # m/s, a third of level


@pytest.mark.parametrize(("direction", "least", "most"), [("up", 1.15, 1.35), ("down", 1.35, 1.65)])
def test_the_force_on_stairs(direction: str, least: float, most: float) -> None:
    stairs = StairStretch(from_m=10.0, to_m=22.0, direction=direction)  # type: ignore[arg-type]
    walk = trip(stairs, length_m=32.0)
    force = 1.0 + steady(walk, walk.steps.rise_m != 0.0, 4).up.acceleration / STANDARD_GRAVITY_MPS2
    assert force.mean() == pytest.approx(1.0, abs=0.01)
    assert least < np.percentile(force, 99.5) < most


def test_another_pace_changes_cadence_and_length_together() -> None:
    walk = trip(PacedStretch(from_m=30.0, to_m=90.0, cadence_hz=1.4))
    period_s = walk.steps.time_s - walk.steps.start_s
    slow = np.abs(period_s - 1.0 / 1.4) < 0.08
    assert slow.sum() == pytest.approx(60.0 / (0.3139 * 1.73 * np.sqrt(1.4)), abs=2)
    ratio = np.median(walk.steps.length_m[slow]) / np.median(walk.steps.length_m[~slow])
    assert ratio == pytest.approx(np.sqrt(1.4 / 1.8), rel=0.03)


def test_the_barometer_follows_the_height() -> None:
    stairs = StairStretch(from_m=10.0, to_m=10.0 + 40 * 0.29, direction="up")
    exact = replace(PHONE_BAROMETER, noise_std=0.0, bias_std=0.0, bias_walk=0.0)
    device = DeviceParams(carry=PocketPhone(), sensors=SensorParams(rate_hz=50.0, barometer=exact))
    path = PathParams(vertices_m=((0.0, 0.0), (30.0, 0.0)))
    scenario = Scenario(path=path, gait=WalkerGaitParams(stretches=(stairs,)), devices=(device,))
    recording = simulate_walk(scenario).recording.devices[0]
    assert recording.pressure is not None
    fall_pa = recording.pressure.values[0, 0] - recording.pressure.values[-1, 0]
    assert fall_pa == pytest.approx(12.0 * 40 * 0.17, rel=0.01)  # 12 Pa/m near the sea
    assert simulate_walk(replace(scenario, devices=(DeviceParams(),))).recording.devices[0].pressure is None


@pytest.mark.parametrize(
    "stretches",
    [(run(3.0, 50.0, 40.0),), (run(3.0, 10.0, 40.0), run(2.0, 30.0, 60.0)), (run(3.0, 100.0, 130.0),)],
    ids=["backwards", "overlapping", "beyond the path"],
)
def test_stretches_that_do_not_follow_each_other_are_refused(stretches: tuple[GaitStretch, ...]) -> None:
    with pytest.raises(ConfigError, match="stretches: jogging"):
        trip(*stretches)


def test_a_speed_that_nobody_runs_is_refused() -> None:
    with pytest.raises(ConfigError, match="speed_mps"):
        run(1.0)


@pytest.mark.parametrize(
    ("name", "distance_m", "gaits"),
    [("gaits", 470.0, {1, 2, 3}), ("compound", 623.0, {1, 2}), ("building", 95.0, {1}), ("stairs", 53.0, {1, 2})],
)
def test_trips_of_uptime_have_the_papers_distance_and_gaits(name: str, distance_m: float, gaits: set[int]) -> None:
    walk = simulate_walk(uptime_trip(name))  # type: ignore[arg-type]
    assert walk.distance_m == pytest.approx(distance_m, abs=0.6)
    assert set(walk.steps.gait.tolist()) == gaits
    assert (walk.steps.rise_m.sum(), np.abs(walk.steps.rise_m).sum() > 0.0) == (pytest.approx(0.0), name == "stairs")
