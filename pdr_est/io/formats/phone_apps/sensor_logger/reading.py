"""State of a Sensor Logger export while it is read: what was decided, what was used and what is suspicious."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.conversion.stale_samples import count_stale_samples, stale_warning
from pdr_est.io.formats.phone_apps.sensor_logger.clock import seconds_since
from pdr_est.io.formats.phone_apps.sensor_logger.export import CLOCK_COLUMN, Export
from pdr_est.io.text.finite_values import finite_signal_or_none
from pdr_est.io.text.number_table import NumberTable
from pdr_est.types.recording import Signal

AXES = ("x", "y", "z")
_CLOCK = (CLOCK_COLUMN, "seconds_elapsed")


@dataclass
class ExportReading:
    """Export while it is read, with the decisions and warnings so far.

    Attributes
    ----------
    export
        Tables of the sensors.
    metadata
        What the export says about the phone and the app.
    zero_ns
        Unix time, ns, of time zero.
    decisions, warnings
        Sentences for the device recording.
    used
        Sensor -> columns that were read.
    """

    export: Export
    metadata: Mapping[str, str]
    zero_ns: int
    decisions: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    used: dict[str, set[str]] = field(default_factory=dict)

    def table(self, sensor: str, columns: tuple[str, ...], texts: tuple[str, ...] = ()) -> NumberTable | None:
        """Read columns of a sensor and remember that they are used; None when it has no rows."""
        table = self.export.table(sensor, columns, texts)
        if table is not None:
            self.used.setdefault(sensor, set()).update((*columns, *texts))
        return table

    def signal(self, sensor: str, columns: tuple[str, ...] = AXES) -> Signal | None:
        """Read the finite rows of a sensor, without values older than the recording; None when it has none."""
        table = self.table(sensor, columns)
        if table is None or any(name not in table for name in columns):
            return None
        time_s, values = seconds_since(table, self.zero_ns), table.stack(columns)
        stale = count_stale_samples(time_s)
        if stale:
            self.warnings.append(stale_warning(sensor, stale, len(time_s)))
        signal, dropped = finite_signal_or_none(time_s[stale:], values[stale:], sensor, table.place)
        self.warnings.extend(dropped)
        return signal

    def add(
        self, device: RawDevice, sensor: RawSensor, name: str, columns: tuple[str, ...], factor: float | None = None
    ) -> bool:
        """Give a device the signal of a sensor of the export, if it has one; tell whether it has.

        Parameters
        ----------
        device
            Device to complete.
        sensor
            What the signal is.
        name, columns
            Sensor of the export and its columns.
        factor
            Factor to SI units; None where the values tell.
        """
        signal = self.signal(name, columns)
        if signal is not None:
            device.signals[sensor] = RawSignal(signal, name, factor)
        return signal is not None

    def name_unused(self) -> None:
        """Add the sensors and columns that were not used to the decisions."""
        empty = set(self.export.empty)
        sensors = sorted(set(self.export.sensors) - set(self.used) - empty)
        if sensors:
            self.decisions.append(f"sensors not used: {', '.join(sensors)}")
        columns = [
            f"{sensor}: {', '.join(left)}"
            for sensor, names in sorted(self.used.items())
            if sensor in self.export.sensors
            and sensor != "Metadata"
            and (left := [title for title in self.export.titles(sensor) if title not in {*names, *_CLOCK}])
        ]
        if columns:
            self.decisions.append(f"columns not used: {'; '.join(columns)}")
