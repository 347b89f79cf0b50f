"""Whole simulated walks: presets, truth, determinism, fixes, refusals."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from pdr_est.errors import ConfigError
from pdr_est.simulate import (
    NO_SENSOR_ERRORS,
    PRESETS,
    BodyParams,
    BodyTurn,
    DeviceParams,
    HeldPhone,
    PathParams,
    Pause,
    Scenario,
    SensorParams,
    WalkerGaitParams,
    preset,
    simulate_walk,
)

FEW_PRESETS = ("office_loop", "l_shape", "mmpdr_indoor_multi", "park_348", "uptime_stairs", "ride_lift", "floors")


def with_sensors(scenario: Scenario, **changes: object) -> Scenario:
    sensors = replace(SensorParams(), **changes)  # type: ignore[arg-type]
    return replace(scenario, devices=(DeviceParams(sensors=sensors),))


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name in FEW_PRESETS else [pytest.mark.slow]) for name in PRESETS]
)
def test_a_preset_gives_a_recording_with_consistent_truth(name: str) -> None:
    walk = simulate_walk(preset(name))
    recording, truth = walk.recording, walk.recording.truth
    device = recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    rate_hz = walk.scenario.devices[0].sensors.rate_hz
    assert len(device.specific_force) == len(device.rotation_rate) == int(walk.steps.end_s * rate_hz) + 1
    assert (device.model, device.platform) == ("simulated", "simulated")
    assert truth.steps is not None
    assert truth.positions is not None
    assert truth.step_count == walk.step_count == len(truth.steps.time_s)
    assert truth.distance_m == pytest.approx(walk.steps.length_m.sum(), rel=1e-12)
    assert (np.diff(truth.positions.time_s) > 0.0).all()
    legs_m = np.linalg.norm(np.diff(truth.positions.position_m, axis=0), axis=1)
    rides_s = getattr(walk.body, "ride_spans_s", ())
    middle_s = 0.5 * (truth.positions.time_s[1:] + truth.positions.time_s[:-1])
    rides = [(middle_s > start_s - 0.1) & (middle_s < end_s + 0.1) for start_s, end_s in rides_s]
    walked = ~np.any(rides, axis=0) if rides else np.ones(len(legs_m), dtype=np.bool_)
    assert legs_m[walked].sum() == pytest.approx(walk.distance_m, rel=1e-3)


def test_the_office_loop_is_closed_and_pauses_once() -> None:
    walk = simulate_walk(preset("office_loop"))
    assert walk.distance_m == pytest.approx(150.0, abs=1.0)
    np.testing.assert_allclose(walk.truth_position_m[-1], walk.truth_position_m[0], atol=1e-9)
    assert walk.truth_heading_rad[-1] - walk.truth_heading_rad[0] == pytest.approx(2.0 * np.pi)
    assert len(walk.steps.bouts) == 2
    turns = walk.recording.truth.turns
    assert turns is not None
    np.testing.assert_allclose(turns.angle_rad, np.pi / 2.0)
    np.testing.assert_allclose(
        walk.heading_at(turns.time_s), np.pi / 4.0 + np.pi / 2.0 * np.arange(4), atol=1e-6
    )  # half turned


def test_the_straight_walk_is_80_m_to_the_east() -> None:
    walk = simulate_walk(preset("straight"))
    assert walk.distance_m == pytest.approx(80.0, abs=1e-12)
    np.testing.assert_allclose(walk.truth_position_m[-1], [80.0, 0.0], atol=1e-9)
    np.testing.assert_array_equal(walk.truth_position_m[:, 1], 0.0)


def test_an_unknown_preset_names_the_nearest() -> None:
    with pytest.raises(ConfigError, match="did you mean straight"):
        preset("straigth")


def test_the_same_seed_repeats_and_another_differs() -> None:
    first, again = simulate_walk(preset("l_shape")), simulate_walk(preset("l_shape"))
    other = simulate_walk(replace(preset("l_shape"), seed=1))
    for channel in ("specific_force", "rotation_rate"):
        one, two = (getattr(walk.recording.devices[0], channel) for walk in (first, again))
        np.testing.assert_array_equal(one.values, two.values)
        np.testing.assert_array_equal(one.time_s, two.time_s)
    np.testing.assert_array_equal(first.steps.time_s, again.steps.time_s)
    assert not np.array_equal(first.steps.length_m, other.steps.length_m[: len(first.steps)])


def test_truth_does_not_depend_on_rate_or_sensors() -> None:
    slow = simulate_walk(with_sensors(preset("l_shape"), rate_hz=25.0, lost_fraction=0.2))
    fast = simulate_walk(with_sensors(preset("l_shape"), rate_hz=500.0, accelerometer=NO_SENSOR_ERRORS))
    np.testing.assert_array_equal(slow.steps.time_s, fast.steps.time_s)
    np.testing.assert_array_equal(slow.truth_position_m, fast.truth_position_m)
    few, many = slow.devices[0].motion, fast.devices[0].motion
    np.testing.assert_allclose(few.time_s, many.time_s[::20], atol=1e-12)
    np.testing.assert_allclose(few.specific_force_mps2, many.specific_force_mps2[::20], atol=1e-9)


def test_lost_samples_are_missing_from_the_recording_only() -> None:
    walk = simulate_walk(with_sensors(preset("straight"), lost_fraction=0.05, gaps_s=((20.0, 23.0),)))
    device = walk.recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    true_count = len(walk.devices[0].motion.time_s)
    assert len(device.specific_force) == pytest.approx(0.95 * (true_count - 300), rel=0.02)
    assert np.diff(device.specific_force.time_s).max() > 2.9
    assert not np.array_equal(device.specific_force.time_s, device.rotation_rate.time_s)


def test_several_devices_share_the_body_and_differ_in_their_sensors() -> None:
    scenario = replace(
        preset("l_shape"),
        devices=(DeviceParams(name="1L", carry=HeldPhone(left_m=0.2)), DeviceParams(name="2R")),
    )
    walk = simulate_walk(scenario)
    left, right = walk.recording.devices
    assert (left.name, right.name) == ("1L", "2R")
    assert left.rotation_rate is not None
    assert right.rotation_rate is not None
    assert not np.array_equal(left.rotation_rate.values, right.rotation_rate.values)
    apart = walk.devices[0].motion.position_m - walk.devices[1].motion.position_m
    np.testing.assert_allclose(np.hypot(apart[:, 0], apart[:, 1]), 0.2, atol=0.001)
    assert not np.array_equal(walk.devices[0].motion.quaternion, walk.devices[1].motion.quaternion)


def test_the_attitude_is_recorded_when_asked() -> None:
    assert simulate_walk(preset("l_shape")).recording.devices[0].attitude is None
    walk = simulate_walk(with_sensors(preset("l_shape"), record_attitude=True, time_jitter_s=0.0))
    attitude = walk.recording.devices[0].attitude
    assert attitude is not None
    np.testing.assert_array_equal(attitude.values, walk.devices[0].motion.quaternion)


def test_fixes_have_their_error_and_leave_the_rest_alone() -> None:
    walk = simulate_walk(preset("office_loop"))
    fixed = walk.with_fixes(every_s=0.1, sigma_m=2.0, seed=4)
    time_s = np.array([fix.time_s for fix in fixed.recording.fixes])
    measured = np.array([fix.position_m for fix in fixed.recording.fixes])
    np.testing.assert_allclose(np.diff(time_s), 0.1)
    assert time_s[-1] <= walk.steps.end_s
    error = measured - walk.position_at(time_s)
    np.testing.assert_allclose(error.std(axis=0), 2.0, rtol=0.1)
    np.testing.assert_allclose(fixed.recording.fixes[0].covariance_m2, 4.0 * np.eye(2))
    assert walk.recording.fixes == ()
    assert fixed.recording.devices is walk.recording.devices
    with pytest.raises(ConfigError, match="positive"):
        walk.with_fixes(every_s=0.0, sigma_m=1.0)


LINE = PathParams(vertices_m=((0.0, 0.0), (20.0, 0.0)))


@pytest.mark.parametrize(
    ("scenario", "message"),
    [
        (lambda: with_sensors(Scenario(path=LINE), rate_hz=10.0), "rate_hz"),
        (lambda: with_sensors(Scenario(path=LINE), gaps_s=((5.0, 4.0),)), "swap the times"),
        (lambda: Scenario(path=LINE, gait=WalkerGaitParams(cadence_hz=-1.0)), "cadence_hz"),
        (lambda: Scenario(path=LINE, gait=WalkerGaitParams(height_m=float("nan"))), "height_m"),
        (lambda: Scenario(path=LINE, gait=WalkerGaitParams(pauses=(Pause(at_m=5.0, duration_s=0.1),))), "duration_s"),
        (lambda: Scenario(path=LINE, devices=(DeviceParams(), DeviceParams())), "a name of its own"),
        (lambda: Scenario(path=LINE, seed=-1), "seed"),
    ],
)
def test_values_out_of_range_are_refused(scenario: Callable[[], Scenario], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        simulate_walk(scenario())


def test_a_walk_of_one_short_step_without_standing() -> None:
    scenario = Scenario(
        path=PathParams(vertices_m=((0.0, 0.0), (0.0, 0.4))), gait=WalkerGaitParams(lead_in_s=0.0, lead_out_s=0.0)
    )
    walk = simulate_walk(scenario)
    assert walk.step_count == 1
    np.testing.assert_allclose(walk.position_at(np.array([walk.steps.end_s]))[0], [0.0, 0.4], atol=1e-12)


def test_a_body_that_turns_alone_stays_on_its_path() -> None:
    straight = preset("straight")
    turn = BodyTurn(start_s=10.0, end_s=14.0, angle_rad=2.0)
    ahead, aside = (
        simulate_walk(replace(straight, body=replace(straight.body, turns=turns))) for turns in ((), (turn,))
    )
    time_s = np.array([9.0, 12.0, 16.0])
    np.testing.assert_array_equal(ahead.position_at(time_s), aside.position_at(time_s))
    np.testing.assert_array_equal(ahead.heading_at(time_s), aside.heading_at(time_s))
    turned = aside.body.at(time_s).heading.value - ahead.body.at(time_s).heading.value
    np.testing.assert_allclose(turned, [0.0, 2.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(aside.body.at(time_s).east.value, ahead.body.at(time_s).east.value)


@pytest.mark.parametrize("times_s", [((10.0, 10.5),), ((10.0, 14.0), (14.5, 18.0))])
def test_turns_of_the_body_that_overlap_are_refused(times_s: tuple[tuple[float, float], ...]) -> None:
    turns = tuple(BodyTurn(start_s=start, end_s=end, angle_rad=1.0) for start, end in times_s)
    with pytest.raises(ConfigError, match="body turn at"):
        simulate_walk(replace(preset("straight"), body=BodyParams(turns=turns)))
