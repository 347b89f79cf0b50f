"""Gaps and segments are drawn as a single shape and a single line, so that their number costs no time."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from pdr_est.report.plots.time_axis import TimeAxis
from pdr_est.types.sensors import Gap


@pytest.mark.parametrize("count", [1, 5000])
def test_any_number_of_gaps_is_one_shape(count: int) -> None:
    starts_s = np.arange(count, dtype=np.float64)
    gaps = [Gap("specific_force", float(start_s), float(start_s) + 0.5, "gap") for start_s in starts_s]
    axes = Figure().add_subplot()
    TimeAxis(0.0, 0.0, float(count)).apply(axes, [*gaps, *gaps])
    (shape,) = axes.patches
    assert len(shape.get_path().vertices) == 5 * count


def test_no_gap_gives_no_shape() -> None:
    axes = Figure().add_subplot()
    TimeAxis(0.0, 0.0, 10.0).apply(axes, [])
    assert not axes.patches
