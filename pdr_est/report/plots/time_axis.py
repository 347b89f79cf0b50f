"""The time axis that the plots over time share."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator

from pdr_est.frames import Array
from pdr_est.pipeline import SmoothedWalk
from pdr_est.report.plots import figure as svg
from pdr_est.types.sensors import Gap

RASTER_FROM = 2500  # marks; more are drawn as an image
ONE_PATH_FROM = 600  # marks; more are one shape, which takes a tenth of the time


@dataclass(frozen=True)
class TimeAxis:
    """Time interval in a unit that suits its length.

    Attributes
    ----------
    zero_s : float
        Time at which the axis begins to count, s.
    begin_s, end_s : float
        Interval that is shown, s.
    """

    zero_s: float
    begin_s: float
    end_s: float

    @property
    def unit(self) -> tuple[float, str]:
        """Return the number of seconds in the unit, and its symbol."""
        duration_s = self.end_s - self.begin_s
        if duration_s < 200.0:
            return 1.0, "s"
        return (60.0, "min") if duration_s < 3 * 3600.0 else (3600.0, "h")

    @property
    def label(self) -> str:
        """Return the label of the axis."""
        return f"time since the start of the recording ({self.unit[1]})"

    def __call__(self, time_s: Array | float) -> Array:
        """Convert times of the recording, s, to values on this axis."""
        return (np.asarray(time_s, dtype=np.float64) - self.zero_s) / self.unit[0]

    def section(self, begin_s: float, end_s: float) -> "TimeAxis":
        """Return a part of this axis."""
        return TimeAxis(self.zero_s, begin_s, end_s)

    def apply(self, axes: Axes, gaps: Sequence[Gap]) -> None:
        """Set limits and ticks, and shade what was not recorded."""
        self._shade(axes, gaps)
        steps = [1, 2, 5, 10] if self.unit[1] == "s" else [1, 1.5, 3, 6, 10]  # quarters of an hour, not fifths
        axes.set_xlim(*self(np.array([self.begin_s, self.end_s])))
        axes.xaxis.set_major_locator(MaxNLocator(12, steps=steps))
        axes.ticklabel_format(axis="x", style="plain", useOffset=False)

    def _shade(self, axes: Axes, gaps: Sequence[Gap]) -> None:
        """Shade all gaps as a single shape, however many they are; those of several channels that overlap are one."""
        spans: list[list[float]] = []
        for gap in sorted(gaps, key=lambda one: one.start_s):
            if spans and gap.start_s <= spans[-1][1]:
                spans[-1][1] = max(spans[-1][1], gap.end_s)
            else:
                spans.append([gap.start_s, gap.end_s])
        if not spans:
            return
        x = self(np.array(spans))
        corners = [[(a, 0.0), (a, 1.0), (b, 1.0), (b, 0.0), (a, 0.0)] for a, b in x]
        box = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY]
        shape = Path(np.concatenate(corners), box * len(corners))
        axes.add_patch(
            PathPatch(shape, facecolor=svg.MUTED, alpha=0.18, linewidth=0, transform=axes.get_xaxis_transform())
        )


def time_axis(walk: SmoothedWalk) -> TimeAxis:
    """Make the axis from the first to the last sample or pose of any device, at least one second long."""
    times = [walk.track.time_s, *(block.time_s for device in walk.devices for block in device.level)]
    ends = np.array([time_s[end] for time_s in times if len(time_s) for end in (0, -1)] or [0.0])
    begin_s = float(ends.min())
    return TimeAxis(begin_s, begin_s, max(float(ends.max()), begin_s + 1.0))


def draw_dots(axes: Axes, x: Array, y: Array, colour: str) -> None:
    """Draw one dot for each step: smaller the more there are; very many become an image in which density shows."""
    few, dense = len(x) < 60, len(x) > RASTER_FROM
    if ONE_PATH_FROM <= len(x) <= RASTER_FROM:
        _draw_dots_as_one(axes, x, y, colour)
        return
    axes.plot(
        x,
        y,
        "o",
        color=colour,
        markersize=6.5 if few else 1.6 if dense else 2.6,
        markeredgecolor=svg.PAPER,
        markeredgewidth=1.0 if few else 0.0,
        alpha=0.4 if dense else 1.0,
        rasterized=dense,
    )


def _draw_dots_as_one(axes: Axes, x: Array, y: Array, colour: str) -> None:
    """Draw dots as lines without length, whose round ends are the dots."""
    points = np.column_stack([x, y])
    points = points[np.isfinite(points).all(axis=1)]
    codes = np.tile(np.array([Path.MOVETO, Path.LINETO], dtype=np.uint8), len(points))
    path = Path(np.repeat(points, 2, axis=0), codes)
    path.should_simplify = False  # which would leave out lines without length
    dots = PathPatch(path, fill=False, edgecolor=colour, linewidth=1.6, capstyle="round", zorder=2)
    axes.add_artist(dots)  # add_patch would look at every line by itself
    axes.update_datalim(points)
    axes.autoscale_view()
