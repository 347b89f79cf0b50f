"""Features of a step that tell the gait: the six of UPTIME, and our own six of a stride.

Both are the same for every orientation of the phone and need no gyroscope. One sample is enough for a step. Those of
a stride were chosen by how well they classify people who were left out of the training.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import log
from typing import Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.front_end.signal.step_samples import Places, StepSamples, of_equal_count, rows_from
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

    def push_all(self, steps: Sequence[Step], /) -> Array:
        """Compute the features (n, k) of the next steps, at least one: the same to the last bit as one by one."""
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
        samples = step.samples
        m = _excess_magnitude(samples.up, samples.acceleration_mps2)
        duration_s = step.event.time_s - step.start_s
        mean = float(m.sum()) / len(m)
        deviation = m - mean
        variance = float((deviation * deviation).sum()) / len(m)
        peak = float(m.max())
        rms = (variance + mean * mean) ** 0.5
        return np.array((duration_s, variance, peak, peak - float(m.min()), rms, rms * duration_s))

    def push_all(self, steps: Sequence[Step], /) -> Array:
        """Compute the features (n, 6) of some steps."""
        return np.stack([self.push(step) for step in steps])


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
        self._last: _Movement | None = None  # of the previous step; None where it is not known yet
        self._waves: dict[
            tuple[int, int], Array
        ] = {}  # cached: strides have few lengths, and a wave costs more than the rest

    def push(self, step: Step, /) -> Array:
        """Compute the features (6,) of the stride that ends with a step."""
        previous, own = self._previous, _movement_of(step)
        count, rows, sums = own.rows.shape[1], own.rows, own.sums
        if previous is None or begins_walk(step, previous):
            spectrum = np.matmul(rows, self._wave(count, 1))
            period_s, horizontal, lowest, upwards = sums
        else:
            last = self._last or _movement_of(previous)
            rows, old = np.concatenate((last.rows, rows), axis=1), last.sums
            count = rows.shape[1]
            spectrum = np.matmul(rows, self._wave(count, 2))
            period_s = 0.5 * (sums[0] + old[0])
            horizontal, lowest, upwards = sums[1] + old[1], min(sums[2], old[2]), sums[3] + old[3]
        self._previous, self._last = step, own
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

    def push_all(self, steps: Sequence[Step], /) -> Array:
        """Compute the features (n, 6) of the strides that end with each of some steps."""
        if len(steps) == 1:
            return self.push(steps[0])[None]
        before = self._previous or steps[0]
        is_stride = np.array([not begins_walk(step, previous) for previous, step in pairwise([before, *steps])])
        is_stride[0] &= self._previous is not None
        self._previous, self._last = steps[-1], None
        both = _Movements([before, *steps])
        # A stride adds the step before; a step that begins a walk stands for itself.
        own = np.arange(1, len(steps) + 1)
        other = np.where(is_stride, own - 1, own)
        count = both.samples.count[own] + np.where(is_stride, both.samples.count[other], 0)
        v_cos, v_sin, m_cos, m_sin = self._spectrum(both, both.samples.start[other], count, is_stride)
        horizontal = both.horizontal[own] + np.where(is_stride, both.horizontal[other], 0.0)
        upwards = both.upwards[own] + np.where(is_stride, both.upwards[other], 0.0)
        columns = [
            0.5 * _log(v_cos * v_cos + v_sin * v_sin, _LEAST_POWER),
            0.5 * _log(m_cos * m_cos + m_sin * m_sin, _LEAST_POWER),
            _log(0.5 * (both.duration_s[own] + both.duration_s[other]), _LEAST_PERIOD_S),
            0.5 * _log(horizontal / count, _LEAST_HORIZONTAL_POWER),
            np.minimum(both.lowest[own], both.lowest[other]),
            upwards / count,
        ]
        return np.stack(columns, axis=1)

    def _spectrum(self, movements: "_Movements", start: Places, count: Places, is_stride: NDArray[np.bool_]) -> Array:
        """Compute cosine and sine part of v, then of m, at the step frequency of strides or single steps (4, n)."""
        spectrum = np.empty((len(count), 2, 2))
        for periods, chosen in ((1, ~is_stride), (2, is_stride)):
            if not chosen.any():
                continue
            for length, places in of_equal_count(count[chosen]):
                where = np.flatnonzero(chosen)[places]
                rows = [rows_from(column, start[where], length) for column in (movements.vertical, movements.excess)]
                spectrum[where] = np.matmul(np.stack(rows, axis=1), self._wave(length, periods))
        return spectrum.reshape(-1, 4).T

    def _wave(self, count: int, periods: int) -> Array:
        """Return cosine and sine (count, 2) that turn samples into amplitudes."""
        wave = self._waves.get((count, periods))
        if wave is None:
            phase = (2.0 * np.pi * periods / count) * np.arange(count)
            wave = 2.0 / count * np.stack([np.cos(phase), np.sin(phase)], axis=1)
            self._waves[count, periods] = wave
        return wave


class _Movement(NamedTuple):
    """Movement during a step: rows (2, n) of v and m; duration, horizontal power, least v, samples with v > 0."""

    rows: Array
    sums: tuple[float, float, float, int]


def _movement_of(step: Step) -> _Movement:
    """Compute v, m and their sums of one step."""
    samples = step.samples
    vertical = samples.vertical_mps2
    rows = np.empty((2, len(vertical)))
    rows[0] = vertical
    rows[1] = _excess_magnitude(samples.up, samples.acceleration_mps2)
    acceleration = samples.acceleration_mps2.reshape(1, -1)  # in order of rows, however it lies in memory
    power = np.matmul(acceleration, acceleration.T) - np.matmul(rows[:1], rows[:1].T)
    values = vertical.tolist()  # a list of plain numbers is quicker for so few
    duration_s = step.event.time_s - step.start_s
    return _Movement(rows, (duration_s, max(power.item(), 0.0), min(values), sum([value > 0.0 for value in values])))


class _Movements:
    """The same of many steps at once; each product is that of one step, so that the rounding is the same.

    Parameters
    ----------
    steps : Sequence[Step]
        The n steps.

    Attributes
    ----------
    samples : StepSamples
        Their samples.
    vertical, excess : ndarray, shape (samples,)
        v and m at each sample.
    duration_s, horizontal, lowest, upwards : ndarray, shape (n,)
        Duration of each step, sum of the squared horizontal acceleration, least v, number of samples with v > 0.
    """

    def __init__(self, steps: Sequence[Step]) -> None:
        self.samples = samples = StepSamples(steps)
        self.vertical = vertical = samples.column("vertical_mps2")
        self.excess: Array = np.empty(len(vertical))
        self.duration_s = np.array([step.event.time_s - step.start_s for step in steps])
        self.horizontal, self.lowest, self.upwards = np.empty((3, len(steps)))
        acceleration, up = samples.column("acceleration_mps2"), samples.column("up")
        for count, places in of_equal_count(samples.count):
            start = samples.start[places]
            rows, vectors = rows_from(vertical, start, count), rows_from(acceleration, start, count)
            self.excess[start[:, None] + np.arange(count)] = _excess_magnitude(rows_from(up, start, count), vectors)
            power = _own_products(vectors.reshape(len(places), -1)) - _own_products(rows)
            self.horizontal[places] = np.maximum(power, 0.0)
            self.lowest[places] = rows.min(axis=1)
            self.upwards[places] = np.count_nonzero(rows > 0.0, axis=1)


def _own_products(rows: Array) -> Array:
    """Compute the scalar product of each row (n, k) with itself."""
    products: Array = np.matmul(rows[:, None, :], rows[:, :, None])[:, 0, 0]
    return products


def _log(values: Array, least: float) -> Array:
    """Compute the logarithm of values (n,) of at least `least`."""
    return np.array([log(max(value, least)) for value in values.tolist()])


def _excess_magnitude(up: Array, acceleration_mps2: Array) -> Array:
    """Compute `signal.vectors.excess_magnitude` of steps (..., n, 3) in half the time, as no step is cut."""
    force = STANDARD_GRAVITY_MPS2 * up
    force += acceleration_mps2
    np.square(force, out=force)
    magnitude: Array = np.matmul(force, _ONES)
    np.sqrt(magnitude, out=magnitude)
    magnitude -= STANDARD_GRAVITY_MPS2
    return magnitude
