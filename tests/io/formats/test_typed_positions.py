"""Annotations that are positions, and those that are remarks."""

import numpy as np
import pytest

from pdr_est.io.formats.phone_apps.sensor_logger.annotations import typed_positions


@pytest.mark.parametrize(
    "text", ["12.5, -3", "12.5 -3", "x=12.5 y=-3", "(12.5; -3.0)", "X: 12.5 m, Y: -3 m", "[12.5,-3]"]
)
def test_positions(text: str) -> None:
    (fix,) = typed_positions(np.array([4.0]), [text])
    assert fix.time_s == 4.0
    assert fix.position_m == pytest.approx([12.5, -3.0])
    assert fix.clock_known


@pytest.mark.parametrize(
    "text", ["door", "room 12, left", "12.5", "1, 2, 3", "3rd floor 2", "lat 48.1, lon 11.6", ""]
)
def test_remarks(text: str) -> None:
    assert typed_positions(np.array([4.0]), [text]) == ()


def test_a_time_that_is_missing() -> None:
    assert typed_positions(np.array([np.nan]), ["1, 2"]) == ()
