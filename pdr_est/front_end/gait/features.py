"""Features of a step that tell the gait: the six of UPTIME, and our own six of a stride.

Both are the same for every orientation of the phone and need no gyroscope. One sample is enough for a step. Those of
a stride were chosen by how well they classify people who were left out of the training.
"""

from math import log
from typing import Literal, Protocol

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import Step, begins_walk

FeatureSet = Literal["auto", "uptime"]

UPTIME_NAMES = ("duration_s", "variance", "peak", "range", "rms", "rms_duration")
STRIDE_NAMES = (
    "log_vertical_fundamental",
    "log_magnitude_fundamental",
    "log_period",
    "log_horizontal_rms",
    "lowest_vertical",
    "up_share",
)

# Floors that keep the logarithms of a phone at rest finite; far below what any gait shows.
_LEAST_POWER = 0.05**2  # (m/s^2)^2
_LEAST_HORIZONTAL_POWER = 1e-3  # (m/s^2)^2
_LEAST_PERIOD_S = 0.1
_ONES = np.ones(3)


class StepFeatures(Protocol):
    """Extractor of features of one step after the other, in time order; it may remember the previous step."""

    @property
    def names(self) -> tuple[str, ...]:
        """Return the names of the features."""
        ...

    def push(self, step: Step, /) -> Array:
        """Compute the features (k,) of the next step, in the order of `names`."""
        ...


def step_features(name: FeatureSet) -> StepFeatures:
    """Make the extractor of a feature set."""
    return StrideFeatures() if name == "auto" else UptimeFeatures()


class UptimeFeatures:
    """Six features of the acceleration within a step, after UPTIME.

    m is the acceleration as UPTIME's step detector takes it: length of the specific force less standard gravity,
    m/s^2. In the paper's order: duration T of the step, variance of m, peak of m (its signed maximum), maximum less
    minimum of m, root mean square of m, root mean square times T.

    References
    ----------
    UPTIME: Alzantot and Youssef, WCNC 2012, section III-B.
    """

    names = UPTIME_NAMES

    def push(self, step: Step, /) -> Array:
        """Compute the features (6,) of a step."""
        m = np.empty(len(step.samples))
        _excess_magnitude(step.samples, out=m)
        duration_s = step.event.time_s - step.start_s
        mean = float(m.sum()) / len(m)
        deviation = m - mean
        variance = float((deviation * deviation).sum()) / len(m)
        peak = float(m.max())
        rms = (variance + mean * mean) ** 0.5
        return np.array((duration_s, variance, peak, peak - float(m.min()), rms, rms * duration_s))


class StrideFeatures:
    """Six features of a stride: this step and the one before, or this step alone when it begins a walk.

    With N samples, k periods (2 or 1), v the vertical acceleration, m the length of the specific force less gravity
    and A(x) = 2/N |sum_n x_n exp(-2 pi i k n / N)|, the amplitude at the step frequency: log A(v), log A(m), log of
    the mean duration of the steps, log of the horizontal root mean square, least v, share of samples with v > 0. A
    jolt spreads over all harmonics and hardly enters A; the difference between left and right lies at half the
    frequency and cancels, which is why a stride tells more than a step. The features are ours.
    """

    names = STRIDE_NAMES

    def __init__(self) -> None:
        self._previous: Step | None = None
        self._rows = np.empty((2, 0))  # of the previous step
        self._sums = (0.0, 0.0, 0.0, 0)  # its duration, horizontal power, least v, samples upwards
        self._waves: dict[
            tuple[int, int], Array
        ] = {}  # cached: strides have few lengths, and a wave costs more than the rest

    def push(self, step: Step, /) -> Array:
        """Compute the features (6,) of the stride that ends with a step."""
        first = begins_walk(step, self._previous)
        rows, sums = _of_step(step)
        if first:
            count = rows.shape[1]
            spectrum = rows.dot(self._wave(count, 1))
            period_s, horizontal, lowest, upwards = sums
        else:
            stride = np.concatenate((self._rows, rows), axis=1)
            count = stride.shape[1]
            spectrum = stride.dot(self._wave(count, 2))
            old = self._sums
            period_s = 0.5 * (sums[0] + old[0])
            horizontal, lowest, upwards = sums[1] + old[1], min(sums[2], old[2]), sums[3] + old[3]
        self._previous, self._rows, self._sums = step, rows, sums
        (v_cos, v_sin), (m_cos, m_sin) = spectrum.tolist()
        return np.array(
            (
                0.5 * log(max(v_cos * v_cos + v_sin * v_sin, _LEAST_POWER)),
                0.5 * log(max(m_cos * m_cos + m_sin * m_sin, _LEAST_POWER)),
                log(max(period_s, _LEAST_PERIOD_S)),
                0.5 * log(max(horizontal / count, _LEAST_HORIZONTAL_POWER)),
                lowest,
                upwards / count,
            )
        )

    def _wave(self, count: int, periods: int) -> Array:
        """Return cosine and sine (count, 2) that turn samples into amplitudes."""
        wave = self._waves.get((count, periods))
        if wave is None:
            phase = (2.0 * np.pi * periods / count) * np.arange(count)
            wave = 2.0 / count * np.stack([np.cos(phase), np.sin(phase)], axis=1)
            self._waves[count, periods] = wave
        return wave


def _of_step(step: Step) -> tuple[Array, tuple[float, float, float, int]]:
    """Compute the rows (2, n) of v and m; duration, horizontal power, least v, number of samples with v > 0."""
    samples = step.samples
    vertical = samples.vertical_mps2
    rows = np.empty((2, len(vertical)))
    rows[0] = vertical
    _excess_magnitude(samples, out=rows[1])
    acceleration = samples.acceleration_mps2.ravel()  # in order of rows, however it lies in memory
    horizontal = max(float(acceleration.dot(acceleration) - vertical.dot(vertical)), 0.0)
    duration_s = step.event.time_s - step.start_s
    values = vertical.tolist()  # a list of plain numbers is quicker for so few
    return rows, (duration_s, horizontal, min(values), sum([value > 0.0 for value in values]))


def _excess_magnitude(samples: LevelBlock, out: Array) -> None:
    """Compute `signal.vectors.excess_magnitude` of a step in half the time, as no block is cut."""
    force = STANDARD_GRAVITY_MPS2 * samples.up
    force += samples.acceleration_mps2
    np.square(force, out=force)
    np.dot(force, _ONES, out=out)
    np.sqrt(out, out=out)
    out -= STANDARD_GRAVITY_MPS2
