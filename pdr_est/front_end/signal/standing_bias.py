"""Find the bias of the gyroscope while the walker stands.

A phone in the hand of somebody who stands is not at rest, but after a while it points where it pointed before, up to
a few degrees. So the mean rotation rate of a stretch of standing scatters about the bias, the less, the longer the
stretch and the steadier the hand is; or the walker has turned round, and it tells nothing.
"""

import numpy as np

from pdr_est.frames import Array
from pdr_est.params import Fraction, Positive, params

_GRID_RADPS = np.deg2rad(np.arange(-60, 61) * 0.05)  # up to 3 degrees per second
_FASTEST_TURN_RADPS = np.deg2rad(30.0)  # of a walker who turns round on the spot, averaged over the stretch; ours
_LONGEST_STRETCH_S = 60.0  # of standing that is one measurement: the bias changes; ours
_NO_BIAS_RADPS = np.deg2rad(0.05)  # standard deviation of a bias that does not matter


@params
class StandingBiasParams:
    """Parameters of the bias of the gyroscope by seconds in which the walker stands."""

    enabled: bool = True
    """True to look for it; False leaves the bias to VQF alone."""
    window_s: Positive = 1.0
    """Duration, s, over which rotation rates are averaged."""
    steady_mps2: Positive = 0.3
    """Standard deviation of the length of the specific force, m/s^2, below which the walker stands. In recorded walks
    it is below 0.35 in one second of a thousand with steps, and below 0.23 in three of four without.
    """
    width: Positive = 0.57
    """Scale of the mean rates of such seconds about the bias, over the standard deviation of the rate within the
    second, for a t distribution with three degrees of freedom. It has the greatest likelihood on fifteen data sets
    of equal weight; with any of them left out that has 0.52 to 0.60.
    """
    sway_rad: Positive = 0.11
    """Standard deviation, rad, by which the phone points elsewhere at the end of a stretch of standing than at its
    begin, because people sway and turn a little: in 26 recorded stretches of 20 s with the phone in the hand the mean
    rate is wrong by 0.2 degrees per second in the median, by 0.5 in one of ten.
    """
    turning_share: Fraction = 0.1
    """Prior probability that the walker turns round meanwhile, so that the mean rate tells nothing; ours."""
    kept_s: Positive = 200.0
    """Time constant, s, with which the bias is forgotten, because it changes slowly; ours."""
    unbiased_share: Fraction = 0.5
    """Prior probability of a bias that does not matter."""
    scale_radps: Positive = 0.0026
    """Scale of all other biases before anything is known of them, rad/s, for a t distribution with three degrees of
    freedom. Both values fit how 60 recorded walks drift.
    """


class StandingBias:
    """Keep a density of the bias in each of three axes, which seconds of standing narrow.

    Parameters
    ----------
    rate_hz : float
        Sampling rate.
    parameters : StandingBiasParams
        Widths, weights and prior.

    Attributes
    ----------
    enabled : bool
        Whether the bias is to be found in this way.
    """

    def __init__(self, rate_hz: float, parameters: StandingBiasParams) -> None:
        self._parameters = parameters
        self.enabled = parameters.enabled
        self._width = max(round(parameters.window_s * rate_hz), 2)
        self._rate_hz = rate_hz
        self._log_prior = _log_prior(parameters)
        self._log_density: Array = np.tile(self._log_prior, (3, 1))
        self._at: int | None = None  # sample up to which it is known
        self._stands = False  # whether the last window belongs to a stretch of standing that goes on
        self._before: Array = self._log_density  # density before the present stretch of standing
        self._rates: list[Array] = []  # mean rate in each window of this stretch, and
        self._information: Array = np.zeros(3)  # the sum of their inverse variances
        self._mean, self._variance = _moments(self._log_density)
        self._parts: list[tuple[Array, Array]] = []  # samples of the window that is not complete
        self._next = 0  # index of the sample after them
        self._begin = 0  # index of the first sample of that window, which may still have to come

    def turn(self, matrix: Array) -> None:
        """Describe the bias in other axes, the rows of a matrix (3, 3), and begin a new segment."""
        mean, variance = matrix @ self._mean, matrix**2 @ self._variance
        if self._at is not None:
            self._log_density = -0.5 * (_GRID_RADPS - mean[:, None]) ** 2 / variance[:, None]
            self._mean, self._variance = _moments(self._log_density)
        self._stands = False
        self._parts.clear()

    def push(self, first_index: int, force_mps2: Array, rate_radps: Array) -> tuple[Array, Array]:
        """Take samples, and return the bias at each of them as it is known from complete windows before.

        Parameters
        ----------
        first_index : int
            Index of the first sample; windows lie on multiples of their length.
        force_mps2 : ndarray, shape (n,)
            Length of the specific force.
        rate_radps : ndarray, shape (n, 3)
            Rotation rate.

        Returns
        -------
        mean, variance : ndarray, shape (n, 3) or (1, 3)
            Mean, rad/s, and variance of the bias in each axis.
        """
        count = len(force_mps2)
        if not self.enabled:
            return self._mean[None], self._variance[None]
        if not self._parts or self._next != first_index:
            self._parts.clear()
            self._begin = first_index + -first_index % self._width
        before = max(self._begin - first_index, 0)
        self._next = first_index + count
        self._parts.append((force_mps2[before:], rate_radps[before:]))
        if self._next - self._begin < self._width:
            return self._mean[None], self._variance[None]
        return self._windows(first_index, count)

    def _windows(self, first_index: int, count: int) -> tuple[Array, Array]:
        """Use the windows that are complete now, and keep the rest."""
        force, rate = (np.concatenate(columns) for columns in zip(*self._parts, strict=True))
        whole = len(force) // self._width
        used = whole * self._width
        self._parts = [(force[used:], rate[used:])]
        spread = force[:used].reshape(whole, self._width).std(axis=1)
        changes, means, variances = [first_index], [self._mean], [self._variance]
        for number in np.flatnonzero(spread < self._parameters.steady_mps2).tolist():
            end = (number + 1) * self._width
            self._use(self._begin + end, rate[end - self._width : end])
            changes.append(self._begin + end)
            means.append(self._mean)
            variances.append(self._variance)
        self._begin += used
        lengths = np.diff([*changes, first_index + count])
        return np.repeat(means, lengths, axis=0), np.repeat(variances, lengths, axis=0)

    def _use(self, index: int, rate_radps: Array) -> None:
        """Narrow the densities by the rates (n, 3) of a window in which the walker stands.

        All windows of a stretch of standing are one measurement: the walker may point elsewhere at its end.
        """
        p = self._parameters
        passed = 0 if self._at is None else index - self._at
        lasts_s = len(self._rates) * p.window_s
        if not self._stands or passed > self._width or lasts_s >= _LONGEST_STRETCH_S:  # another stretch
            kept = np.exp(-passed / (p.kept_s * self._rate_hz))
            self._before = self._log_prior + kept * (self._log_density - self._log_prior)
            self._rates, self._information = [], np.zeros(3)
        self._at, self._stands = index, True
        spread = p.width * np.maximum(rate_radps.std(axis=0), _NO_BIAS_RADPS)
        self._information = self._information + spread**-2
        self._rates.append(rate_radps.mean(axis=0))
        sway = p.sway_rad * self._rate_hz / (len(self._rates) * self._width)
        mean, variance = np.median(self._rates, axis=0), 1.0 / self._information + sway**2  # turns are outliers
        squared = (mean[:, None] - _GRID_RADPS) ** 2 / variance[:, None]
        density = np.exp(-0.5 * squared) / np.sqrt(2.0 * np.pi * variance)[:, None]
        likelihood = (1.0 - p.turning_share) * density + p.turning_share / (2.0 * _FASTEST_TURN_RADPS)
        self._log_density = self._before + np.log(likelihood)
        self._mean, self._variance = _moments(self._log_density)


def _log_prior(parameters: StandingBiasParams) -> Array:
    """Compute the logarithm of the prior probability of each bias of the grid."""
    none = np.exp(-0.5 * (_GRID_RADPS / _NO_BIAS_RADPS) ** 2)
    some = (1.0 + (_GRID_RADPS / parameters.scale_radps) ** 2 / 3.0) ** -2
    share = parameters.unbiased_share
    density: Array = np.log(share * none / none.sum() + (1.0 - share) * some / some.sum())
    return density


def _moments(log_density: Array) -> tuple[Array, Array]:
    """Compute mean and variance (3,) of densities (3, m) on the grid."""
    density = np.exp(log_density - log_density.max(axis=1, keepdims=True))
    total = density.sum(axis=1)
    mean = (density * _GRID_RADPS).sum(axis=1) / total
    variance = (density * (_GRID_RADPS - mean[:, None]) ** 2).sum(axis=1) / total
    return mean, np.maximum(variance, (0.2 * _NO_BIAS_RADPS) ** 2)
