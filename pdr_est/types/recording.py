"""Recordings: the signals of the devices of one walk, with the reference data and fixes that the recorder kept."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pdr_est.frames import Array
from pdr_est.frames import GeoOrigin as GeoOrigin
from pdr_est.types.array_checks import checked_times, checked_values
from pdr_est.types.ground_truth import Truth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.sensors import AttitudeReference, Channel, SensorBlock

_LATEST_TIME_OF_DAY_S = 2.0 * 86400.0  # also of a recording that began before midnight


@dataclass(frozen=True)
class Signal:
    """Samples of one sensor with their own time stamps.

    Attributes
    ----------
    time_s
        (n,) s on the clock of the recording.
    values
        (n, k) in SI units.
    """

    time_s: Array
    values: Array

    def __len__(self) -> int:
        return len(self.time_s)

    def interpolated_at(self, time_s: Array) -> Array:
        """Return the values (m, k) at some times (m,), s, by straight lines, whatever the order of the samples."""
        order = np.argsort(self.time_s, kind="stable")
        return np.stack([np.interp(time_s, self.time_s[order], one) for one in self.values[order].T], axis=1)


_CHANNELS = ("specific_force", "linear_acceleration", "rotation_rate", "magnetic_field", "attitude", "pressure")


@dataclass(frozen=True)
class DeviceRecording:
    """Signals of one device; a signal is None where the device has no such sensor.

    Attributes
    ----------
    name
        Name of the device, unique within the recording.
    model, platform
        Model and operating system as the recorder states them; empty where unknown.
    specific_force
        (n, 3) m/s², device axes; points up when the device lies still (Android's sign).
    rotation_rate
        (n, 3) rad/s, device axes.
    magnetic_field
        (n, 3) µT, device axes.
    attitude
        (n, 4) quaternions w first, device to a frame with z up.
    attitude_reference
        Direction that the yaw of `attitude` counts from.
    pressure
        (n, 1) Pa.
    decisions
        How units and signs were determined, in words.
    warnings
        Suspicious properties of the data, in words.
    clock_shift_s
        Constant added to the recorder's own time stamps so that they count from the time zero of the recording, s.
    usual_axes
        True if the axes are those that phones have: x to the right, y to the top of the screen, z out of it.
    linear_acceleration
        (n, 3) m/s² without gravity, device axes, with the sign of `specific_force`; steps can be counted with it.
    restarts_s
        Times of the first samples after each restart of the clock, s; how long it stood still before is not known.
    """

    name: str = "device"
    model: str = ""
    platform: str = ""
    specific_force: Signal | None = None
    rotation_rate: Signal | None = None
    magnetic_field: Signal | None = None
    attitude: Signal | None = None
    attitude_reference: AttitudeReference = AttitudeReference.UNKNOWN
    pressure: Signal | None = None
    decisions: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    clock_shift_s: float = 0.0
    usual_axes: bool = True
    linear_acceleration: Signal | None = None
    restarts_s: tuple[float, ...] = ()

    @property
    def span_s(self) -> tuple[float, float] | None:
        """Times of the first and the last sample of any motion sensor or attitude, s; None without samples."""
        stamps = [block.time_s for block in self.blocks() if block.channel is not Channel.PRESSURE]
        stamps += [] if self.linear_acceleration is None else [self.linear_acceleration.time_s]
        times = [time_s[np.isfinite(time_s)] for time_s in stamps]
        known = [time_s for time_s in times if len(time_s)]
        if not known:
            return None
        return min(float(time_s.min()) for time_s in known), max(float(time_s.max()) for time_s in known)

    def with_times(self, convert: Callable[[Array], Array]) -> "DeviceRecording":
        """Return a copy in which `convert` has been applied to the times (n,) of every signal."""
        found = self.signals().items()
        converted: dict[str, Any] = {name: Signal(convert(one.time_s), one.values) for name, one in found}
        if self.restarts_s:
            converted["restarts_s"] = tuple(convert(np.array(self.restarts_s)).tolist())
        return replace(self, **converted)

    def signals(self) -> dict[str, Signal]:
        """Return the signals that the device has, by the name of their attribute."""
        signals = {name: getattr(self, name) for name in _CHANNELS}
        return {name: signal for name, signal in signals.items() if signal is not None}

    def blocks(self) -> Iterator[SensorBlock]:
        """Iterate over the channels of the front end, a block each; first those for which no resampler waits."""
        for channel, signal in (
            (Channel.MAGNETIC_FIELD, self.magnetic_field),
            (Channel.ATTITUDE, self.attitude),
            (Channel.PRESSURE, self.pressure),
            (Channel.SPECIFIC_FORCE, self.specific_force),
            (Channel.ROTATION_RATE, self.rotation_rate),
        ):
            if signal is not None and len(signal):
                yield SensorBlock(channel, signal.time_s, signal.values)


@dataclass(frozen=True)
class ClockMessages:
    """Message exchanges by which two devices compared their clocks.

    Time stamps are as recorded: seconds of the device's recording, or Unix time.

    Attributes
    ----------
    place
        File name, for error messages.
    device
        (n,) name of the device that answered.
    t1_s, t3_s
        (n,) request sent and answer received, on the clock of the first device.
    t2_s
        (n,) answer sent, on the clock of the device that answered.
    """

    place: str
    device: tuple[str, ...]
    t1_s: Array
    t2_s: Array
    t3_s: Array


@dataclass(frozen=True)
class Recording:
    """One walk, recorded by one or several devices.

    Attributes
    ----------
    name
        Name of the walk, usually that of the file.
    format
        Recorder format in words.
    devices
        Signals of each device.
    truth
        Reference data, for evaluation only.
    fixes
        Positions that the recorder itself kept (GPS, annotations), never the reference data of a data set.
    origin
        Origin of the map frame; None where latitude and longitude are unknown.
    epoch_s
        Unix time of time zero, s; None where the recorder does not state it.
    notes
        Remarks of the reader.
    messages
        Message exchanges by which the devices compared their clocks.
    waypoints
        Positions that the walker marked on the device while passing them, other than the reference data.
    local_epoch_s
        What `epoch_s` would be if the date that the recorder wrote without a time zone were UTC; None without such a
        date. Dates of others that state no zone either are compared with it. Of a time of day without a date it is
        the seconds since midnight.
    """

    name: str
    format: str
    devices: tuple[DeviceRecording, ...]
    truth: Truth = field(default_factory=Truth)
    fixes: tuple[PositionFix, ...] = ()
    origin: GeoOrigin | None = None
    epoch_s: float | None = None
    notes: tuple[str, ...] = ()
    messages: tuple[ClockMessages, ...] = ()
    waypoints: tuple[PositionFix, ...] = ()
    local_epoch_s: float | None = None

    @classmethod
    def from_arrays(
        cls,
        time_s: ArrayLike,
        specific_force_mps2: ArrayLike,
        rotation_rate_radps: ArrayLike | None = None,
        *,
        magnetic_field_ut: ArrayLike | None = None,
        attitude: ArrayLike | None = None,
        attitude_reference: AttitudeReference = AttitudeReference.UNKNOWN,
        device: str = "phone",
        name: str = "arrays",
    ) -> "Recording":
        """Make a recording of one device from numpy arrays.

        All sensors share the time stamps. For sensors with time stamps of their own, build
        `DeviceRecording(specific_force=Signal(...), ...)` instead.

        Parameters
        ----------
        time_s
            (n,) s, strictly increasing.
        specific_force_mps2
            (n, 3) accelerometer including gravity, m/s², device axes, pointing up when the device lies still.
        rotation_rate_radps
            (n, 3) gyroscope, rad/s, device axes. Without it there are steps but no track.
        magnetic_field_ut
            (n, 3) magnetometer, µT, device axes.
        attitude, attitude_reference
            (n, 4) quaternions w first, device to a frame with z up, and the direction that their yaw counts from.
        device, name
            Names of the device and of the recording.

        Raises
        ------
        RecordingError
            If a shape is wrong, a number is not finite, times do not increase, or values cannot be in the stated
            unit.
        """
        times = checked_times(time_s)
        force = checked_values("specific_force_mps2", specific_force_mps2, len(times))
        optional = {
            signal: None if values is None else Signal(times, checked_values(argument, values, len(times)))
            for signal, argument, values in (
                ("rotation_rate", "rotation_rate_radps", rotation_rate_radps),
                ("magnetic_field", "magnetic_field_ut", magnetic_field_ut),
                ("attitude", "attitude", attitude),
            )
        }
        recorded = DeviceRecording(
            name=device,
            specific_force=Signal(times, force),
            rotation_rate=optional["rotation_rate"],
            magnetic_field=optional["magnetic_field"],
            attitude=optional["attitude"],
            attitude_reference=attitude_reference,
            decisions=("units and signs as the caller states them",),
        )
        return cls(name=name, format="arrays", devices=(recorded,))

    @property
    def span_s(self) -> tuple[float, float] | None:
        """Times of the first and the last sample that any device has for the front end, s; None without samples."""
        spans = [span for device in self.devices if (span := device.span_s) is not None]
        if not spans:
            return None
        return min(begin for begin, _ in spans), max(end for _, end in spans)

    @property
    def tells_local_date(self) -> bool:
        """Tell whether a date is known in the recorder's own time zone, and not only the time of day."""
        return self.local_epoch_s is not None and self.local_epoch_s > _LATEST_TIME_OF_DAY_S

    def place_of(self, device: DeviceRecording) -> str:
        """Name a device of this recording for error messages."""
        return f"{self.name} ({device.name})"

    def __repr__(self) -> str:
        names = ", ".join(repr(device.name) for device in self.devices)
        spans = [device.span_s for device in self.devices]
        length_s = max((span[1] - span[0] for span in spans if span is not None), default=0.0)
        return f"Recording({self.name!r}: {self.format}, devices {names}, {length_s:.1f} s)"
