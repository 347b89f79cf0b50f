"""Drawings of a track for notebooks and scripts: matplotlib axes, and a table with an inline SVG.

They belong to the record that every user has in hand, so they lie beside it: `report`, which has richer figures, may
import `types` and not the reverse. matplotlib is imported where it is used.
"""

import html
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix
from pdr_est.types.region import ellipses_of_poses

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from pdr_est.types.track import Track

_COLOURS = ("#7446a8", "#b08a00", "#00869b", "#8a5a3c")
_FIX_COLOUR = "#c2188b"
_ELLIPSES = 24  # for each device; more hide the track
_CHI_SQUARED_95 = -2.0 * math.log(0.05)  # 95 % quantile with two degrees of freedom
_SVG_WIDTH, _SVG_HEIGHT = 480.0, 320.0
_MARGIN = 0.06


def plot_track_on(
    ax: "Axes | None", track: "Track", fixes: Sequence[PositionFix] = (), truth_m: Array | None = None
) -> "Axes":
    """Draw the tracks of all devices with 95 % ellipses into axes with equal scales; see `Track.plot`."""
    from matplotlib.patches import Ellipse

    if ax is None:
        from matplotlib import pyplot

        _, ax = pyplot.subplots(layout="constrained")
    if truth_m is not None:
        ax.plot(truth_m[:, 0], truth_m[:, 1], "--", color="#69727f", linewidth=1.0, label="truth")
    for number, name in enumerate(track.devices):
        one, colour = track.of_device(name), _COLOURS[number % len(_COLOURS)]
        for centre_m, covariance_m2 in _drawn_ellipses(one):
            long_m, short_m, angle_rad = _ellipse(covariance_m2)
            centre = (float(centre_m[0]), float(centre_m[1]))
            shape = Ellipse(centre, 2.0 * long_m, 2.0 * short_m, angle=math.degrees(angle_rad))
            shape.set(facecolor=colour, edgecolor=colour, alpha=0.15, linewidth=0.7)
            ax.add_patch(shape)
        ax.plot(one.position_m[:, 0], one.position_m[:, 1], color=colour, label=name)
        ax.plot(*one.position_m[0], "o", color="white", markeredgecolor=colour, markersize=8.0)
    if fixes:
        at_m = np.array([fix.position_m for fix in fixes])
        ax.plot(at_m[:, 0], at_m[:, 1], "D", color=_FIX_COLOUR, markersize=5.0, label="fixes")
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("east (m)")
    ax.set_ylabel("north (m)")
    ax.legend(frameon=False)
    return ax


def track_html(track: "Track") -> str:
    """Return a table with one row for each device, and an SVG drawing of the track; no scripts."""
    rows = "".join(_table_row(track.of_device(name), number) for number, name in enumerate(track.devices))
    return (
        f"<div><p>Track by {html.escape(track.estimator)} ({html.escape(track.kind)}), x east and y north, 95 % "
        "ellipses</p><table><thead><tr><th>device</th><th>poses</th><th>time (s)</th><th>distance (m)</th>"
        f"<th>end (m)</th><th>95 % radius at the end (m)</th></tr></thead><tbody>{rows}</tbody></table>"
        f"{_svg(track)}</div>"
    )


def _table_row(track: "Track", number: int) -> str:
    long_m, _, _ = _ellipse(track.covariance_m2[-1])
    x_m, y_m = track.position_m[-1]
    cells = (
        html.escape(track.devices[0]),
        str(len(track)),
        f"{track.time_s[0]:.1f} – {track.time_s[-1]:.1f}",
        f"{track.distance_m:.1f}",
        f"{x_m:.1f}, {y_m:.1f}",
        f"{long_m:.1f}",
    )
    colour = _COLOURS[number % len(_COLOURS)]
    return f'<tr style="color:{colour}">' + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def _svg(track: "Track") -> str:
    """Draw lines and ellipses at one scale, north up; empty where no position is finite."""
    finite_m = track.position_m[np.isfinite(track.position_m).all(axis=1)]
    if not len(finite_m):
        return ""
    low, high = finite_m.min(axis=0), finite_m.max(axis=0)
    span = np.maximum(high - low, 1.0)
    scale = float(min(_SVG_WIDTH / span[0], _SVG_HEIGHT / span[1])) * (1.0 - 2.0 * _MARGIN)
    centre = (low + high) / 2.0
    shapes = "".join(
        _svg_shapes(track.of_device(name), centre, scale, _COLOURS[number % len(_COLOURS)])
        for number, name in enumerate(track.devices)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label="track" width="{_SVG_WIDTH:g}" '
        f'height="{_SVG_HEIGHT:g}" viewBox="{-_SVG_WIDTH / 2:g} {-_SVG_HEIGHT / 2:g} {_SVG_WIDTH:g} '
        f'{_SVG_HEIGHT:g}">{shapes}</svg>'
    )


def _svg_shapes(track: "Track", centre: Array, scale: float, colour: str) -> str:
    points = (track.position_m - centre) * np.array([scale, -scale])
    points = points[np.isfinite(points).all(axis=1)]
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    x, y = points[0] if len(points) else (0.0, 0.0)
    return (
        "".join(_svg_ellipses(track, centre, scale, colour))
        + f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>'
        + f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="white" stroke="{colour}" stroke-width="2"/>'
    )


def _svg_ellipses(track: "Track", centre: Array, scale: float, colour: str) -> Iterator[str]:
    for centre_m, covariance_m2 in _drawn_ellipses(track):
        x, y = (centre_m - centre) * np.array([scale, -scale])
        long_m, short_m, angle_rad = _ellipse(covariance_m2)
        yield (
            f'<ellipse cx="{x:.1f}" cy="{y:.1f}" rx="{scale * long_m:.1f}" ry="{scale * short_m:.1f}" '
            f'fill="{colour}" fill-opacity="0.12" '
            f'transform="rotate({-math.degrees(angle_rad):.1f} {x:.1f} {y:.1f})"/>'
        )


def _drawn_ellipses(track: "Track") -> list[tuple[Array, Array]]:
    """Return centre and covariance of the ellipses of the regions of the chosen poses."""
    found = ellipses_of_poses(track.position_m, track.covariance_m2, track.region)
    return found.of_poses(_poses_with_ellipse(track))


def _poses_with_ellipse(track: "Track") -> list[int]:
    """Choose poses at even intervals, the last one among them, whose position and covariance are finite."""
    numbers: Array = np.column_stack([track.position_m, track.covariance_m2.reshape(len(track), 4)])
    finite = np.all(np.isfinite(numbers), axis=1)
    every = max(1, math.ceil(len(track) / _ELLIPSES))
    last_first = np.arange(len(track) - 1, -1, -every)
    return [int(i) for i in last_first[finite[last_first]]]


def _ellipse(covariance_m2: Array) -> tuple[float, float, float]:
    """Compute the semi-axes (m) of the 95 % region, the longer one first, and the angle (rad) of the longer one."""
    if not np.isfinite(covariance_m2).all():
        return math.inf, math.inf, 0.0
    variances, directions = np.linalg.eigh(covariance_m2)
    short_m, long_m = np.sqrt(_CHI_SQUARED_95 * np.maximum(variances, 0.0)).tolist()
    return long_m, short_m, math.atan2(directions[1, 1], directions[0, 1])
