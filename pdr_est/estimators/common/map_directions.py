"""Dominant directions that are known in the map: relative heading priors become absolute ones."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from pdr_est.types.measurements import HeadingPrior, Measurement
from pdr_est.types.track import Track


def tied_to_map(
    measurements: Iterable[Measurement], track: Track, direction_rad: float, spacing_rad: float
) -> list[Measurement]:
    """The measurements of one device, with its relative heading priors in the map.

    track: of the device, without this knowledge: its heading at the first of the priors tells which of the directions
    at equal spacing, one of which is direction_rad, the walk took there; where the track is in a frame of its own,
    that is the smallest turn into the map.
    """
    given = list(measurements)
    first = next((m for m in given if isinstance(m, HeadingPrior) and m.relative), None)
    if first is None:
        return given
    heading_rad = float(np.interp(first.time_s, track.time_s, np.unwrap(track.heading_rad)))
    along_rad = direction_rad + spacing_rad * round((heading_rad - direction_rad) / spacing_rad)
    turn_rad = along_rad - first.heading_rad
    return [
        replace(m, heading_rad=m.heading_rad + turn_rad, relative=False)
        if isinstance(m, HeadingPrior) and m.relative
        else m
        for m in given
    ]
