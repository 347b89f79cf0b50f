"""Known positions of a walk beside its track: the fixes that the estimator was given, and those it never saw."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.evaluate.consistency import radius95_m
from pdr_est.frames import Array
from pdr_est.pipeline import SmoothedWalk
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.track import Track

GIVEN, HELD_OUT = "given", "held out"
MOST_HELD_OUT = 300  # positions, evenly chosen: a motion-capture system gives a hundred every second


@dataclass(frozen=True)
class FixResiduals:
    """Known positions, and how far the track is from each.

    Attributes
    ----------
    kind
        GIVEN or HELD_OUT.
    source
        (n,) name of the source of each position.
    time_s
        (n,) s.
    position_m
        (n, 2) in the frame of the track, m.
    covariance_m2
        (n, 2, 2) covariance of the known positions, m².
    distance_m
        (n,) distance between the known position and the track, m.
    bound_m
        (n,) semi-major axis of the 95 % region of that distance, m: of the fix alone where it was given, because
        the track follows it, and of fix and track together where it was held out.
    """

    kind: str
    source: tuple[str, ...]
    time_s: Array
    position_m: Array
    covariance_m2: Array
    distance_m: Array
    bound_m: Array


def fix_residuals(walk: SmoothedWalk, truth: TruePositions | None, truth_m: Array | None) -> list[FixResiduals]:
    """Compare the track of the person, or of the only device, with the known positions.

    Parameters
    ----------
    walk
        Finished walk.
    truth
        True positions, which no estimator is given.
    truth_m
        (n, 2) the same in the frame of the track, m; None where that is not possible.
    """
    track = walk.track.of_device(walk.track.devices[-1])
    found = []
    if walk.fixes:
        wander_m2 = np.array([fix.sigma_wander_m for fix in walk.fixes])[:, None, None] ** 2 * np.eye(2)
        covariance_m2 = np.array([fix.covariance_m2 for fix in walk.fixes]) + wander_m2
        sources = [fix.source for fix in walk.fixes]
        times_s, places_m = (
            np.array([getattr(fix, name) for fix in walk.fixes]) for name in ("time_s", "position_m")
        )
        kind = GIVEN if walk.fixes_used else HELD_OUT
        found.append(_compared(track, kind, sources, times_s, places_m, covariance_m2))
    if truth is not None and truth_m is not None and len(truth_m):
        chosen = np.unique(np.linspace(0, len(truth_m) - 1, min(len(truth_m), MOST_HELD_OUT)).round().astype(int))
        covariance_m2 = np.broadcast_to(truth.sigma_m**2 * np.eye(2), (len(chosen), 2, 2))
        sources = [truth.source] * len(chosen)
        found.append(_compared(track, HELD_OUT, sources, truth.time_s[chosen], truth_m[chosen], covariance_m2))
    return found


def _compared(
    track: Track, kind: str, sources: Sequence[str], time_s: Array, position_m: Array, covariance_m2: Array
) -> FixResiduals:
    reached_m, of_track_m2 = track.at(time_s)
    total_m2 = covariance_m2 if kind == GIVEN else covariance_m2 + of_track_m2
    away_m = np.linalg.norm(position_m - reached_m, axis=1)
    return FixResiduals(kind, tuple(sources), time_s, position_m, covariance_m2, away_m, radius95_m(total_m2))
