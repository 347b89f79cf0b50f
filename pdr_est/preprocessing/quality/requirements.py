"""Refuse recordings that lack what steps or a track need, with an error that says why and what to do."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.units import Conversion, detect_acceleration_unit, detect_rotation_rate_unit
from pdr_est.preprocessing.gravity_stand_in import needs_stand_in
from pdr_est.preprocessing.quality.capabilities import suggest_unused_columns
from pdr_est.preprocessing.quality.clock_requirements import format_time, require_clock
from pdr_est.preprocessing.quality.sampling_rate import refuse_slow_sampling
from pdr_est.preprocessing.sensor_ranges import rows_kept, usable_samples
from pdr_est.types.recording import DeviceRecording, Signal
from pdr_est.types.sensors import Channel

COARSE_SAMPLING_S = 0.03
"""Sampling period, s, above which the integrated rotation rate of a phone on a leg drifts: at 25 Hz three times as
fast."""

_LATE_S = 1.0
_MANY_SAMPLES = 5
_SENSOR_NAMES = {
    Channel.SPECIFIC_FORCE: "accelerometer",
    Channel.ROTATION_RATE: "gyroscope",
    Channel.ATTITUDE: "attitude",
}
_UNITS: Mapping[Channel, tuple[Callable[[Array], Conversion], str, str]] = MappingProxyType(
    {
        Channel.SPECIFIC_FORCE: (detect_acceleration_unit, "m/s^2", "acc_x (g)"),
        Channel.ROTATION_RATE: (detect_rotation_rate_unit, "rad/s", "gyr_x (deg/s)"),
    }
)


def has_gyroscope(device: DeviceRecording) -> bool:
    """Tell whether a device recorded a gyroscope, without which its steps have no heading."""
    return _signal(device, Channel.ROTATION_RATE) is not None


def require_track_sensors(device: DeviceRecording, label: str, one_of_several: bool = False) -> None:
    """Check that a device has the sensors without which no track is possible, whatever the settings.

    Parameters
    ----------
    device
        Recording of the device.
    label
        Name of the device in messages.
    one_of_several
        True when other devices could make a track without this one.

    Raises
    ------
    RecordingError
        When there is no accelerometer, only one without gravity, or no gyroscope.
    """
    _refuse_without_gravity(device, label)
    _specific_force(device, label)
    if not has_gyroscope(device):
        raise RecordingError(
            f"{label}: no gyroscope{_reader_warnings(device)}, so steps can be found but no heading and no track: "
            f"record it too{', or leave this device out' if one_of_several else ''}"
            f"{suggest_unused_columns(device.decisions)}; `pdr-est steps` still finds the steps"
        )


def require_plausible_samples(device: DeviceRecording, label: str) -> None:
    """Check the clocks, rates and units of accelerometer and gyroscope, of those that a device has.

    Parameters
    ----------
    device
        Recording of the device.
    label
        Name of the device in messages.

    Raises
    ------
    RecordingError
        When one has a single sample, a clock that does not advance or spans more than a year, or a wrong unit, or
        when the accelerometer is too slow for steps.
    """
    for channel in _UNITS:
        signal = _signal(device, channel)
        if signal is not None:
            require_clock(signal, _SENSOR_NAMES[channel], label)
            _check_unit(channel, signal, label)
    force = _signal(device, Channel.SPECIFIC_FORCE)
    if force is not None:
        refuse_slow_sampling(force, label)


def prefers_recorded_attitude(device: DeviceRecording) -> bool:
    """Tell whether the recorded attitude of a device is better than one integrated from its samples.

    That is so where the gyroscope was sampled so coarsely that it misses the motion of a limb, while the attitude was
    recorded all along and at least about as often.
    """
    rate, attitude = _signal(device, Channel.ROTATION_RATE), _signal(device, Channel.ATTITUDE)
    if rate is None or attitude is None or len(rate) < 2 or len(attitude) < 0.9 * len(rate):
        return False
    period_s = float(np.median(np.diff(rate.time_s)))
    late_s = max(attitude.time_s[0] - rate.time_s[0], rate.time_s[-1] - attitude.time_s[-1])
    return bool(period_s > COARSE_SAMPLING_S and late_s < _LATE_S)


def required_channels(device: DeviceRecording, label: str, with_attitude: bool) -> tuple[Channel, ...]:
    """Select the channels that the front end needs; without a gyroscope that is the accelerometer alone.

    Parameters
    ----------
    device
        Recording of the device.
    label
        Name of the device in messages.
    with_attitude
        True when the recorded attitude is used.

    Raises
    ------
    RecordingError
        When one of the channels is missing, has a single sample, a clock that does not advance or a wrong unit, or
        when the channels do not overlap in time.
    """
    signals = _required_signals(device, label, with_attitude)
    for channel, signal in signals.items():
        require_clock(signal, _SENSOR_NAMES[channel], label)
        _check_unit(channel, signal, label)
    refuse_slow_sampling(signals[Channel.SPECIFIC_FORCE], label)
    start_s = max(float(signal.time_s.min()) for signal in signals.values())
    end_s = min(float(signal.time_s.max()) for signal in signals.values())
    if start_s >= end_s:
        spans = ", ".join(
            f"{_SENSOR_NAMES[channel]} {format_time(signal.time_s.min())} to {format_time(signal.time_s.max())} s"
            for channel, signal in signals.items()
        )
        raise RecordingError(f"{label}: the channels do not overlap in time ({spans}): check the recorder's clocks")
    return tuple(signals)


def require_magnetometer(device: DeviceRecording, label: str) -> None:
    """Check that a device recorded a magnetic field.

    Raises
    ------
    RecordingError
        When it did not; `label` names the device in the message.
    """
    if _signal(device, Channel.MAGNETIC_FIELD) is None:
        raise RecordingError(
            f"{label}: no magnetometer{_reader_warnings(device)}, which heading.method: magnetometer needs: "
            "record it too, or choose another method"
        )


def _required_signals(device: DeviceRecording, label: str, with_attitude: bool) -> Mapping[Channel, Signal]:
    signals = {Channel.SPECIFIC_FORCE: _specific_force(device, label)}
    rate = _signal(device, Channel.ROTATION_RATE)
    if rate is not None:
        signals[Channel.ROTATION_RATE] = rate
    if with_attitude:
        if rate is None:
            raise RecordingError(
                f"{label}: no gyroscope{_reader_warnings(device)}, without which the recorded attitude cannot be "
                "used: set attitude.source: vqf in the configuration to find steps by the accelerometer alone"
            )
        attitude = _signal(device, Channel.ATTITUDE)
        if attitude is None:
            raise RecordingError(
                f"{label}: the device recorded no attitude{_reader_warnings(device)}: "
                "set attitude.source: vqf in the configuration"
            )
        signals[Channel.ATTITUDE] = attitude
    return signals


def _specific_force(device: DeviceRecording, label: str) -> Signal:
    force = _signal(device, Channel.SPECIFIC_FORCE)
    if force is None:
        raise RecordingError(
            f"{label}: no accelerometer{_reader_warnings(device)}, without which nothing can be estimated: record it "
            "and try again"
        )
    return force


def _refuse_without_gravity(device: DeviceRecording, label: str) -> None:
    """Refuse an acceleration without gravity, which shows neither tilt nor headings."""
    if needs_stand_in(device):
        told = [warning for warning in device.warnings if "without gravity" in warning]
        remedy = "; ".join(told) or "record the accelerometer with gravity, or the gravity besides"
        raise RecordingError(
            f"{label}: the acceleration is without gravity, so no track is possible, only steps, with "
            f"`pdr-est steps`: {remedy}"
        )


def _reader_warnings(device: DeviceRecording) -> str:
    """Quote the warnings of the reader in brackets: they often say why a sensor is missing."""
    return f" ({'; '.join(device.warnings)})" if device.warnings else ""


def _signal(device: DeviceRecording, channel: Channel) -> Signal | None:
    """Return the signal of a channel; None when it is absent or empty."""
    signal = {
        Channel.SPECIFIC_FORCE: device.specific_force,
        Channel.ROTATION_RATE: device.rotation_rate,
        Channel.ATTITUDE: device.attitude,
        Channel.MAGNETIC_FIELD: device.magnetic_field,
    }[channel]
    return signal if signal is not None and len(signal) else None


def _check_unit(channel: Channel, signal: Signal, label: str) -> None:
    """Refuse values that are surely in another unit than the one they were read in."""
    if channel not in _UNITS:
        return
    detect, assumed_unit, title = _UNITS[channel]
    values = rows_kept(signal.values, usable_samples(channel, signal.values))
    if len(values) < _MANY_SAMPLES:
        return
    conversion = detect(values)
    if conversion.factor != 1.0:
        raise RecordingError(
            f"{label}: the {_SENSOR_NAMES[channel]} was read as {assumed_unit}, but {conversion.decision}: "
            f"convert the values, or write their unit into the header, as in {title}"
        )
