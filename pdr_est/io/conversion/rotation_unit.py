"""Detect the unit of a rotation rate from the motion that the accelerometer saw at the same time.

Whoever carries a phone shakes and turns it together: in intervals of 2 s the root mean square of the rotation rate,
rad/s, is about a quarter of the standard deviation of the acceleration, m/s^2. The median of the logarithm of that
ratio over a recording is -1.3 with a standard deviation of 0.4 over 358 recordings of 25 data sets: hand, pocket,
bag, belt, leg and arm, standing, walking, running and stairs; it lies between -2.2 and -0.2. Degrees instead of
radians add 4.05 to it, whether the person walks or stands.

Two more numbers tell units apart that are nearer to each other: how fast the person turns, because the logarithm of
the fastest mean rate over 2.4 s is -0.15 with a standard deviation of 0.85 over 24 sets; and that the rate, if it is
not too large, leaves gravity where it is. Rates of real recordings, written in rad/s, deg/s and mdeg/s, are all found
right; deg/s and mdeg/s sometimes, and revolutions mostly, with a doubt.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.io.conversion.gravity_drift import gravity_scatter, hann_means
from pdr_est.io.conversion.gravity_windows import GravityWindows, gravity_windows, turned_by
from pdr_est.io.conversion.units import ROTATION_RATE_UNITS, Conversion, detect_rotation_rate_unit, sampled_rows
from pdr_est.types.recording import Signal

_USUAL_LOG_RATIO = -1.3
_SIGMA = 0.6  # of the median of a recording; wider than measured, for devices and motions that nobody measured
_USUAL_LOG_TURN, _TURN_SIGMA = -0.15, 1.0  # ln rad/s, of the fastest mean over two strides; wider than measured
# Logarithm of the median movement of gravity, by its upper bound: half as much again in the noisiest of 24 sets.
_USUAL_LOG_DRIFT, _DRIFT_SIGMA = -1.4, 0.5
_LEAST_GRAVITY_MPS2 = 5.0
_OTHER_UNIT = 0.0005  # probability that the values are in none of the units, spread over the width below
_OTHER_WIDTH = 20.0
_INTERVAL_S = 2.0
_MOST_INTERVALS = 100  # spread over longer recordings
_LEAST_SAMPLES = 4  # in an interval
_LEAST_INTERVALS = 1
_DECISIVE = 0.99  # less would take rpm for deg/s without a word
_LEAST_TOLD = 0.005  # probability
_NEGLIGIBLE = 10.0  # logarithm of odds
_RARE_UNITS: Mapping[str, float] = {"rpm": np.pi / 30.0, "rev/s": 2.0 * np.pi, "mrad/s": 1e-3}
_UNITS: Mapping[str, float] = {**ROTATION_RATE_UNITS, **_RARE_UNITS}
_PRIORS: Mapping[str, float] = {
    "rad/s": 0.6,
    "deg/s": 0.34,
    "mdeg/s": 0.04,
    "rpm": 0.005,
    "rev/s": 0.002,
    "mrad/s": 0.003,
}
"""How often recorders write each unit; a judgement."""


@dataclass(frozen=True)
class _Motion:
    """Motion of a recording, which tells the unit of its rotation rate.

    Attributes
    ----------
    log_ratio
        Logarithm of the ratio of rotation to shaking, by the values as they are.
    log_turn
        Logarithm of the fastest mean rate over two strides; None without a window of 6 s or rotation.
    windows
        Windows of an acceleration with gravity; None without one.
    """

    log_ratio: float
    log_turn: float | None
    windows: GravityWindows | None

    @classmethod
    def of(cls, rate: Signal, acceleration: Signal) -> "_Motion | None":
        """Measure the motion; None when the two hardly run together, or nothing moves."""
        ratio = motion_log_ratio(rate, acceleration)
        if ratio is None:
            return None
        windows = gravity_windows(acceleration, rate)
        if windows is None:
            return cls(ratio, None, None)
        fastest = float(np.linalg.norm(hann_means(windows.rate_radps, windows.period_s), axis=2).max())
        gravity = float(np.median(np.linalg.norm(windows.force_mps2.mean(axis=1), axis=1)))
        return cls(
            ratio,
            float(np.log(fastest)) if fastest > 0.0 else None,
            windows if gravity > _LEAST_GRAVITY_MPS2 else None,
        )

    def log_likelihood(self, factor: float) -> float:
        """Compute how well the motion fits if the rates are multiplied by a factor."""
        total = _log_likelihood(self.log_ratio + float(np.log(factor)))
        if self.log_turn is not None:
            # A person who stands, or walks straight on, turns slowly in any unit.
            excess = self.log_turn + float(np.log(factor)) - _USUAL_LOG_TURN
            total -= 0.5 * (max(excess, 0.0) / _TURN_SIGMA) ** 2
        return total

    def log_penalty(self, factor: float) -> float:
        """Compute what speaks against a factor because gravity would move about; too small a rate never does that."""
        if self.windows is None:
            return 0.0
        turned = turned_by(factor * self.windows.rate_radps, self.windows.period_s)
        moved = gravity_scatter(turned, self.windows) / self.windows.variance_m2ps4
        excess = 0.5 * np.log(max(float(np.median(moved)), 1e-12)) - _USUAL_LOG_DRIFT
        return -0.5 * float(max(excess, 0.0) / _DRIFT_SIGMA) ** 2


def motion_log_ratio(rate: Signal, acceleration: Signal) -> float | None:
    """Compute the median logarithm of the ratio of rotation to shaking in intervals of 2 s.

    Parameters
    ----------
    rate
        (n, 3) rotation rate, in any unit.
    acceleration
        (m, 3) acceleration with or without gravity, m/s².

    Returns
    -------
    float or None
        None when the two hardly run together, or nothing moves.
    """
    start_s = max(rate.time_s.min(), acceleration.time_s.min())
    end_s = min(rate.time_s.max(), acceleration.time_s.max())
    count = int((end_s - start_s) / _INTERVAL_S) if end_s > start_s else 0
    if not _LEAST_INTERVALS <= count <= len(rate):  # beyond, a time stamp is wrong
        return None
    chosen = np.arange(count) if count <= _MOST_INTERVALS else np.linspace(0, count - 1, _MOST_INTERVALS).round()
    begins_s = start_s + _INTERVAL_S * chosen
    turning, often = _mean_squares(rate, begins_s, about_mean=False)
    shaking, also_often = _mean_squares(acceleration, begins_s, about_mean=True)
    usable = often & also_often & (turning > 0.0) & (shaking > 0.0)
    if usable.sum() < _LEAST_INTERVALS:
        return None
    return float(np.median(0.5 * np.log(turning[usable] / shaking[usable])))


def detect_rotation_unit(rate: Signal, acceleration: Signal | None) -> Conversion:
    """Detect the unit of a rotation rate: rad/s, deg/s, mdeg/s, or more rarely rpm, rev/s or mrad/s.

    The motion that the accelerometer saw decides; without one, the size of the values (`detect_rotation_rate_unit`).

    Parameters
    ----------
    rate
        (n, 3) rotation rate, unit unknown.
    acceleration
        (m, 3) acceleration of the same device, m/s², with or without gravity; None when there is none.
    """
    by_size = detect_rotation_rate_unit(rate.values)
    motion = None if acceleration is None else _Motion.of(rate, acceleration)
    if motion is None:
        return by_size
    probabilities = _probabilities(motion)
    name = max(probabilities, key=lambda one: probabilities[one])
    if not name:
        return Conversion(
            by_size.factor,
            by_size.decision,
            f"{by_size.warning + '; ' if by_size.warning else ''}{_odd_ratio(motion.log_ratio)}: turns of the track "
            f"are doubtful; {_remedy(rate)}",
        )
    factor = _UNITS[name]
    decision = (
        f"rotation rate is in {name}: it is {np.exp(motion.log_ratio):.2g} of the acceleration's variation, usual "
        f"are {np.exp(_USUAL_LOG_RATIO) / factor:.2g}"
    )
    if probabilities[name] >= _DECISIVE:
        return Conversion(factor, decision)
    others = sorted((one for one in probabilities if one), key=lambda one: -probabilities[one])
    told = ", ".join(f"{one} {probabilities[one]:.0%}" for one in others if probabilities[one] >= _LEAST_TOLD)
    return Conversion(
        factor,
        decision,
        f"the unit of the rotation rate is doubtful ({told}): {_odd_ratio(motion.log_ratio)}; {name} is taken: "
        f"{_remedy(rate)}",
    )


def _remedy(rate: Signal) -> str:
    """Return what helps if the unit is not known."""
    values = sampled_rows(rate.values)
    if not values.any() or (values != np.round(values)).any():
        return "write the unit of the gyroscope into the header"
    return (
        "the values are integers: if they are the counts of a sensor chip, state what one is with --map, such as "
        "unit: 0.0001332 (131 counts in 1 deg/s), else write the unit of the gyroscope into the header"
    )


def rotation_unit_warnings(rate: Signal, acceleration: Signal) -> tuple[str, ...]:
    """Warn if a rotation rate that was read as rad/s is surely in another unit, or was converted twice.

    Parameters
    ----------
    rate
        (n, 3) rotation rate, rad/s.
    acceleration
        (m, 3) acceleration of the same device, m/s², with or without gravity.
    """
    motion = _Motion.of(rate, acceleration)
    if motion is None:
        return ()
    turns = {f"in {name}": _UNITS[name] for name in ("deg/s", "mdeg/s", "rpm")}
    turns["converted from deg/s twice"] = 1.0 / ROTATION_RATE_UNITS["deg/s"]
    likelihoods = {words: motion.log_likelihood(factor) for words, factor in turns.items()}
    words = max(likelihoods, key=lambda one: likelihoods[one])
    surely = np.log(1.0 / (1.0 - _DECISIVE))
    fits = likelihoods[words] > np.log(_OTHER_UNIT / _OTHER_WIDTH)
    if not fits or likelihoods[words] < motion.log_likelihood(1.0) + surely:
        return ()
    return (
        f"the gyroscope looks as if it were {words}: {_odd_ratio(motion.log_ratio)}; a factor of {turns[words]:.4g} "
        "fits: correct the unit, or do not trust headings and track",
    )


def _odd_ratio(ratio: float) -> str:
    return (
        f"the rotation rate is {np.exp(ratio):.2g} of the acceleration's variation, usual are "
        f"{np.exp(_USUAL_LOG_RATIO):.2g} in rad/s and {np.degrees(np.exp(_USUAL_LOG_RATIO)):.2g} in deg/s"
    )


def _probabilities(motion: _Motion) -> dict[str, float]:
    """Return the probability of each unit, and under "" that of none of them."""
    logs = {name: float(np.log(_PRIORS[name])) + motion.log_likelihood(one) for name, one in _UNITS.items()}
    none_of_them = float(np.log(_OTHER_UNIT / _OTHER_WIDTH))
    best = none_of_them
    for name in sorted(logs, key=lambda one: -logs[one]):
        if logs[name] < best - _NEGLIGIBLE:
            break  # the penalty takes long, and can only lower what is improbable without it
        logs[name] += motion.log_penalty(_UNITS[name])
        best = max(best, logs[name])
    logs[""] = none_of_them
    highest = max(logs.values())
    weights = {name: float(np.exp(one - highest)) for name, one in logs.items()}
    total = sum(weights.values())
    return {name: weight / total for name, weight in weights.items()}


def _log_likelihood(log_ratio: float) -> float:
    away = (log_ratio - _USUAL_LOG_RATIO) / _SIGMA
    return -0.5 * away * away - float(np.log(_SIGMA * np.sqrt(2.0 * np.pi)))


def _without_gaps(values: Array) -> Array:
    """Set rows that are not finite to zero."""
    return np.where(np.isfinite(values).all(axis=1, keepdims=True), values, 0.0)


def _mean_squares(signal: Signal, begins_s: Array, about_mean: bool) -> tuple[Array, NDArray[np.bool_]]:
    """Compute the mean square norm (k,) of a signal in intervals that begin at (k,), and where samples are enough."""
    time_s, values = signal.time_s, signal.values
    if (np.diff(time_s) < 0.0).any():
        order = np.argsort(time_s, kind="stable")
        time_s, values = time_s[order], values[order]
    first, last = (np.searchsorted(time_s, times_s) for times_s in (begins_s, begins_s + _INTERVAL_S))
    # Sums of each interval alone, not differences of one long sum, which a single damaged number would spoil.
    within = [_without_gaps(values[a:b]) for a, b in zip(first, last, strict=True)]
    if about_mean:
        within = [part - part.mean(axis=0) if len(part) else part for part in within]
    mean_squares = np.array([np.square(part).sum() / max(len(part), 1) for part in within])
    return mean_squares, last - first >= _LEAST_SAMPLES
