"""Noise of position fixes: from the accuracy that a source states to an independent and a wandering error."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from pdr_est.params import NonNegative, Positive, params
from pdr_est.params.validation_messages import contradiction
from pdr_est.types.measurements import PositionFix


@params
class FixNoise:
    """Errors of the fixes of one source, relative to the accuracy that it states; by default as stated.

    Each part has a standard deviation in each coordinate: the root of the squares of a share of the stated accuracy
    and of a least value.
    """

    white_share: NonNegative = 1.0
    """Standard deviation of the error that is independent from fix to fix, over the stated accuracy."""

    least_white_m: NonNegative = 0.0
    """Independent error of a source that states an accuracy of 0, m."""

    wander_share: NonNegative = 0.0
    """Standard deviation of the error that wanders slowly and is common to the fixes of the source, over the stated
    accuracy."""

    least_wander_m: NonNegative = 0.0
    """Wandering error of a source that states an accuracy of 0, m."""

    most_wander_m: Positive = 1e5
    """Largest standard deviation of the wandering error, m; what is beyond it counts as independent. A fix of such a
    poor accuracy comes from another method, whose error tells nothing about that of the other fixes."""

    wander_time_s: Positive = 60.0
    """Correlation time of the wandering error, s."""

    def __post_init__(self) -> None:
        if not self.white_share and not self.least_white_m:
            raise contradiction("white_share and least_white_m are both 0: give one of them, no fix is exact")

    def of(self, fix: PositionFix) -> PositionFix:
        """Return a fix with this noise, whose covariance so far is its stated accuracy."""
        stated_m2 = np.asarray(fix.covariance_m2)
        variance = self.wander_share**2 * float(np.trace(stated_m2)) / 2.0 + self.least_wander_m**2
        wander = min(variance, self.most_wander_m**2)
        beyond = (variance - wander + self.least_white_m**2) * np.eye(2)
        return replace(
            fix,
            covariance_m2=self.white_share**2 * stated_m2 + beyond,
            sigma_wander_m=float(np.sqrt(wander)),
            wander_time_s=self.wander_time_s,
        )


@params
class GpsNoise(FixNoise):
    """Errors of the positions that a phone's location service gives.

    A phone states the radius around its position within which it believes to be with a probability of 68 %, which is
    1.51 standard deviations of a coordinate. Its filter smooths the positions: their errors hardly change from second
    to second, and they wander.

    The defaults are rounded from a maximum-likelihood fit to the errors of 930 positions, thinned to one in 8 to
    15 s, on ten walks along five routes with two phones (IPIN 2023, track 3), against tracks that are smoothed with
    all surveyed points. When the walks of one route are left out, the fit gives a wandering share of 0.45 to 0.61, a
    least wandering error of 1.8 to 3.2 m, a correlation time of 56 to 92 s, and an independent share of 0.03 to 0.16.
    """

    white_share: NonNegative = 0.15
    """Standard deviation of the error that is independent from fix to fix, over the stated accuracy."""

    least_white_m: NonNegative = 0.5
    """Independent error of a phone that states an accuracy of 0, m."""

    wander_share: NonNegative = 0.6
    """Standard deviation of the error that wanders slowly and is common to the fixes of the source, over the stated
    accuracy."""

    least_wander_m: NonNegative = 2.5
    """Wandering error of a phone that states an accuracy of 0, m."""

    most_wander_m: Positive = 20.0
    """Largest standard deviation of the wandering error, m; what is beyond it counts as independent. Phones state
    such an accuracy for positions from radio masts, whose error is not that of their GPS positions (our choice)."""

    wander_time_s: Positive = 70.0
    """Correlation time of the wandering error, s."""


@params
class SourceFixNoise(FixNoise):
    """Errors of the fixes of a source that is named; by default as stated."""

    source: str
    """Name of the source, as in the column `source` of a table of fixes."""


@params
class FixNoiseParams:
    """Errors of position fixes by their source.

    Fixes of other sources, such as surveyed points, are as accurate as they state and their errors are independent.
    """

    gps: GpsNoise = GpsNoise()
    """Errors of the fixes of the source "gps": the positions that the recorder kept."""

    others: tuple[SourceFixNoise, ...] = ()
    """Errors of the fixes of other sources."""

    def __post_init__(self) -> None:
        names = ["gps", *(one.source for one in self.others)]
        twice = [name for name in names if names.count(name) > 1]
        if twice:
            raise contradiction(f"others: the source {twice[0]!r} stands twice: remove one")


def fixes_with_noise(fixes: Iterable[PositionFix], parameters: FixNoiseParams) -> tuple[PositionFix, ...]:
    """Apply the noise of its source to each fix.

    Parameters
    ----------
    fixes
        Fixes as they were stated. One that has a wandering error already keeps its noise.
    parameters
        Noise of the sources.

    Returns
    -------
    tuple of PositionFix
        The fixes in their order, with the noise that estimators should use.
    """
    known: dict[str, FixNoise] = {"gps": parameters.gps} | {one.source: one for one in parameters.others}
    return tuple(
        known[fix.source].of(fix) if fix.source in known and fix.sigma_wander_m == 0.0 else fix for fix in fixes
    )
