"""Movement of gravity that is left after the gyroscope has turned the accelerometer's samples back.

In axes that do not rotate, the specific force of a walking person has a mean over two strides that hardly changes: it
is gravity. The gyroscope turns the samples of a window into such axes. If its axes, signs and unit are right, the
means of the window's parts agree; if not, gravity seems to move. Only rotations of the vertical show: the sign of a
rotation about it does not, nor does the sign of gravity.

The means carry Hann windows, which suppress the rhythm of walking by more than a hundredfold. What also moves them is
the walker's velocity, which turns with the body: at 1.3 m/s and a quarter turn in two seconds by 0.9 m/s^2. It is
taken as an unknown velocity that is constant in the axes of the device, and what it can explain does not count.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array
from pdr_est.io.conversion.gravity_windows import GravityWindows

MOST_INDEPENDENT_WINDOWS = 20
"""Windows of one walk that count as independent (ours): more of them repeat the same error."""

_MEANS = 4  # in a window
_MEAN_S = 2.4  # length of the Hann windows, two strides
_VELOCITY_SIGMA_MPS = 1.0  # of a component
# Of the upper bound of the variance: nine of ten windows of 395 sound recordings move less.
_USUAL_SHARE = 0.25


@dataclass(frozen=True)
class WalkerVelocity:
    """Movement of the means of each window that a walker's velocity can explain, when it turns with the device.

    Attributes
    ----------
    patterns
        (k, 12, 3) movement of the three components of four means, m/s², by a velocity of 1 m/s along each axis.
    gain
        (k, 3, 3) matrix by which the movement along the patterns becomes the most probable velocity.
    """

    patterns: Array
    gain: Array

    @classmethod
    def of(cls, turned: Array, windows: GravityWindows) -> "WalkerVelocity":
        """Compute the patterns for rotations (k, n, 3, 3) of the windows."""
        rising = -np.gradient(_weights(turned.shape[1], windows.period_s), axis=1) / windows.period_s
        patterns = _about_mean(np.moveaxis(np.tensordot(rising, turned, axes=(1, 1)), 0, 1))
        unexplained = _USUAL_SHARE * windows.variance_m2ps4 / _VELOCITY_SIGMA_MPS**2
        information = patterns.transpose(0, 2, 1) @ patterns + unexplained[:, None, None] * np.eye(3)
        return cls(patterns, np.linalg.inv(information).astype(np.float64))

    def removed_from(self, movements: Array) -> Array:
        """Return movements (k, 12, c) less what the velocity explains of them."""
        explained: Array = self.patterns @ (self.gain @ (self.patterns.transpose(0, 2, 1) @ movements))
        return movements - explained

    def scatter(self, means: Array) -> Array:
        """Compute the variance (k,) of a component of means (k, 4, 3) that is not explained."""
        movement = _about_mean(means[..., None])
        variance: Array = (movement * self.removed_from(movement)).sum(axis=(1, 2)) / (3.0 * (_MEANS - 1))
        return variance


def gravity_scatter(turned: Array, windows: GravityWindows) -> Array:
    """Compute how much gravity seems to move in each window (k,), m²/s⁴, if its samples turn by (k, n, 3, 3)."""
    force = np.einsum("kjab,kjb->kja", turned, windows.force_mps2)
    return WalkerVelocity.of(turned, windows).scatter(hann_means(force, windows.period_s))


def log_likelihood(variance: Array, windows: GravityWindows) -> float:
    """Compute the log likelihood of apparent movements of gravity (k,), up to a constant; 0 without any.

    It is that of a t distribution, -(f + d)/2 log(1 + d v/(f u)) with the variance v and the usual one u: its tails
    are heavy (f = 2), because a phone may be thrown about. The nine components of the means of a window count as
    d = 2, because their errors are not independent, nor are those of overlapping windows (`independent_share`).
    """
    share = independent_share(len(variance))
    return -2.0 * share * float(np.log1p(variance / usual_variance(windows)).sum())


def usual_variance(windows: GravityWindows) -> Array:
    """Return the variance (k,) of a component of the means of each window, m²/s⁴, by sound sensors."""
    return _USUAL_SHARE * windows.variance_m2ps4


def independent_share(windows: int) -> float:
    """Return the share of a number of windows that counts as independent."""
    return min(1.0, MOST_INDEPENDENT_WINDOWS / windows)


def hann_means(values: Array, period_s: float) -> Array:
    """Average values (k, n, ...) of windows with Hann windows of 2.4 s: the means (k, 4, ...) of their parts."""
    means = np.tensordot(_weights(values.shape[1], period_s), values, axes=(1, 1))
    return np.moveaxis(means, 0, 1)


def _weights(n: int, period_s: float) -> Array:
    """Make the weights (4, n) of the means."""
    length = min(_MEAN_S / period_s, n)
    centres = np.linspace(0.5 * length, n - 0.5 * length, _MEANS)
    away = np.arange(n) + 0.5 - centres[:, None]
    weights = np.where(np.abs(away) < 0.5 * length, np.cos(np.pi * away / length) ** 2, 0.0)
    normalised: Array = weights / weights.sum(axis=1, keepdims=True)
    return normalised


def _about_mean(means: Array) -> Array:
    """Subtract from means (k, 4, 3, c) what the four have in common, and put their components in a row (k, 12, c)."""
    movement: Array = (means - means.mean(axis=1, keepdims=True)).reshape(len(means), 3 * _MEANS, -1)
    return movement
