"""Refuse time stamps that cannot be those of a walk, and say what they look like."""

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.preprocessing.quality.sampling_rate import FASTEST_HZ, mean_rate_hz
from pdr_est.preprocessing.sensor_ranges import SENSOR_RANGES, out_of_range
from pdr_est.types.recording import DeviceRecording, Signal
from pdr_est.types.sensors import Channel

_LONGEST_WALK_S = 366 * 86400.0  # time stamps further apart are wrong
_LONGEST_STEP_S = 60.0  # usual time between two samples, from which on all stamps are in another unit
_MOST_OUT_OF_RANGE = 0.5  # of the samples: more are not damaged, their unit is another one
_MANY_SAMPLES = 5
_NAMED = 3
_MANY_DIGITS, _MOST_DIGITS = 1e12, 1e20
_REMEDY = "or state the unit of time with --map (time: {column: time_s, unit: ns})"


def require_clock(signal: Signal, sensor: str, label: str) -> None:
    """Check the time stamps of a sensor.

    Parameters
    ----------
    signal
        Samples of the sensor, at least one.
    sensor, label
        Name of the sensor and of the device in messages.

    Raises
    ------
    RecordingError
        For a single sample, a clock that does not advance, and one that spans more than a year.
    """
    time_s = signal.time_s
    if len(signal) == 1:
        raise RecordingError(f"{label}: the {sensor} has a single sample: record for longer")
    if time_s.min() == time_s.max():
        raise RecordingError(
            f"{label}: all {len(signal)} time stamps of the {sensor} are {format_time(time_s[0])} s, the clock does "
            f"not advance: give the fractions of the seconds, too, {_REMEDY}"
        )
    if time_s.max() - time_s.min() > _LONGEST_WALK_S:
        steps_s = np.abs(np.diff(time_s))
        if float(np.median(steps_s)) > _LONGEST_STEP_S:
            shown = ", ".join(format_time(one) for one in time_s[:_NAMED])
            raise RecordingError(
                f"{label}: the time stamps of the {sensor} begin with {shown} and span {_span(signal)}, more than a "
                f"year: give the time in seconds, {_REMEDY}"
            )
        wrong = int(np.argmax(np.abs(time_s - np.median(time_s))))
        raise RecordingError(
            f"{label}: the time stamps of the {sensor} span {format_time(time_s.min())} to "
            f"{format_time(time_s.max())} s, more than a year: correct the time of sample {wrong + 1}, "
            f"{format_time(time_s[wrong])} s, or give the time in seconds, {_REMEDY}"
        )


def explain_empty_grid(device: DeviceRecording, label: str, max_gap_s: float) -> RecordingError:
    """Make the error for a device that has all channels, but from which resampling made no grid point.

    Parameters
    ----------
    device
        Recording of the device.
    label
        Name of the device in messages.
    max_gap_s
        Longest gap, s, that resampling interpolates.
    """
    sensors = (
        ("accelerometer", Channel.SPECIFIC_FORCE, device.specific_force),
        ("gyroscope", Channel.ROTATION_RATE, device.rotation_rate),
        ("attitude", Channel.ATTITUDE, device.attitude),
    )
    for sensor, channel, signal in sensors:
        if signal is None or len(signal) < 2:
            continue
        limit = SENSOR_RANGES.get(channel)
        if limit is not None and out_of_range(channel, signal.values).mean() > _MOST_OUT_OF_RANGE:
            return RecordingError(
                f"{label}: the values of the {sensor} reach {np.abs(signal.values).max():.3g} {limit.unit}, "
                f"more than {limit.largest:g}, which no phone can measure: write their unit into the header"
            )
        apart_s = float(np.median(np.diff(signal.time_s)))
        if apart_s < 0.0:
            return RecordingError(f"{label}: the time stamps of the {sensor} run backwards: sort its rows by time")
        if apart_s > max_gap_s:
            return RecordingError(
                f"{label}: the samples of the {sensor} lie {apart_s:.6g} s apart, more than resample.max_gap_s = "
                f"{max_gap_s:g}, and span {_span(signal)}: give the time in seconds, {_REMEDY}, or record at a "
                "higher rate"
            )
        if mean_rate_hz(signal.time_s) > FASTEST_HZ:
            return RecordingError(
                f"{label}: the {sensor} spans only {_span(signal)}, more a second than any phone has: give the time "
                f"in seconds, {_REMEDY}"
            )
        if len(signal) >= _MANY_SAMPLES and _in_whole_seconds(signal):
            return RecordingError(
                f"{label}: the time stamps of the {sensor} are whole seconds, {len(signal)} samples on "
                f"{len(np.unique(signal.time_s))} of them: give the fractions of the seconds, too"
            )
    spans = [
        f"the {sensor} spans {_span(signal)}" for sensor, _, signal in sensors if signal is not None and len(signal)
    ]
    told = f" ({', '.join(spans)})" if spans else ""
    return RecordingError(f"{label}: too few samples for a single point of the working grid{told}: record for longer")


def _in_whole_seconds(signal: Signal) -> bool:
    """Tell whether time stamps were rounded to seconds, so that some samples share one."""
    since_s = signal.time_s - signal.time_s[0]
    return bool((since_s == np.round(since_s)).all()) and len(np.unique(since_s)) < len(since_s)


def _span(signal: Signal) -> str:
    """Describe how long a signal lasts, and how many samples it has."""
    span_s = float(signal.time_s.max() - signal.time_s.min())
    return f"{span_s:.6g} s with {len(signal)} samples"


def format_time(time_s: float) -> str:
    """Format a time for a message: to the hundredth of a second, but never with hundreds of digits."""
    if _MANY_DIGITS <= abs(time_s) < _MOST_DIGITS:
        return f"{time_s:.0f}"
    text = f"{time_s:.2f}" if abs(time_s) < _MANY_DIGITS else f"{time_s:.6g}"
    return text.removeprefix("-") if float(text) == 0.0 else text
