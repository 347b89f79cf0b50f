"""Place a finished track on the Earth, where position and north are known."""

import math
from collections.abc import Iterable
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
    a frame of its own, is shifted so that it passes through one GPS position of the recording: that for which the
    shift is known best. The covariances of the shift and of the pose are added up, as if they were independent.

    Parameters
    ----------
    track
        Track of one or more devices; the person, who is shifted to the GPS position, comes last.
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
    return _through_fix(track, recording.origin, fixes_with_noise(gps, noise))


def _through_fix(track: Track, origin: GeoOrigin, fixes: Iterable[PositionFix]) -> EarthPlacement:
    """Shift a track through the fix that leaves the shift least uncertain; the first one of equals."""
    person = track.of_device(track.devices[-1])

    def covariance_of_shift(fix: PositionFix) -> Array:
        (of_pose,) = person.at(fix.time_s)[1]
        total: Array = of_pose + fix.covariance_m2 + fix.sigma_wander_m**2 * np.eye(2)
        return total

    best, covariance = min(
        ((fix, covariance_of_shift(fix)) for fix in fixes), key=lambda pair: float(np.trace(pair[1]))
    )
    shift_m = best.position_m - person.at(best.time_s)[0][0]
    placed = replace(track, position_m=track.position_m + shift_m, covariance_m2=track.covariance_m2 + covariance)
    sigma_m = math.sqrt(float(np.trace(covariance)) / 2.0)
    words = f"north-up through the {best.source} position at {best.time_s:.1f} s (standard deviation {sigma_m:.1f} m)"
    return EarthPlacement(placed, origin, words)
