"""The plot of position errors over time."""

from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from pdr_est.evaluate.trajectories.scores import TrajectoryScore
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.time_axis import RASTER_FROM, TimeAxis

_HEIGHT_IN, _BOTTOM_IN, _TOP_IN = 1.9, 0.55, 0.1
_WITH_DOTS = 200  # more true positions are a line alone


def plot_errors(scores: Sequence[TrajectoryScore]) -> Figure:
    """Draw the error of each device at the true positions over time."""
    begin_s = min(float(score.pairs.time_s.min()) for score in scores)
    end_s = max(float(score.pairs.time_s.max()) for score in scores)
    axis = TimeAxis(begin_s, begin_s, max(end_s, begin_s + 1.0))
    figure = svg.new_figure(_BOTTOM_IN + _HEIGHT_IN + _TOP_IN)
    axes = svg.add_axes(figure, _BOTTOM_IN, _HEIGHT_IN)
    for number, score in enumerate(scores):
        few = len(score.error_m) <= _WITH_DOTS
        axes.plot(
            axis(score.pairs.time_s),
            score.error_m,
            "o-" if few else "-",
            color=svg.device_colour(number),
            linewidth=1.3,
            markersize=4.0,
            rasterized=len(score.error_m) > RASTER_FROM,
        )
    axis.apply(axes, ())
    axes.set_ylim(bottom=0.0)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    svg.label_axes(axes, f"time since the first true position ({axis.unit[1]})", "error (m)")
    return figure
