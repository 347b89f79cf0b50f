"""Clock."""

from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array


@dataclass(frozen=True)
class ClockEstimate:
    """The other clock shows t + offset_s + skew (t - at_s) when the reference clock shows t.

    sigma_s, sigma_skew: standard deviations of offset and skew, independent at at_s. quality: 0 to 1, how much of
    what could be compared agrees. method: "walk", "messages" or "given". doubts: why the estimate is poor, in
    words; empty if it is good.
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
        return bool(self.doubts)

    @property
    def used(self) -> bool:
        """A poor estimate from the walk may be wrong by steps; poor messages are still the best that is known."""
        return not self.poor or self.method != "walk"

    def offset_at(self, time_s: Array) -> Array:
        """What the other clock is ahead at times (n,) of the reference clock."""
        ahead: Array = self.offset_s + self.skew * (time_s - self.at_s)
        return ahead

    def sigma_at(self, time_s: Array) -> Array:
        """Standard deviation (n,) of `offset_at`."""
        sigma: Array = np.hypot(self.sigma_s, self.sigma_skew * (time_s - self.at_s))
        return sigma

    def to_reference(self, time_s: Array) -> Array:
        """Times (n,) of the other clock, on the reference clock."""
        there: Array = self.at_s + (time_s - self.at_s - self.offset_s) / (1.0 + self.skew)
        return there
