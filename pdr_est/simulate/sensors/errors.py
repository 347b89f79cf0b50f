"""What a recorder keeps of an ideal signal: noise, bias, scale error, clock jitter, lost samples and gaps."""

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
    """Errors of one three-axis sensor, in its own unit.

    noise_std: white noise of each sample. bias_std: the constant bias of each axis is drawn with it. bias_walk:
    random walk of the bias, unit per square root of a second. scale_std: relative, drawn for each axis.
    """

    noise_std: NonNegative = 0.0
    bias_std: NonNegative = 0.0
    bias_walk: NonNegative = 0.0
    scale_std: NonNegative = 0.0


@params
class SensorParams:
    """The inertial sensors of a phone and its recorder; the defaults are those of an ordinary phone,
    whose gyroscope bias is what its own calibration leaves.

    The gyroscope's bias walks by 2e-5 rad/s per square root of a second, which turns the heading by 0.3 degrees (one
    standard deviation) in a minute and by 2.5 in four; Allan variances of such sensors show 1e-5 to 5e-5. Ours.

    time_jitter_s: standard deviation of the time stamps about the true sampling times, cut at 0.45 of the
    sampling interval so that time never runs back. clock_offset_s, clock_skew: what the device's clock is ahead
    of the true one at the start, and the share by which it runs faster. lost_fraction: samples missing one by
    one, each sensor by itself. gaps_s: (from, to) without any sample, on the true clock. magnetometer: None for a
    device without one; its bias is the hard iron. record_attitude: also keep the exact orientation, as a phone with
    perfect fusion would.
    """

    rate_hz: Annotated[float, Ge(20.0), Le(500.0)] = 100.0
    accelerometer: SensorErrors = SensorErrors(noise_std=0.05, bias_std=0.05, scale_std=0.003)
    gyroscope: SensorErrors = SensorErrors(
        noise_std=0.005, bias_std=float(np.deg2rad(0.05)), bias_walk=2e-5, scale_std=0.003
    )
    magnetometer: SensorErrors | None = None
    time_jitter_s: NonNegative = 0.0005
    clock_offset_s: float = 0.0
    clock_skew: Annotated[float, Ge(-0.01), Le(0.01)] = 0.0
    lost_fraction: Annotated[float, Ge(0.0), Lt(1.0)] = 0.0
    gaps_s: tuple[tuple[float, float], ...] = ()
    record_attitude: bool = False


PERFECT = SensorErrors()
PHONE_MAGNETOMETER = SensorErrors(noise_std=0.6, bias_std=15.0, scale_std=0.01)


@dataclass(frozen=True)
class RecordedSensor:
    """A recorded signal with the errors that were drawn for it. bias, scale: (3,); recorded = scale * true + bias."""

    signal: Signal
    bias: Array
    scale: Array


def sampling_times(end_s: float, rate_hz: float) -> Array:
    """The true sampling times from 0 up to the end, (n,)."""
    count = int(np.floor(end_s * rate_hz + 1e-9)) + 1
    return np.arange(count) / rate_hz


def record(
    time_s: Array, ideal: Array, errors: SensorErrors, sensors: SensorParams, rng: np.random.Generator
) -> RecordedSensor:
    """Record an ideal signal (n, 3) that was sampled at true times (n,)."""
    bias = errors.bias_std * rng.standard_normal(3)
    scale = 1.0 + errors.scale_std * rng.standard_normal(3)
    noise = errors.noise_std * rng.standard_normal(ideal.shape)
    wander = np.cumsum(rng.standard_normal(ideal.shape), axis=0) * errors.bias_walk / np.sqrt(sensors.rate_hz)
    kept = _kept(time_s, sensors, rng)
    values = scale * ideal + bias + wander + noise
    return RecordedSensor(Signal(_stamps(time_s, sensors, rng)[kept], values[kept]), bias, scale)


def record_exactly(time_s: Array, ideal: Array, sensors: SensorParams, rng: np.random.Generator) -> Signal:
    """Record a signal (n, k) without errors in its values; its stamps, lost samples and gaps are as usual."""
    kept = _kept(time_s, sensors, rng)
    return Signal(_stamps(time_s, sensors, rng)[kept], ideal[kept])


def _stamps(time_s: Array, sensors: SensorParams, rng: np.random.Generator) -> Array:
    limit_s = 0.45 / sensors.rate_hz
    jittered_s = time_s + np.clip(sensors.time_jitter_s * rng.standard_normal(len(time_s)), -limit_s, limit_s)
    return (1.0 + sensors.clock_skew) * jittered_s + sensors.clock_offset_s


def _kept(time_s: Array, sensors: SensorParams, rng: np.random.Generator) -> NDArray[np.bool_]:
    kept: NDArray[np.bool_] = rng.random(len(time_s)) >= sensors.lost_fraction
    for start_s, end_s in sensors.gaps_s:
        kept &= (time_s < start_s) | (time_s >= end_s)
    return kept
