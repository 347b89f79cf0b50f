"""Features of a window of samples that tell the carrying mode, and the likelihood of each mode.

* The swing of the direction of gravity in device axes: 1 to 5 degrees in a hand held still, 5 to 20 in a trouser
  pocket, 9 to 30 in a swinging hand.
* The radius of the swing. A phone at a distance r from the joint about which it swings is accelerated across r by the
  angular acceleration times r, whatever else shakes it: some 0.3 m for an arm that swings from the shoulder and bends
  at the elbow, 0.1 m for a thigh, for wide and for small swings.
* The mean frequency of the vertical acceleration: arms soften each step, a thigh is jolted by it.
* The part of gravity along the screen's normal: only a phone that is looked at has its screen up.

They hold for any walker. The first three hold for any way that the phone lies in the hand or in the pocket; the last
one speaks against a hand or pocket in which the screen happens to face up, and is outvoted there.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.signal.vectors import dot, norm
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode

MODES: NDArray[np.int8] = np.array(
    [CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET, CarryingMode.OTHER], dtype=np.int8
)

# Typical features of each of MODES (logarithms of gravity's swing in radians, of the radius in metres and of the
# frequency in hertz), and their spread. Shape (modes, features, 1), to broadcast over windows. From simulated people,
# the held, swung, pocket and bag walks of the data sets in the README, and MotionSense.
_TYPICAL = np.log(
    [
        [np.deg2rad(2.1), 0.12, 2.5],
        [np.deg2rad(20.0), 0.32, 2.15],
        [np.deg2rad(12.5), 0.11, 4.0],
        [np.deg2rad(3.0), 0.17, 3.2],
    ]
)[:, :, None]
_SPREAD = np.array([[0.5, 0.6, 0.35], [0.35, 0.16, 0.25], [0.5, 0.4, 0.25], [0.45, 0.4, 0.35]])[:, :, None]
_PEAK_DENSITY = 1.0 / np.prod(_SPREAD, axis=1)
_JERK_LAG_S = 0.04  # the vertical acceleration's change is taken over this time, whatever the sampling rate
_SCREEN_UP = 0.35  # least part of gravity along the screen's normal of a phone that is looked at
_SCREEN_SPREAD = 0.1
# Probability that a phone in each of the other modes does not show its screen.
_SCREEN_WEIGHT = np.array([[0.95], [0.98], [0.98]])
_LEAST_LIKELIHOOD = 1e-3  # no single window is proof
_LEAST_DENSITY = 1e-30  # for damaged samples that no mode explains
SAMPLE_COLUMNS = 10
_UP, _RATE, _ACCELERATION, _VERTICAL = slice(0, 3), slice(3, 6), slice(6, 9), 9
# Columns of the means beyond those of the samples: the square of the vertical acceleration and of its jerk; the cross
# product of angular acceleration and acceleration, and the square of the angular acceleration.
_VERTICAL_SQUARED, _JERK_SQUARED, _CROSS_PRODUCT, _ALPHA_SQUARED = 10, 11, slice(12, 15), 15
COLUMNS = 16
_YZX, _ZXY = [1, 2, 0], [2, 0, 1]  # orders of axes, for a cross product


def sample_columns(blocks: Sequence[LevelBlock]) -> Array:
    """Stack the columns of consecutive blocks that windows need.

    Returns
    -------
    ndarray, shape (n, SAMPLE_COLUMNS)
        Unit vector up, rotation rate, acceleration (three columns each), and vertical acceleration.
    """
    columns = (
        [block.up for block in blocks],
        [block.rotation_rate_radps for block in blocks],
        [block.acceleration_mps2 for block in blocks],
        [block.vertical_mps2[:, None] for block in blocks],
    )
    return np.concatenate([np.concatenate(column) for column in columns], axis=1)


def hop_means(samples: Array, hop: int, rate_hz: float, previous: Array) -> Array:
    """Average the samples of each hop; windows are made of these means.

    Parameters
    ----------
    samples : ndarray, shape (n, SAMPLE_COLUMNS)
        Columns as `sample_columns` gives them; n is a multiple of `hop`.
    hop : int
        Number of samples of a hop, at least 2.
    rate_hz : float
        Sampling rate.
    previous : ndarray, shape (1, COLUMNS) or (0, COLUMNS)
        Means of the hop before, if there is one.

    Returns
    -------
    ndarray, shape (n // hop, COLUMNS)
    """
    count = len(samples) // hop
    means = np.empty((count, COLUMNS))
    means[:, :SAMPLE_COLUMNS] = np.add.reduceat(samples, np.arange(0, len(samples), hop)) / hop
    vertical = samples[:, _VERTICAL].reshape(count, hop)
    lag = min(max(round(_JERK_LAG_S * rate_hz), 1), hop - 1)
    jerk = (vertical[:, lag:] - vertical[:, :-lag]) * (rate_hz / lag)
    means[:, _VERTICAL_SQUARED] = (vertical * vertical).sum(axis=1) / hop
    means[:, _JERK_SQUARED] = (jerk * jerk).sum(axis=1) / (hop - lag)
    rows = np.concatenate([previous if len(previous) else means[:1], means])
    alpha = (rows[1:, _RATE] - rows[:-1, _RATE]) * (rate_hz / hop)  # angular acceleration
    acceleration = 0.5 * (rows[1:, _ACCELERATION] + rows[:-1, _ACCELERATION])
    means[:, _CROSS_PRODUCT] = alpha[:, _YZX] * acceleration[:, _ZXY] - alpha[:, _ZXY] * acceleration[:, _YZX]
    means[:, _ALPHA_SQUARED] = dot(alpha, alpha)
    return means


def mode_likelihoods(early: Array, late: Array, walking_mps2: float) -> Array:
    """Compute the likelihood of windows under each mode.

    It is the same for all modes where nobody walks during both halves, and without rotation rate (NaN).

    Parameters
    ----------
    early, late : ndarray, shape (n, COLUMNS)
        Means over the two halves of each window.
    walking_mps2 : float
        Least standard deviation of the vertical acceleration of a walk.

    Returns
    -------
    ndarray, shape (modes, n)
        In the order of `MODES`.
    """
    mean = 0.5 * (early + late)
    up_length = norm(mean[:, _UP])
    deviation = (window_features(mean, up_length) - _TYPICAL) / _SPREAD
    density = _PEAK_DENSITY * np.exp(-0.5 * (deviation * deviation).sum(axis=1))
    upward = mean[:, _UP.stop - 1] / np.maximum(up_length, 1e-12)
    screen_up = 1.0 / (1.0 + np.exp((_SCREEN_UP - upward) / _SCREEN_SPREAD))
    density[0] *= screen_up
    density[1:] *= 1.0 - _SCREEN_WEIGHT * screen_up
    density += _LEAST_DENSITY
    total = density.sum(axis=0)
    walking = np.minimum(_vertical_variance(early), _vertical_variance(late)) > walking_mps2**2
    informative = walking & (total > 0.0)  # NaN is not
    likelihood: Array = np.where(informative, density / total + _LEAST_LIKELIHOOD, 1.0)
    return likelihood


def window_features(mean: Array, up_length: Array) -> Array:
    """Compute the logarithms of swing (rad), radius (m) and frequency (Hz) of windows.

    With a = s x r, where s is the angular acceleration across r, r = -(s x a) / s^2; both are means over the window.
    Averaging over hops of length h makes the radius of a swing of frequency f too small by a factor x / tan(x) with x
    = pi f h: by a sixth for a walk.

    Parameters
    ----------
    mean : ndarray, shape (n, COLUMNS)
        Means over each window.
    up_length : ndarray, shape (n,)
        Length of the mean of the unit vector up.

    Returns
    -------
    ndarray, shape (3, n)
        Rows in the order of the columns of `_TYPICAL`.
    """
    rows = np.empty((3, len(mean)))
    rows[0] = np.sqrt(np.maximum(1.0 - up_length * up_length, 1e-8))
    rows[1] = np.maximum(norm(mean[:, _CROSS_PRODUCT]) / np.maximum(mean[:, _ALPHA_SQUARED], 1e-12), 1e-3)
    variance = np.maximum(_vertical_variance(mean), 1e-12)
    rows[2] = np.sqrt(np.maximum(mean[:, _JERK_SQUARED], 1e-12) / variance) / (2.0 * np.pi)
    logarithms: Array = np.log(rows)
    return logarithms


def _vertical_variance(mean: Array) -> Array:
    """Compute the variance (n,) of the vertical acceleration."""
    vertical = mean[:, _VERTICAL]
    variance: Array = mean[:, _VERTICAL_SQUARED] - vertical * vertical
    return variance


def gravity_turn(early: Array, late: Array) -> Array:
    """Compute how far the vertical turns in device axes from one half of each window to the other.

    Parameters
    ----------
    early, late : ndarray, shape (n, COLUMNS)
        Means over the two halves.

    Returns
    -------
    ndarray, shape (n,)
        1 - cos of the angle.
    """
    a, b = early[:, _UP], late[:, _UP]
    turn: Array = 1.0 - dot(a, b) / np.maximum(np.sqrt(dot(a, a) * dot(b, b)), 1e-12)
    return turn
