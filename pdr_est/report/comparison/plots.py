"""Plots of the comparison: distribution and growth of the errors, consistency of the covariance, tracks."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MultipleLocator, NullLocator, PercentFormatter

from pdr_est.frames import Array
from pdr_est.report.comparison.curves import (
    NOMINAL,
    coverage_shares,
    differ_widely,
    error_growth,
    error_range,
    growth_range,
    pooled_values,
)
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.floor_plan import draw_floor_plan
from pdr_est.report.plots.legend import LegendEntry
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.outcome import TrackOutcome

_DASHES: tuple[tuple[float, ...], ...] = ((), (3.2, 1.6), (1.1, 1.1), (5.0, 1.2, 1.1, 1.2))
_HEIGHT_IN, _BOTTOM_IN, _TOP_IN = 3.2, 0.52, 0.12
_WIDE_M = 6.0


def variant_styles(variants: Sequence[str]) -> dict[str, LegendEntry]:
    """Choose colour and dashes of each variant's line: four colours, then the same ones with dashes."""
    colours = len(svg.DEVICE_COLOURS)
    return {
        name: LegendEntry(
            "line",
            svg.css_name(svg.device_colour(number)),
            name,
            _DASHES[number // colours % len(_DASHES)],
        )
        for number, name in enumerate(variants)
    }


def plot_distribution(outcomes: Sequence[TrackOutcome], variants: Sequence[str]) -> Figure:
    """Draw the cumulative distribution of the position errors of each variant."""
    figure, axes = _figure()
    pools = [pooled_values(outcomes, name, "error_m") for name in variants]
    for number, pool in enumerate(pools):
        error_m = np.sort(pool)
        if not len(error_m):
            continue
        share = np.arange(1, len(error_m) + 1) / len(error_m)
        step = np.unique(np.linspace(0, len(error_m) - 1, 400).round().astype(int))
        _line(axes, np.append(error_m[0], error_m[step]), np.append(0.0, share[step]), number, stairs=True)
    lowest, highest = error_range(pools)
    if differ_widely(pools) and lowest > 0.0:
        axes.set_xscale("log")
        axes.set_xlim(lowest, highest)
        _plain_logarithmic(axes.xaxis)
    else:
        axes.set_xlim(0.0, highest)
    axes.set_ylim(0.0, 1.0)
    axes.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    svg.label_axes(axes, "error (m)", "share below")
    return figure


def plot_growth(outcomes: Sequence[TrackOutcome], variants: Sequence[str]) -> Figure:
    """Draw median (thick) and 90th percentile (thin) of the error against the distance walked.

    Few errors also as dots.
    """
    figure, axes = _figure()
    growth = error_growth(outcomes, variants)
    for number, name in enumerate(variants):
        if growth.few:
            way_m, error_m = (pooled_values(outcomes, name, field) for field in ("way_m", "error_m"))
            axes.plot(way_m, error_m, ".", color=svg.device_colour(number), markersize=4.0)
        _line(axes, growth.middle_m, growth.median_m[number], number, linewidth=2.2)
        _line(axes, growth.middle_m, growth.p90_m[number], number, linewidth=1.0)
    axes.set_xlim(0.0, growth.farthest_m)
    limits = growth_range(growth, [pooled_values(outcomes, name, "error_m") for name in variants])
    if limits[0] > 0.0:
        axes.set_yscale("log")
        axes.set_ylim(*limits)
        _plain_logarithmic(axes.yaxis)
    else:
        axes.set_ylim(bottom=0.0)
    svg.label_axes(axes, "distance walked (m)", "error (m)")
    return figure


def plot_coverage(outcomes: Sequence[TrackOutcome], variants: Sequence[str]) -> Figure:
    """Draw the fraction of true positions inside the confidence region of each nominal probability."""
    figure, axes = _figure()
    axes.plot([0.0, 1.0], [0.0, 1.0], color=svg.MUTED, linewidth=1.0, dashes=(4, 2.5))
    for number, name in enumerate(variants):
        squared = pooled_values(outcomes, name, "squared")
        if len(squared):
            _line(axes, NOMINAL, coverage_shares(squared), number)
    for axis, set_limits in ((axes.xaxis, axes.set_xlim), (axes.yaxis, axes.set_ylim)):
        set_limits(0.0, 1.0)
        axis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    svg.label_axes(axes, "stated probability", "share inside")
    return figure


def plot_tracks(outcomes: Sequence[TrackOutcome], variants: Sequence[str], plan: FloorPlan | None = None) -> Figure:
    """Draw the tracks of one walk, one line for each variant, over the true positions and the floor plan."""
    clouds = [one.drawn_m for one in outcomes] + [one.truth_m for one in outcomes]
    cloud = np.concatenate([points for points in clouds if len(points)])
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    span = np.maximum((high - low) * 1.08, _WIDE_M)
    width_in = svg.WIDTH_IN - svg.LEFT_IN - svg.RIGHT_IN
    height_in = width_in * float(np.clip(span[1] / span[0], 0.25, 0.5))
    metres_per_inch = max(span[0] / width_in, span[1] / height_in)
    half = 0.5 * metres_per_inch * np.array([width_in, height_in])
    middle = 0.5 * (low + high)
    figure = svg.new_figure(_BOTTOM_IN + height_in + _TOP_IN)
    axes = svg.add_axes(figure, _BOTTOM_IN, height_in)
    axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
    axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
    axes.set_aspect("equal")
    locator = svg.nice_step(2.0 * float(half[0]), 9)
    axes.xaxis.set_major_locator(MultipleLocator(locator))
    axes.yaxis.set_major_locator(MultipleLocator(locator))
    if plan is not None:
        draw_floor_plan(axes, plan)
    if len(outcomes[0].truth_m):
        east_m, north_m = outcomes[0].truth_m.T
        axes.plot(east_m, north_m, color=svg.MUTED, linewidth=1.0, dashes=(4, 2.5))
        axes.plot(east_m, north_m, "o", color=svg.PAPER, markeredgecolor=svg.MUTED, markersize=4.0)
    for one in outcomes:
        _line(axes, one.drawn_m[:, 0], one.drawn_m[:, 1], variants.index(one.variant), linewidth=1.6)
    svg.label_axes(axes, "east (m)", "north (m)")
    return figure


def _plain_logarithmic(axis: Axis) -> None:
    """Write plain numbers at 1, 2 and 5 times the powers of ten of a logarithmic axis."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _place: f"{value:g}"))
    axis.set_minor_locator(NullLocator())


def _figure() -> tuple[Figure, Axes]:
    figure = svg.new_figure(_BOTTOM_IN + _HEIGHT_IN + _TOP_IN)
    return figure, svg.add_axes(figure, _BOTTOM_IN, _HEIGHT_IN)


def _line(axes: Axes, x: Array, y: Array, number: int, linewidth: float = 1.8, stairs: bool = False) -> None:
    (line,) = axes.plot(x, y, color=svg.device_colour(number), linewidth=linewidth)
    line.set_drawstyle("steps-post" if stairs else "default")
    dashes = _DASHES[number // len(svg.DEVICE_COLOURS) % len(_DASHES)]
    if dashes:
        line.set_dashes(dashes)
