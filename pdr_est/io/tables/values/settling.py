"""Settle by the values what titles leave open: gravity in an acceleration, gravity or gyroscope, the sign."""

import numpy as np

from pdr_est.frames import Array
from pdr_est.io.conversion.gravity_content import has_gravity, is_gravity, lacks_gravity
from pdr_est.io.conversion.raw_device import RawDevice, RawSignal
from pdr_est.io.conversion.units import detect_acceleration_unit
from pdr_est.io.tables.placed import PlacedSignal
from pdr_est.io.tables.quantities import Quantity
from pdr_est.types.recording import Signal

_LONGEST_ROTATION_VECTOR = 1.01


def settle_quantities(placed: dict[Quantity, PlacedSignal], device: RawDevice) -> None:
    """Give every signal the quantity that its values show, and leave out what cannot be one.

    Parameters
    ----------
    placed
        Signals by the quantity that their titles mean; changed in place.
    device
        Where decisions and warnings are kept.
    """
    _settle_nameless_sensors(placed, device)
    _settle_gravity_sensor(placed, device)
    _settle_acceleration(placed, device)
    _settle_rotation_vector(placed, device)
    _settle_pressure(placed, device)


def settle_sign(placed: dict[Quantity, PlacedSignal], device: RawDevice) -> None:
    """Find the sign that header, mapping or unit imply for the acceleration, unless the device states it."""
    used = [placed[quantity] for quantity in (Quantity.FORCE, Quantity.LINEAR) if quantity in placed]
    if not used or device.sign is not None:
        return
    mapping = used[0].table.mapping
    columns = mapping.columns.get(Quantity.FORCE)
    if columns is not None and columns.canonical:
        device.sign, device.sign_reason, device.sign_promised = 1.0, "the documented header", True
        return
    device.sign, device.sign_reason = mapping.force_sign, mapping.sign_reason
    device.sign_promised = mapping.given and mapping.force_sign is not None


def _settle_nameless_sensors(placed: dict[Quantity, PlacedSignal], device: RawDevice) -> None:
    """Find the accelerometer among two groups of axes whose titles name no sensor, by gravity."""
    force, rate = placed.get(Quantity.FORCE), placed.get(Quantity.RATE)
    if force is None or rate is None or not rate.is_nameless(Quantity.RATE):
        return
    if has_gravity(rate.raw.signal.values) and not has_gravity(force.raw.signal.values):
        force, rate = rate, force
        placed[Quantity.FORCE], placed[Quantity.RATE] = force, rate
    device.warnings.append(
        f"the titles name no sensor: {force.raw.title} are taken as accelerometer, because they hold gravity, "
        f"{rate.raw.title} as gyroscope: name the columns with --map to be sure"
    )


def _settle_gravity_sensor(placed: dict[Quantity, PlacedSignal], device: RawDevice) -> None:
    rate = placed.get(Quantity.RATE)
    if rate is not None and rate.is_ambiguous(Quantity.RATE) and is_gravity(rate.raw.signal.values):
        device.decisions.append(f"{rate.raw.title} are gravity, no gyroscope: their length never changes")
        placed.setdefault(Quantity.GRAVITY, placed.pop(Quantity.RATE))

    gravity = placed.get(Quantity.GRAVITY)
    if gravity is not None and gravity.is_ambiguous(Quantity.GRAVITY) and not is_gravity(gravity.raw.signal.values):
        device.decisions.append(f"not used: {gravity.raw.title}, which are no gravity by their values")
        placed.pop(Quantity.GRAVITY)


def _settle_acceleration(placed: dict[Quantity, PlacedSignal], device: RawDevice) -> None:
    """Tell acceleration with gravity from acceleration without it, whatever the titles say."""
    force, linear = placed.get(Quantity.FORCE), placed.get(Quantity.LINEAR)
    if force is not None and lacks_gravity(force.raw.signal, force.raw.factor):
        device.decisions.append(f"{force.raw.title} are without gravity by their values")
        placed.pop(Quantity.FORCE)
        if linear is None:
            placed[Quantity.LINEAR] = force
            return
        force = None
    if force is None and linear is not None and not detect_acceleration_unit(_scaled(linear.raw)).warning:
        device.decisions.append(f"{linear.raw.title} include gravity by their values")
        placed[Quantity.FORCE] = placed.pop(Quantity.LINEAR)


def _settle_rotation_vector(placed: dict[Quantity, PlacedSignal], device: RawDevice) -> None:
    vector = placed.get(Quantity.ROTATION_VECTOR)
    if vector is None:
        return
    longest = float(np.linalg.norm(vector.raw.signal.values, axis=1).max())
    if longest > _LONGEST_ROTATION_VECTOR:
        device.warnings.append(
            f"{vector.raw.title} are not a rotation vector (length {longest:.3g}) and are left out"
        )
        placed.pop(Quantity.ROTATION_VECTOR)
    elif Quantity.ATTITUDE in placed:
        placed.pop(Quantity.ROTATION_VECTOR)
    else:
        device.decisions.append(
            f"{vector.raw.title} are an Android rotation vector, because it is never longer than 1"
        )


def _settle_pressure(placed: dict[Quantity, PlacedSignal], device: RawDevice) -> None:
    """Leave out pressures that are not positive, which recorders write before the first sample."""
    pressure = placed.get(Quantity.PRESSURE)
    if pressure is None:
        return
    signal = pressure.raw.signal
    measured = signal.values[:, 0] > 0.0
    if measured.all():
        return
    removed = len(measured) - int(measured.sum())
    device.warnings.append(
        f"{Quantity.PRESSURE}: {removed} of {len(measured)} rows without a positive value are left out"
    )
    kept = Signal(signal.time_s[measured], signal.values[measured])
    placed.pop(Quantity.PRESSURE)
    if len(kept):
        raw = RawSignal(kept, pressure.raw.title, pressure.raw.factor)
        placed[Quantity.PRESSURE] = PlacedSignal(raw, pressure.table)


def _scaled(raw: RawSignal) -> Array:
    return raw.signal.values if raw.factor is None else raw.signal.values * raw.factor
