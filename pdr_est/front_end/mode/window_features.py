"""Features of a window of samples that tell the carrying mode, and the likelihood of each mode.

* The swing of the direction of gravity in the device: 1 to 4 degrees in a hand held still or at the trunk, 3 to 5 in
  a bag, 7 to 15 in a trouser pocket, 9 to 30 in a swinging hand.
* The radius of the swing. A phone at a distance r from the joint about which it swings is accelerated across r by the
  angular acceleration times r, whatever else shakes it: some 0.3 m for an arm that swings from the shoulder and bends
  at the elbow, 0.1 m for a thigh, for wide and for small swings.
* The mean frequency of the vertical acceleration: arms soften each step, a thigh is jolted by it.
* The mean frequency of the rotation about level axes: an arm and a bag swing once a stride (1 to 2 Hz), a thigh does
  so with harmonics (2 to 3 Hz), a hand held still trembles with every step (3 to 5 Hz).
* The same below 2 Hz: about the frequency of steps in a hand held still, which feels both feet alike, and that of
  strides elsewhere.
* The horizontal acceleration over the vertical one: 2 and more in a swinging hand, less than 1 where a phone is held.

They hold for any walker, and do not change when the axes of the device are turned: it does not matter where its
screen faces. A phone that is fixed to the trunk, on a belt or in a breast pocket, moves like one in a hand held still
and is taken for one.
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

# Typical features of the ways to carry a phone in each of MODES (logarithms of gravity's swing in radians, of the
# radius in metres, of the three frequencies in hertz and of the ratio of accelerations), their spread, and the share
# of the way among those of its mode. Shape (ways, features, 1), to broadcast over windows. Fitted to ILC20, IPIN
# 2023, OxIOD, MotionSense, phone-gps, known-distance, stride-length, the sets of `walks` and simulated people, each
# set with the same weight. With each set left out of the fit, 96 % of its held windows, 99 % of pockets, 99 % of
# swinging hands and 91 % of bags are recognised, before neighbouring windows are weighed; without phones fixed to the
# trunk.
_WAY_OF = np.array([0, 0, 1, 2, 3])  # number of the mode of each way; a hand that moves, or is held still
_SHARE = np.array([0.18, 0.82, 1.0, 1.0, 1.0])
_TYPICAL = np.log(
    [
        [np.deg2rad(3.08), 0.11, 2.91, 2.80, 1.05, 0.72],
        [np.deg2rad(1.83), 0.12, 2.89, 4.35, 0.99, 0.81],
        [np.deg2rad(16.7), 0.34, 2.14, 1.20, 0.83, 2.50],
        [np.deg2rad(10.3), 0.09, 4.06, 2.46, 0.83, 1.17],
        [np.deg2rad(3.83), 0.14, 3.23, 1.64, 0.88, 0.66],
    ]
)[:, :, None]
_SPREAD = np.array(
    [
        [0.38, 0.63, 0.29, 0.20, 0.19, 0.66],
        [0.33, 0.59, 0.24, 0.16, 0.16, 0.33],
        [0.43, 0.17, 0.20, 0.16, 0.13, 0.32],
        [0.32, 0.35, 0.21, 0.23, 0.16, 0.31],
        [0.32, 0.46, 0.15, 0.19, 0.15, 0.35],
    ]
)[:, :, None]
_FEATURES = _TYPICAL.shape[1]
_PEAK_DENSITY = _SHARE[:, None] / np.prod(_SPREAD, axis=1)
_LAG_S = 0.04  # changes from sample to sample are taken over this time, whatever the sampling rate
_LEAST_LIKELIHOOD = 1e-3  # no single window is proof
_LEAST_DENSITY = 1e-30  # for damaged samples that no mode explains
SAMPLE_COLUMNS = 10
_UP, _RATE, _ACCELERATION, _VERTICAL = slice(0, 3), slice(3, 6), slice(6, 9), 9
# Columns of the means beyond those of the samples: the squares of the vertical acceleration, of its jerk and of the
# horizontal acceleration; the cross product of angular acceleration and acceleration, and the squares of the angular
# acceleration and of its part about level axes; the squares of the rotation rate about level axes, of its change, and
# of its mean over the hop.
_VERTICAL_SQUARED, _JERK_SQUARED, _HORIZONTAL_SQUARED = 10, 11, 12
_CROSS_PRODUCT, _ALPHA_SQUARED, _LEVEL_ALPHA_SQUARED = slice(13, 16), 16, 17
_LEVEL_SQUARED, _LEVEL_CHANGE_SQUARED, _SLOW_LEVEL_SQUARED = 18, 19, 20
COLUMNS = 21
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
    lag = min(max(round(_LAG_S * rate_hz), 1), hop - 1)
    jerk = (vertical[:, lag:] - vertical[:, :-lag]) * (rate_hz / lag)
    means[:, _VERTICAL_SQUARED] = (vertical * vertical).sum(axis=1) / hop
    means[:, _JERK_SQUARED] = (jerk * jerk).sum(axis=1) / (hop - lag)
    acceleration = samples[:, _ACCELERATION]
    horizontal = _squares(acceleration) - samples[:, _VERTICAL] * samples[:, _VERTICAL]
    means[:, _HORIZONTAL_SQUARED] = horizontal.reshape(count, hop).sum(axis=1) / hop
    level = _level_part(samples[:, _RATE], samples[:, _UP]).reshape(count, hop, 3)
    change = ((level[:, lag:] - level[:, :-lag]) * (rate_hz / lag)).reshape(-1, 3)
    means[:, _LEVEL_SQUARED] = _squares(level.reshape(-1, 3)).reshape(count, hop).sum(axis=1) / hop
    means[:, _LEVEL_CHANGE_SQUARED] = _squares(change).reshape(count, hop - lag).sum(axis=1) / (hop - lag)
    _fill_slow_rotation(means, rate_hz / hop, previous)
    return means


def _fill_slow_rotation(means: Array, hops_hz: float, previous: Array) -> None:
    """Fill the columns that follow from the mean rotation rate of hops and its change from hop to hop."""
    rows = np.concatenate([previous if len(previous) else means[:1], means])
    alpha = (rows[1:, _RATE] - rows[:-1, _RATE]) * hops_hz  # angular acceleration
    acceleration = 0.5 * (rows[1:, _ACCELERATION] + rows[:-1, _ACCELERATION])
    up = means[:, _UP] / np.maximum(norm(means[:, _UP]), 1e-12)[:, None]
    means[:, _CROSS_PRODUCT] = alpha[:, _YZX] * acceleration[:, _ZXY] - alpha[:, _ZXY] * acceleration[:, _YZX]
    means[:, _ALPHA_SQUARED] = _squares(alpha)
    means[:, _LEVEL_ALPHA_SQUARED] = _squares(_level_part(alpha, up))
    means[:, _SLOW_LEVEL_SQUARED] = _squares(_level_part(means[:, _RATE], up))


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
    of_way = _PEAK_DENSITY * np.exp(-0.5 * (deviation * deviation).sum(axis=1))
    density = np.stack([of_way[mode == _WAY_OF].sum(axis=0) for mode in range(len(MODES))])
    density += _LEAST_DENSITY
    total = density.sum(axis=0)
    walking = np.minimum(_vertical_variance(early), _vertical_variance(late)) > walking_mps2**2
    informative = walking & (total > 0.0)  # NaN is not
    likelihood: Array = np.where(informative, density / total + _LEAST_LIKELIHOOD, 1.0)
    return likelihood


def window_features(mean: Array, up_length: Array) -> Array:
    """Compute the logarithms of the features of windows.

    They are the swing (rad), the radius (m), the frequencies of the vertical acceleration, of the rotation about
    level axes and of its slow part (Hz), and the horizontal acceleration over the vertical one.

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
    ndarray, shape (6, n)
        Rows in the order of the columns of `_TYPICAL`.
    """
    rows = np.empty((_FEATURES, len(mean)))
    rows[0] = np.sqrt(np.maximum(1.0 - up_length * up_length, 1e-8))
    rows[1] = np.maximum(norm(mean[:, _CROSS_PRODUCT]) / np.maximum(mean[:, _ALPHA_SQUARED], 1e-12), 1e-3)
    variance = np.maximum(_vertical_variance(mean), 1e-12)
    for row, change, signal in (
        (2, mean[:, _JERK_SQUARED], variance),
        (3, mean[:, _LEVEL_CHANGE_SQUARED], mean[:, _LEVEL_SQUARED]),
        (4, mean[:, _LEVEL_ALPHA_SQUARED], mean[:, _SLOW_LEVEL_SQUARED]),
    ):
        rows[row] = np.sqrt(np.maximum(change, 1e-12) / np.maximum(signal, 1e-12)) / (2.0 * np.pi)
    rows[5] = np.sqrt(np.maximum(mean[:, _HORIZONTAL_SQUARED], 1e-12) / variance)
    logarithms: Array = np.log(rows)
    return logarithms


def _level_part(vectors: Array, up: Array) -> Array:
    """Compute the horizontal part of vectors (n, 3), in device axes."""
    level: Array = vectors - dot(vectors, up)[:, None] * up
    return level


def _squares(vectors: Array) -> Array:
    return dot(vectors, vectors)


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
