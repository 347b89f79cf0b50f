"""The line of a device on the map: coloured by its carrying modes, with arrow heads."""

import numpy as np
from matplotlib.axes import Axes

from pdr_est.frames import Array
from pdr_est.label_runs import label_runs
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.mode_style import MODE_DASHES
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

ARROWS = 7
LONG_TRACK = 3000  # poses; the line is thinner from here on
BAND_PT = 8.0


def mode_polylines(track: Track) -> dict[CarryingMode, Array]:
    """Split the track of one device by carrying mode.

    A leg has the mode of the step that ends it.

    Returns
    -------
    dict of CarryingMode to Array
        Points (n, 2), m, of the polylines of each mode, with a row of NaN between two of them.
    """
    mode = track.mode[1:]
    pieces: dict[CarryingMode, list[Array]] = {}
    for start, stop in label_runs(mode):
        legs = pieces.setdefault(CarryingMode(int(mode[start])), [])
        legs += [track.position_m[start : stop + 1], np.full((1, 2), np.nan)]
    return {value: np.concatenate(legs[:-1]) for value, legs in sorted(pieces.items())}


def draw_mode_line(axes: Axes, track: Track, arrow_m: float) -> None:
    """Draw the track of the only device: its line itself has the colours of the modes."""
    for mode, points in mode_polylines(track).items():
        (line,) = axes.plot(
            *points.T, color=svg.MODE_COLOURS[mode], linewidth=_width(track, 2.2), solid_joinstyle="round"
        )
        if mode in MODE_DASHES:
            line.set_dashes(MODE_DASHES[mode])
    _arrows(axes, track, arrow_m, None)


def draw_mode_bands(axes: Axes, track: Track) -> None:
    """Draw wide pale bands in the colours of the modes, to lie under the line of one of several devices."""
    for mode, points in mode_polylines(track).items():
        axes.plot(
            *points.T,
            color=svg.MODE_COLOURS[mode],
            linewidth=_width(track, BAND_PT),
            alpha=0.5,
            solid_joinstyle="round",
            solid_capstyle="butt",
        )


def draw_device_line(axes: Axes, track: Track, colour: str, arrow_m: float) -> None:
    """Draw the line of one of several devices, in the colour of the device."""
    axes.plot(*track.position_m.T, color=colour, linewidth=_width(track, 1.7), solid_joinstyle="round")
    _arrows(axes, track, arrow_m, colour)


def _width(track: Track, usual_pt: float) -> float:
    return usual_pt if len(track) < LONG_TRACK else 0.55 * usual_pt


def _arrows(axes: Axes, track: Track, arrow_m: float, colour: str | None) -> None:
    """Draw arrow heads at equal distances; without a colour each has that of the mode there."""
    legs = np.nan_to_num(np.linalg.norm(np.diff(track.position_m, axis=0), axis=1))
    way = np.concatenate([[0.0], np.cumsum(legs)])
    if way[-1] < 4.0 * arrow_m:
        return
    for tip_at in way[-1] * (np.arange(ARROWS) + 0.5) / ARROWS:
        tip, tail = (
            np.array([np.interp(at, way, track.position_m[:, axis]) for axis in (0, 1)])
            for at in (tip_at, tip_at - 0.5 * arrow_m)
        )
        mode = CarryingMode(int(track.mode[np.searchsorted(way, tip_at)]))
        _arrow(axes, tip, tip - tail, arrow_m, colour or svg.MODE_COLOURS[mode])


def _arrow(axes: Axes, tip: Array, direction: Array, size_m: float, colour: str) -> None:
    """Draw a small filled arrow head in the walking direction."""
    norm = float(np.hypot(*direction))
    if not norm >= 1e-9:
        return
    ahead = direction / norm
    aside = np.array([-ahead[1], ahead[0]])
    base = tip - 0.65 * size_m * ahead
    corners = [tip, base + 0.32 * size_m * aside, base - 0.32 * size_m * aside]
    axes.fill(*np.array(corners).T, facecolor=colour, edgecolor=svg.PAPER, linewidth=0.6, zorder=2.5)
