"""Make a device recording from the signals of one device, whatever files they come from.

Gravity, units, signs and the direction of the attitude are settled in one place: what the recorder states is taken,
otherwise the values decide, and every decision is kept in words.
"""

from dataclasses import dataclass, field, replace
from enum import StrEnum

from pdr_est.io.conversion import signs, units
from pdr_est.io.conversion.axes import quaternion_from_rotation_vector
from pdr_est.io.conversion.gravity_content import detect_linear_acceleration_unit, has_gravity, is_gravity
from pdr_est.io.conversion.gravity_parts import put_together
from pdr_est.io.conversion.restored_gravity import restore_gravity
from pdr_est.io.conversion.rotation_unit import detect_rotation_unit
from pdr_est.io.conversion.sign_evidence import (
    SignEvidence,
    dip_evidence,
    screen_evidence,
    title_evidence,
    turn_evidence,
    unit_evidence,
)
from pdr_est.io.conversion.units import RawSignal
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Signal
from pdr_est.types.sensors import AttitudeReference

__all__ = ["RawDevice", "RawSensor", "RawSignal"]


class RawSensor(StrEnum):
    """Sensor of a device, by the quantity that it measures."""

    FORCE = "accelerometer"
    LINEAR = "linear acceleration"
    GRAVITY = "gravity"
    RATE = "gyroscope"
    FIELD = "magnetometer"
    ATTITUDE = "attitude"
    ROTATION_VECTOR = "rotation vector"
    PRESSURE = "barometer"


@dataclass
class RawDevice:
    """Device before its conversion.

    Attributes
    ----------
    signals
        What each sensor recorded.
    name, model, platform
        As in `DeviceRecording`.
    sign, sign_reason
        Sign by which the acceleration becomes specific force, and why; None where the format does not tell.
    sign_promised
        True where a documented header or a person states the sign: it is then taken, and a contradiction only told.
    attitude_reference
        As in `DeviceRecording`.
    usual_axes
        As in `DeviceRecording`.
    fixes, latitude_deg
        Positions that were recorded with it, and where on earth that is; they help to find the sign.
    without_gravity
        Advice on what to switch on, for a recording of acceleration without gravity.
    decisions, warnings
        Sentences so far.
    """

    signals: dict[RawSensor, RawSignal]
    name: str = "device"
    model: str = ""
    platform: str = ""
    sign: float | None = None
    sign_reason: str = ""
    sign_promised: bool = False
    attitude_reference: AttitudeReference = AttitudeReference.UNKNOWN
    usual_axes: bool = True
    fixes: tuple[PositionFix, ...] = ()
    latitude_deg: float | None = None
    without_gravity: str = "record the accelerometer with gravity"
    decisions: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def note(self, conversion: units.Conversion) -> float:
        """Keep the decision and the warning of a conversion; return its factor."""
        if conversion.decision:
            self.decisions.append(conversion.decision)
        self.warnings.extend(conversion.warnings)
        return conversion.factor

    def convert(self) -> DeviceRecording:
        """Return the device in SI units, with specific force that points up at rest."""
        attitude = self._attitude()
        total = self._acceleration()
        magnetic_field = self._in_si(RawSensor.FIELD)
        force: Signal | None = None
        if total is not None and self.sign_promised and self.sign is not None:
            force = self._with_promised_sign(total, attitude, self.sign)
        elif total is not None:
            if attitude is not None:
                attitude, conversion = signs.resolve_attitude_direction(total, attitude)
                self.note(conversion)
            unit = self._recorded_unit()
            # Apple's own unit is g: in m/s^2 somebody has converted it, perhaps with the sign.
            expected = None if self.sign == -1.0 and unit == 1.0 else self.sign
            evidence = self._sign_evidence(total, magnetic_field, unit) if expected is None else ()
            conversion = signs.detect_force_sign(total, attitude, expected, self.sign_reason, evidence)
            # Steps do not depend on the sign: without a gyroscope there is no track that could be mirrored.
            sign = self.note(conversion if RawSensor.RATE in self.signals else replace(conversion, warning=""))
            force = _times(total, sign)
        linear = self._acceleration_without_gravity() if force is None else None
        rate = self._rotation_rate(force or linear)
        if linear is not None:
            force, attitude = self._restored(linear, attitude, rate)
        pressure = self._in_si(RawSensor.PRESSURE)
        return DeviceRecording(
            name=self.name,
            model=self.model,
            platform=self.platform,
            specific_force=force,
            linear_acceleration=linear,
            rotation_rate=rate,
            magnetic_field=magnetic_field,
            attitude=attitude,
            attitude_reference=AttitudeReference.UNKNOWN if attitude is None else self.attitude_reference,
            pressure=pressure,
            decisions=tuple(self.decisions),
            warnings=tuple(self.warnings),
            usual_axes=self.usual_axes,
        )

    def _with_promised_sign(self, total: Signal, attitude: Signal | None, sign: float) -> Signal:
        """Take the sign that the header or a person states; tell where the attitude contradicts it."""
        self.decisions.append(f"acceleration points {'up' if sign > 0.0 else 'down'} at rest by {self.sign_reason}")
        cosine = None if attitude is None else signs.gravity_cosine(total, attitude)
        if cosine is not None and cosine * sign < 0.0:
            self.warnings.append(
                f"acceleration and attitude contradict each other: median cosine {cosine * sign:+.2f}"
            )
        return _times(total, sign)

    def _recorded_unit(self) -> float:
        """Return the factor to m/s² of the signal that shows gravity, which one without it does not."""
        source = self.signals.get(RawSensor.FORCE) or self.signals[RawSensor.GRAVITY]
        return source.factor or units.detect_acceleration_unit(source.signal.values).factor

    def _sign_evidence(self, total: Signal, magnetic_field: Signal | None, unit: float) -> tuple[SignEvidence, ...]:
        """Collect what tells the sign of an acceleration where neither attitude nor recorder do."""
        linear = self.signals.get(RawSensor.LINEAR)
        # Core Motion gives both parts in g.
        apart = RawSensor.FORCE not in self.signals and linear is not None and linear.factor in (None, unit)
        found = [unit_evidence(unit, gravity_apart=apart)]
        if self.sign is not None:
            found.append(title_evidence(self.sign, self.sign_reason))
        if self.usual_axes:
            found.append(screen_evidence(total))
        dip = None if magnetic_field is None else dip_evidence(total, magnetic_field, self.latitude_deg)
        rate = self.signals.get(RawSensor.RATE)
        turns = None
        if rate is not None and self.fixes:
            factor = rate.factor or detect_rotation_unit(rate.signal, total).factor
            turns = turn_evidence(total, Signal(rate.signal.time_s, rate.signal.values * factor), self.fixes)
        return (*found, *(one for one in (dip, turns) if one is not None))

    def _rotation_rate(self, acceleration: Signal | None) -> Signal | None:
        """Convert the rotation rate by the recorder's statement, else by the motion that the acceleration shows."""
        raw = self.signals.get(RawSensor.RATE)
        if raw is None or raw.factor is not None:
            return self._in_si(RawSensor.RATE)
        return _times(raw.signal, self.note(detect_rotation_unit(raw.signal, acceleration)))

    def _acceleration(self) -> Signal | None:
        """Find the acceleration with gravity, m/s^2, still with the recorder's sign."""
        measured = self.signals.get(RawSensor.FORCE)
        linear, gravity = self.signals.get(RawSensor.LINEAR), self.signals.get(RawSensor.GRAVITY)
        if (
            measured is not None
            and not has_gravity(measured.signal.values)
            and linear is None
            and gravity is not None
        ):
            self.decisions.append(f"{measured.title} is without gravity by its values")
            measured, linear = None, measured
        if measured is not None:
            self.decisions.append(f"specific force is {measured.title}")
            return self._scaled(RawSensor.FORCE, measured)
        if linear is None and gravity is not None and not is_gravity(gravity.signal.values):
            self.decisions.append(f"specific force is {gravity.title}: it is no gravity, because its length changes")
            return self._scaled(RawSensor.FORCE, gravity)
        if linear is None or gravity is None:
            return None
        total = put_together(linear, gravity, self.signals.get(RawSensor.RATE))
        for conversion in total.conversions:
            self.note(conversion)
        return total.signal

    def _restored(
        self, linear: Signal, attitude: Signal | None, rate: Signal | None
    ) -> tuple[Signal | None, Signal | None]:
        """Add gravity by the attitude; say what is missing where that cannot be done.

        Returns
        -------
        force : Signal or None
            Specific force; None without gravity.
        attitude : Signal or None
            Attitude, from device to level axes where gravity could be added.
        """
        force: Signal | None = None
        if attitude is not None and rate is not None:
            force, attitude, conversion = restore_gravity(linear, attitude, rate)
            self.note(conversion)
        title = self.signals[RawSensor.LINEAR].title
        if force is None:
            self.warnings.append(
                f"{title} is without gravity: steps can be counted from it, a track needs more: "
                f"{self.without_gravity}"
            )
        elif self.sign is None:
            self.warnings.append(
                f"the sign of {title}, to which gravity is added, is not known: Android's is assumed; state it with "
                "--map, or record the accelerometer with gravity"
            )
        return force, attitude

    def _acceleration_without_gravity(self) -> Signal | None:
        """Find the acceleration without gravity, m/s^2, with the sign of specific force, or Android's if unknown."""
        linear = self.signals.get(RawSensor.LINEAR)
        if linear is None:
            return None
        assumed = ", whose sign is not known and taken to be Android's" if self.sign is None else ""
        self.decisions.append(f"acceleration without gravity is {linear.title}{assumed}")
        factor = linear.factor or self.note(detect_linear_acceleration_unit(linear.signal.values))
        return Signal(linear.signal.time_s, linear.signal.values * (factor * (self.sign or 1.0)))

    def _attitude(self) -> Signal | None:
        quaternion = self.signals.get(RawSensor.ATTITUDE)
        if quaternion is not None:
            return quaternion.signal
        vector = self.signals.get(RawSensor.ROTATION_VECTOR)
        if vector is None:
            return None
        self.decisions.append(f"attitude is the rotation vector {vector.title}")
        return Signal(vector.signal.time_s, quaternion_from_rotation_vector(vector.signal.values))

    def _in_si(self, sensor: RawSensor) -> Signal | None:
        raw = self.signals.get(sensor)
        return None if raw is None else self._scaled(sensor, raw)

    def _scaled(self, sensor: RawSensor, raw: RawSignal) -> Signal:
        """Convert to SI units by what the recorder states, which the values must not contradict, else by them."""
        detect = _DETECT_UNIT.get(sensor)
        if raw.factor is None:
            if detect is None:
                self.decisions.append(f"{raw.title}: taken in uT")
                return raw.signal
            return _times(raw.signal, self.note(detect(raw.signal.values)))
        converted = _times(raw.signal, raw.factor)
        if detect is not None:
            checked = detect(converted.values)
            as_written = detect(raw.signal.values) if checked.warnings and sensor is RawSensor.FORCE else checked
            if not as_written.warnings and checked.warnings:
                self.warnings.append(
                    f"the stated unit of {raw.title} contradicts its values and is not used: {as_written.decision}"
                )
                return _times(raw.signal, as_written.factor)
            if checked.factor != 1.0:
                self.warnings.append(f"the stated unit of {raw.title} contradicts its values: {checked.decision}")
            elif sensor is RawSensor.FORCE:
                self.warnings.extend(checked.warnings)
        return converted


def _times(signal: Signal, factor: float) -> Signal:
    """Multiply the values; long recordings are not copied for a factor of 1."""
    return signal if factor == 1.0 else Signal(signal.time_s, signal.values * factor)


_DETECT_UNIT = {
    RawSensor.FORCE: units.detect_acceleration_unit,
    RawSensor.RATE: units.detect_rotation_rate_unit,
    RawSensor.PRESSURE: units.detect_pressure_unit,
}
