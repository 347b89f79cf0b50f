"""Figure of the height of the walker over time, with the floors."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.gait import BOTTOM_IN, SIGMA_95
from pdr_est.report.plots.time_axis import TimeAxis
from pdr_est.types.height import HeightProfile

_HEIGHT_IN = 1.5
_MOST_NAMED = 40  # stays on a floor; more would not be legible


def plot_heights(profile: HeightProfile, axis: TimeAxis) -> Figure:
    """Draw the height with its 95 % interval; moves are shaded, and the numbers of the floors stand over the line."""
    figure = svg.new_figure(BOTTOM_IN + _HEIGHT_IN + 0.3)
    axes = svg.add_axes(figure, BOTTOM_IN, _HEIGHT_IN)
    time, half_m = axis(profile.time_s), SIGMA_95 * profile.sigma_m
    colour = svg.device_colour(0)
    low_m, high_m = profile.height_m - half_m, profile.height_m + half_m
    axes.fill_between(time, low_m, high_m, color=colour, alpha=0.2, linewidth=0)
    axes.plot(time, profile.height_m, color=colour, linewidth=1.2)
    for move in profile.moves:
        axes.axvspan(*axis(np.array([move.begin_s, move.end_s])), color=svg.MUTED, alpha=0.25, linewidth=0)
    changes = np.flatnonzero(np.diff(profile.floor)) + 1
    if len(changes) < _MOST_NAMED:
        for stay in np.split(np.arange(len(profile.floor)), changes):
            middle = stay[len(stay) // 2]
            place = float(time[middle]), float(high_m[middle])
            axes.annotate(
                str(profile.floor[middle]), place, (0, 3), textcoords="offset points", ha="center", fontsize=7
            )
    axis.apply(axes, [])
    axes.margins(y=0.2)
    axes.yaxis.set_major_locator(MaxNLocator(4))
    svg.label_axes(axes, axis.label, "height (m)")
    return figure
