"""Restore gravity in an acceleration without it, where the device recorded its attitude.

The attitude gives the vertical in the axes of the device, and gravity has a known length, so that the sum is exact
up to the error of the attitude. The gyroscope tells whether the attitude fits the axes of the device, and whether it
turns from them to level axes or back. Without it nothing is restored.

The gyroscope alone does not suffice: over a stride the mean acceleration without gravity is zero in every direction.
"""

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, up_in_device
from pdr_est.io.conversion.units import Conversion
from pdr_est.types.recording import Signal

_LEAST_AGREEMENT = 0.7
_CLEARLY_BETTER = 0.3
_LONGEST_STEP_S = 0.25  # between attitudes; over longer ones a person turns back and forth
_FEWEST_STEPS = 50
_CONJUGATE = np.array([1.0, -1.0, -1.0, -1.0])


def restore_gravity(linear: Signal, attitude: Signal, rate: Signal) -> tuple[Signal | None, Signal, Conversion]:
    """Add gravity along the vertical of the attitude.

    Parameters
    ----------
    linear
        (n, 3) acceleration without gravity, m/s², with the sign of specific force.
    attitude
        (m, 4) quaternions, w first, device to level axes or back.
    rate
        (k, 3) rotation rate, rad/s.

    Returns
    -------
    force : Signal or None
        Specific force where both were recorded; None where the attitude does not fit the gyroscope.
    attitude : Signal
        The attitude from device to level axes.
    conversion : Conversion
        How that was decided; its factor has no meaning.
    """
    forth = rotation_agreement(attitude, rate) or 0.0
    back = rotation_agreement(Signal(attitude.time_s, attitude.values * _CONJUGATE), rate) or 0.0
    inverted = back > forth
    best, other = max(forth, back), min(forth, back)
    if best < _LEAST_AGREEMENT or best - other < _CLEARLY_BETTER:
        text = (
            f"gravity cannot be restored: attitude and gyroscope do not rotate the same way (correlation {best:+.2f})"
        )
        return None, attitude, Conversion(1.0, text, text)
    if inverted:
        attitude = Signal(attitude.time_s, attitude.values * _CONJUGATE)
    order = np.argsort(attitude.time_s, kind="stable")
    times_s, up = attitude.time_s[order], up_in_device(attitude.values[order])
    inside = (linear.time_s >= times_s[0]) & (linear.time_s <= times_s[-1])
    time_s = linear.time_s[inside]
    vertical = np.stack([np.interp(time_s, times_s, column) for column in up.T], axis=1)
    vertical /= np.maximum(np.linalg.norm(vertical, axis=1, keepdims=True), 1e-9)
    force = Signal(time_s, linear.values[inside] + STANDARD_GRAVITY_MPS2 * vertical)
    words = (
        f"gravity is restored by the {'inverted ' if inverted else ''}attitude, whose rotation correlates with the "
        f"gyroscope's by {best:+.2f}"
    )
    doubt = "gravity is not recorded but restored by the attitude, which is taken to have z up: track with care"
    return (force if len(force) else None), attitude, Conversion(1.0, words, doubt)


def rotation_agreement(attitude: Signal, rate: Signal) -> float | None:
    """Correlate the gyroscope with the rotation between consecutive attitudes, over all axes.

    Parameters
    ----------
    attitude
        (n, 4) quaternions, w first, device to level axes.
    rate
        (m, 3) rotation rate, in any unit.

    Returns
    -------
    float or None
        Near +1 when both use the same axes and signs; None without enough motion or overlap in time.
    """
    w, v = attitude.values[:, 0], attitude.values[:, 1:]
    time_s, step_s = attitude.time_s, np.diff(attitude.time_s)
    # The vector part of conj(q_k) q_(k+1) is half the rotation vector in device axes, for small rotations.
    rotated = w[:-1, None] * v[1:] - w[1:, None] * v[:-1] - np.cross(v[:-1], v[1:])
    cosine = w[:-1] * w[1:] + (v[:-1] * v[1:]).sum(axis=1)
    usable = (step_s > 0.0) & (step_s < _LONGEST_STEP_S) & (rotated != 0.0).any(axis=1)
    usable &= (time_s[:-1] >= rate.time_s.min()) & (time_s[1:] <= rate.time_s.max())
    if usable.sum() < _FEWEST_STEPS:
        return None
    derived = 2.0 * np.sign(cosine)[usable, None] * rotated[usable] / step_s[usable, None]
    order = np.argsort(rate.time_s, kind="stable")
    middle_s = 0.5 * (time_s[:-1] + time_s[1:])[usable]
    measured = np.stack([np.interp(middle_s, rate.time_s[order], one) for one in rate.values[order].T], axis=1)
    power = float(np.sqrt(np.square(derived).sum() * np.square(measured).sum()))
    return float((derived * measured).sum()) / power if power > 0.0 else None
