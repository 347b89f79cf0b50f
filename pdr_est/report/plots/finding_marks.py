"""Marks on the map where something does not fit."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes

from pdr_est.frames import Array
from pdr_est.report.plots import figure as svg
from pdr_est.types.findings import Finding
from pdr_est.types.track import Track

_BAND_PT, _RING_PT, _ALPHA = 15.0, 15.0, 0.35


def marked_places(track: Track) -> list[Array]:
    """Find the places of the doubtful findings that have a time span.

    Returns
    -------
    list of Array
        Points (n, 2), m, of each finding on each device that it concerns; a single point for a moment.
    """
    return [
        points
        for finding in track.findings
        if finding.doubtful and finding.begin_s is not None and finding.end_s is not None
        for points in _places_of(track, finding, finding.begin_s, finding.end_s)
    ]


def draw_findings(axes: Axes, track: Track) -> None:
    """Draw a broad band under the track where something does not fit, and a ring for a moment."""
    for points in marked_places(track):
        if len(points) == 1:
            axes.plot(
                *points[0], "o", color="none", markeredgecolor=svg.DOUBT, markersize=_RING_PT, markeredgewidth=2.5
            )
        else:
            axes.plot(*points.T, color=svg.DOUBT, linewidth=_BAND_PT, alpha=_ALPHA, solid_joinstyle="round")


def _places_of(track: Track, finding: Finding, begin_s: float, end_s: float) -> Iterator[Array]:
    for name in track.devices:
        if finding.device in ("", name):
            own = track.of_device(name)
            within = own.position_m[(own.time_s > begin_s) & (own.time_s < end_s)]
            ends_m = own.at(np.unique([begin_s, end_s]))[0]
            yield np.vstack([ends_m[:1], within, ends_m[1:]])
