"""Our step-length model by the shape of the vertical acceleration: one law for walking and running.

    length = k * height * h ** a * p ** b * T ** c * exp(-d * turn)

where h is the amplitude of the first harmonic of the vertical acceleration over the step, p the value that it exceeds
for a tenth of the step, T the duration of the step, and turn the heading change per step.

The body rises and falls once per step, higher for a longer step: that is the first harmonic. For a sine p is 0.95 h.
What makes it larger is the blow of the heel, the arm and the hand, which differ between people, phones and ways of
carrying far more than step lengths do. The quotient of the two therefore carries over where a range of acceleration
does not. Neither changes with the axes of the device, and hardly with its sampling rate.

The exponents were fitted on walks of known length, all people and phones of a data set left out in turn
(`experiments/step_length_fit.py`, `docs/accuracy.md`). Compared with the smoothed range (`range-power`, and with
cadence), the second and third harmonic, the root mean square, the jerk, horizontal and turning motion, the skewness
and the phases of the harmonics, in all combinations of three, this form had the smallest error on what was left out;
quantiles from 85 to 95 % and the mean of the positive part are nearly as good. Averages over the last steps are not
better than the step by itself, and worse for a phone in a swinging arm. Runners were not in the fit.
"""

import math
from collections import deque
from collections.abc import Callable, Sequence
from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Ge, Gt, Le

from pdr_est.frames import Array
from pdr_est.front_end.signal.step_samples import StepSamples, of_equal_count, rows_from
from pdr_est.params import Positive, params
from pdr_est.types.steps import Step, walks_begun

LEAST_SAMPLES = 6  # of a step whose shape shows

_HEIGHT_M = 1.73  # height of a person for whom the constants hold
_LEAST_AMPLITUDE_MPS2 = 0.1  # keeps a step without movement finite
_MOST_QUOTIENT = 1.5  # of first harmonic and upper values; more is a knock, shorter than a tenth of the step
_LEAST_DURATION_S = 0.1
_QUICKEST_S = 0.4  # 2.5 steps per second, as in `walker`
_UPPER = 0.9
_TURN_STEPS = 4  # two strides: a phone in a pocket turns to and fro once per stride
_MOST_TURN_RAD = 1.0  # per step; quicker is the phone and not the walker


@params
class HarmonicParams:
    """Length by the first harmonic of the vertical acceleration, its upper values and the duration of the step.

    The constants are those of `experiments/step_length_fit.py`.
    """

    length_m: Positive = 0.761
    """Length, m, of a step of 1 s by someone 1.73 m tall with a first harmonic and upper values of 1 m/s^2; ours."""
    harmonic_exponent: Annotated[float, Gt(0.0), Le(1.0)] = 0.59
    """Power of the amplitude of the first harmonic; ours."""
    push_exponent: Annotated[float, Ge(-1.0), Le(0.0)] = -0.4
    """Power of the upper values; ours."""
    duration_exponent: Annotated[float, Ge(0.0), Le(1.0)] = 0.4
    """Power of the duration of the step; ours."""
    turn_per_rad: Annotated[float, Ge(0.0), Le(2.0)] = 0.25
    """Decrease of the logarithm of the length per radian of heading change per step; ours, from the differences
    between the stretches of a walk.
    """


class StepShapes(NamedTuple):
    """Numbers that the samples of n steps tell of their lengths.

    Attributes
    ----------
    harmonic_mps2, upper_mps2 : ndarray, shape (n,)
        First harmonic and upper values of the vertical acceleration.
    turn_rate_radps : ndarray, shape (n,)
        Mean rotation rate about the vertical; NaN for a device without gyroscope.
    """

    harmonic_mps2: Array
    upper_mps2: Array
    turn_rate_radps: Array


def step_shapes(steps: Sequence[Step]) -> StepShapes:
    """Measure the shape of each of some steps, at least one; it is NaN for a step without samples."""
    samples = StepSamples(steps)
    vertical, turn_rate = samples.column("vertical_mps2"), samples.column("turn_rate_radps")
    shapes = StepShapes(*np.full((3, len(steps)), np.nan))
    for count, places in of_equal_count(samples.count):
        if count:
            rows = rows_from(vertical, samples.start[places], count)
            shapes.harmonic_mps2[places] = first_harmonic_mps2(rows)
            shapes.upper_mps2[places] = upper_values_mps2(rows)
            turned = rows_from(turn_rate, samples.start[places], count).sum(axis=1)
            shapes.turn_rate_radps[places] = turned / count
    return shapes


def harmonic_length_m(
    parameters: HarmonicParams, height_m: float, duration_s: float, turn_rad: float, vertical_mps2: Array
) -> float:
    """Compute the length of a step.

    Parameters
    ----------
    parameters : HarmonicParams
        Constants.
    height_m : float
        Height of the walker, m.
    duration_s : float
        Duration of the step, s.
    turn_rad : float
        Heading change per step, rad, not negative.
    vertical_mps2 : ndarray
        Vertical acceleration (n,) during the step, m/s^2.
    """
    features = log_features(duration_s, vertical_mps2)
    return float(lengths_of_features_m(parameters, height_m, np.array([turn_rad]), np.array([features]).T)[0])


def lengths_of_features_m(parameters: HarmonicParams, height_m: float, turn_rad: Array, features: Array) -> Array:
    """Compute the lengths (n,) of steps from turns (n,) and `shape_features` (3, n); see `harmonic_length_m`."""
    p = parameters
    harmonic, upper, duration = features
    exponent = (
        p.harmonic_exponent * harmonic
        + p.push_exponent * upper
        + p.duration_exponent * duration
        - p.turn_per_rad * turn_rad
    )
    return p.length_m * height_m / _HEIGHT_M * _each(math.exp, exponent)


def walked_part(parameters: HarmonicParams, duration_s: float) -> float:
    """Compute the factor of a walker's step that took less time than that of the quickest walk, else 1.

    The detector has cut a step in two, or has found one where the foot only moved. Such an interval counts for its
    time: with the factor its length is proportional to the duration.
    """
    part = max(duration_s, _LEAST_DURATION_S) / _QUICKEST_S
    return float(min(part, 1.0) ** (1.0 - parameters.duration_exponent))


def log_features(duration_s: float, vertical_mps2: Array) -> tuple[float, float, float]:
    """Compute the logarithms of first harmonic, upper values and duration of a step, within bounds."""
    rows = vertical_mps2[None]
    shape = StepShapes(first_harmonic_mps2(rows), upper_values_mps2(rows), np.zeros(1))
    harmonic, upper, duration = shape_features(np.array([duration_s]), shape)[:, 0].tolist()
    return harmonic, upper, duration


def shape_features(duration_s: Array, shapes: StepShapes) -> Array:
    """Compute the `log_features` (3, n) of steps with durations (n,) whose shapes are known."""
    harmonic_mps2 = np.maximum(shapes.harmonic_mps2, _LEAST_AMPLITUDE_MPS2)
    upper_mps2 = np.maximum(shapes.upper_mps2, harmonic_mps2 / _MOST_QUOTIENT)
    bounded = (harmonic_mps2, upper_mps2, np.maximum(duration_s, _LEAST_DURATION_S))
    return np.stack([_each(math.log, values) for values in bounded])


def _each(function: Callable[[float], float], values: Array) -> Array:
    """Apply a function of the standard library, as the rounding of NumPy's may depend on the place in an array."""
    return np.array(list(map(function, values.tolist())))


def first_harmonic_mps2(vertical_mps2: Array) -> Array:
    """Compute the amplitude of the sine that has one period in the samples of a step, the last axis."""
    count = vertical_mps2.shape[-1]
    phase = np.exp(-2j * np.pi / count * np.arange(count))
    total = np.sum(vertical_mps2 * phase, axis=-1)
    amplitude: Array = 2.0 / count * np.hypot(total.real, total.imag)
    return amplitude


def upper_values_mps2(vertical_mps2: Array) -> Array:
    """Compute the 90 % quantile of the samples of a step, the last axis, about their mean."""
    count = vertical_mps2.shape[-1]
    ordered = np.sort(vertical_mps2, axis=-1)  # quicker than np.quantile, and the same
    place = _UPPER * (count - 1)
    below = int(place)
    above = min(below + 1, count - 1)
    quantile = ordered[..., below] + (place - below) * (ordered[..., above] - ordered[..., below])
    upper: Array = quantile - np.sum(vertical_mps2, axis=-1) / count
    return upper


class TurnMeter:
    """Heading change per step over the last steps of a walk, by the rotation about the vertical alone.

    A device without gyroscope, and one that does not turn, gives 0.
    """

    def __init__(self) -> None:
        self._previous: Step | None = None
        self._changes_rad: deque[float] = deque(maxlen=_TURN_STEPS)

    def at(self, step: Step) -> float:
        """Take in the next step and return the heading change per step, rad, not negative."""
        return self.after_each([step], [float(step.samples.turn_rate_radps.mean())])[0]

    def after_each(self, steps: Sequence[Step], turn_rate_radps: Sequence[float]) -> list[float]:
        """Take in the next steps with their mean rotation rates about the vertical; return what `at` does."""
        changes, found = self._changes_rad, []
        for step, begins, rate in zip(steps, walks_begun(steps, self._previous), turn_rate_radps, strict=True):
            if begins:
                changes.clear()
            change_rad = rate * (step.event.time_s - step.start_s)
            changes.append(change_rad if math.isfinite(change_rad) else 0.0)
            found.append(min(abs(math.fsum(changes)) / len(changes), _MOST_TURN_RAD))
        self._previous = steps[-1] if steps else self._previous
        return found
