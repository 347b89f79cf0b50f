"""MMPDR's state machine on made-up rotation rates and gravity whose modes follow from Tables I and II by hand."""

from dataclasses import replace
from itertools import groupby

import numpy as np
import pytest
from signals import level, run

from pdr_est.frames import Array
from pdr_est.front_end.mode.mmpdr_fsm import MmpdrMode, MmpdrModeParams
from pdr_est.front_end.signal.blocks import part
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode

RATE_HZ = 5.0
WINDOW = 10  # samples of two seconds
HOLDING, SWING, POCKET, TRANS = (CarryingMode[name] for name in ("HOLDING", "SWING", "POCKET", "TRANS"))

# Gravity in the paper's axes, units of g; it points down, so that a phone held with its screen up has z = -1.
NEUTRAL = (0.3, 0.3, 0.3)  # no condition of Table I
FLAT_IN_HAND = (0.0, -0.1, -0.99)
HANGING_ARM = (0.95, -0.2, 0.0)
TRIGGER = (0.0, 9.0, 9.0)  # rotation rate, rad/s, that begins a transition in every mode

Triple = tuple[float, float, float]


def phone(gravity: list[Triple], rate: dict[int, Triple] | None = None, segment: int = 0) -> LevelBlock:
    """Samples with these directions of gravity, at rest but for the rotation rates at some samples."""
    turning = np.zeros((len(gravity), 3))
    for i, radps in (rate or {}).items():
        turning[i] = radps
    block = level(np.zeros(len(gravity)), segment, rate_hz=RATE_HZ)
    return replace(block, up=-np.array(gravity), rotation_rate_radps=turning)


def modes_of(*blocks: LevelBlock, **changes: float) -> list[CarryingMode]:
    """The mode of every sample."""
    labelled = run(MmpdrMode(RATE_HZ, MmpdrModeParams(**changes)), blocks)
    return [CarryingMode(mode) for block in labelled for mode in block.mode.tolist()]


def ways_into(mode: CarryingMode) -> tuple[list[Triple], dict[int, Triple]]:
    """Gravity and rates that lead from the beginning into a mode, which the sample after them has."""
    if mode is HOLDING:
        return [], {}
    return [HANGING_ARM if mode is SWING else NEUTRAL] * WINDOW, {0: TRIGGER}


def mode_after(before: CarryingMode, window: dict[int, Triple], rest: Triple = NEUTRAL) -> CarryingMode:
    """The mode after a transition whose samples have gravity `rest`, but for those of `window`."""
    gravity, rates = ways_into(before)
    watched = [window.get(i, rest) for i in range(WINDOW)]
    start = len(gravity)
    found = modes_of(phone([*gravity, *watched, NEUTRAL], rates | {start: TRIGGER}))
    assert found[start:-1] == [TRANS] * WINDOW
    return found[-1]


# --- Table II: which rotation begins a transition


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("mode", "rate", "begins"),
    [
        (HOLDING, (9.0, 2.9, 4.9), False),
        (HOLDING, (0.0, 3.1, 0.0), True),
        (HOLDING, (0.0, 0.0, 5.1), True),
        (SWING, (9.0, 2.9, 9.0), False),
        (SWING, (0.0, 3.1, 0.0), True),
        (POCKET, (9.0, 9.0, 4.9), False),
        (POCKET, (0.0, 0.0, 5.1), True),
    ],
)
def test_each_mode_watches_its_own_axes(mode: CarryingMode, rate: Triple, begins: bool, sign: float) -> None:
    gravity, rates = ways_into(mode)
    start = len(gravity) + 1
    turned = tuple(sign * one for one in rate)
    found = modes_of(phone([*gravity, NEUTRAL, NEUTRAL], rates | {start: turned}))  # type: ignore[dict-item]
    assert found[-2:] == [mode, TRANS if begins else mode]


def test_a_rate_of_exactly_the_threshold_begins_nothing() -> None:
    assert modes_of(phone([NEUTRAL], {0: (0.0, 3.0, 5.0)})) == [HOLDING]


# --- Table I: which mode a transition leads to


@pytest.mark.parametrize("at", [0, 4, WINDOW - 1])
@pytest.mark.parametrize(("before", "otherwise"), [(SWING, POCKET), (POCKET, SWING)])
@pytest.mark.parametrize(
    ("gravity", "holds"),
    [
        ((0.0, -0.7, -0.1), True),
        ((0.0, -0.1, -0.7), True),
        ((0.0, -0.7, 0.1), False),  # the screen faces down
        ((0.0, 0.1, -0.7), False),  # the phone stands on its head
        ((0.0, 0.7, 0.1), False),  # the condition with the opposite sign of gravity
        ((0.0, 0.1, 0.7), False),
        ((0.0, -0.6, -0.6), False),  # neither is beyond 0.65
        ((-0.7, -0.1, -0.1), False),
    ],
)
def test_one_sample_of_a_held_phone_leads_to_holding(
    before: CarryingMode, otherwise: CarryingMode, gravity: Triple, holds: bool, at: int
) -> None:
    assert mode_after(before, {at: gravity}) is (HOLDING if holds else otherwise)


@pytest.mark.parametrize("at", [0, 4, WINDOW - 1])
@pytest.mark.parametrize(
    ("gravity_x", "after"), [(0.95, SWING), (-0.95, SWING), (0.85, POCKET), (-0.85, POCKET), (0.9, POCKET)]
)
def test_one_sample_of_a_hanging_arm_leads_from_holding_to_swing(
    gravity_x: float, after: CarryingMode, at: int
) -> None:
    assert mode_after(HOLDING, {at: (gravity_x, 0.0, 0.0)}) is after


@pytest.mark.parametrize("at", [0, 4, WINDOW - 1])
@pytest.mark.parametrize(("gravity_z", "after"), [(0.39, SWING), (0.4, POCKET), (0.5, POCKET), (-0.9, SWING)])
def test_every_sample_must_keep_its_screen_from_facing_down_for_swing(
    gravity_z: float, after: CarryingMode, at: int
) -> None:
    """All g_z stay below the threshold, not just one of them."""
    assert mode_after(HOLDING, {at: (0.0, 0.0, gravity_z)}, rest=HANGING_ARM) is after


def test_from_holding_a_held_phone_in_the_window_does_not_lead_back() -> None:
    assert mode_after(HOLDING, {4: FLAT_IN_HAND}) is POCKET


def test_a_swinging_phone_in_the_window_is_no_condition_from_pocket_or_swing() -> None:
    assert mode_after(SWING, {}, rest=HANGING_ARM) is POCKET
    assert mode_after(POCKET, {}, rest=(0.95, 0.2, 0.9)) is SWING


# --- the window


def test_only_the_samples_of_the_window_count() -> None:
    """The arm hangs down just before and just after the two seconds."""
    gravity = [HANGING_ARM, *[NEUTRAL] * WINDOW, HANGING_ARM]
    assert modes_of(phone(gravity, {1: TRIGGER})) == [HOLDING, *[TRANS] * WINDOW, POCKET]


def test_rotation_within_a_transition_does_not_prolong_it_and_counts_again_right_after() -> None:
    gravity = [NEUTRAL] * (WINDOW + 2)
    within = modes_of(phone(gravity, {0: TRIGGER, 5: TRIGGER, WINDOW - 1: TRIGGER}))
    assert within == [TRANS] * WINDOW + [POCKET] * 2
    after = modes_of(phone(gravity, {0: TRIGGER, WINDOW: TRIGGER}))
    assert after == [TRANS] * (WINDOW + 2)


def test_each_transition_forgets_what_was_seen_in_the_one_before() -> None:
    """HOLDING -> POCKET (screen down once) -> HOLDING -> SWING -> POCKET -> SWING."""
    windows = [
        [HANGING_ARM, (0.0, 0.0, 0.9), *[NEUTRAL] * (WINDOW - 2)],
        [FLAT_IN_HAND, *[NEUTRAL] * (WINDOW - 1)],
        [HANGING_ARM, *[NEUTRAL] * (WINDOW - 1)],
        [NEUTRAL] * WINDOW,
        [NEUTRAL] * WINDOW,
    ]
    gravity = [one for window in windows for one in (*window, NEUTRAL)]
    starts = {k * (WINDOW + 1): TRIGGER for k in range(len(windows))}
    found = modes_of(phone(gravity, starts))
    assert [mode for mode, _ in groupby(found) if mode is not TRANS] == [POCKET, HOLDING, SWING, POCKET, SWING]


def test_the_second_transition_from_holding_does_not_remember_a_hanging_arm() -> None:
    windows = [[HANGING_ARM, *[NEUTRAL] * (WINDOW - 1)], [FLAT_IN_HAND] * WINDOW, [NEUTRAL] * WINDOW]
    gravity = [one for window in windows for one in (*window, NEUTRAL)]
    found = modes_of(phone(gravity, {k * (WINDOW + 1): TRIGGER for k in range(3)}))
    assert [mode for mode, _ in groupby(found) if mode is not TRANS] == [SWING, HOLDING, POCKET]


def test_a_new_segment_begins_in_holding() -> None:
    first = phone([NEUTRAL] * (WINDOW + 1), {0: TRIGGER})
    cut_off = phone([NEUTRAL] * 3, {0: TRIGGER}, segment=1)
    assert modes_of(first, cut_off, phone([NEUTRAL] * 2, segment=2))[-6:] == [POCKET, *[TRANS] * 3, *[HOLDING] * 2]


def test_what_was_seen_at_the_beginning_of_a_window_outlasts_every_cut() -> None:
    """Only the first sample of each window meets a condition, and samples come one by one."""
    rest = [NEUTRAL] * (WINDOW - 1)
    gravity: list[Triple] = [
        HANGING_ARM,
        *rest,
        NEUTRAL,
        FLAT_IN_HAND,
        *rest,
        NEUTRAL,
        (0.95, 0.0, 0.5),
        *rest,
        NEUTRAL,
    ]
    block = phone(gravity, {k * (WINDOW + 1): TRIGGER for k in range(3)})
    pieces = [part(block, i, i + 1) for i in range(len(block))]
    assert [mode for mode, _ in groupby(modes_of(*pieces)) if mode is not TRANS] == [SWING, HOLDING, POCKET]
    assert modes_of(*pieces) == modes_of(block)


def test_the_window_is_a_duration_and_the_latency() -> None:
    stage = MmpdrMode(50.0, MmpdrModeParams())
    assert stage.latency_s == pytest.approx(2.0)
    fast = replace(phone([NEUTRAL] * 120, {0: TRIGGER}), time_s=np.arange(120) / 50.0)
    (labelled,) = run(stage, [fast])
    assert np.count_nonzero(labelled.mode == TRANS) == 100
    probability: Array = labelled.mode_probability
    assert (probability == 1.0).all()
