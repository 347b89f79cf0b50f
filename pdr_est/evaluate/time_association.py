"""Which place of a track belongs to which point of the truth."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.track import Track

END_TOLERANCE_S = 1.0


@dataclass(frozen=True)
class Association:
    """A track at the truth's own times; the truth itself is never interpolated.

    time_s: (n,); truth_m, track_m: (n, 2) m, each in its own frame; covariance_m2: (n, 2, 2) of track_m.
    not_scored: number of truth points that are not among the n because the recording does not cover them.
    """

    time_s: Array
    truth_m: Array
    track_m: Array
    covariance_m2: Array
    not_scored: int

    def __len__(self) -> int:
        return len(self.time_s)


def associate(track: Track, truth_time_s: Array, truth_m: Array, span_s: tuple[float, float]) -> Association:
    """The track of one device, interpolated linearly to the times of the truth.

    truth_time_s: (n,) s; truth_m: (n, 2) m. span_s: times of the first and last sensor sample that the track was made
    of, which reach beyond the track's poses while the walker stands. A truth point at most 1 s outside the span takes
    the track's end; one farther outside is left out and counted.
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
    """(n,) which truth points are scored: those at most `END_TOLERANCE_S` outside the span of the samples."""
    first_s, last_s = span_s
    time = np.asarray(truth_time_s, dtype=np.float64)
    return np.asarray((time >= first_s - END_TOLERANCE_S) & (time <= last_s + END_TOLERANCE_S))
