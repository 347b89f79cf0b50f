"""Association of the positions of a track with true positions by time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.track import Track

END_TOLERANCE_S = 1.0


@dataclass(frozen=True)
class Association:
    """A track at the times of the true positions; the truth itself is never interpolated.

    Attributes
    ----------
    time_s : ndarray
        Times (n,), s.
    truth_m, track_m : ndarray
        Positions (n, 2), m, each in its own frame.
    covariance_m2 : ndarray
        Covariances (n, 2, 2) of `track_m`, m².
    not_scored : int
        Number of true positions that are left out because the recording does not cover them.
    """

    time_s: Array
    truth_m: Array
    track_m: Array
    covariance_m2: Array
    not_scored: int

    def __len__(self) -> int:
        """Return the number of pairs."""
        return len(self.time_s)


def associate(track: Track, truth_time_s: Array, truth_m: Array, span_s: tuple[float, float]) -> Association:
    """Interpolate the track of one device linearly at the times of the true positions.

    A true position at most 1 s outside the span gets the end of the track; one farther outside is left out and
    counted.

    Parameters
    ----------
    track : Track
        Track of one device.
    truth_time_s : ndarray
        Times (n,) of the true positions, s.
    truth_m : ndarray
        True positions (n, 2), m.
    span_s : (float, float)
        Times of the first and last sensor sample of the track, s; the span is longer than that of the poses while the
        walker stands.
    """
    scored = covered(truth_time_s, span_s)
    position, covariance = track.at(truth_time_s[scored])
    return Association(
        time_s=truth_time_s[scored],
        truth_m=truth_m[scored],
        track_m=position,
        covariance_m2=covariance,
        not_scored=int(len(truth_time_s) - scored.sum()),
    )


def covered(truth_time_s: Array, span_s: tuple[float, float]) -> NDArray[np.bool_]:
    """Select the true positions (n,) at most `END_TOLERANCE_S` outside the span of the samples."""
    first_s, last_s = span_s
    time = np.asarray(truth_time_s, dtype=np.float64)
    return np.asarray((time >= first_s - END_TOLERANCE_S) & (time <= last_s + END_TOLERANCE_S))
