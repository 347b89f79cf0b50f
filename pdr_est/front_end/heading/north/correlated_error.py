"""Standard deviations of headings against north, whose errors are alike from one to the next.

Estimators take the errors of heading priors for independent. Those of north are not: a phone that is held askew, or
an unknown declination, turns all of them alike, and iron in the building all those of some metres. The standard
deviations given here make up for it: an estimator that gets the priors one by one, and takes them for independent,
ends up with the variance of the heading that one has which knows about both kinds of error.
"""

from dataclasses import dataclass
from math import exp, inf, sqrt

from pdr_est.front_end.heading.phone_posture import wrapped

_UNKNOWN_VARIANCE = 1e4  # rad², of a heading of which nothing is known
_SAME_WEIGHT_SIGMAS = 2.0  # larger innovations count less, by Huber's weight


@dataclass(frozen=True)
class IndependentSigma:
    """Standard deviation that stands for a correlated measurement.

    Attributes
    ----------
    sigma_rad
        Standard deviation, rad; infinity for a measurement that tells nothing new.
    innovation_rad
        Measurement less what was expected, rad.
    innovation_sigmas
        Its absolute value in standard deviations.
    """

    sigma_rad: float
    innovation_rad: float
    innovation_sigmas: float


class CorrelatedHeadingError:
    """Kalman filter of the heading, of the error that stays, and of the one that wanders.

    Parameters
    ----------
    sigma_stays_rad, sigma_wanders_rad
        Standard deviations of the two errors, rad.
    length_m
        Distance over which the correlation of the wandering error falls to 1/e, m.
    """

    def __init__(self, sigma_stays_rad: float, sigma_wanders_rad: float, length_m: float) -> None:
        self._wander_variance, self._length_m = sigma_wanders_rad**2, length_m
        self._heading_rad = self._stays_rad = self._wanders_rad = 0.0
        # Covariance of heading (h), the error that stays (s) and the one that wanders (w).
        self._hh, self._ss, self._ww = _UNKNOWN_VARIANCE, sigma_stays_rad**2, self._wander_variance
        self._hs = self._hw = self._sw = 0.0
        self._known = False

    def set_stays(self, sigma_rad: float) -> None:
        """Set the standard deviation, rad, of the error that stays; only before the first measurement."""
        self._ss = sigma_rad**2

    def forget_heading(self) -> None:
        """Begin anew with an unknown heading; what is known of the errors stays."""
        self._hh, self._hs, self._hw = _UNKNOWN_VARIANCE, 0.0, 0.0
        self._known = False

    def move(self, turn_rad: float, variance_rad2: float, distance_m: float) -> None:
        """Predict the state after a step."""
        kept = exp(-distance_m / self._length_m)
        self._heading_rad += turn_rad
        self._wanders_rad *= kept
        self._hh += variance_rad2
        self._hw, self._sw = kept * self._hw, kept * self._sw
        self._ww = kept * kept * self._ww + (1.0 - kept * kept) * self._wander_variance

    def expected_sigma(self, sigma_white_rad: float) -> float:
        """Return the standard deviation that stands for a measurement now, rad, if it is as expected.

        It is infinite for a measurement that would tell nothing new.
        """
        with_sum = self._with_sum()
        return self._equivalent_sigma(with_sum[0], sum(with_sum) + sigma_white_rad**2)

    def measure(self, heading_rad: float, sigma_white_rad: float) -> IndependentSigma:
        """Update with a heading, rad, whose independent error has that standard deviation."""
        if not self._known:
            self._heading_rad = heading_rad - self._stays_rad - self._wanders_rad
            self._known = True
        heading, stays, wanders = with_sum = self._with_sum()
        variance = sum(with_sum) + sigma_white_rad**2
        innovation = wrapped(heading_rad - (self._heading_rad + self._stays_rad + self._wanders_rad))
        sigmas = abs(innovation) / sqrt(variance)
        variance *= max(sigmas / _SAME_WEIGHT_SIGMAS, 1.0)
        sigma_rad = self._equivalent_sigma(heading, variance)
        self._heading_rad += heading * (innovation / variance)
        self._stays_rad += stays * (innovation / variance)
        self._wanders_rad += wanders * (innovation / variance)
        self._hh -= heading * heading / variance
        self._ss -= stays * stays / variance
        self._ww -= wanders * wanders / variance
        self._hs -= heading * stays / variance
        self._hw -= heading * wanders / variance
        self._sw -= stays * wanders / variance
        return IndependentSigma(sigma_rad, innovation, sigmas)

    def _with_sum(self) -> tuple[float, float, float]:
        """Return the covariance of each state with the sum of all, which is what is measured."""
        return self._hh + self._hs + self._hw, self._hs + self._ss + self._sw, self._hw + self._sw + self._ww

    def _equivalent_sigma(self, shared: float, variance: float) -> float:
        """Return the independent standard deviation that leaves the heading the variance that the update leaves."""
        if shared <= 0.0:
            return inf
        return sqrt(max(self._hh * (self._hh * variance / shared**2 - 1.0), 0.0))
