"""Find samples at the beginning of a recording that were measured long before it.

When a sensor is switched on, phones first hand over its last value with the time at which it was measured, which may
be days ago.
"""

import numpy as np

from pdr_est.frames import Array

_MOST_STALE = 5  # ours: one sample is usual
_SHORTEST_GAP_S = 10.0  # ours: no sensor that runs is silent for so long just after it was switched on
_FEWEST_LIVE = 10


def count_stale_samples(time_s: Array) -> int:
    """Count the first samples that lie more than 10 s before the rest of the recording.

    Parameters
    ----------
    time_s
        (n,) s, in the order of the file.

    Returns
    -------
    int
        Number of samples to leave out, at most 5, and 0 unless at least 10 samples follow.
    """
    if len(time_s) < _FEWEST_LIVE + 1:
        return 0
    most = min(_MOST_STALE, len(time_s) - _FEWEST_LIVE)
    gaps = np.flatnonzero(np.diff(time_s[: most + 1]) > _SHORTEST_GAP_S)
    return int(gaps[-1]) + 1 if len(gaps) else 0


def stale_warning(sensor: str, count: int, total: int) -> str:
    """Describe the stale samples that were left out."""
    first = "the first row is" if count == 1 else f"the first {count} rows are"
    return f"{sensor}: {first} left out, of {total}, because measured long before the recording"
