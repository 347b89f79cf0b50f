"""What a reader returns: the signals of the devices of one walk, with truth and fixes if the recorder kept any."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.ground_truth import Truth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.sensors import Channel, SensorBlock


@dataclass(frozen=True)
class Signal:
    """One sensor with its own time stamps. time_s: (n,) s on the recording's clock; values: (n, k), SI units."""

    time_s: Array
    values: Array

    def __len__(self) -> int:
        return len(self.time_s)


_CHANNELS = ("specific_force", "rotation_rate", "magnetic_field", "attitude", "pressure")


@dataclass(frozen=True)
class DeviceRecording:
    """What one device recorded. Specific force m/s^2 points up at rest (Android signs), rotation rate rad/s,
    magnetic field uT, all (n, 3) in device axes; attitude (n, 4) w first, device -> frame with z up;
    pressure (n, 1) Pa.

    decisions: how units and signs were found, in words. warnings: what looks wrong with the data. moved_s: what the
    recorder's own times were moved by to start from the time zero of the recording.
    """

    name: str = "device"
    model: str = ""
    platform: str = ""
    specific_force: Signal | None = None
    rotation_rate: Signal | None = None
    magnetic_field: Signal | None = None
    attitude: Signal | None = None
    pressure: Signal | None = None
    decisions: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    moved_s: float = 0.0

    @property
    def span_s(self) -> tuple[float, float] | None:
        """When the first and the last sample of any sensor of the front end was taken; None without any."""
        times = [block.time_s[np.isfinite(block.time_s)] for block in self.blocks()]
        known = [time_s for time_s in times if len(time_s)]
        if not known:
            return None
        return min(float(time_s.min()) for time_s in known), max(float(time_s.max()) for time_s in known)

    def with_times(self, moved: Callable[[Array], Array]) -> "DeviceRecording":
        """The same with the times (n,) of every channel as `moved` gives them."""
        signals = {name: getattr(self, name) for name in _CHANNELS}
        on_them: dict[str, Any] = {
            name: None if signal is None else Signal(moved(signal.time_s), signal.values)
            for name, signal in signals.items()
        }
        return replace(self, **on_them)

    def blocks(self) -> Iterator[SensorBlock]:
        """The signals that the front end uses, each as one block; first those that a resampler does not wait for."""
        for channel, signal in (
            (Channel.MAGNETIC_FIELD, self.magnetic_field),
            (Channel.SPECIFIC_FORCE, self.specific_force),
            (Channel.ROTATION_RATE, self.rotation_rate),
            (Channel.ATTITUDE, self.attitude),
        ):
            if signal is not None and len(signal):
                yield SensorBlock(channel, signal.time_s, signal.values)


@dataclass(frozen=True)
class ClockMessages:
    """Exchanges by which devices compared their clocks, (n,) each. device: who answered; t1_s, t3_s: when the first
    device asked and got the answer, on its own clock; t2_s: when the other answered, on its own. Stamps are as
    recorded: seconds of the device's recording or Unix time. place: the file, for messages."""

    place: str
    device: tuple[str, ...]
    t1_s: Array
    t2_s: Array
    t3_s: Array


@dataclass(frozen=True)
class GeoOrigin:
    """Where the map frame's origin lies on WGS 84, degrees."""

    latitude_deg: float
    longitude_deg: float


@dataclass(frozen=True)
class Recording:
    """One walk. time stamps are seconds; `epoch_s` is the Unix time of time zero, None when the recorder does
    not tell. fixes: positions that the recorder itself kept (GPS, annotations), never the truth of a data set.
    messages: by which its devices compared their clocks.
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

    def place_of(self, device: DeviceRecording) -> str:
        """What to call a device of this recording in messages."""
        return f"{self.name} ({device.name})"
