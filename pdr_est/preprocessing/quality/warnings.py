"""Warn of faults of accelerometer and gyroscope that make steps and track doubtful although they can be computed."""

from collections.abc import Iterator

import numpy as np

from pdr_est.preprocessing.gravity_stand_in import needs_stand_in
from pdr_est.preprocessing.quality.consistency import consistency_warnings
from pdr_est.preprocessing.quality.sampling_rate import sampling_rate_warnings, slow_gyroscope_warnings
from pdr_est.preprocessing.quality.sensor_checks import check_clock, clipped_axes, constant_axes, stuck_intervals
from pdr_est.preprocessing.sensor_ranges import SENSOR_RANGES, out_of_range, rows_kept, usable_samples
from pdr_est.types.recording import DeviceRecording, Signal
from pdr_est.types.sensors import Channel

_COVERED_SHARE = 0.98  # of the accelerometer's time: sensors start and stop one after the other
_COVERED_HALF = 0.5
_FEWEST_FOR_CLIPPING = 50  # samples
_AXES = "xyz"
_GUESSED = (
    "the acceleration is without gravity, and the direction of the strongest motion was taken for the vertical: take "
    "the number of steps with care"
)


def quality_warnings(device: DeviceRecording) -> tuple[str, ...]:
    """List the faults of accelerometer and gyroscope of a device as sentences; empty when there are none."""
    force, rate = (_non_empty(signal) for signal in (device.specific_force, device.rotation_rate))
    if force is None and needs_stand_in(device):
        force = device.linear_acceleration
        return (*sampling_rate_warnings(force), _GUESSED) if force is not None else ()
    found = [*_range_warnings("accelerometer", Channel.SPECIFIC_FORCE, force)]
    found += _range_warnings("gyroscope", Channel.ROTATION_RATE, rate)
    if force is not None:
        found += sampling_rate_warnings(force)
        found += _stuck_warnings("accelerometer", force, rate, "steps cannot be seen there")
        found += _axis_warnings("accelerometer", Channel.SPECIFIC_FORCE, force, "step lengths and tilt")
    if rate is not None and not rate.values.any():
        found.append("all values of the gyroscope are zero, the sensor is missing or faulty: turns cannot be seen")
    elif rate is not None:
        found += slow_gyroscope_warnings(rate)
        found += _stuck_warnings("gyroscope", rate, force, "turns cannot be seen there")
        found += _axis_warnings("gyroscope", Channel.ROTATION_RATE, rate, "headings and track")
    if force is not None and rate is not None:
        found += _coverage_warnings(force, rate)
    return (*found, *consistency_warnings(device))


def _non_empty(signal: Signal | None) -> Signal | None:
    return signal if signal is not None and len(signal) else None


def _range_warnings(sensor: str, channel: Channel, signal: Signal | None) -> Iterator[str]:
    """Count samples beyond what a phone can measure."""
    count = 0 if signal is None else int(out_of_range(channel, signal.values).sum())
    if signal is not None and count:
        limit = SENSOR_RANGES[channel]
        yield (
            f"{count} of {len(signal)} samples of the {sensor} are beyond {limit.largest:g} {limit.unit}, "
            "which no phone can measure, and are left out"
        )


def _stuck_warnings(sensor: str, signal: Signal, other: Signal | None, effect: str) -> Iterator[str]:
    """Sum up the time in which a sensor does not change while the other one moves."""
    intervals = stuck_intervals(signal, () if other is None else (other,))
    if intervals:
        total_s = sum(interval.length_s for interval in intervals)
        yield f"the {sensor} is stuck from {intervals[0].start_s:.2f} s on, for {total_s:.1f} s in all: {effect}"


def _axis_warnings(sensor: str, channel: Channel, signal: Signal, doubtful: str) -> Iterator[str]:
    """Tell axes that never change, and those that stay at the end of their range."""
    values = rows_kept(signal.values, usable_samples(channel, signal.values))
    for axis in constant_axes(values):
        yield (
            f"the {_AXES[axis]} axis of the {sensor} is always {values[0, axis]:.3g} while the others change: "
            f"{doubtful} are wrong; check its column"
        )
    if len(values) < _FEWEST_FOR_CLIPPING:
        return
    for axis in clipped_axes(values):
        column = values[:, axis]
        share = float(np.mean((column == column.max()) | (column == column.min())))
        yield (
            f"the {_AXES[axis]} axis of the {sensor} hits the end of its range, {column.min():.3g} to "
            f"{column.max():.3g} {SENSOR_RANGES[channel].unit}, in {max(share, 0.001):.1%} of its samples: "
            f"{doubtful} are doubtful; record with a wider range"
        )


def _coverage_warnings(force: Signal, rate: Signal) -> Iterator[str]:
    """Compare the time that the gyroscope recorded with that of the accelerometer."""
    recorded_s = _recorded_s(force, force)
    covered_s = min(_recorded_s(rate, force), recorded_s)
    if covered_s >= _COVERED_SHARE * recorded_s:
        return
    text = (
        f"the gyroscope covers only {covered_s:.1f} of {recorded_s:.1f} s of the accelerometer: "
        "nothing outside is used"
    )
    if covered_s < _COVERED_HALF * recorded_s:
        text += "; `pdr-est steps` finds more steps in a recording without the gyroscope"
    yield text


def _recorded_s(signal: Signal, within: Signal) -> float:
    """Compute how long a signal was recorded, without its gaps, from the first to the last sample of another."""
    start_s, end_s = within.time_s.min(), within.time_s.max()
    # Sorted, because a clock that goes back would count gaps twice and make the duration negative.
    inside_s = np.sort(signal.time_s[(signal.time_s >= start_s) & (signal.time_s <= end_s)])
    if len(inside_s) < 2:
        return 0.0
    gaps_s = sum(gap.length_s for gap in check_clock(inside_s).gaps)
    return float(inside_s.max() - inside_s.min()) - gaps_s
