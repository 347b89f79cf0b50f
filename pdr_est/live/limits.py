"""Limits of the live server: how much a client may send, and how many clients there may be."""

from typing import Annotated

from annotated_types import Ge, Le

from pdr_est.params import Positive, params

Count = Annotated[int, Ge(1), Le(1_000_000_000_000)]
"""Whole number above 0."""


@params
class LiveLimits:
    """Limits of the live server; all are ours, with room for eight phones that send every sensor at 500 Hz."""

    phones: Count = 8
    """Number of phones of one walk."""

    pages: Count = 24
    """Number of pages that are open at the same time."""

    connections: Count = 48
    """Number of all connections at the same time; a request beyond is refused."""

    strangers: Count = 16
    """Number of connections of a port at the same time that have named no token; the oldest makes place for one."""

    stranger_s: Positive = 10.0
    """Time after which such a connection is closed, s."""

    message_bytes: Count = 256 * 1024
    """Size of a message from a page, bytes: a minute of motion sensors that a page kept while it was offline."""

    push_bytes: Count = 4 * 1024**2
    """Size of a message that an app pushes, bytes."""

    samples_per_s: Positive = 4000.0
    """Mean number of samples that a phone may send in a second, all sensors together."""

    burst_s: Positive = 120.0
    """Time for which a phone may have saved samples while it was offline, s."""

    walk_bytes: Count = 4 * 1024**3
    """Size of the recording of a walk, bytes; the walk ends when it is reached."""

    waiting_blocks: Count = 20_000
    """Number of blocks of samples that may wait for the filter; what comes beyond is recorded but not tracked."""


class SampleBudget:
    """Number of samples that one phone may still send: it fills with time up to what a burst may hold."""

    def __init__(self, limits: LiveLimits) -> None:
        self._rate = limits.samples_per_s
        self._most = limits.samples_per_s * limits.burst_s
        self._left, self._at_s = self._most, 0.0

    def take(self, samples: int, now_s: float) -> bool:
        """Take samples out of the budget; return False, and take nothing, if it does not hold so many.

        Parameters
        ----------
        samples
            Number of samples.
        now_s
            Present time, s.
        """
        self._left = min(self._left + self._rate * max(now_s - self._at_s, 0.0), self._most)
        self._at_s = now_s
        if samples > self._left:
            return False
        self._left -= samples
        return True
