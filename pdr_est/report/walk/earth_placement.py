"""Place a finished track on the Earth, where position and north are known."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.estimators.common.fix_noise import FixNoiseParams, fixes_with_noise
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin, Recording
from pdr_est.types.track import Track

PHONE_SOURCES = ("gps", "network")
"""Sources of the positions that a phone's location service gives."""


@dataclass(frozen=True)
class EarthPlacement:
    """Track in a frame whose place on the Earth is known, or the reason why there is none.

    Attributes
    ----------
    track
        Track about `origin`, x east and y north; the track as it is where the place is unknown.
    origin
        Latitude and longitude of the origin; None where the place is unknown.
    meaning
        How the track was placed, or why it was not and what to do, in words.
    """

    track: Track
    origin: GeoOrigin | None
    meaning: str


def place_on_earth(track: Track, frame: str, recording: Recording, noise: FixNoiseParams) -> EarthPlacement:
    """Place a track on the Earth.

    A track in the map frame lies about the origin of the recording. A north-up track, which begins at the origin of
    a frame of its own, is shifted to the GPS positions of the recording, its shape unchanged: by the median, in each
    coordinate, of the shifts to all of them, weighted by their inverse variances. A single position may be stale by
    the length of a street, and the median is not moved by it. As the errors of GPS positions are alike, the shift
    counts as no better known than by the best of them alone, and its covariance is added to that of each pose.

    Parameters
    ----------
    track
        Track of one or more devices; the person, who is shifted to the GPS positions, comes last.
    frame
        "map", "north-up" or "own", as the summary has it.
    recording
        Recording that the track was made from.
    noise
        Errors of the GPS positions.
    """
    if recording.origin is None:
        words = "the recording holds no latitude and longitude: record GPS as well"
        return EarthPlacement(track, None, words)
    if frame == "map":
        return EarthPlacement(track, recording.origin, "in the map frame about the origin of the recording")
    if frame != "north-up":
        words = "north is unknown: give --fixes recording, or --start and --heading"
        return EarthPlacement(track, None, words)
    gps = [fix for fix in recording.fixes if fix.source in PHONE_SOURCES]
    if not gps:
        words = "the recording holds no GPS position in its time: give --start"
        return EarthPlacement(track, None, words)
    return _shifted(track, recording.origin, fixes_with_noise(gps, noise))


def _shifted(track: Track, origin: GeoOrigin, fixes: Sequence[PositionFix]) -> EarthPlacement:
    """Shift a track to GPS positions."""
    position_m, of_poses = track.of_device(track.devices[-1]).at(np.array([fix.time_s for fix in fixes]))
    shifts_m = np.array([fix.position_m for fix in fixes]) - position_m
    errors = np.array([fix.covariance_m2 + fix.sigma_wander_m**2 * np.eye(2) for fix in fixes])
    covariance_m2 = of_poses + errors
    variance_m2 = np.trace(covariance_m2, axis1=1, axis2=2) / 2.0
    shift_m = [_weighted_median(shifts_m[:, axis], 1.0 / variance_m2) for axis in (0, 1)]
    best = int(np.argmin(variance_m2))
    region = None if track.region is None else track.region.shifted(np.array(shift_m), covariance_m2[best])
    placed = replace(
        track,
        position_m=track.position_m + np.array(shift_m),
        covariance_m2=track.covariance_m2 + covariance_m2[best],
        region=region,
    )
    sigma_m = math.sqrt(float(variance_m2[best]))
    words = f"north-up, at the median of {len(fixes)} GPS positions (standard deviation {sigma_m:.1f} m)"
    return EarthPlacement(placed, origin, words)


def _weighted_median(values: Array, weights: Array) -> float:
    """Return the value below and above which lies at most half of the weight."""
    order = np.argsort(values, kind="stable")
    reached = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(reached, reached[-1] / 2.0)])
