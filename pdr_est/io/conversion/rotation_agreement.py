"""Compare the rotation by attitudes with that by the gyroscope: the same axes, signs and direction correlate."""

import numpy as np

from pdr_est.types.recording import Signal

_LONGEST_STEP_S = 0.25  # between attitudes; over longer ones a person turns back and forth
_FEWEST_STEPS = 50


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
