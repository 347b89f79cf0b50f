"""Height and floors in the report of a walk."""

from dataclasses import replace
from functools import cache

import numpy as np

from pdr_est.config import Config
from pdr_est.pipeline import SmoothedWalk, smooth_recording
from pdr_est.report.plots.heights import plot_heights
from pdr_est.report.plots.time_axis import time_axis
from pdr_est.report.walk.explorer_data import explorer_data
from pdr_est.report.walk.map_extras import MapExtras
from pdr_est.report.walk.panels import time_panels
from pdr_est.simulate import preset, simulate_walk


@cache
def walk() -> SmoothedWalk:
    return smooth_recording(simulate_walk(preset("floors")).recording, Config().with_estimator("ekf"))


def test_the_heights_have_a_panel_with_floors_and_moves() -> None:
    titles = [panel.title for panel in time_panels(walk())]
    assert titles[-1] == "Height and floors"
    figure = plot_heights(walk().track.height, time_axis(walk()))
    numbers = [text.get_text() for text in figure.axes[0].texts]
    assert numbers[:2] == ["0", "1"]
    (line,) = figure.axes[0].lines
    assert np.max(line.get_ydata()) > 20.0
    assert len(figure.axes[0].patches) == len(walk().track.height.moves) == 3


def test_without_heights_there_is_no_panel() -> None:
    flat = replace(walk(), track=replace(walk().track, height=None))
    assert "Height and floors" not in [panel.title for panel in time_panels(flat)]
    assert explorer_data(flat, [], None, True, MapExtras())["height"] is None


def test_the_explorer_has_the_heights() -> None:
    data = explorer_data(walk(), [], None, True, MapExtras())["height"]
    assert set(data["columns"]) == {"time_s", "height_m", "sigma_m", "floor"}
    assert set(data["moves"]) == {"begin_s", "end_s"}
