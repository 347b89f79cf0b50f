"""Acceleration without gravity, put together with gravity into specific force."""

import numpy as np

from pdr_est.io.recording import Signal

_GRAVITY_REACH_S = 0.2


def with_gravity(linear: Signal, gravity: Signal) -> tuple[Signal, tuple[str, ...]]:
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
