"""Colours and numbers of the carrying modes: on the map, above the signals, in the legends and in the summary."""

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.patches import PathPatch

from pdr_est.pipeline import DeviceWalk, SmoothedWalk
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.acceleration import plot_acceleration
from pdr_est.report.plots.gait import plot_gait
from pdr_est.report.plots.mode_style import ModeRun, draw_strip, mode_runs
from pdr_est.report.plots.time_axis import TimeAxis, time_axis
from pdr_est.report.plots.track import plot_track
from pdr_est.report.plots.track_line import mode_polylines
from pdr_est.report.walk.mode_statistics import mode_statistics
from pdr_est.report.walk.page import render_report
from pdr_est.report.walk.panels import time_panels, track_panel
from pdr_est.report.walk.summary import summarise
from pdr_est.types.steps import CarryingMode

HOLDING, SWING, POCKET = CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET


def carried(walk: SmoothedWalk, changes_s: Sequence[float], modes: Sequence[CarryingMode]) -> SmoothedWalk:
    """The walk with other modes: modes[i + 1] from changes_s[i] on; the probability is 0.5 for SWING, else 0.9."""

    def at(time_s: np.ndarray) -> np.ndarray:
        return np.array(modes, dtype=np.int8)[np.searchsorted(changes_s, time_s, side="right")]

    devices = []
    for device in walk.devices:
        steps = []
        for step in device.steps:
            mode = CarryingMode(int(at(np.array(step.event.time_s))))
            event = replace(step.event, mode=mode, mode_probability=0.5 if mode is SWING else 0.9)
            steps.append(replace(step, event=event))
        level = tuple(replace(block, mode=at(block.time_s)) for block in device.level)
        devices.append(replace(device, steps=tuple(steps), level=level))
    track = replace(walk.track, mode=at(walk.track.time_s))
    return replace(walk, track=track, devices=tuple(devices))


@pytest.fixture
def changing(make_walk) -> tuple:
    """A walk of 40 steps: 10 s HOLDING, 6 s SWING, then POCKET."""
    walk, recording = make_walk(steps=40)
    return carried(walk, (10.0, 16.0), (HOLDING, SWING, POCKET)), recording


def strip(axes: Axes) -> list[tuple[CarryingMode, float, float, float]]:
    """Mode, begin, end and bottom of every box of the strips above the axes."""
    by_colour = {colour: mode for mode, colour in svg.MODE_COLOURS.items()}
    boxes = []
    for shape in axes.patches:
        mode = by_colour.get(to_hex(shape.get_facecolor()))
        if mode is not None and isinstance(shape, PathPatch):
            for corners in shape.get_path().vertices.reshape(-1, 5, 2):
                (left, bottom), (right, _) = corners.min(axis=0), corners.max(axis=0)
                boxes.append((mode, left, right, bottom))
    return boxes


def only_device(walk: SmoothedWalk) -> DeviceWalk:
    (device,) = walk.devices
    return device


def test_runs_follow_each_other_and_stop_before_a_gap(changing) -> None:
    device = only_device(changing[0])
    (level,) = device.level
    arrays = {name: value for name, value in vars(level).items() if isinstance(value, np.ndarray)}
    early = replace(level, **{name: value[:600] for name, value in arrays.items()})
    late = replace(level, segment=1, **{name: value[700:] for name, value in arrays.items()})
    runs = mode_runs(replace(device, level=(early, late)))
    assert [run.mode for run in runs] == [HOLDING, SWING, SWING, POCKET]
    edges = [time_s for run in runs for time_s in (run.begin_s, run.end_s)]
    times = [0.0, 10.0, 10.0, level.time_s[599], level.time_s[700], 16.0, 16.0, level.time_s[-1]]
    assert edges == pytest.approx(times)
    assert mode_runs(replace(device, level=())) == []


def test_a_leg_has_the_mode_of_the_step_that_ends_it(changing) -> None:
    track = changing[0].track
    legs = mode_polylines(track)
    assert list(legs) == [HOLDING, SWING, POCKET]
    for mode, points in legs.items():
        ends = np.flatnonzero(track.mode[1:] == mode) + 1
        np.testing.assert_array_equal(points, track.position_m[ends[0] - 1 : ends[-1] + 1])


def test_a_mode_that_comes_back_is_not_joined_across_the_other(make_walk) -> None:
    walk, _ = make_walk(steps=40)
    legs = mode_polylines(carried(walk, (10.0, 16.0), (HOLDING, SWING, HOLDING)).track)
    assert np.isnan(legs[HOLDING]).all(axis=1).sum() == 1
    assert not np.isnan(legs[SWING]).any()


def test_every_leg_of_a_single_device_is_drawn_once_in_the_colour_of_its_mode(changing) -> None:
    track = changing[0].track
    every = plot_track(track).axes[0].lines
    lines = {line.get_color(): line for line in every if line.get_color() in svg.MODE_COLOURS.values()}
    assert set(lines) == {svg.MODE_COLOURS[mode] for mode in (HOLDING, SWING, POCKET)}
    assert sum(len(line.get_xdata()) - 1 for line in lines.values()) == len(track) - 1
    assert not lines[svg.MODE_COLOURS[HOLDING]].is_dashed()
    assert lines[svg.MODE_COLOURS[SWING]].is_dashed(), "colour is the only sign of the mode"


def test_several_devices_keep_their_colours_above_bands_of_the_modes(make_walk) -> None:
    walk, _ = make_walk(steps=40, devices=("1L", "2R"))
    walk = carried(walk, (10.0,), (HOLDING, POCKET))
    lines = list(plot_track(walk.track).axes[0].lines)
    bands = [i for i, line in enumerate(lines) if line.get_color() in svg.MODE_COLOURS.values()]
    devices = [
        i for i, line in enumerate(lines) if line.get_color() in svg.DEVICE_COLOURS and len(line.get_xdata()) == 41
    ]
    assert [lines[i].get_color() for i in devices] == [svg.device_colour(0), svg.device_colour(1)]
    assert len(bands) == 4
    assert max(bands) < min(devices)
    assert min(lines[i].get_linewidth() for i in bands) > 3 * max(lines[i].get_linewidth() for i in devices)


def test_strips_stand_above_both_parts_of_the_acceleration(changing) -> None:
    walk, _ = changing
    detail, whole = plot_acceleration(only_device(walk), time_axis(walk), svg.DEVICE_COLOURS[0]).axes
    runs = mode_runs(only_device(walk))
    assert [mode for mode, *_ in strip(whole)] == [run.mode for run in runs]
    for (_, begin, end, bottom), run in zip(strip(whole), runs, strict=True):
        assert (begin, end) == pytest.approx((run.begin_s, run.end_s))
        assert bottom > 1.0, "the strip covers the signal"
    low, high = detail.get_xlim()
    assert strip(detail)
    assert all(low - 1e-9 <= begin < end <= high + 1e-9 for _, begin, end, _ in strip(detail))


def test_every_device_has_a_strip_of_its_own_above_the_gait(make_walk) -> None:
    walk, _ = make_walk(steps=40, devices=("1L", "2R"))
    left, right = carried(walk, (), (POCKET,)).devices[0], carried(walk, (), (SWING,)).devices[1]
    figure = plot_gait(replace(walk, devices=(left, right)), time_axis(walk))
    heading = figure.axes[2]
    (first, *_, first_bottom), (second, *_, second_bottom) = strip(heading)
    assert (first, second) == (POCKET, SWING)
    assert first_bottom > second_bottom > 1.0
    dots = [line.get_color() for line in heading.lines if len(line.get_xdata()) == 1]
    assert dots == [svg.device_colour(0), svg.device_colour(1)]


@pytest.mark.slow
def test_thousands_of_changes_stay_small(make_walk) -> None:
    walk, recording = make_walk(steps=1500)
    changes_s = 3.0 + 0.5 * np.arange(1.0, 1500.0)
    restless = carried(walk, changes_s, [(HOLDING, SWING, POCKET)[i % 3] for i in range(1500)])
    assert len(mode_runs(only_device(restless))) == 1500
    calm_size, size = (len(str(panels)) for panels in (time_panels(walk), time_panels(restless)))
    assert size < calm_size + 300_000
    assert len(track_panel(restless, recording, in_map_frame=True).svg) < 300_000


def test_words_stand_only_where_they_fit() -> None:
    axes = svg.add_axes(svg.new_figure(2.0), 0.5, 1.0)
    runs = [ModeRun(0.0, 50.0, HOLDING), ModeRun(50.0, 51.0, SWING), ModeRun(51.0, 100.0, CarryingMode.UNKNOWN)]
    draw_strip(axes, runs, TimeAxis(0.0, 0.0, 100.0))
    assert [text.get_text() for text in axes.texts] == ["HOLDING", "UNKNOWN"]


def test_legends_name_the_modes_that_occur_and_no_other(changing) -> None:
    walk, recording = changing
    for panel in (track_panel(walk, recording, in_map_frame=True), *time_panels(walk)):
        named = [entry.label.split(":")[0] for entry in panel.legend if entry.colour.startswith("mode-")]
        assert named == ["HOLDING", "SWING", "POCKET"], panel.title


def test_shares_are_of_the_walking_time_and_probabilities_of_the_steps(changing) -> None:
    device = only_device(changing[0])
    uses = {use.mode: use for use in mode_statistics(device)}
    assert sum(use.steps for use in uses.values()) == 40
    assert sum(use.walking_time_share for use in uses.values()) == pytest.approx(1.0)
    assert uses[SWING].steps == sum(10.0 <= step.event.time_s < 16.0 for step in device.steps)
    assert uses[SWING].mean_probability == pytest.approx(0.5)
    slow = replace(device.steps[0], start_s=device.steps[0].event.time_s - 100.0)
    slowed = {use.mode: use for use in mode_statistics(replace(device, steps=(slow, *device.steps[1:])))}
    assert slowed[HOLDING].steps == uses[HOLDING].steps
    assert slowed[HOLDING].walking_time_share > 0.8 > uses[HOLDING].walking_time_share


def test_summary_and_page_list_the_modes_of_every_device(make_walk) -> None:
    walk, recording = make_walk(steps=40, devices=("1L", "2R"))
    walk = carried(walk, (10.0,), (SWING, POCKET))
    summary = json.loads(json.dumps(summarise(walk, recording, {}, {}, {}), allow_nan=False))
    rows = summary["carrying_modes"]
    assert [(row["device"], row["mode"]) for row in rows] == [
        ("1L", "POCKET"),
        ("1L", "SWING"),
        ("2R", "POCKET"),
        ("2R", "SWING"),
    ]
    assert rows[1]["mean_probability"] == pytest.approx(0.5)
    text = " ".join(re.sub("<[^>]*>", " ", render_report(walk, recording, summary)).split())
    assert f"2R SWING {100 * rows[3]['walking_time_share']:.1f} % {rows[3]['steps']} 50.0 %" in text


def test_no_step_means_no_modes(make_walk) -> None:
    walk, _ = make_walk(steps=0)
    assert mode_statistics(only_device(walk)) == []
    assert mode_polylines(walk.track) == {}


def test_every_colour_has_a_value_in_both_themes() -> None:
    template = (files("pdr_est") / "report" / "style.html.j2").read_text(encoding="utf-8")
    dark = template.index("prefers-color-scheme: dark")
    for colour in (*svg.MODE_COLOURS.values(), *svg.DEVICE_COLOURS, svg.FIX, svg.INK, svg.MUTED):
        definition = f"--{svg.css_name(colour)}: #"
        assert template.count(definition) == 2, definition
        assert template.index(definition) < dark < template.rindex(definition)
        assert f"--{svg.css_name(colour)}: {colour};" in template
    assert len({*svg.MODE_COLOURS.values(), *svg.DEVICE_COLOURS}) == len(svg.MODE_COLOURS) + len(svg.DEVICE_COLOURS)
