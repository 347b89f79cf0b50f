"""Offset and skew between the clocks of two devices, and Unix times as dates."""

from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from pdr_est.frames import Array


def utc_date(unix_s: float) -> datetime | None:
    """Return a Unix time, s, as a date with its time in UTC; None where it is none of the years 1 to 9999."""
    try:
        return datetime.fromtimestamp(unix_s, UTC)
    except (OverflowError, OSError, ValueError):
        return None


@dataclass(frozen=True)
class ClockEstimate:
    """Linear model of one clock against a reference clock.

    When the reference clock shows t, the other clock shows t + offset_s + skew (t - at_s).

    Attributes
    ----------
    offset_s
        Offset at `at_s`, s.
    skew
        Relative rate difference.
    sigma_s, sigma_skew
        Standard deviations of offset (s) and skew, uncorrelated at `at_s`.
    at_s
        Time at which the offset is defined, s on the reference clock.
    quality
        Fraction of the compared data that agrees with the model, 0 to 1.
    method
        Source of the estimate: "walk" (motion signals), "messages" or "given".
    doubts
        Reasons why the estimate may be wrong, in words; empty for a good estimate.
    """

    offset_s: float
    skew: float
    sigma_s: float
    sigma_skew: float = 0.0
    at_s: float = 0.0
    quality: float = 1.0
    method: str = "given"
    doubts: tuple[str, ...] = ()

    @property
    def poor(self) -> bool:
        """True when there is a reason to doubt the estimate."""
        return bool(self.doubts)

    @property
    def used(self) -> bool:
        """True when the clocks are corrected by this estimate.

        A poor estimate from the walk may be wrong by whole steps and is not used; poor messages are still the best
        information there is.
        """
        return not self.poor or self.method != "walk"

    def offset_at(self, time_s: Array) -> Array:
        """Compute the lead (n,) of the other clock, s, at times (n,) of the reference clock."""
        ahead: Array = self.offset_s + self.skew * (time_s - self.at_s)
        return ahead

    def sigma_at(self, time_s: Array) -> Array:
        """Compute the standard deviation (n,) of `offset_at`, s."""
        sigma: Array = np.hypot(self.sigma_s, self.sigma_skew * (time_s - self.at_s))
        return sigma

    def to_reference(self, time_s: Array) -> Array:
        """Convert times (n,) of the other clock to the reference clock."""
        reference: Array = self.at_s + (time_s - self.at_s - self.offset_s) / (1.0 + self.skew)
        return reference
