"""Dominant directions known in the map frame, which turn relative heading priors into absolute ones."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from pdr_est.types.measurements import HeadingPrior, Measurement
from pdr_est.types.track import Track


def resolve_relative_priors(
    measurements: Iterable[Measurement], track: Track, direction_rad: float, spacing_rad: float
) -> list[Measurement]:
    """Make the relative heading priors of a device absolute.

    Parameters
    ----------
    measurements
        Measurements of the device.
    track
        Track of the device estimated without this knowledge. Its heading at the first relative prior selects the
        dominant direction along which the walk went there; in a frame of its own that is the smallest rotation.
    direction_rad
        One of the dominant directions in the map frame.
    spacing_rad
        Angle between neighbouring dominant directions.
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
