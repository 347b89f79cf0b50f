"""Errors of sensors and recorder: noise, bias, scale error, clock jitter, lost samples and gaps."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le, Lt
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.params import NonNegative, params
from pdr_est.types.recording import Signal


@params
class SensorErrors:
    """Errors of one three-axis sensor, in its own unit."""

    noise_std: NonNegative = 0.0
    """Standard deviation of the white noise of each sample."""
    bias_std: NonNegative = 0.0
    """Standard deviation of the constant bias of each axis."""
    bias_walk: NonNegative = 0.0
    """Random walk of the bias, unit per square root of a second."""
    scale_std: NonNegative = 0.0
    """Relative standard deviation of the scale factor of each axis."""
    bias: tuple[float, ...] = ()
    """Given bias of each axis, to which the drawn constant bias is added; none if empty."""


@params
class SensorParams:
    """Inertial sensors of a phone and its recorder; the defaults are those of an ordinary phone."""

    rate_hz: Annotated[float, Ge(20.0), Le(500.0)] = 100.0
    """Sampling rate, Hz."""
    accelerometer: SensorErrors = SensorErrors(noise_std=0.05, bias_std=0.05, scale_std=0.003)
    """Errors of the accelerometer, m/s^2."""
    gyroscope: SensorErrors = SensorErrors(
        noise_std=0.005, bias_std=float(np.deg2rad(0.05)), bias_walk=2e-5, scale_std=0.003
    )
    """Errors of the gyroscope, rad/s. The bias is what the phone's own calibration leaves. It walks by 2e-5 rad/s per
    square root of a second, which rotates the heading by 0.3 degrees (one standard deviation) in a minute and by 2.5
    in four; Allan variances of such sensors show 1e-5 to 5e-5. The value is our choice.
    """
    magnetometer: SensorErrors | None = None
    """Errors of the magnetometer, uT, whose bias is the hard iron; None for a device without one."""
    barometer: SensorErrors | None = None
    """Errors of the barometer, Pa; None for a device without one."""
    time_jitter_s: NonNegative = 0.0005
    """Standard deviation of the time stamps about the true sampling times, s, cut at 0.45 of the sampling interval so
    that time never runs back.
    """
    clock_offset_s: float = 0.0
    """Offset of the device's clock from the true one at the start, s; positive if it is ahead."""
    clock_skew: Annotated[float, Ge(-0.01), Le(0.01)] = 0.0
    """Relative rate error of the device's clock; positive if it runs faster."""
    lost_fraction: Annotated[float, Ge(0.0), Lt(1.0)] = 0.0
    """Fraction of samples that are lost one by one, independently for each sensor."""
    gaps_s: tuple[tuple[float, float], ...] = ()
    """Intervals (from, to) without any sample, on the true clock, s."""
    record_attitude: bool = False
    """Also record the exact orientation, as a phone with perfect sensor fusion would."""


NO_SENSOR_ERRORS = SensorErrors()
PHONE_MAGNETOMETER = SensorErrors(noise_std=0.6, bias_std=15.0, scale_std=0.01)
PHONE_BAROMETER = SensorErrors(noise_std=1.5, bias_std=100.0, bias_walk=0.5)
"""Noise and absolute error of phones' barometers by their data sheets; the walk, 4 cm per root second, is ours."""


@dataclass(frozen=True)
class RecordedSensor:
    """Recorded signal with the errors that were drawn for it: recorded = scale * true + bias, plus noise.

    Attributes
    ----------
    signal : Signal
        Recorded time stamps and values.
    bias, scale : Array
        Constant bias in the sensor's unit and scale factor of each axis, (k,).
    """

    signal: Signal
    bias: Array
    scale: Array


def sampling_times(end_s: float, rate_hz: float) -> Array:
    """Compute the true sampling times (n,), s, from 0 up to the end."""
    count = int(np.floor(end_s * rate_hz + 1e-9)) + 1
    return np.arange(count) / rate_hz


def record_signal(
    time_s: Array, ideal: Array, errors: SensorErrors, sensors: SensorParams, rng: np.random.Generator
) -> RecordedSensor:
    """Record an ideal signal (n, k) that was sampled at true times (n,), s, with errors."""
    axes = ideal.shape[1:]
    bias = np.array(errors.bias or 0.0) + errors.bias_std * rng.standard_normal(axes)
    scale = 1.0 + errors.scale_std * rng.standard_normal(axes)
    noise = errors.noise_std * rng.standard_normal(ideal.shape)
    wander = np.cumsum(rng.standard_normal(ideal.shape), axis=0) * errors.bias_walk / np.sqrt(sensors.rate_hz)
    kept = _kept_samples(time_s, sensors, rng)
    values = scale * ideal + bias + wander + noise
    return RecordedSensor(Signal(_time_stamps(time_s, sensors, rng)[kept], values[kept]), bias, scale)


def record_without_errors(time_s: Array, ideal: Array, sensors: SensorParams, rng: np.random.Generator) -> Signal:
    """Record a signal (n, k) with exact values; time stamps, lost samples and gaps are as usual."""
    kept = _kept_samples(time_s, sensors, rng)
    return Signal(_time_stamps(time_s, sensors, rng)[kept], ideal[kept])


def air_pressure_pa(height_m: Array) -> Array:
    """Compute the air pressure (n, 1), Pa, of the standard atmosphere (ISO 2533) at heights (n,), m."""
    pressure: Array = 101325.0 * (1.0 - 2.25577e-5 * height_m[:, None]) ** 5.25588
    return pressure


def _time_stamps(time_s: Array, sensors: SensorParams, rng: np.random.Generator) -> Array:
    """Compute the device's time stamps: jitter, skew and offset."""
    limit_s = 0.45 / sensors.rate_hz
    jittered_s = time_s + np.clip(sensors.time_jitter_s * rng.standard_normal(len(time_s)), -limit_s, limit_s)
    return (1.0 + sensors.clock_skew) * jittered_s + sensors.clock_offset_s


def _kept_samples(time_s: Array, sensors: SensorParams, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Draw which samples are recorded."""
    kept: NDArray[np.bool_] = rng.random(len(time_s)) >= sensors.lost_fraction
    for start_s, end_s in sensors.gaps_s:
        kept &= (time_s < start_s) | (time_s >= end_s)
    return kept
