"""Features of a step that tell the gait: the six of UPTIME, and our own six of a stride.

Both are the same for every orientation of the phone and need no gyroscope. One sample is enough for a step. Those of
a stride were chosen by how well they classify people who were left out of the training.
"""

from collections.abc import Sequence
from math import log
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.signal.step_samples import Places, StepSamples, of_equal_count, rows_from
from pdr_est.front_end.signal.vectors import dot, excess_magnitude
from pdr_est.types.steps import Step, walks_begun

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
_MOST_PERIODS = 2  # of steps in a stride


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
        m = excess_magnitude(samples.up, samples.acceleration_mps2)
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
        self._last: _Movements | None = None  # of the previous step
        self._waves: dict[
            tuple[int, int], Array
        ] = {}  # cached: strides have few lengths, and a wave costs more than the rest

    def push(self, step: Step, /) -> Array:
        """Compute the features (6,) of the stride that ends with a step."""
        found: Array = self.push_all([step])[0]
        return found

    def push_all(self, steps: Sequence[Step], /) -> Array:
        """Compute the features (n, 6) of the strides that end with each of some steps."""
        begins, new = np.array(walks_begun(steps, self._previous)), _movements_of(steps)
        both = new if self._last is None else self._last.followed_by(new)
        self._previous, self._last = steps[-1], new.last()
        # A stride adds the step before; a step that begins a walk stands for itself.
        own = np.arange(len(both.samples) - len(steps), len(both.samples))
        other = np.where(begins, own, own - 1)

        def total(column: NDArray[Any]) -> NDArray[Any]:
            return np.asarray(column[own] + np.where(begins, 0, column[other]))

        count, start = total(both.samples), both.samples.cumsum() - both.samples
        v_cos, v_sin, m_cos, m_sin = self._spectrum(both, start[other], count, np.where(begins, 1, 2))
        columns = [
            0.5 * _log(v_cos * v_cos + v_sin * v_sin, _LEAST_POWER),
            0.5 * _log(m_cos * m_cos + m_sin * m_sin, _LEAST_POWER),
            _log(0.5 * (both.duration_s[own] + both.duration_s[other]), _LEAST_PERIOD_S),
            0.5 * _log(total(both.horizontal) / count, _LEAST_HORIZONTAL_POWER),
            np.minimum(both.lowest[own], both.lowest[other]),
            total(both.upwards) / count,
        ]
        return np.stack(columns, axis=1)

    def _spectrum(self, movements: "_Movements", start: Places, count: Places, periods: Places) -> Array:
        """Compute cosine and sine part of v, then of m, at the step frequency of strides or single steps (4, n)."""
        spectrum = np.empty((len(count), 2, 2))
        for both, places in of_equal_count(count * _MOST_PERIODS + periods - 1):
            length, number = both // _MOST_PERIODS, both % _MOST_PERIODS + 1
            rows = [rows_from(column, start[places], length) for column in (movements.vertical, movements.excess)]
            spectrum[places] = np.matmul(np.stack(rows, axis=1), self._wave(length, number))
        return spectrum.reshape(-1, 4).T

    def _wave(self, count: int, periods: int) -> Array:
        """Return cosine and sine (count, 2) that turn samples into amplitudes."""
        wave = self._waves.get((count, periods))
        if wave is None:
            phase = (2.0 * np.pi * periods / count) * np.arange(count)
            wave = 2.0 / count * np.stack([np.cos(phase), np.sin(phase)], axis=1)
            self._waves[count, periods] = wave
        return wave


class _Movements(NamedTuple):
    """Movement during successive steps, (n,) in number."""

    samples: Places
    """Number of samples of each step (n,)."""
    vertical: Array
    """v at each sample (samples,)."""
    excess: Array
    """m at each sample (samples,)."""
    duration_s: Array
    """Duration of each step (n,)."""
    horizontal: Array
    """Sum of the squared horizontal acceleration of each step (n,)."""
    lowest: Array
    """Least v of each step (n,)."""
    upwards: Array
    """Number of samples of each step with v > 0 (n,)."""

    def last(self) -> "_Movements":
        """Return that of the last step."""
        samples = slice(len(self.vertical) - int(self.samples[-1]), None)
        by_step = [column[-1:].copy() for column in (self.duration_s, self.horizontal, self.lowest, self.upwards)]
        return _Movements(self.samples[-1:], self.vertical[samples].copy(), self.excess[samples].copy(), *by_step)

    def followed_by(self, others: "_Movements") -> "_Movements":
        """Return that of these steps and others after them."""
        columns: list[NDArray[Any]] = [np.concatenate(both) for both in zip(self, others, strict=True)]
        return _Movements(*columns)


def _movements_of(steps: Sequence[Step]) -> _Movements:
    """Compute the movement of some steps; each product is that of one step, so that no step depends on the others."""
    samples = StepSamples(steps)
    vertical, acceleration, up = (samples.column(name) for name in ("vertical_mps2", "acceleration_mps2", "up"))
    horizontal = dot(acceleration, acceleration) - vertical * vertical
    return _Movements(
        samples.count,
        vertical,
        excess_magnitude(up, acceleration),
        np.array([step.event.time_s - step.start_s for step in steps]),
        np.maximum(samples.sums(horizontal[None])[0], 0.0),
        np.minimum.reduceat(vertical, samples.start),
        np.add.reduceat(vertical > 0.0, samples.start, dtype=np.intp),
    )


def _log(values: Array, least: float) -> Array:
    """Compute the logarithm of values (n,) of at least `least`."""
    # That of the standard library: the rounding of NumPy's may depend on where in the array a number is.
    return np.array(list(map(log, np.maximum(values, least).tolist())))
