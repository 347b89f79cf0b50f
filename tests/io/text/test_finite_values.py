"""Signals keep their finite rows, and what is left out is counted."""

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.io.text.finite_values import finite_signal, finite_signal_or_none


def test_rows_that_are_not_finite_are_dropped_and_counted() -> None:
    time_s = np.array([0.0, 1.0, np.nan, 3.0])
    values = np.array([[1.0, 1.0], [np.inf, 1.0], [1.0, 1.0], [2.0, 2.0]])
    signal, warnings = finite_signal(time_s, values, "rotation rate", "walk.csv")
    np.testing.assert_array_equal(signal.time_s, [0.0, 3.0])
    assert warnings == ("rotation rate: 2 of 4 rows are left out: NaN or infinite values",)
    assert finite_signal(signal.time_s, signal.values, "rotation rate", "walk.csv")[1] == ()


def test_nothing_finite_or_nothing_at_all_is_an_error() -> None:
    with pytest.raises(RecordingError, match=r"walk\.csv: all 1 rows of rotation rate are NaN"):
        finite_signal(np.zeros(1), np.full((1, 3), np.nan), "rotation rate", "walk.csv")
    with pytest.raises(RecordingError, match=r"walk\.csv: rotation rate has no rows"):
        finite_signal(np.zeros(0), np.zeros((0, 3)), "rotation rate", "walk.csv")


def test_a_sensor_that_may_be_missing_is_left_out_with_a_warning() -> None:
    for n_rows, reason in ((0, "it has no rows"), (2, "all 2 rows contain NaN or infinite values")):
        signal, warnings = finite_signal_or_none(
            np.arange(float(n_rows)), np.full((n_rows, 3), np.nan), "magnetometer", "walk.csv"
        )
        assert signal is None
        assert warnings == (f"magnetometer: left out because {reason}",)
