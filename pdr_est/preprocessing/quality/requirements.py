"""What steps and what a track need of a device's recording, and in words why a recording does not have it."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.units import Conversion, detect_acceleration_unit, detect_rotation_rate_unit
from pdr_est.preprocessing.sensor_ranges import SENSOR_RANGES, out_of_range
from pdr_est.types.recording import DeviceRecording, Signal
from pdr_est.types.sensors import Channel

_LONGEST_WALK_S = 366 * 86400.0  # what lies further apart is a wrong time stamp
_MOST_IMPOSSIBLE = 0.5  # of the samples: more are no damage, their unit is another one
COARSE_SAMPLING_S = 0.03  # between samples; integrated, those of a phone on a leg at 25 Hz drift three times as fast
_LATE_S = 1.0
_MANY_SAMPLES = 5  # of which some share a second
_WORDS = {
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
    """Whether steps of this device can have a direction."""
    return _signal(device, Channel.ROTATION_RATE) is not None


def require_track_sensors(device: DeviceRecording, place: str, one_of_several: bool = False) -> None:
    """Raises RecordingError when a device lacks a sensor without which there is no track, whatever the settings.

    place: what to call the device in messages. one_of_several: whether others could make a track without it.
    """
    _specific_force(device, place)
    if not has_gyroscope(device):
        raise RecordingError(
            f"{place}: no gyroscope{_reasons(device)}, so steps could be found but no heading and no track: "
            f"record it too{', or leave this device out' if one_of_several else ''}; `pdr-est steps` still finds the "
            "steps"
        )


def prefers_recorded_attitude(device: DeviceRecording) -> bool:
    """Whether the attitude that the device recorded is better than one from its samples: they are so far apart that
    they miss what a limb does, and it was recorded all along, at least as often as they were."""
    rate, attitude = _signal(device, Channel.ROTATION_RATE), _signal(device, Channel.ATTITUDE)
    if rate is None or attitude is None or len(rate) < 2 or len(attitude) < 0.9 * len(rate):
        return False
    apart_s = float(np.median(np.diff(rate.time_s)))
    late_s = max(attitude.time_s[0] - rate.time_s[0], rate.time_s[-1] - attitude.time_s[-1])
    return bool(apart_s > COARSE_SAMPLING_S and late_s < _LATE_S)


def required_channels(device: DeviceRecording, place: str, with_attitude: bool) -> tuple[Channel, ...]:
    """The channels that the front end takes: the accelerometer alone where there is no gyroscope.

    with_attitude: whether the device's own attitude is one of them. place: what to call the device in messages.
    Raises RecordingError when one of them is missing, has a single sample, has no running clock, is in a wrong unit,
    or when they never run at the same time.
    """
    signals = _needed_signals(device, place, with_attitude)
    for channel, signal in signals.items():
        _refuse_useless_clock(signal, _WORDS[channel], place)
        _refuse_wrong_unit(channel, signal, place)
    start_s = max(float(signal.time_s.min()) for signal in signals.values())
    end_s = min(float(signal.time_s.max()) for signal in signals.values())
    if start_s >= end_s:
        spans = ", ".join(
            f"{_WORDS[channel]} {_seconds(signal.time_s.min())} to {_seconds(signal.time_s.max())} s"
            for channel, signal in signals.items()
        )
        raise RecordingError(f"{place}: the channels do not overlap in time ({spans}): check the recorder's clocks")
    return tuple(signals)


def require_magnetometer(device: DeviceRecording, place: str) -> None:
    """Raises RecordingError when a device recorded no magnetic field. place: what to call it in messages."""
    if _signal(device, Channel.MAGNETIC_FIELD) is None:
        raise RecordingError(
            f"{place}: no magnetometer{_reasons(device)}, which heading.method: magnetometer needs: record it too, "
            "or choose another method"
        )


def explain_empty_grid(device: DeviceRecording, place: str, longest_pause_s: float) -> RecordingError:
    """The error for a device with all channels from which resampling made nothing."""
    for channel, words in _WORDS.items():
        signal = _signal(device, channel)
        if signal is None or len(signal) < 2:
            continue
        limit = SENSOR_RANGES.get(channel)
        if limit is not None and out_of_range(channel, signal.values).mean() > _MOST_IMPOSSIBLE:
            return RecordingError(
                f"{place}: the values of the {words} reach {np.abs(signal.values).max():.3g} {limit.unit}, more than "
                f"{limit.largest:g}, which no phone can measure: write their unit into the header"
            )
        pause_s = float(np.median(np.diff(signal.time_s)))
        if pause_s < 0.0:
            return RecordingError(f"{place}: the time stamps of the {words} run backwards: sort its rows by time")
        if pause_s > longest_pause_s:
            return RecordingError(
                f"{place}: the samples of the {words} lie {pause_s:.6g} s apart, more than resample.max_gap_s = "
                f"{longest_pause_s:g}: give the time in seconds, or record at a higher rate"
            )
        if len(signal) >= _MANY_SAMPLES and _whole_seconds(signal):
            return RecordingError(
                f"{place}: the time stamps of the {words} are whole seconds, {len(signal)} samples on "
                f"{len(np.unique(signal.time_s))} of them: give seconds with their fractions"
            )
    return RecordingError(f"{place}: too few samples for a single point of the working grid: record for longer")


def _whole_seconds(signal: Signal) -> bool:
    since_s = signal.time_s - signal.time_s[0]
    return bool((since_s == np.round(since_s)).all()) and len(np.unique(since_s)) < len(since_s)


def _needed_signals(device: DeviceRecording, place: str, with_attitude: bool) -> Mapping[Channel, Signal]:
    signals = {Channel.SPECIFIC_FORCE: _specific_force(device, place)}
    rate = _signal(device, Channel.ROTATION_RATE)
    if rate is not None:
        signals[Channel.ROTATION_RATE] = rate
    if with_attitude:
        if rate is None:
            raise RecordingError(
                f"{place}: no gyroscope{_reasons(device)}, which the device's own attitude is used together with: "
                "with attitude.source: vqf in the configuration steps are found by the accelerometer alone"
            )
        attitude = _signal(device, Channel.ATTITUDE)
        if attitude is None:
            raise RecordingError(
                f"{place}: the device recorded no attitude{_reasons(device)}: "
                "set attitude.source: vqf in the configuration"
            )
        signals[Channel.ATTITUDE] = attitude
    return signals


def _specific_force(device: DeviceRecording, place: str) -> Signal:
    force = _signal(device, Channel.SPECIFIC_FORCE)
    if force is None:
        raise RecordingError(
            f"{place}: no accelerometer{_reasons(device)}: nothing can be done without it; record it and try again"
        )
    return force


def _reasons(device: DeviceRecording) -> str:
    """What the reader said of the sensors, in brackets."""
    return f" ({'; '.join(device.warnings)})" if device.warnings else ""


def _signal(device: DeviceRecording, channel: Channel) -> Signal | None:
    """A channel's signal; None when it is absent or empty."""
    signal = {
        Channel.SPECIFIC_FORCE: device.specific_force,
        Channel.ROTATION_RATE: device.rotation_rate,
        Channel.ATTITUDE: device.attitude,
        Channel.MAGNETIC_FIELD: device.magnetic_field,
    }[channel]
    return signal if signal is not None and len(signal) else None


def _refuse_useless_clock(signal: Signal, words: str, place: str) -> None:
    time_s = signal.time_s
    if len(signal) == 1:
        raise RecordingError(f"{place}: a single sample of the {words}: record for longer")
    if time_s.min() == time_s.max():
        raise RecordingError(
            f"{place}: all {len(signal)} time stamps of the {words} are {_seconds(time_s[0])} s, its clock does not "
            "run: give seconds with their fractions"
        )
    if time_s.max() - time_s.min() > _LONGEST_WALK_S:
        wrong = int(np.argmax(np.abs(time_s - np.median(time_s))))
        raise RecordingError(
            f"{place}: the {words} spans {_seconds(time_s.min())} to {_seconds(time_s.max())} s, more than a year: "
            f"correct the time of sample {wrong + 1}, {_seconds(time_s[wrong])} s, or give the time in seconds"
        )


def _refuse_wrong_unit(channel: Channel, signal: Signal, place: str) -> None:
    """Refuse values that are surely in another unit than they were read in: all that follows would be nonsense."""
    if channel not in _UNITS:
        return
    detect, right, title = _UNITS[channel]
    usable = np.isfinite(signal.values).all(axis=1) & ~out_of_range(channel, signal.values)
    if usable.sum() < _MANY_SAMPLES:
        return
    found = detect(signal.values[usable])
    if found.factor != 1.0:
        raise RecordingError(
            f"{place}: the {_WORDS[channel]} was read as {right}, but {found.decision}: convert the values, or write "
            f"their unit into the header, as in {title}"
        )


def _seconds(time_s: float) -> str:
    """A time for a message: to the hundredth, but never hundreds of digits."""
    text = f"{time_s:.2f}" if abs(time_s) < 1e12 else f"{time_s:.6g}"
    return text.removeprefix("-") if float(text) == 0.0 else text
