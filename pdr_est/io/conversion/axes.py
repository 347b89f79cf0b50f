"""Attitude and gravity conventions of the two phone platforms, brought to the project's: w first, device -> z up,
specific force upwards at rest."""

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, up_in_device
from pdr_est.types.recording import Signal

_AGREEMENT = 0.1  # about 6 degrees between the attitude's vertical and gravity


def quaternion_from_rotation_vector(vector: Array) -> Array:
    """Quaternions (n, 4), w first, of Android rotation vectors (n, 3), whose w is never negative."""
    w = np.sqrt(np.maximum(0.0, 1.0 - np.square(vector).sum(axis=1)))
    return np.column_stack([w, vector])


def specific_force_from_core_motion(gravity_g: Array, user_acceleration_g: Array) -> Array:
    """Specific force (n, 3) m/s^2, upwards at rest, of Core Motion's gravity and user acceleration in g.

    Apple's gravity vector points down when the device lies still, hence the sign.
    """
    force: Array = -(gravity_g + user_acceleration_g) * STANDARD_GRAVITY_MPS2
    return force


def vertical_mismatch(attitude: Array, up: Array) -> float:
    """Median distance between the attitude's vertical and unit vectors up (n, 3) in device axes; NaN if empty."""
    finite = np.isfinite(attitude).all(axis=1) & np.isfinite(up).all(axis=1)
    if not finite.any():
        return float("nan")
    return float(np.median(np.linalg.norm(up_in_device(attitude[finite]) - up[finite], axis=1)))


def vertical_mismatch_warnings(attitude: Array, up: Array) -> tuple[str, ...]:
    """A warning when the recorded attitude and the recorded gravity do not agree."""
    mismatch = vertical_mismatch(attitude, up)
    if mismatch < _AGREEMENT:
        return ()
    return (f"the vertical of the recorded attitude and recorded gravity differ by {mismatch:.2f} (unit vectors)",)


_GRAVITY_REACH_S = 0.2


def add_gravity(linear: Signal, gravity: Signal) -> tuple[Signal, tuple[str, ...]]:
    """Acceleration plus gravity at the times of the acceleration, with warnings.

    Gravity varies slowly and is interpolated where the time stamps differ. Rows outside its time are left out.
    """
    if np.array_equal(linear.time_s, gravity.time_s):
        return Signal(linear.time_s, linear.values + gravity.values), ()
    order = np.argsort(gravity.time_s, kind="stable")
    time_s = gravity.time_s[order]
    inside = (linear.time_s >= time_s[0] - _GRAVITY_REACH_S) & (linear.time_s <= time_s[-1] + _GRAVITY_REACH_S)
    wanted_s = linear.time_s[inside]
    interpolated = np.stack([np.interp(wanted_s, time_s, column) for column in gravity.values[order].T], axis=1)
    total = Signal(wanted_s, linear.values[inside] + interpolated)
    lost = len(inside) - len(wanted_s)
    warning = f"acceleration: {lost} of {len(inside)} rows outside the time of the gravity are left out"
    return total, ((warning,) if lost else ())
