"""Accuracies of gait labels, against cases worked out by hand."""

import numpy as np
import pytest

from pdr_est.evaluate.gait_recognition import accuracies, counts_of, recalls
from pdr_est.types.steps import Gait

UNKNOWN, WALKING, JOGGING, RUNNING = Gait.UNKNOWN, Gait.WALKING, Gait.JOGGING, Gait.RUNNING


def three_gaits():
    """10 steps walked, 5 jogged and 2 run."""
    return (
        counts_of(WALKING, [WALKING] * 8 + [RUNNING, UNKNOWN])
        + counts_of(JOGGING, [JOGGING] * 3 + [RUNNING, WALKING])
        + counts_of(RUNNING, [JOGGING, RUNNING])
    )


def test_rows_are_true_and_columns_are_labels():
    assert three_gaits().tolist() == [[0, 0, 0, 0], [1, 8, 0, 1], [0, 1, 3, 1], [0, 0, 1, 1]]


def test_accuracies_of_three_gaits():
    assert recalls(three_gaits()) == pytest.approx({WALKING: 0.8, JOGGING: 0.6, RUNNING: 0.5})
    assert accuracies(three_gaits()) == pytest.approx(
        {
            "gait_accuracy": 12 / 17,
            "walking_accuracy": (8 + 4 + 2) / 17,  # to run when jogging is meant is no mistake here
            "balanced_accuracy": (0.8 + 0.6 + 0.5) / 3,
        }
    )


def test_a_gait_that_nobody_walked_has_no_recall_and_weighs_nothing():
    counts = counts_of(WALKING, [WALKING, WALKING, JOGGING, WALKING]) + counts_of(UNKNOWN, [RUNNING] * 9)
    assert accuracies(counts) == {"gait_accuracy": 0.75, "walking_accuracy": 0.75, "balanced_accuracy": 0.75}
    assert recalls(counts) == {WALKING: 0.75}


def test_an_unknown_label_is_right_in_no_sense():
    counts = counts_of(JOGGING, [UNKNOWN, JOGGING])
    assert set(accuracies(counts).values()) == {0.5}


def test_without_a_step_of_a_known_gait_nothing_can_be_told():
    assert all(np.isnan(value) for value in accuracies(counts_of(UNKNOWN, [WALKING])).values())
