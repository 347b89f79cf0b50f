"""Watch what each phone of a live walk sends: the rates of its sensors, and in words what is missing."""

from collections import deque
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from pdr_est.types.sensors import Channel, SensorBlock

Source = Literal["sensor-logger", "phyphox", "browser", "replay"]
"""Way in which the samples of a phone arrive."""

SENSOR_NAMES = {
    Channel.SPECIFIC_FORCE: "accelerometer",
    Channel.ROTATION_RATE: "gyroscope",
    Channel.MAGNETIC_FIELD: "magnetometer",
    Channel.ATTITUDE: "attitude",
    Channel.PRESSURE: "barometer",
}
"""Sensors as people call them."""

_RATE_OVER_S = 4.0
_SILENT_AFTER_S = 3.0
_PATIENCE_S = 3.0  # after the first samples, until a sensor counts as missing
_SLOW_HZ = 20.0  # below it a step has too few samples to tell its length well; recorders offer 50 Hz and more
_WHERE = {
    "sensor-logger": "in Sensor Logger",
    "phyphox": "in the phyphox experiment",
    "browser": "in this browser",
    "replay": "in the recording",
}


@dataclass
class PhoneMonitor:
    """Counts what one phone sends.

    Attributes
    ----------
    name
        Name of the phone in the track and in the recording.
    source
        Way in which its samples arrive.
    heard
        Names of the sensors in the messages of an app, as the app calls them.
    remark
        What the receiver has to say about the connection; empty for nothing.
    """

    name: str
    source: Source
    heard: set[str] = field(default_factory=set)
    remark: str = ""
    _first_s: float | None = None
    _last_s: float = 0.0
    _arrivals: dict[Channel, deque[tuple[float, int]]] = field(default_factory=dict)
    _totals: dict[Channel, int] = field(default_factory=dict)

    def note(self, blocks: Sequence[SensorBlock], now_s: float) -> None:
        """Count samples that arrive now."""
        for block in blocks:
            arrivals = self._arrivals.setdefault(block.channel, deque())
            arrivals.append((now_s, len(block.time_s)))
            while arrivals[0][0] < now_s - _RATE_OVER_S:
                arrivals.popleft()
            self._totals[block.channel] = self._totals.get(block.channel, 0) + len(block.time_s)
            self._last_s = now_s
            self._first_s = now_s if self._first_s is None else self._first_s

    def rates_hz(self, now_s: float) -> dict[Channel, float]:
        """Return the samples per second of each sensor over the last seconds."""
        rates = {}
        for channel, arrivals in self._arrivals.items():
            recent = [(at_s, count) for at_s, count in arrivals if at_s >= now_s - _RATE_OVER_S]
            since_s = 0.0 if self._first_s is None else now_s - self._first_s
            rates[channel] = sum(count for _, count in recent) / max(min(since_s, _RATE_OVER_S), 1.0)
        return rates

    def missing(self, now_s: float) -> list[str]:
        """Tell in words what a track lacks, and what to do about it."""
        told = [self.remark] if self.remark else []
        if self._first_s is None:
            return told or [f"{self.name}: nothing has arrived yet: start the recording {_WHERE[self.source]}"]
        if now_s - self._last_s > _SILENT_AFTER_S:
            silence_s = now_s - self._last_s
            told.append(
                f"{self.name}: nothing has arrived for {silence_s:.0f} s: does the phone still record, "
                "with its screen on, and is it in the network?"
            )
            return told
        if now_s - self._first_s < _PATIENCE_S:
            return told
        rates = self.rates_hz(now_s)
        for channel in (Channel.SPECIFIC_FORCE, Channel.ROTATION_RATE):
            if not rates.get(channel):
                told.append(self._missing_sensor(channel))
            elif rates[channel] < _SLOW_HZ:
                told.append(
                    f"{self.name}: the {SENSOR_NAMES[channel]} sends {rates[channel]:.0f} samples a second: choose "
                    f"at least 50 {_WHERE[self.source]}"
                )
        return told

    def _missing_sensor(self, channel: Channel) -> str:
        if self.source == "sensor-logger" and channel is Channel.SPECIFIC_FORCE:
            return f"{self.name}: {missing_acceleration(self.heard)}"
        words = f"{self.name}: no {SENSOR_NAMES[channel]} arrives"
        if self.source == "browser":
            return f"{words}: this browser or phone gives none: use another browser, Sensor Logger or phyphox"
        return f"{words}: switch it on {_WHERE[self.source]}"

    def as_json(self, now_s: float, steps: int) -> dict[str, Any]:
        """Describe the phone for a page."""
        rates = self.rates_hz(now_s)
        return {
            "name": self.name,
            "source": self.source,
            "steps": steps,
            "sensors": [
                {"name": SENSOR_NAMES[channel], "rate_hz": round(rates[channel], 1), "samples": self._totals[channel]}
                for channel in SENSOR_NAMES
                if channel in rates
            ],
        }


def missing_acceleration(heard: Collection[str]) -> str:
    """Tell which sensor of Sensor Logger lacks for an acceleration with gravity.

    Parameters
    ----------
    heard
        Names of the sensors that arrive, as in its messages.
    """
    if "accelerometer" in heard and "gravity" not in heard:
        return "no gravity arrives: switch on Gravity in Sensor Logger, beside Accelerometer"
    if "gravity" in heard and "accelerometer" not in heard:
        return "no accelerometer arrives: switch on Accelerometer in Sensor Logger, beside Gravity"
    return "no accelerometer arrives: switch on Accelerometer and Gravity in Sensor Logger"
