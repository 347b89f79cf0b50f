"""A hand that takes the phone from one place to another: one motion of one rigid body, with true modes."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from carried import finely_walked, orientation_error_rad, twice_integrated, up_in, walk_with

from pdr_est.errors import ConfigError
from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.simulate import (
    DeviceParams,
    HeldPhone,
    ModeChange,
    PocketPhone,
    Scenario,
    SwingingPhone,
    preset,
    simulate_walk,
)
from pdr_est.simulate.motion.rigid_body import RigidMotion
from pdr_est.types.steps import CarryingMode

# the first change while standing, the others while walking, round a corner, and without a pause in between
CHANGES = (
    ModeChange(start_s=1.0, carry=SwingingPhone(), duration_s=0.8),
    ModeChange(start_s=6.0, carry=HeldPhone(heading_offset_rad=3.0), duration_s=1.2),
    ModeChange(start_s=9.0, carry=PocketPhone(), duration_s=1.0),
    ModeChange(start_s=10.0, carry=SwingingPhone(hand="left"), duration_s=1.6, flick_rad=(0.5, -1.0, 1.2)),
    ModeChange(start_s=15.0, carry=HeldPhone(), duration_s=1.0, turn_from=0.0, turn_to=1.0),
)
MANY = DeviceParams(changes=CHANGES)


@pytest.fixture(scope="module")
def motion() -> RigidMotion:
    return finely_walked(MANY)


def test_sensors_agree_with_the_motion_through_all_changes(motion: RigidMotion) -> None:
    assert orientation_error_rad(motion).max() < 3e-5
    np.testing.assert_allclose(twice_integrated(motion), motion.position_m, atol=4e-3)


def test_nothing_jumps(motion: RigidMotion) -> None:
    assert np.abs(np.diff(motion.specific_force_mps2, axis=0)).max() < 5.0  # within 2 ms; a shock swings at 10 Hz
    assert np.abs(np.diff(motion.rotation_rate_radps, axis=0)).max() < 0.7
    assert np.abs(np.diff(motion.quaternion, axis=0)).max() < 0.05
    np.testing.assert_allclose(np.linalg.norm(motion.quaternion, axis=1), 1.0, atol=1e-12)


def test_a_hand_moves_as_hands_do(motion: RigidMotion) -> None:
    in_change = np.zeros(len(motion.time_s), dtype=bool)
    for change in CHANGES:
        in_change |= (motion.time_s >= change.start_s) & (motion.time_s < change.end_s)
    speed = np.abs(motion.up.rate[in_change]).max()
    assert 0.3 < speed < 3.0
    assert np.linalg.norm(motion.specific_force_mps2[in_change], axis=1).max() < 4.0 * STANDARD_GRAVITY_MPS2
    assert 3.0 < np.abs(motion.rotation_rate_radps[in_change]).max() < 20.0


@pytest.mark.parametrize("number", range(len(CHANGES)))
def test_before_and_after_a_change_the_phone_is_carried_as_told(motion: RigidMotion, number: int) -> None:
    expected = {"holding": (0.0, np.sin(0.6), np.cos(0.6)), "pocket": (0.0, -1.0, 0.0)}
    change = CHANGES[number]
    end_s = CHANGES[number + 1].start_s if number + 1 < len(CHANGES) else motion.time_s[-1]
    settled = up_in(motion)[(motion.time_s >= change.end_s) & (motion.time_s < end_s)]
    if not len(settled):
        return  # the next change follows at once
    if isinstance(change.carry, SwingingPhone):
        assert abs(settled.mean(axis=0)[0]) > 0.9
    else:
        np.testing.assert_allclose(settled.mean(axis=0), expected[change.carry.mode], atol=0.3)


def test_a_change_leaves_what_was_before_it_alone() -> None:
    plain, changed = (walk_with(device).devices[0].motion for device in (DeviceParams(), MANY))
    before = plain.time_s < CHANGES[0].start_s
    np.testing.assert_array_equal(plain.specific_force_mps2[before], changed.specific_force_mps2[before])
    np.testing.assert_array_equal(plain.rotation_rate_radps[before], changed.rotation_rate_radps[before])


def test_the_motion_does_not_depend_on_the_rate() -> None:
    walk = walk_with(MANY)
    slow = walk_with(replace(MANY, sensors=replace(MANY.sensors, rate_hz=25.0)))
    fine, coarse = walk.devices[0].motion, slow.devices[0].motion
    np.testing.assert_allclose(fine.specific_force_mps2[::4], coarse.specific_force_mps2, atol=1e-9)
    np.testing.assert_allclose(fine.rotation_rate_radps[::4], coarse.rotation_rate_radps, atol=1e-9)


def test_the_true_modes_are_those_of_the_schedule() -> None:
    walk = walk_with(MANY)
    modes = walk.recording.truth.modes
    assert modes is not None
    asked_s = np.array([-1.0, 0.0, 0.99, 1.0, 1.79, 1.81, 6.5, 7.3, 10.5, 11.7, 99.0])
    trans, swing, holding = CarryingMode.TRANS, CarryingMode.SWING, CarryingMode.HOLDING
    assert modes.at(asked_s).tolist() == [
        0,
        holding,
        holding,
        trans,
        trans,
        swing,
        trans,
        holding,
        trans,
        swing,
        holding,
    ]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (lambda: (CHANGES[1], replace(CHANGES[2], start_s=7.0)), "start it later"),
        (lambda: (replace(CHANGES[1], turn_from=0.9, turn_to=0.5),), "swap the shares"),
        (lambda: (replace(CHANGES[1], duration_s=0.1),), "duration_s"),
        (lambda: (replace(CHANGES[1], carry=PocketPhone(amplitude_rad=-1.0)),), "amplitude_rad"),
    ],
)
def test_impossible_changes_are_refused(changes: Callable[[], tuple[ModeChange, ...]], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        simulate_walk(replace(preset("straight"), devices=(DeviceParams(changes=changes()),)))


def test_a_change_after_the_walk_is_over_is_harmless() -> None:
    late = DeviceParams(changes=(ModeChange(start_s=1000.0, carry=PocketPhone()),))
    walk = simulate_walk(Scenario(path=preset("l_shape").path, devices=(late,)))
    plain = simulate_walk(Scenario(path=preset("l_shape").path))
    np.testing.assert_array_equal(
        walk.devices[0].motion.specific_force_mps2, plain.devices[0].motion.specific_force_mps2
    )


def test_every_way_of_carrying_follows_every_other() -> None:
    carries = (HeldPhone(), SwingingPhone(), PocketPhone())
    order = [0, 1, 2, 0, 2, 1, 0]
    changes = tuple(
        ModeChange(start_s=4.0 + 3.0 * number, carry=carries[after])
        for number, (_, after) in enumerate(pairwise(order))
    )
    motion = walk_with(DeviceParams(changes=changes)).devices[0].motion
    assert np.isfinite(motion.specific_force_mps2).all()
    assert np.abs(np.diff(motion.position_m, axis=0)).max() < 0.06  # within 10 ms
