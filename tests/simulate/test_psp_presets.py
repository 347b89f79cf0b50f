"""The walks of PSP, and its Turn Insufficient Effect, which has to follow from the swing of the leg alone."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.errors import ConfigError
from pdr_est.frames import Array, wrap_angle
from pdr_est.simulate import (
    PSP_GYROSCOPE_BIAS_RADPS,
    PSP_TESTS,
    DeviceParams,
    HeldPhone,
    PathParams,
    PocketPhone,
    PspTrajectory,
    Scenario,
    SimulatedWalk,
    WalkingPath,
    psp_path,
    psp_walks,
    scatter_dipoles,
    simulate_walk,
)
from pdr_est.simulate.sensors.magnetic_field import magnetic_field_ut

TURNING, STRAIGHT = psp_path("II", clockwise=False), PathParams(vertices_m=((0.0, 0.0), (290.0, 0.0)))
STANDING_UPRIGHT = HeldPhone(
    tilt_rad=np.pi / 2.0, rock_pitch_rad=0.0, rock_yaw_rad=0.0, rock_roll_rad=0.0, wander_rad=0.0, tremor_rad=0.0
)
POCKET = PocketPhone(spin_rad=0.0, tip_rad=0.0)


def walked(carry: HeldPhone | PocketPhone, path: PathParams) -> SimulatedWalk:
    return simulate_walk(Scenario(path=path, devices=(DeviceParams(carry=carry),), seed=2))


def y_rates(carry: HeldPhone | PocketPhone) -> tuple[Array, Array, Array]:
    """At 100 Hz: what the y axis turns, less what the leg itself makes it turn; the walker's turn rate; cos theta.

    The same walker on a straight line of the same length takes the same steps, and moves the leg in the same way.
    """
    turning, straight = walked(carry, TURNING), walked(carry, STRAIGHT)
    np.testing.assert_array_equal(turning.steps.time_s, straight.steps.time_s)
    motion, beside = turning.devices[0].motion, straight.devices[0].motion
    rate = motion.rotation_rate_radps[:, 1] - beside.rotation_rate_radps[:, 1]
    up = motion.in_device(np.array([0.0, 0.0, 1.0]))[:, 1]
    return rate, turning.body.at(motion.time_s).heading.rate, up


def test_a_phone_on_a_swinging_leg_turns_too_little_about_its_y_axis() -> None:
    rate, turn_rate, cosine = y_rates(POCKET)
    np.testing.assert_allclose(rate, turn_rate * cosine, atol=1e-9)  # PSP eq. 1, at every moment
    turned, true = 0.01 * rate.sum(), 0.01 * turn_rate.sum()
    assert true == pytest.approx(12.0 * np.pi, rel=1e-3)
    assert turned / true == pytest.approx(float(np.average(cosine, weights=np.abs(turn_rate))), abs=1e-3)
    assert 0.90 < turned / true < 0.97


@pytest.mark.slow
def test_a_phone_held_upright_turns_as_the_walker_does() -> None:
    rate, turn_rate, cosine = y_rates(STANDING_UPRIGHT)
    np.testing.assert_allclose(cosine, 1.0, atol=1e-9)
    np.testing.assert_allclose(rate, turn_rate, atol=1e-9)


@pytest.mark.slow
def test_a_leg_that_swings_less_turns_less_too_little() -> None:
    shares = []
    for amplitude_rad in (0.0, 0.4):
        rate, turn_rate, _ = y_rates(replace(POCKET, amplitude_rad=amplitude_rad, spread_rad=0.0, wander_rad=0.0))
        shares.append(rate.sum() / turn_rate.sum())
    assert shares[0] > 0.998
    assert shares[0] > shares[1] + 0.01


@pytest.mark.parametrize(("trajectory", "length_m", "turns"), [("I", 204.0, 0.75), ("II", 290.0, 6.0)])
@pytest.mark.parametrize("clockwise", [False, True])
def test_the_paths_are_closed_of_the_papers_lengths_and_begin_to_the_east(
    trajectory: PspTrajectory, length_m: float, turns: float, clockwise: bool
) -> None:
    path = WalkingPath(psp_path(trajectory, clockwise))
    ends = path.at(np.array([0.0, path.length_m]))
    assert path.length_m == pytest.approx(length_m, abs=1e-9)
    np.testing.assert_allclose(ends.position_m, 0.0, atol=1e-9)
    turn = (-1.0 if clockwise else 1.0) * turns * 2.0 * np.pi
    np.testing.assert_allclose(ends.heading_rad, [0.0, turn], atol=1e-9)


def test_the_circle_is_a_circle_walked_five_times() -> None:
    path = WalkingPath(psp_path("II", clockwise=False))
    points = path.at(np.linspace(0.0, path.length_m, 20001))
    from_centre_m = np.linalg.norm(points.position_m - [0.0, 21.0], axis=1)
    on_circle = np.abs(from_centre_m - 4.0) < 0.01
    assert on_circle.mean() * path.length_m == pytest.approx(5.0 * 2.0 * np.pi * 4.0, rel=0.015)
    # 20 degrees in a stride of 1.4 m, a little less where it comes in and goes out
    stride = round(1.4 / path.length_m * 20000)
    turned = points.heading_rad[stride:] - points.heading_rad[:-stride]
    inside = on_circle[stride:] & on_circle[:-stride]
    assert np.rad2deg(turned[inside]).min() > 15.0
    assert np.rad2deg(np.median(turned[inside])) == pytest.approx(20.0, abs=0.4)
    assert np.rad2deg(turned[inside]).max() < 22.5


def test_legs_of_the_papers_gyroscope_swing_in_a_plane_by_what_is_said() -> None:
    carried = {}
    for legs in ("paper", "planar", "circling"):
        walks = psp_walks("I", 25, legs=legs)  # type: ignore[arg-type]
        assert [walk.seed for walk in walks] == [walk.seed for walk in psp_walks("I")]
        carried[legs] = [walk.devices[0].carry for walk in walks]
        biases = {walk.devices[0].sensors.gyroscope.bias for walk in walks}
        assert len(biases) == 1  # one phone
        np.testing.assert_allclose(np.abs(biases.pop()), PSP_GYROSCOPE_BIAS_RADPS)
    swing = {carry.amplitude_rad for carry in carried["paper"] if isinstance(carry, PocketPhone)}
    assert len(swing) == 5
    assert 0.198 <= min(swing) < max(swing) <= 0.242
    for carry in (*carried["paper"], *carried["planar"]):
        assert isinstance(carry, PocketPhone)
        assert carry.twist_rad == carry.spread_rad == 0.0
    for own, real in zip(carried["paper"], carried["circling"], strict=True):  # its jolts are those of real pockets
        assert isinstance(own, PocketPhone)
        assert isinstance(real, PocketPhone)
        assert (own.shock_rad, own.give_rad, own.unrest_radps) == (real.shock_rad, real.give_rad, real.unrest_radps)
    assert all(carry.twist_rad > 0.0 for carry in carried["circling"] if isinstance(carry, PocketPhone))
    (small,) = psp_walks("I", 1, gyroscope_bias_radps=1e-3)
    np.testing.assert_allclose(np.abs(small.devices[0].sensors.gyroscope.bias), 1e-3)


@pytest.mark.slow
def test_the_y_axis_of_the_papers_legs_shows_98_percent_of_a_turn() -> None:
    """As in pockets of OxIOD, 97 to 98 %; the rest is the Turn Insufficient Effect."""
    shares = []
    for scenario in psp_walks("II", 5):
        walk = simulate_walk(replace(scenario, irons=()))
        straight = simulate_walk(
            replace(scenario, irons=(), path=PathParams(vertices_m=((0.0, 0.0), (walk.distance_m, 0.0))))
        )
        rate = (motion.rotation_rate_radps[:, 1] for motion in (walk.devices[0].motion, straight.devices[0].motion))
        turned, beside = (0.01 * one.sum() for one in rate)
        shares.append((turned - beside) / walk.truth_heading_rad[-1])
    assert np.mean(shares) == pytest.approx(0.979, abs=0.004)
    assert 0.965 < min(shares) < max(shares) < 0.99


def test_the_tests_are_of_five_people_both_pockets_and_both_ways() -> None:
    for trajectory in ("I", "II"):
        walks = psp_walks(trajectory)
        assert len(walks) == PSP_TESTS == 25
        assert len({walk.gait.height_m for walk in walks}) == 5
        combinations = {
            (walk.gait.height_m, walk.devices[0].carry.side, walk.path.vertices_m[2][1] > 0.0)  # type: ignore[union-attr]
            for walk in walks
        }
        assert len(combinations) == 20
        assert len({walk.seed for walk in walks}) == 25
        assert walks[:5] == psp_walks(trajectory, tests=5)
    assert psp_walks("I", 1, seed=1) != psp_walks("I", 1)


@pytest.mark.slow
def test_the_phone_stands_nearly_straight_and_has_a_magnetometer() -> None:
    for scenario in psp_walks("I", 5):
        walk = simulate_walk(scenario)
        still = walk.devices[0].motion.time_s < walk.steps.start_s[0]
        assert walk.devices[0].motion.in_device(np.array([0.0, 0.0, 1.0]))[still, 1].mean() > np.cos(0.35)
        assert walk.recording.devices[0].magnetic_field is not None
        assert walk.recording.devices[0].specific_force is not None
        assert np.median(np.diff(walk.recording.devices[0].specific_force.time_s)) == pytest.approx(0.01, abs=1e-4)


def test_scattered_irons_disturb_a_compass_as_in_a_building() -> None:
    path, earth = WalkingPath(TURNING), psp_walks("II", 1)[0].earth
    places = np.column_stack([path.at(np.linspace(0.0, path.length_m, 2000)).position_m, np.zeros(2000)])
    rms_deg = []
    for seed in range(8):
        irons = scatter_dipoles(path, 5.0, seed)
        assert len(irons) == 58
        field, quiet = magnetic_field_ut(places, earth, irons, path), earth.vector_ut
        off = wrap_angle(np.arctan2(field[:, 1], field[:, 0]) - np.arctan2(quiet[1], quiet[0]))
        rms_deg.append(float(np.rad2deg(np.sqrt(np.mean(off**2)))))
    assert 5.0 < np.median(rms_deg) < 30.0
    assert scatter_dipoles(path, 5.0, 3) == scatter_dipoles(path, 5.0, 3) != scatter_dipoles(path, 5.0, 4)
    with pytest.raises(ConfigError, match=r"irons every 0.0 m"):
        scatter_dipoles(path, 0.0, 1)
