"""Confusion of modes and counted transitions, against cases worked out by hand."""

import numpy as np
import pytest

from pdr_est.evaluate.carrying_modes import count_transitions, mode_confusion, row_shares
from pdr_est.types.ground_truth import TrueModes
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode

UNKNOWN, HOLDING, SWING, POCKET, TRANS = (
    CarryingMode.UNKNOWN,
    CarryingMode.HOLDING,
    CarryingMode.SWING,
    CarryingMode.POCKET,
    CarryingMode.TRANS,
)
TRUTH = TrueModes(np.array([0.0, 10.0, 11.0, 20.0, 21.0]), np.array([HOLDING, TRANS, SWING, TRANS, POCKET], np.int8))


def labelled(*stretches: tuple[CarryingMode, int]) -> list[LevelBlock]:
    """Blocks with one sample every half second from 0 s on; each stretch is a block of some samples."""
    blocks, first = [], 0
    for mode, count in stretches:
        empty = np.zeros((count, 3))
        time_s = 0.5 * np.arange(first, first + count)
        label = np.full(count, mode, dtype=np.int8)
        none = np.zeros(count)
        blocks.append(LevelBlock(first, 0, time_s, empty, empty, none, none, empty, none, label, none))
        first += count
    return blocks


def test_confusion_counts_samples_outside_true_transitions():
    counts = mode_confusion(TRUTH, labelled((HOLDING, 20), (POCKET, 4), (SWING, 16), (TRANS, 4), (POCKET, 16)))
    assert counts[HOLDING].tolist() == [0, 20, 0, 0, 0, 0]
    assert counts[SWING].tolist() == [0, 0, 16, 2, 0, 0]
    assert counts[POCKET].tolist() == [0, 0, 0, 16, 0, 2]
    assert counts.sum() == 56


def test_confusion_counts_only_the_span():
    counts = mode_confusion(TRUTH, labelled((HOLDING, 60)), (1.0, 12.0))
    assert counts[HOLDING, HOLDING] == 18
    assert counts[SWING, HOLDING] == 3
    assert counts.sum() == 21


def test_shares_are_of_each_true_mode():
    counts = np.zeros((6, 6), dtype=np.int64)
    counts[HOLDING, HOLDING], counts[HOLDING, POCKET] = 3, 1
    share = row_shares(counts)
    assert share[HOLDING, POCKET] == pytest.approx(0.25)
    assert np.isnan(share[SWING]).all()


def test_transitions_seen_in_time_with_the_right_mode():
    found = count_transitions(TRUTH, labelled((HOLDING, 21), (SWING, 20), (POCKET, 19)))
    assert (found.real, found.missed, found.false) == (2, 0, 0)
    assert found.arrived[SWING, SWING] == found.arrived[POCKET, POCKET] == 1


def test_a_transition_that_was_not_seen_is_missed():
    found = count_transitions(TRUTH, labelled((HOLDING, 41), (POCKET, 19)))
    assert (found.real, found.missed, found.false) == (2, 1, 0)
    assert found.arrived.sum() == 1


def test_a_change_seen_too_late_is_missed_and_false():
    late = count_transitions(TRUTH, labelled((HOLDING, 25), (SWING, 16), (POCKET, 19)))
    assert (late.missed, late.false) == (1, 1)
    tolerated = count_transitions(TRUTH, labelled((HOLDING, 24), (SWING, 17), (POCKET, 19)))
    assert (tolerated.missed, tolerated.false) == (0, 0)


def test_a_change_seen_as_two_is_one_false_one():
    found = count_transitions(TRUTH, labelled((HOLDING, 20), (POCKET, 1), (SWING, 20), (POCKET, 19)))
    assert (found.missed, found.false) == (0, 1)


def test_a_run_of_transition_labels_is_one_change_wherever_it_leads():
    found = count_transitions(TRUTH, labelled((HOLDING, 5), (TRANS, 4), (HOLDING, 11), (TRANS, 4), (SWING, 36)))
    assert (found.real, found.missed, found.false) == (2, 1, 1)


def test_unknown_labels_fire_nothing():
    found = count_transitions(TRUTH, labelled((UNKNOWN, 4), (HOLDING, 17), (UNKNOWN, 2), (SWING, 18), (POCKET, 19)))
    assert (found.missed, found.false) == (0, 0)


def test_counts_of_walks_add_up():
    one = count_transitions(TRUTH, labelled((HOLDING, 60)))
    both = one + count_transitions(TRUTH, labelled((HOLDING, 21), (SWING, 39)))
    assert (both.real, both.missed, both.false) == (4, 3, 0)
    assert both.arrived.sum() == 1


def test_without_any_sample_every_transition_is_missed():
    found = count_transitions(TRUTH, [])
    assert (found.real, found.missed, found.false) == (2, 2, 0)
