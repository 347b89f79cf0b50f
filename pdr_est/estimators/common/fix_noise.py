"""Noise of position fixes: from the accuracy that a source states to an independent and a wandering error."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from pdr_est.params import NonNegative, Positive, params
from pdr_est.params.validation_messages import contradiction
from pdr_est.types.measurements import PositionFix

_OF_PHONES = ("gps", "network")


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
    """Largest standard deviation of the wandering error, m; what is beyond it counts as independent. A fix with such
    a poor accuracy tells nothing about the error of the other fixes."""

    wander_time_s: Positive = 60.0
    """Correlation time of the wandering error, s."""

    clock_known: bool = False
    """Whether the times of the source are certainly right, such as those of points that are marked on the recording
    device itself. Estimators suspect the clock of any other source to be wrong by some seconds."""

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
            clock_known=fix.clock_known or self.clock_known,
        )


@params
class GpsNoise(FixNoise):
    """Errors of the positions that a phone's location service gives.

    A phone states the radius around its position within which it believes to be with a probability of 68 %, which is
    1.51 standard deviations of a coordinate, and indoors it is further off. Its filter smooths the positions: they
    lag behind, their errors hardly change from second to second, and they wander.

    The defaults come from ten walks along five routes in and around buildings with two phones (IPIN 2023, track 3).
    Whichever route is left out, the smoothed track predicts the surveyed points of the others best, by their log
    density, at a wandering share of 0.85 to 1, a least wandering error of 2.5 to 3 m and a correlation time of 10 to
    15 s. There the ellipses cover all points, so that the share is a little smaller: 0.75, at which they cover 99 %.
    The errors themselves, against tracks through all surveyed points, have a standard deviation of 0.8 to 1.5 stated
    accuracies over 1.51 and stay alike for about a minute; but they also shorten the ways by 5 to 30 %, which a
    shorter correlation time allows for.
    """

    white_share: NonNegative = 0.3
    """Standard deviation of the error that is independent from fix to fix, over the stated accuracy."""

    least_white_m: NonNegative = 1.0
    """Independent error of a phone that states an accuracy of 0, m."""

    wander_share: NonNegative = 0.75
    """Standard deviation of the error that wanders slowly and is common to the fixes of the source, over the stated
    accuracy."""

    least_wander_m: NonNegative = 2.5
    """Wandering error of a phone that states an accuracy of 0, m."""

    most_wander_m: Positive = 20.0
    """Largest standard deviation of the wandering error, m; what is beyond it counts as independent (our choice)."""

    wander_time_s: Positive = 15.0
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
    """Errors of the fixes of the sources "gps" and "network": the positions that the recorder kept. Each of the two
    has a wandering error of its own."""

    others: tuple[SourceFixNoise, ...] = ()
    """Errors of the fixes of other sources."""

    def __post_init__(self) -> None:
        names = [*_OF_PHONES, *(one.source for one in self.others)]
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
    known: dict[str, FixNoise] = dict.fromkeys(_OF_PHONES, parameters.gps) | {
        one.source: one for one in parameters.others
    }
    return tuple(
        known[fix.source].of(fix) if fix.source in known and fix.sigma_wander_m == 0.0 else fix for fix in fixes
    )
