"""Standard deviations of headings against north, whose errors are alike from one to the next.

Estimators take the errors of heading priors for independent. Those of north are not: a phone that is held askew, or
an unknown declination, turns all of them alike, and iron in the building all those of some metres. The standard
deviations given here make up for it: an estimator that gets the priors one by one, and takes them for independent,
ends up with the variance of the heading that one has which knows about both kinds of error.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array, wrap_angle

_HEADING, _STAYS, _WANDERS = 0, 1, 2
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
        self._mean = np.zeros(3)
        self._covariance = np.diag([_UNKNOWN_VARIANCE, sigma_stays_rad**2, self._wander_variance])
        self._known = False

    def set_stays(self, sigma_rad: float) -> None:
        """Set the standard deviation, rad, of the error that stays; only before the first measurement."""
        self._covariance[_STAYS, _STAYS] = sigma_rad**2

    def forget_heading(self) -> None:
        """Begin anew with an unknown heading; what is known of the errors stays."""
        self._covariance[_HEADING, :] = self._covariance[:, _HEADING] = 0.0
        self._covariance[_HEADING, _HEADING] = _UNKNOWN_VARIANCE
        self._known = False

    def move(self, turn_rad: float, variance_rad2: float, distance_m: float) -> None:
        """Predict the state after a step."""
        self._mean[_HEADING] += turn_rad
        self._covariance[_HEADING, _HEADING] += variance_rad2
        kept = float(np.exp(-distance_m / self._length_m))
        scale = np.array([1.0, 1.0, kept])
        self._mean *= scale
        self._covariance *= np.outer(scale, scale)
        self._covariance[_WANDERS, _WANDERS] += (1.0 - kept**2) * self._wander_variance

    def expected_sigma(self, sigma_white_rad: float) -> float:
        """Return the standard deviation that stands for a measurement now, rad, if it is as expected.

        It is infinite for a measurement that would tell nothing new.
        """
        with_sum: Array = self._covariance.sum(axis=1)
        return self._equivalent_sigma(with_sum, float(with_sum.sum()) + sigma_white_rad**2)

    def measure(self, heading_rad: float, sigma_white_rad: float) -> IndependentSigma:
        """Update with a heading, rad, whose independent error has that standard deviation."""
        if not self._known:
            self._mean[_HEADING] = heading_rad - self._mean[_STAYS] - self._mean[_WANDERS]
            self._known = True
        with_sum: Array = self._covariance.sum(axis=1)  # the sum of all states is what is measured
        variance = float(with_sum.sum()) + sigma_white_rad**2
        innovation = float(wrap_angle(heading_rad - float(self._mean.sum())))
        sigmas = abs(innovation) / float(np.sqrt(variance))
        variance *= max(sigmas / _SAME_WEIGHT_SIGMAS, 1.0)
        sigma_rad = self._equivalent_sigma(with_sum, variance)
        self._mean = self._mean + with_sum * (innovation / variance)
        self._covariance = self._covariance - np.outer(with_sum, with_sum) / variance
        return IndependentSigma(sigma_rad, innovation, sigmas)

    def _equivalent_sigma(self, with_sum: Array, variance: float) -> float:
        """Return the independent standard deviation that leaves the heading the variance that the update leaves."""
        before, shared = float(self._covariance[_HEADING, _HEADING]), float(with_sum[_HEADING])
        if shared <= 0.0:
            return float("inf")
        return float(np.sqrt(max(before * (before * variance / shared**2 - 1.0), 0.0)))
