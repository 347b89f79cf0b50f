"""What a stretch of samples tells about the carrying mode: four numbers of a window, and how likely modes have them.

* The swing of the direction of gravity in device axes: 1 to 5 degrees in a hand held still, 5 to 20 in a trouser
  pocket, 9 to 30 in a swinging hand.
* The radius of the swing. A phone at a distance r from the joint about which it swings is accelerated across r by
  the angular acceleration times r, whatever else shakes it: some 0.3 m for an arm that swings from the shoulder
  and bends at the elbow, 0.1 m for a thigh, whether they swing far or little.
* The mean frequency of the vertical acceleration: arms soften each step, a thigh is jolted by it.
* Whether the screen faces up, as only a phone looked at does.

They hold for anybody and for any way that the phone lies in the hand or in the pocket.
"""

import numpy as np

from pdr_est.frames import Array
from pdr_est.records import CarryingMode, LevelBlock

MODES = (CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET, CarryingMode.OTHER)

# A row for each of MODES: what is typical of the logarithms of gravity's swing in degrees, of the radius in metres
# and of the frequency in hertz; and their spread. From simulated people, the held, swung, pocket and bag walks of the
# data sets in the README, and MotionSense.
_TYPICAL = np.log([[2.1, 0.12, 2.5], [20.0, 0.32, 2.15], [12.5, 0.11, 4.0], [3.0, 0.17, 3.2]])
_SPREAD = np.array([[0.5, 0.6, 0.35], [0.35, 0.16, 0.25], [0.5, 0.4, 0.25], [0.45, 0.4, 0.35]])
_HEIGHT = 1.0 / np.prod(_SPREAD, axis=1)
_JOLT_LAG_S = 0.04  # the vertical acceleration's change is taken over this time, whatever the sampling rate
_SCREEN_UP = 0.35  # least part of gravity along the screen's normal of a phone that is looked at
_SCREEN_SPREAD = 0.1
_SCREEN_WEIGHT = np.array([0.95, 0.998, 0.98])  # how sure it is that no phone in the other modes shows its screen
_LEAST_LIKELIHOOD = 1e-3  # no single window is proof
_LEAST_DENSITY = 1e-30  # for damaged samples of which no mode knows anything
_VECTORS, _UP, _RATE, _ACCELERATION, _VERTICAL, _VERTICAL_SQUARED, _JOLT, _TORQUE, _SPIN = (
    slice(0, 9), slice(0, 3), slice(3, 6), slice(6, 9), 9, 10, 11, slice(12, 15), 15
)  # fmt: skip
COLUMNS = 16
_YZX, _ZXY = [1, 2, 0], [2, 0, 1]  # orders of axes, for a vector product


def hop_means(block: LevelBlock, hop: int, rate_hz: float, before: Array) -> Array:
    """What windows are made of, (n // hop, COLUMNS): means over each `hop` samples of a block.

    n is a multiple of hop, which is at least 2. before: (1, COLUMNS) the row before, or none (0, COLUMNS).
    """
    count = len(block) // hop
    means = np.empty((count, COLUMNS))
    vectors = np.concatenate([block.up, block.rotation_rate_radps, block.acceleration_mps2], axis=1)
    means[:, _VECTORS] = vectors.reshape(count, hop, 9).sum(axis=1) / hop
    vertical = block.vertical_mps2.reshape(count, hop)
    lag = min(max(round(_JOLT_LAG_S * rate_hz), 1), hop - 1)
    change = (vertical[:, lag:] - vertical[:, :-lag]) * (rate_hz / lag)
    means[:, _VERTICAL] = vertical.sum(axis=1) / hop
    means[:, _VERTICAL_SQUARED] = (vertical * vertical).sum(axis=1) / hop
    means[:, _JOLT] = (change * change).sum(axis=1) / (hop - lag)
    rows = np.concatenate([before if len(before) else means[:1], means])
    spin = (rows[1:, _RATE] - rows[:-1, _RATE]) * (rate_hz / hop)
    acceleration = 0.5 * (rows[1:, _ACCELERATION] + rows[:-1, _ACCELERATION])
    means[:, _TORQUE] = spin[:, _YZX] * acceleration[:, _ZXY] - spin[:, _ZXY] * acceleration[:, _YZX]
    means[:, _SPIN] = (spin * spin).sum(axis=1)
    return means


def likelihoods(early: Array, late: Array, walking_mps2: float) -> Array:
    """Likelihood (n, modes) of windows whose halves have these means (n, COLUMNS).

    It is the same for all modes where one does not walk during both halves, and without rotation rate (NaN).
    """
    mean = 0.5 * (early + late)
    deviation = (features(mean)[:, None, :] - _TYPICAL) / _SPREAD
    density = _HEIGHT * np.exp(-0.5 * (deviation * deviation).sum(axis=2))
    up = mean[:, _UP]
    screen_up = 1.0 / (1.0 + np.exp((_SCREEN_UP - up[:, 2] / np.maximum(_norm(up), 1e-12)) / _SCREEN_SPREAD))
    density[:, 0] *= screen_up
    density[:, 1:] *= 1.0 - _SCREEN_WEIGHT * screen_up[:, None]
    density += _LEAST_DENSITY
    total = density[:, 0] + density[:, 1] + density[:, 2] + density[:, 3]
    walking = (_bounce(early) > walking_mps2**2) & (_bounce(late) > walking_mps2**2)
    tells = walking & (total > 0.0)  # NaN is not
    likelihood: Array = np.where(tells[:, None], density / total[:, None] + _LEAST_LIKELIHOOD, 1.0)
    return likelihood


def features(mean: Array) -> Array:
    """The columns of _TYPICAL (n, 3) for windows with these means (n, COLUMNS).

    With a = s x r, where s is the angular acceleration across r, r = -(s x a) / s^2; means of both over the window.
    Averaging over hops of length h makes the radius of a swing of frequency f too small, by a factor x / tan(x) with
    x = pi f h: by a sixth for a walk.
    """
    length = _norm(mean[:, _UP])
    swing_deg = np.rad2deg(np.sqrt(np.maximum(1.0 - length * length, 1e-8)))
    radius_m = _norm(mean[:, _TORQUE]) / np.maximum(mean[:, _SPIN], 1e-12)
    bounce = np.maximum(_bounce(mean), 1e-12)
    frequency_hz = np.sqrt(np.maximum(mean[:, _JOLT], 1e-12) / bounce) / (2.0 * np.pi)
    logarithms: Array = np.log(np.column_stack([swing_deg, np.maximum(radius_m, 1e-3), frequency_hz]))
    return logarithms


def _bounce(mean: Array) -> Array:
    """Variance of the vertical acceleration, (n,)."""
    variance: Array = mean[:, _VERTICAL_SQUARED] - mean[:, _VERTICAL] ** 2
    return variance


def turned(early: Array, late: Array) -> Array:
    """How far up has turned from one half of windows (n, COLUMNS) to the other: 1 - cos of the angle, (n,)."""
    a, b = early[:, _UP], late[:, _UP]
    dot = a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]
    turn: Array = 1.0 - dot / np.maximum(_norm(a) * _norm(b), 1e-12)
    return turn


def _norm(vectors: Array) -> Array:
    """Lengths (n,) of vectors (n, 3); sums written out, so that they do not depend on the number of rows."""
    length: Array = np.sqrt(vectors[:, 0] ** 2 + vectors[:, 1] ** 2 + vectors[:, 2] ** 2)
    return length
