"""Check the accelerometer by gravity: a wrong gain or a constant error of an axis.

Over two strides the mean specific force of a walking person is gravity, in axes that the gyroscope keeps from turning
(see `pdr_est.io.conversion.gravity_windows`). Its length by the phones of 358 recordings is 9.6 to 10.2 m/s^2, in
pocket, swinging hand and at a run as well; the raw sensors of a belt go to 10.8. Explanations are compared: all axes
have errors as sensors have them, or one of them, or all together, has a gain or an offset beyond that. Each is fitted
with the errors of good sensors as prior knowledge, in which one parameter is set free. The price of that freedom and
one faulty recording in fifty are in the odds. The errors of good sensors give that length the standard deviation of
0.18 m/s^2 that it has over 24 sets of recordings; other constants are ours.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.gravity_drift import hann_means, independent_share
from pdr_est.io.conversion.gravity_windows import GravityWindows
from pdr_est.types.recording import Signal

_GAIN_SIGMA = 0.015  # of an axis of a good sensor
_OFFSET_SIGMA_MPS2 = 0.1
_FREE_GAIN_SIGMA = 0.5
_FREE_OFFSET_SIGMA_MPS2 = 2.0
_FAULTY_SHARE = 0.02
_LEAST_PROBABILITY = 0.8
_AS_GOOD = 2.0  # difference of log evidence of explanations that are told together
_MOST_TOLD = 4
_LARGEST_RESIDUAL = 3.0  # standard deviations; beyond, a phone was thrown about
_STEADY_MPS2 = 3.5  # motion up to which a window without gyroscope shows gravity
_ITERATIONS = 6
_AXES = "xyz"


@dataclass(frozen=True)
class _Fault:
    """Explanation by one parameter that is beyond the errors of good sensors.

    Attributes
    ----------
    log_evidence
        Logarithm of its evidence.
    words
        What the axis does.
    errors
        (7,) parameters of `_log_evidence`.
    """

    log_evidence: float
    words: str
    errors: Array


@dataclass(frozen=True)
class AccelerometerFault:
    """Fault of an accelerometer that its gravity shows.

    Attributes
    ----------
    warning
        What was seen, the explanations that fit, and the remedy.
    gain, offset_mps2
        (3,) each, of the best explanation: an axis is the gain times what it reads, less the offset.
    """

    warning: str
    gain: Array
    offset_mps2: Array

    def corrected(self, force: Signal) -> Signal:
        """Return the specific force without the fault."""
        return Signal(force.time_s, force.values * self.gain - self.offset_mps2)


def find_accelerometer_fault(windows: GravityWindows, with_gyroscope: bool) -> AccelerometerFault | None:
    """Find an axis whose gain or offset keeps gravity from being 9.8 m/s² in every posture; None when all is well.

    Parameters
    ----------
    windows
        Windows of the accelerometer, with the rotation rate or with zeros instead.
    with_gyroscope
        False where there is no rotation rate: then only a gravity that is too short is told, of calm stretches.
    """
    means, motion_mps2 = _means_at_the_middle(windows)
    usable = (np.linalg.norm(means, axis=1) > 0.0) & (with_gyroscope | (motion_mps2 < _STEADY_MPS2))
    gravity, sigma_mps2 = means[usable], np.sqrt(windows.variance_m2ps4[usable])
    lengths = np.linalg.norm(gravity, axis=1)
    # Without a gyroscope a swinging device has a mean that is too long: it turns with what pulls it inwards.
    if not len(gravity) or (not with_gyroscope and np.median(lengths) > STANDARD_GRAVITY_MPS2):
        return None
    good = _log_evidence(gravity, sigma_mps2, None)[0]
    faults = sorted(_faults(gravity, sigma_mps2), key=lambda one: -one.log_evidence)
    odds = np.mean(np.exp(np.minimum([one.log_evidence - good for one in faults], 500.0)))
    if odds * _FAULTY_SHARE / (1.0 - _FAULTY_SHARE) < _LEAST_PROBABILITY / (1.0 - _LEAST_PROBABILITY):
        return None
    alike = [one.words for one in faults if faults[0].log_evidence - one.log_evidence < _AS_GOOD]
    low, high = np.percentile(lengths, [5, 95])
    shown = f"{np.median(lengths):.1f}" if high - low < 0.5 else f"{low:.1f} to {high:.1f}"
    errors = faults[0].errors
    return AccelerometerFault(
        f"gravity is {shown} m/s^2 by the accelerometer instead of {STANDARD_GRAVITY_MPS2:.1f}: "
        f"{', or '.join(alike[:_MOST_TOLD])}; calibrate it or correct its columns: step lengths and tilt are wrong",
        gain=1.0 + errors[:3] + errors[6],
        offset_mps2=errors[3:6],
    )


def _means_at_the_middle(windows: GravityWindows) -> tuple[Array, Array]:
    """Return the mean specific force (k, 3) in the axes of the middle of each window, and the motion (k,) in it."""
    turned = windows.turned
    level = np.einsum("kjab,kjb->kja", turned, windows.force_mps2)
    means = hann_means(level, windows.period_s).mean(axis=1)
    middle = turned[:, turned.shape[1] // 2]
    motion = np.sqrt(np.square(level - level.mean(axis=1, keepdims=True)).sum(axis=2).mean(axis=1))
    return np.einsum("kab,ka->kb", middle, means), motion


def _faults(gravity: Array, sigma_mps2: Array) -> Iterator[_Fault]:
    """Fit each explanation by a single parameter that is free."""
    for axis, name in enumerate(_AXES):
        evidence, errors, sigma = _log_evidence(gravity, sigma_mps2, axis)
        gain = 1.0 / max(1.0 + errors[axis], 1e-3)
        uncertain = sigma * gain**2
        yield _Fault(evidence, f"the {name} axis reads {gain:.2f} +- {uncertain:.2f} of the truth", errors)
        evidence, errors, sigma = _log_evidence(gravity, sigma_mps2, 3 + axis)
        yield _Fault(evidence, f"the {name} axis reads {errors[3 + axis]:+.1f} +- {sigma:.1f} m/s^2 too much", errors)
    evidence, errors, sigma = _log_evidence(gravity, sigma_mps2, 6)
    gain = 1.0 / max(1.0 + errors[6], 1e-3)
    yield _Fault(evidence, f"all axes read {gain:.2f} +- {sigma * gain**2:.2f} of the truth", errors)


def _log_evidence(gravity: Array, sigma_mps2: Array, free: int | None) -> tuple[float, Array, float]:
    """Fit gains and offsets, and compute the logarithm of their evidence by Laplace's method, up to a constant.

    Parameters
    ----------
    gravity
        (k, 3) gravity by the accelerometer, m/s².
    sigma_mps2
        (k,) standard deviation of its length.
    free
        Number of the parameter that is beyond the errors of good sensors: gains of x, y, z, offsets of x, y, z, and
        the gain of all axes; None for none.

    Returns
    -------
    log_evidence : float
        Log evidence.
    errors : (7,) array
        The parameters; the corrected axis is (1 + gain + common gain) times what it reads, less the offset.
    sigma : float
        Standard deviation of the free parameter.
    """
    prior = np.array([_GAIN_SIGMA] * 3 + [_OFFSET_SIGMA_MPS2] * 3 + [0.1 * _GAIN_SIGMA])
    if free is not None:
        prior[free] = _FREE_OFFSET_SIGMA_MPS2 if 3 <= free < 6 else _FREE_GAIN_SIGMA
    share = independent_share(len(gravity))
    errors = np.zeros(7)
    for _ in range(_ITERATIONS):
        residual, slopes = _residuals(gravity, errors)
        scaled = residual / sigma_mps2
        weight = share / np.maximum(np.abs(scaled) / _LARGEST_RESIDUAL, 1.0) / np.square(sigma_mps2)
        information = (slopes * weight[:, None]).T @ slopes + np.diag(1.0 / np.square(prior))
        errors = errors - np.linalg.solve(information, slopes.T @ (weight * residual) + errors / np.square(prior))
    scaled = np.abs(_residuals(gravity, errors)[0]) / sigma_mps2
    beyond = np.maximum(scaled - _LARGEST_RESIDUAL, 0.0)
    cost = share * float((0.5 * np.square(np.minimum(scaled, _LARGEST_RESIDUAL)) + _LARGEST_RESIDUAL * beyond).sum())
    cost += 0.5 * float(np.square(errors / prior).sum())
    occam = float(np.log(prior).sum()) + 0.5 * float(np.linalg.slogdet(information)[1])
    sigma = 0.0 if free is None else float(np.sqrt(np.linalg.inv(information)[free, free]))
    return -cost - occam, errors, sigma


def _residuals(gravity: Array, errors: Array) -> tuple[Array, Array]:
    """Return length of the corrected gravity less the true one (k,), and its derivatives (k, 7)."""
    corrected = (1.0 + errors[:3] + errors[6]) * gravity - errors[3:6]
    length = np.maximum(np.linalg.norm(corrected, axis=1), 1e-3)
    unit = corrected / length[:, None]
    by_gain = unit * gravity
    return length - STANDARD_GRAVITY_MPS2, np.column_stack([by_gain, -unit, by_gain.sum(axis=1)])
