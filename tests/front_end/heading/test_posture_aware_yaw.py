"""The default heading on made-up steps of phones in any posture, which a hand puts elsewhere."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from heading_steps import SAMPLES, block, step_of
from scipy.spatial.transform import Rotation
from signals import run

from pdr_est.frames import Array, twist_about_vertical, up_in_device, wrap_angle
from pdr_est.front_end.heading.phone_posture import Posture, angle_between, level_axes
from pdr_est.front_end.heading.placement_change.auto_params import AutoHeadingParams
from pdr_est.front_end.heading.posture_aware_yaw import PostureAwareYaw
from pdr_est.front_end.heading.principal_axis import PrincipalAxisParams
from pdr_est.front_end.heading.step_motion import motion_of
from pdr_est.types.steps import CarryingMode, Step

PARAMETERS, AXIS = AutoHeadingParams(), PrincipalAxisParams()
FLAT = Rotation.identity()
HEAD_DOWN = Rotation.from_euler("x", 179.5, degrees=True)  # exactly so, an attitude has no yaw
UPRIGHT = Rotation.from_euler("x", 90.0, degrees=True)
HOLDING, POCKET, SWING = CarryingMode.HOLDING, CarryingMode.POCKET, CarryingMode.SWING
PHASE = 2.0 * np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES


def carried(
    number: int,
    heading_deg: float,
    mount: Rotation = FLAT,
    *,
    mode: CarryingMode = HOLDING,
    segment: int = 0,
    nod_deg: float = 0.0,
    compensated: bool = False,
    forward_mps2: float = 0.0,
) -> Step:
    """Step `number` of a walker in this direction, whose phone sits on the body as `mount` (device -> body) turns it.

    nod_deg: by how much it nods about the walker's sides during the step. forward_mps2: of the acceleration ahead,
    which leads the vertical one by a quarter of a step.
    """
    nod = Rotation.from_euler("y", nod_deg * np.sin(PHASE)[:, None], degrees=True)
    attitude = Rotation.from_euler("z", heading_deg, degrees=True) * nod * mount
    quaternion = np.roll(attitude.as_quat(), 1, axis=1)
    angle = np.deg2rad(heading_deg)
    ahead = -forward_mps2 * np.sin(PHASE)
    lift = 1.5 * forward_mps2 * np.cos(PHASE)
    world = np.stack([ahead * np.cos(angle), ahead * np.sin(angle), lift], axis=1)
    samples = replace(
        block(number, segment=segment),
        up=up_in_device(quaternion),
        yaw_rad=twist_about_vertical(quaternion),
        acceleration_mps2=attitude.inv().apply(world),
        vertical_mps2=lift,
    )
    return step_of(samples, mode, compensated)


def directed(steps: Sequence[Step], axis: PrincipalAxisParams = AXIS) -> Array:
    """Headings (n,) of the steps, degrees, not wrapped, less the first one."""
    found = run(PostureAwareYaw(PARAMETERS, axis), steps)
    assert [step.event for step in found] == [step.event for step in steps]
    assert all(-np.pi <= step.heading_rad < np.pi for step in found)
    heading = np.rad2deg(np.unwrap([step.heading_rad for step in found]))
    return np.asarray(heading - heading[0])


def learnt_at(steps: Sequence[Step]) -> list[int]:
    """Numbers of the steps at which a new offset is learnt: those with several possible turns."""
    found = run(PostureAwareYaw(PARAMETERS, AXIS), steps)
    return [number for number, step in enumerate(found) if step.turn_hypotheses]


def test_level_axes_and_up_make_a_right_handed_frame() -> None:
    for up in Rotation.random(20, random_state=1).apply([0.0, 0.0, 1.0]):
        first, second = level_axes(up)
        frame = np.stack([first, second, up])
        np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(frame) == pytest.approx(1.0)


def test_the_angle_between_directions() -> None:
    assert angle_between(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])) == pytest.approx(np.pi / 2.0)
    assert angle_between(np.array([0.6, 0.8, 0.0]), np.array([0.6, 0.8, 0.0])) == pytest.approx(0.0, abs=1e-7)
    assert angle_between(np.array([0.6, 0.8, 0.0]), np.array([-0.6, -0.8, 0.0])) == pytest.approx(np.pi)


@pytest.mark.parametrize("nod_deg", [0.0, 15.0])
@pytest.mark.parametrize("number", range(12))
def test_the_yaw_turns_with_the_walker_in_any_posture(number: int, nod_deg: float) -> None:
    mount = [FLAT, HEAD_DOWN, UPRIGHT, *Rotation.random(9, random_state=7)][number]
    posture = Posture(motion_of(carried(0, 0.0, mount)).up)
    yaws = [
        posture.yaw_rad(motion_of(carried(0, heading_deg, mount, nod_deg=nod_deg)))
        for heading_deg in (0.0, 40.0, 170.0, -160.0)
    ]
    turned = wrap_angle(np.array(yaws) - yaws[0] - np.deg2rad([0.0, 40.0, 170.0, -160.0]))
    np.testing.assert_allclose(turned, 0.0, atol=1e-6)


@pytest.mark.parametrize("mount", [FLAT, UPRIGHT, HEAD_DOWN])
def test_a_corner_and_a_full_circle(mount: Rotation) -> None:
    """Head down the twist of the attitude about the vertical is undefined; nodding about there, it jumps about."""
    directions = [0.0] * 6 + [45.0] + [90.0 + 15.0 * k for k in range(25)]
    steps = [carried(number, heading, mount, nod_deg=3.0) for number, heading in enumerate(directions)]
    np.testing.assert_allclose(directed(steps), directions, atol=0.5)


@pytest.mark.parametrize(("mode", "left_deg"), [(POCKET, 0.0), (SWING, 0.0), (HOLDING, 5.0)])
def test_what_alternates_with_the_legs_cancels_where_the_phone_is_on_a_limb(
    mode: CarryingMode, left_deg: float
) -> None:
    steps = [carried(number, 5.0 * (-1) ** number, mode=mode) for number in range(20)]
    found = run(PostureAwareYaw(PARAMETERS, AXIS), steps)
    inside = np.rad2deg([step.heading_rad for step in found])[1:-1]
    np.testing.assert_allclose(np.abs(inside), left_deg, atol=1e-6)


def test_corners_are_not_averaged() -> None:
    directions = [0.0] * 8 + [90.0] * 8
    steps = [carried(number, heading, mode=POCKET) for number, heading in enumerate(directions)]
    np.testing.assert_allclose(directed(steps), directions, atol=1e-6)


@pytest.mark.parametrize("number", range(8))
def test_a_phone_put_elsewhere_keeps_the_direction_and_turns_from_there(number: int) -> None:
    """It is turned by anything between two steps; the walker goes on, and turns later."""
    new = Rotation.from_euler("ZXZ", [50.0 * number, 50.0 + 15.0 * number, 70.0 * number], degrees=True)
    assert angle_between(new.inv().apply([0.0, 0.0, 1.0]), np.array([0.0, 0.0, 1.0])) > PARAMETERS.moved_rad
    steps = [carried(k, 20.0) for k in range(10)]
    steps += [carried(k, 20.0, new) for k in range(10, 20)]
    steps += [carried(k, 110.0, new) for k in range(20, 30)]
    np.testing.assert_allclose(directed(steps), [0.0] * 20 + [90.0] * 10, atol=0.1)
    assert learnt_at(steps) == [14]  # one step to arrive, four to learn from


def test_steps_in_a_transition_and_unseen_ones_keep_the_direction() -> None:
    steps = [carried(number, 20.0) for number in range(10)]
    steps += [carried(number, 60.0 * number, mode=CarryingMode.TRANS) for number in range(10, 13)]
    steps += [carried(13, 200.0, compensated=True)]
    steps += [carried(number, 20.0, UPRIGHT) for number in range(14, 24)]
    np.testing.assert_allclose(directed(steps), 0.0, atol=0.1)


def test_a_glance_at_the_screen_keeps_the_old_offset() -> None:
    """The walker turns meanwhile: back in its place the phone tells it, without a new offset to learn."""
    steps = [carried(number, 20.0, UPRIGHT) for number in range(10)]
    steps += [carried(number, 20.0) for number in range(10, 13)]
    steps += [carried(number, 80.0, UPRIGHT) for number in range(13, 20)]
    np.testing.assert_allclose(directed(steps), [0.0] * 13 + [60.0] * 7, atol=1e-6)
    assert learnt_at(steps) == []


def with_a_turn_meanwhile() -> list[Step]:
    """The walker turns by 60 degrees between two steps, just when the phone is put elsewhere."""
    steps = [carried(number, 20.0, forward_mps2=2.0) for number in range(12)]
    return steps + [carried(number, 80.0, UPRIGHT, forward_mps2=2.0) for number in range(12, 30)]


def test_the_axis_of_the_acceleration_tells_a_turn_made_meanwhile() -> None:
    """It is coherent: the turn is more probable than going straight on."""
    turned = directed(with_a_turn_meanwhile())
    np.testing.assert_allclose(turned[:16], 0.0, atol=1e-6)
    np.testing.assert_allclose(turned[16:], 60.0, atol=10.0)
    step = run(PostureAwareYaw(PARAMETERS, AXIS), with_a_turn_meanwhile())[16]
    assert step.turn_hypotheses[0].origin == "principal axis"
    assert sum(one.probability for one in step.turn_hypotheses) == pytest.approx(1.0)
    straight = [one for one in step.turn_hypotheses if abs(one.heading_change_rad) < 0.1]
    assert sum(one.probability for one in straight) < 0.2


def test_without_acceleration_the_walker_is_thought_to_go_straight_on() -> None:
    steps = [carried(number, 20.0) for number in range(12)]
    steps += [carried(number, 80.0, UPRIGHT) for number in range(12, 30)]
    np.testing.assert_allclose(directed(steps), 0.0, atol=0.1)
    step = run(PostureAwareYaw(PARAMETERS, AXIS), steps)[16]
    assert step.turn_hypotheses[0].origin == "straight on"
    assert 0.6 < step.turn_hypotheses[0].probability < 0.95


def test_the_most_probable_turn_is_that_of_the_headings() -> None:
    found = run(PostureAwareYaw(PARAMETERS, AXIS), with_a_turn_meanwhile())
    change = found[16].heading_rad - found[15].heading_rad
    assert found[16].turn_hypotheses[0].heading_change_rad == pytest.approx(float(wrap_angle(change)))


def test_a_turn_before_the_phone_was_taken_is_not_one_made_meanwhile() -> None:
    """The strides before tell the offset of the phone; the direction is that of the last steps alone."""
    steps = [carried(number, 0.0, forward_mps2=2.0) for number in range(10)]
    steps += [carried(number, 90.0, forward_mps2=2.0) for number in range(10, 15)]
    steps += [carried(number, 90.0, UPRIGHT, forward_mps2=2.0) for number in range(15, 30)]
    np.testing.assert_allclose(directed(steps)[10:], 90.0, atol=0.1)


def test_a_phone_taken_out_again_may_have_the_offset_that_it_had() -> None:
    """The walker turns by 60 degrees as it is taken out of the pocket."""
    steps = [carried(number, 0.0) for number in range(10)]
    steps += [carried(number, 0.0, UPRIGHT, mode=POCKET) for number in range(10, 22)]
    steps += [carried(number, 60.0) for number in range(22, 34)]
    hypotheses = run(PostureAwareYaw(PARAMETERS, AXIS), steps)[26].turn_hypotheses
    likely = [one for one in hypotheses if abs(np.rad2deg(one.heading_change_rad) - 60.0) < 10.0]
    assert "carried as before" in [one.origin for one in likely]
    assert sum(one.probability for one in likely) > 0.2


def test_over_a_gap_the_yaw_goes_on_and_steps_are_no_neighbours() -> None:
    steps = [carried(number, 20.0) for number in range(6)]
    steps += [carried(number, 70.0, segment=1) for number in range(8, 14)]
    found = run(PostureAwareYaw(PARAMETERS, AXIS), steps)
    assert np.rad2deg([step.heading_rad for step in found]) == pytest.approx([20.0] * 6 + [70.0] * 6)
    assert not any(step.turn_hypotheses for step in found)


def test_a_phone_put_elsewhere_in_a_gap_has_possible_turns() -> None:
    steps = [carried(number, 20.0) for number in range(6)]
    steps += [carried(number, 70.0, UPRIGHT, segment=1) for number in range(8, 20)]
    found = run(PostureAwareYaw(PARAMETERS, AXIS), steps)
    assert sum(bool(step.turn_hypotheses) for step in found) == 1


def test_a_step_waits_for_the_next_one() -> None:
    stage = PostureAwareYaw(PARAMETERS, AXIS)
    steps = [carried(0, 0.0), carried(1, 0.0), carried(2, 0.0, segment=1)]
    assert [len(stage.push(step)) for step in steps] == [0, 1, 1]
    assert len(stage.flush()) == 1
    assert stage.flush() == []


# --- thresholds of the posture, one by one


def about_x(angle_rad: float) -> Rotation:
    """A mount whose direction of gravity lies so far from that of a flat phone."""
    return Rotation.from_euler("x", angle_rad)


@pytest.mark.parametrize(("off_rad", "numbers"), [(0.3, []), (0.5, [17])])
def test_a_phone_is_back_within_returned_rad_of_its_old_posture(off_rad: float, numbers: list[int]) -> None:
    """It comes back at step 13; further away than 0.4 rad it has a new offset to learn, though not beyond 0.7 rad."""
    steps = [carried(number, 20.0, about_x(1.5)) for number in range(10)]
    steps += [carried(number, 20.0) for number in range(10, 13)]
    steps += [carried(number, 20.0, about_x(1.5 - off_rad)) for number in range(13, 23)]
    assert learnt_at(steps) == numbers


@pytest.mark.parametrize(
    ("moved_rad", "mode", "numbers"),
    [
        (0.5, HOLDING, []),
        (0.5, POCKET, [14]),
        (0.5, CarryingMode.OTHER, []),
        (0.3, POCKET, [15]),
        (0.8, HOLDING, [14]),
    ],
)
def test_a_smaller_change_is_enough_where_the_mode_changes_too(
    moved_rad: float, mode: CarryingMode, numbers: list[int]
) -> None:
    """Only the modes that recognisers tell apart well count: not OTHER."""
    steps = [carried(number, 20.0) for number in range(10)]
    steps += [carried(number, 20.0, about_x(moved_rad), mode=mode) for number in range(10, 20)]
    assert learnt_at(steps) == numbers


def test_a_last_step_at_which_the_phone_had_moved_already_does_not_tell_the_heading() -> None:
    steps = [carried(number, 20.0) for number in range(10)]
    steps += [carried(10, 60.0, about_x(0.3))]  # the hand turns the phone, and not the walker
    steps += [carried(number, 20.0, about_x(1.5)) for number in range(11, 21)]
    np.testing.assert_allclose(directed(steps)[11:], 0.0, atol=0.1)


def test_of_a_walker_who_turns_the_last_heading_is_kept() -> None:
    steps = [carried(number, 0.0) for number in range(9)]
    steps += [carried(9, 30.0)]
    steps += [carried(number, 30.0, about_x(1.5)) for number in range(10, 20)]
    np.testing.assert_allclose(directed(steps)[9:], 30.0, atol=3.0)  # or a little more: the walker was turning


def test_of_a_walker_who_goes_straight_the_mean_of_two_steps_is_kept() -> None:
    steps = [carried(number, 3.0 * (-1) ** number) for number in range(10)]
    steps += [carried(number, 0.0, about_x(1.5)) for number in range(10, 20)]
    np.testing.assert_allclose(directed(steps)[10:], -3.0, atol=0.1)  # less the first one, which is at 3


def test_what_a_limb_turns_from_step_to_step_is_no_turn_of_the_walker() -> None:
    steps = [
        carried(number, 12.0 * (-1) ** number) for number in range(10)
    ]  # by more than the walker turns in a bend
    steps += [carried(number, 0.0, about_x(1.5)) for number in range(10, 20)]
    np.testing.assert_allclose(directed(steps)[10:], -12.0, atol=0.1)  # less the first one, which is at 12


def test_first_steps_at_which_the_hand_still_turns_the_phone_teach_nothing() -> None:
    steps = [carried(number, 20.0) for number in range(10)]
    steps += [carried(10, 20.0, about_x(1.5)), carried(11, 130.0, about_x(1.5))]  # upright, but not yet as it stays
    steps += [carried(number, 20.0, about_x(1.5)) for number in range(12, 20)]
    np.testing.assert_allclose(directed(steps)[12:], 0.0, atol=1.0)


def test_a_phone_settles_in_a_hand_that_swings_widely() -> None:
    swings = [carried(k, 20.0, about_x(1.5 + 0.55 * (-1) ** k), mode=SWING) for k in range(10, 24)]
    assert learnt_at([carried(number, 20.0) for number in range(10)] + swings) == [14]


def test_the_first_step_in_a_new_posture_teaches_nothing() -> None:
    steps = [carried(number, 20.0) for number in range(10)]
    steps += [carried(10, 70.0, about_x(1.5))]  # the hand has not let go yet
    steps += [carried(number, 20.0, about_x(1.5)) for number in range(11, 20)]
    np.testing.assert_allclose(directed(steps), 0.0, atol=0.1)


@pytest.mark.parametrize("moves_rad", [(1.5, 3.0), (1.2, 1.7, 2.2)], ids=["at once", "little by little"])
def test_a_phone_that_moves_on_is_learnt_from_where_it_stays(moves_rad: tuple[float, ...]) -> None:
    """Little by little each posture is within 0.7 rad of the one before, and beyond it of the one before that."""
    passing = [carried(10 + k, 20.0, about_x(angle)) for k, angle in enumerate(moves_rad[:-1])]
    stays_from = 10 + len(passing)
    steps = [carried(number, 20.0) for number in range(10)] + passing
    steps += [carried(number, 20.0, about_x(moves_rad[-1])) for number in range(stays_from, stays_from + 10)]
    assert learnt_at(steps) == [stays_from + 4]


@pytest.mark.parametrize("modes", [(POCKET, SWING), (HOLDING, POCKET)])
def test_modes_that_flip_in_a_corner_are_no_other_place(modes: tuple[CarryingMode, CarryingMode]) -> None:
    directions = [0.0] * 12 + [30.0, 60.0] + [90.0] * 12 + [60.0, 30.0] + [0.0] * 12
    flips = {11, 12, 13, 14, 24, 25, 26, 27, 28}
    steps = [carried(k, turn, UPRIGHT, mode=modes[k in flips]) for k, turn in enumerate(directions)]
    np.testing.assert_allclose(directed(steps), directions, atol=16.0)  # strides are averaged at their edges
    np.testing.assert_allclose(directed(steps)[16:23], 90.0, atol=1.0)
    np.testing.assert_allclose(directed(steps)[-6:], 0.0, atol=1.0)


def test_a_hand_that_turns_the_phone_into_another_mode_of_the_same_posture() -> None:
    spun = Rotation.from_euler("z", 130.0, degrees=True) * UPRIGHT
    steps = [carried(k, 0.0, UPRIGHT, mode=HOLDING) for k in range(12)]
    steps += [carried(k, 0.0, spun, mode=POCKET) for k in range(12, 24)]
    assert learnt_at(steps)
    np.testing.assert_allclose(directed(steps)[-6:], 0.0, atol=5.0)
