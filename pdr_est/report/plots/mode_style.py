"""Appearance of the carrying modes: colours (MMPDR Fig. 15), line styles, names, and a strip over time.

Colour is never the only distinction: lines also differ in their dashes, and strips carry names.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from pdr_est.frames import Array
from pdr_est.label_runs import label_runs
from pdr_est.pipeline import DeviceWalk
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.legend import LegendEntry
from pdr_est.report.plots.time_axis import TimeAxis
from pdr_est.types.steps import CarryingMode

STRIP_IN, STRIP_GAP_IN = 0.16, 0.05  # height of a strip, and the room below it
_LETTER_IN = 0.085  # a generous width of a letter in a strip

MODE_DASHES = MappingProxyType(
    {
        CarryingMode.SWING: (4.0, 1.2),
        CarryingMode.POCKET: (1.4, 0.9),
        CarryingMode.TRANS: (2.5, 1.5),
        CarryingMode.UNKNOWN: (0.8, 1.4),
    }
)  # on and off in line widths; the other modes have full lines
_DESCRIPTIONS = MappingProxyType(
    {
        CarryingMode.HOLDING: "held in the hand",
        CarryingMode.SWING: "in a swinging hand",
        CarryingMode.POCKET: "in a pocket",
        CarryingMode.OTHER: "carried elsewhere",
        CarryingMode.TRANS: "changing between two modes",
        CarryingMode.UNKNOWN: "not recognised",
    }
)


@dataclass(frozen=True)
class ModeRun:
    """Interval in one carrying mode without a gap.

    Attributes
    ----------
    begin_s, end_s : float
        Start and end, s.
    mode : CarryingMode
        Recognised mode.
    """

    begin_s: float
    end_s: float
    mode: CarryingMode


def mode_runs(device: DeviceWalk) -> list[ModeRun]:
    """Find the recognised modes of a device from its first to its last sample, standing included."""
    blocks = [block for block in device.level if len(block)]
    if not blocks:
        return []
    time_s = np.concatenate([block.time_s for block in blocks])
    mode = np.concatenate([block.mode for block in blocks])
    segment = np.repeat([block.segment for block in blocks], [len(block) for block in blocks])
    found = []
    for start, stop in label_runs(mode, segment):
        # A run lasts until the next begins; before a gap and at the end it lasts until its own last sample.
        last = stop if stop < len(time_s) and segment[stop] == segment[stop - 1] else stop - 1
        found.append(ModeRun(float(time_s[start]), float(time_s[last]), CarryingMode(int(mode[start]))))
    return found


def mode_legend(symbol: str, modes: Iterable[CarryingMode]) -> list[LegendEntry]:
    """Make one legend entry for each mode that occurs, in the order of their numbers; `symbol` as in `mode_entry`."""
    return [mode_entry(symbol, mode) for mode in sorted(set(modes))]


def mode_entry(symbol: str, mode: CarryingMode) -> LegendEntry:
    """Make the legend entry of a mode as a "line", a "band" or a "strip" with its name."""
    label = f"{mode.name}: {_DESCRIPTIONS[mode]}"
    colour = svg.css_name(svg.MODE_COLOURS[mode])
    if symbol == "line":
        return LegendEntry(symbol, colour, label, MODE_DASHES.get(mode, ()))
    return LegendEntry("hollow" if symbol == "strip" and mode is CarryingMode.UNKNOWN else symbol, colour, label)


def strips_height_in(count: int) -> float:
    """Return the room above axes that some strips need, in inches."""
    return count * (STRIP_IN + STRIP_GAP_IN)


def draw_strip(axes: Axes, runs: Iterable[ModeRun], axis: TimeAxis, row: int = 0, device_colour: str = "") -> None:
    """Draw a strip of mode colours above the axes; names stand where they fit.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Axes below the strip.
    runs : iterable of ModeRun
        Modes over time.
    axis : TimeAxis
        Time axis of the axes.
    row : int
        Number of the strip, from 0 at the bottom.
    device_colour : str
        Colour of a dot to the left of the strip that shows its device; none for an empty string.
    """
    width_in, height_in = axes.bbox.transformed(axes.figure.dpi_scale_trans.inverted()).size
    bottom, height = 1.0 + (strips_height_in(row) + STRIP_GAP_IN) / height_in, STRIP_IN / height_in
    shown = [_clipped(run, axis) for run in runs if run.end_s > axis.begin_s and run.begin_s < axis.end_s]
    for mode in sorted({run.mode for run in shown}):
        spans = [axis(np.array([run.begin_s, run.end_s])) for run in shown if run.mode is mode]
        _fill(axes, mode, spans, bottom, height)
    letters_a_second = width_in / _LETTER_IN / (axis.end_s - axis.begin_s)
    for run in shown:
        if (run.end_s - run.begin_s) * letters_a_second > len(run.mode.name) + 1:
            middle = float(axis((run.begin_s + run.end_s) / 2.0))
            _write(axes, run.mode, middle, bottom + 0.47 * height)
    if device_colour:
        place = (-0.1 / width_in, bottom + 0.5 * height)
        axes.plot(*place, "o", color=device_colour, markersize=5.0, transform=axes.transAxes, clip_on=False)


def _clipped(run: ModeRun, axis: TimeAxis) -> ModeRun:
    return ModeRun(max(run.begin_s, axis.begin_s), min(run.end_s, axis.end_s), run.mode)


def _fill(axes: Axes, mode: CarryingMode, spans: list[Array], bottom: float, height: float) -> None:
    """Fill the boxes of one mode as a single shape, however many they are; what is not recognised stays empty."""
    empty, top = mode is CarryingMode.UNKNOWN, bottom + height
    corners = [[(a, bottom), (a, top), (b, top), (b, bottom), (a, bottom)] for a, b in spans]
    box = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY]
    shape = PathPatch(
        Path(np.concatenate(corners), box * len(spans)),
        facecolor=svg.PAPER if empty else svg.MODE_COLOURS[mode],
        edgecolor=svg.MODE_COLOURS[mode] if empty else "none",
        linewidth=0.8,
        transform=axes.get_xaxis_transform(),
        clip_on=False,
    )
    axes.add_patch(shape)


def _write(axes: Axes, mode: CarryingMode, middle: float, height: float) -> None:
    axes.text(
        middle,
        height,
        mode.name,
        color=svg.MUTED if mode is CarryingMode.UNKNOWN else svg.PAPER,
        fontsize=7.5,
        ha="center",
        va="center_baseline",
        transform=axes.get_xaxis_transform(),
    )
