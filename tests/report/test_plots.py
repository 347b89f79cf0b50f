"""The plots show what they should, and stay readable and small."""

import re
import subprocess
import sys
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.patches import Ellipse

from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.acceleration import plot_acceleration
from pdr_est.report.plots.finding_marks import marked_places
from pdr_est.report.plots.gait import plot_gait
from pdr_est.report.plots.time_axis import TimeAxis, time_axis
from pdr_est.report.plots.track import ELLIPSES, plot_track, select_ellipses
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import PositionFix
from pdr_est.types.sensors import Gap


def ellipses(figure) -> list[Ellipse]:
    return [patch for patch in figure.axes[0].patches if isinstance(patch, Ellipse)]


def inside(figure, points: np.ndarray) -> np.ndarray:
    axes = figure.axes[0]
    (west, east), (south, north) = axes.get_xlim(), axes.get_ylim()
    return (west <= points[:, 0]) & (points[:, 0] <= east) & (south <= points[:, 1]) & (points[:, 1] <= north)


def test_axes_of_the_track_are_equal_and_hold_everything(make_walk) -> None:
    walk, recording = make_walk()
    fix = PositionFix(0.0, np.array([-30.0, 5.0]), np.eye(2))
    truth = np.vstack([recording.truth.positions.position_m, [70.0, -4.0]])
    figure = plot_track(walk.track, (fix,), truth)
    axes = figure.axes[0]
    figure.draw_without_rendering()
    box = axes.get_window_extent()
    metres = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
    assert metres[0] / box.width == pytest.approx(metres[1] / box.height, rel=1e-6)
    assert inside(figure, np.vstack([walk.track.position_m, truth, fix.position_m])).all()


def test_ellipse_is_the_95_percent_region(make_walk) -> None:
    walk, _ = make_walk(steps=0)
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    covariance = turn @ np.diag([4.0, 0.25]) @ turn.T
    figure = plot_track(replace(walk.track, covariance_m2=covariance[None]))
    ellipse = ellipses(figure)[0]
    scale = 2.0 * np.sqrt(-2.0 * np.log(0.05))
    assert (ellipse.width, ellipse.height) == pytest.approx((2.0 * scale, 0.5 * scale))
    assert ellipse.angle % 180.0 == pytest.approx(np.degrees(np.arctan2(0.8, 0.6)))


@pytest.mark.parametrize("steps", [1, 250, 20_000])
def test_ellipses_are_thinned_and_the_last_pose_keeps_its_own(make_walk, steps: int) -> None:
    walk, _ = make_walk(steps=steps)
    chosen = select_ellipses(walk.track, ELLIPSES)
    assert chosen[-1] == steps
    assert chosen == sorted(set(chosen))
    assert len(chosen) <= ELLIPSES + 1


def test_huge_uncertainty_does_not_shrink_the_track_to_a_dot(make_walk) -> None:
    walk, _ = make_walk(steps=250)
    figure = plot_track(replace(walk.track, covariance_m2=1e8 * walk.track.covariance_m2))
    assert np.ptp(figure.axes[0].get_xlim()) < 2.5 * np.ptp(walk.track.position_m[:, 0])


def test_broken_covariances_are_left_out(make_walk) -> None:
    walk, _ = make_walk(steps=20)
    covariance = walk.track.covariance_m2.copy()
    covariance[-1] = np.nan
    figure = plot_track(replace(walk.track, covariance_m2=covariance))
    assert ellipses(figure)
    assert plot_track(replace(walk.track, covariance_m2=np.full_like(covariance, np.inf))).axes


def test_acceleration_has_every_step_and_does_not_bridge_a_gap(make_walk) -> None:
    walk, _ = make_walk(steps=40)
    device = walk.devices[0]
    (level,) = device.level
    arrays = {name: value for name, value in vars(level).items() if isinstance(value, np.ndarray)}
    early = replace(level, **{name: value[:400] for name, value in arrays.items()})
    late = replace(level, segment=1, **{name: value[600:] for name, value in arrays.items()})
    gap = Gap("specific_force", 8.0, 12.0, "gap")
    figure = plot_acceleration(
        replace(device, level=(early, late), gaps=(gap,)), time_axis(walk), svg.DEVICE_COLOURS[0]
    )
    detail, whole = figure.axes
    line, dots = whole.lines
    time_s = line.get_xdata()
    (broken,) = np.flatnonzero(np.isnan(time_s))
    assert time_s[broken - 1] < gap.start_s < gap.end_s <= time_s[broken + 1]
    np.testing.assert_allclose(dots.get_xdata(), [step.event.time_s for step in device.steps])
    middle = device.steps[20].event.time_s
    assert detail.get_xlim()[0] < middle < detail.get_xlim()[1]


def test_short_recording_is_shown_once(make_walk) -> None:
    walk, _ = make_walk(steps=10)
    assert len(plot_acceleration(walk.devices[0], time_axis(walk), svg.DEVICE_COLOURS[0]).axes) == 1


def test_gait_plot_leaves_out_the_start_and_the_first_cadence(make_walk) -> None:
    walk, _ = make_walk(steps=30)
    cadence, length, heading = plot_gait(walk, time_axis(walk)).axes
    assert len(length.lines[0].get_xdata()) == 30
    np.testing.assert_allclose(
        cadence.lines[0].get_ydata(), [60.0 * step.frequency_hz for step in walk.devices[0].steps[1:]]
    )
    assert np.abs(heading.lines[-1].get_ydata()).max() <= 180.0


@pytest.mark.parametrize(("duration_s", "unit"), [(90.0, "s"), (600.0, "min"), (8 * 3600.0, "h")])
def test_time_counts_from_the_start_in_a_unit_that_suits(duration_s: float, unit: str) -> None:
    axis = TimeAxis(100.0, 100.0, 100.0 + duration_s)
    assert axis.unit[1] == unit
    assert float(axis(100.0)) == 0.0
    assert float(axis(100.0 + duration_s)) == pytest.approx(duration_s / {"s": 1, "min": 60, "h": 3600}[unit])


def test_envelope_keeps_extremes_and_forgets_nothing() -> None:
    time = np.linspace(0.0, 100.0, 50_001)
    values = np.sin(time)
    values[[123, 40_000]] = [9.0, -9.0]
    short_time, short = svg.min_max_envelope(time, values, 500)
    assert len(short) <= 1000
    assert short.max() == 9.0
    assert short.min() == -9.0
    assert short_time[0] == 0.0
    same_time, same = svg.min_max_envelope(time[:50], values[:50], 500)
    assert same_time is not None
    np.testing.assert_array_equal(same, values[:50])


@pytest.mark.parametrize(("span", "step"), [(9.0, 1.0), (9.1, 2.0), (0.31, 0.05), (4000.0, 500.0)])
def test_steps_of_the_grid_are_round(span: float, step: float) -> None:
    assert svg.nice_step(span, 9) == pytest.approx(step)


def test_svg_is_well_formed_themed_and_free_of_addresses(make_walk) -> None:
    walk, recording = make_walk(steps=60)
    text = svg.to_svg(plot_track(walk.track, walk.fixes, recording.truth.positions.position_m), "map", "A map")
    root = ElementTree.fromstring(text)
    assert root.tag == "svg"
    assert root.attrib["viewBox"]
    assert "http" not in text
    assert not set(re.findall(r"#[0-9a-f]{6}", text)), "a colour that no theme changes"
    ids = re.findall(r'\bid="([^"]*)"', text)
    assert len(ids) == len(set(ids))
    assert all(name.startswith("map-") for name in ids)
    used = set(re.findall(r'(?:url\(|href=")#([^)"]+)', text))
    assert used <= set(ids)
    again = svg.to_svg(plot_track(walk.track, walk.fixes, recording.truth.positions.position_m), "map", "A map")
    assert again == text


def test_doubtful_findings_with_a_time_are_marked_where_they_are(make_walk) -> None:
    walk, _ = make_walk(steps=20, devices=("1L", "2R"))
    first, other = (walk.track.of_device(name) for name in ("1L", "2R"))
    begin_s, end_s = float(first.time_s[4]), float(first.time_s[7])
    kind = FindingKind.PLACEMENT
    track = replace(
        walk.track,
        findings=(
            Finding(kind, "a span of one device", "2R", begin_s, end_s),
            Finding(kind, "a moment of all", "", begin_s, begin_s),
            Finding(kind, "certain", "", begin_s, end_s, doubtful=False),
            Finding(kind, "whole walk"),
            Finding(kind, "of a device that has no track", "3X", begin_s, end_s),
        ),
    )
    found = marked_places(track)
    expected = [other.position_m[4:8], first.position_m[4:5], other.position_m[4:5]]
    assert len(found) == len(expected)
    for points, places in zip(found, expected, strict=True):
        np.testing.assert_allclose(points, places)
    drawn = [line for line in plot_track(track).axes[0].lines if svg.DOUBT in (line.get_color(), line.get_mec())]
    assert len(drawn) == 3
    assert not any(line.get_color() == svg.DOUBT for line in plot_track(walk.track).axes[0].lines)


def test_matplotlib_loads_without_composed_docstrings_and_then_has_them_again() -> None:
    code = """
from pdr_est.report.plots.matplotlib_loading import loading_matplotlib

with loading_matplotlib():
    from matplotlib.lines import Line2D
assert "markersize" not in Line2D.set.__doc__
from matplotlib.artist import kwdoc
assert "markersize" in kwdoc(Line2D)
with loading_matplotlib():
    assert "markersize" in kwdoc(Line2D)
line = Line2D([0, 1], [0, 1])
line.set(linewidth=3.0)
assert line.get_linewidth() == 3.0
"""
    subprocess.run((sys.executable, "-c", code), check=True)
