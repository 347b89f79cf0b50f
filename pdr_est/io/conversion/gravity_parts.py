"""Put together an acceleration without gravity and the gravity that was recorded beside it.

Titles do not tell everything: columns of gravity may hold the total acceleration, the two may be in different units,
and one of them may have the opposite sign. The values tell:

* total acceleration shakes as the part without gravity does, gravity does not. The correlation of their second
  differences is at least 0.99 for the one and at most 0.44 for the other (MotionSense, OxIOD);
* gravity is as long as gravity in some unit, and a person walks with a few m/s²;
* the phone finds gravity by drawing the one that its gyroscope carries along towards what its accelerometer measures:
  in 26 of 28 recordings of MotionSense, OxIOD and Sensor Logger the drift of gravity correlates with the part without
  it by 0.04 to 0.6, in two that were held by -0.1 to 0;
* the sharp peaks of the heel strikes point up.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.gravity_windows import turned_by
from pdr_est.io.conversion.rotation_unit import detect_rotation_unit
from pdr_est.io.conversion.units import ACCELERATION_UNITS, Conversion, RawSignal, detect_acceleration_unit
from pdr_est.types.recording import Signal

_MARGIN_S = 0.2  # gravity is extrapolated over this time
_LAG_S = 0.04  # of the second differences
_SURELY_TOTAL, _SURELY_APART = 0.8, 0.6
_ONE_UNIT = 0.97  # probability beforehand that both parts are in one unit; ours
_USUAL_LOG_MOTION, _MOTION_SIGMA = 1.15, 0.6  # ln m/s²: root mean square of the part without gravity; of 24 sets
_ONE_SIGN_LOG_ODDS = 3.5  # beforehand: recorders that mix signs are rare; ours
# Skewness of the vertical acceleration: 0.4 with a standard deviation of 0.4 over 24 sets, in which one swinging hand
# has -0.7; a logistic regression on it has a slope of about 4.
_BY_SKEWNESS, _MOST_BY_SKEWNESS = 3.0, 3.0
_BY_DRIFT, _MOST_BY_DRIFT = 15.0, 6.0  # log odds by that correlation; ours
_CERTAIN_UNIT, _CERTAIN_SIGN = 0.99, 0.95
_STRETCH = 150  # samples over which the gyroscope carries gravity along
_FEWEST_STRETCHES = 3


@dataclass(frozen=True)
class Total:
    """Acceleration with gravity that was put together.

    Attributes
    ----------
    signal
        (n, 3), m/s², with the sign of the recorded gravity; None when both parts never overlap.
    conversions
        How that was decided; their factors have no meaning.
    """

    signal: Signal | None
    conversions: tuple[Conversion, ...]


def put_together(linear: RawSignal, gravity: RawSignal, rate: RawSignal | None) -> Total:
    """Find the acceleration with gravity in an acceleration without it and the gravity beside it.

    Gravity varies slowly and is interpolated where the time stamps differ. Rows more than 0.2 s outside the time of
    the gravity are left out.

    Parameters
    ----------
    linear, gravity
        The two parts.
    rate
        (m, 3) rotation rate; None when there is none.
    """
    length = detect_acceleration_unit(gravity.signal.values)
    factor = gravity.factor or length.factor
    conversions = [] if gravity.factor else [length]
    kept, beside = _at_times_of(linear.signal, gravity.signal)
    if not len(kept):
        text = "acceleration and gravity do not overlap in time: gravity is not used"
        return Total(None, (*conversions, Conversion(1.0, text, text)))
    shaking = _shaking_in_common(kept, beside)
    if abs(shaking) > _SURELY_TOTAL:
        text = (
            f"specific force is {gravity.title}: that is no gravity but the total acceleration, because it shakes as "
            f"{linear.title} does (correlation {shaking:+.2f})"
        )
        signal = gravity.signal
        return Total(Signal(signal.time_s, signal.values * factor), (*conversions, Conversion(1.0, text)))
    beside_mps2 = beside * factor
    unit = _unit_of_motion(kept.values, linear, factor)
    motion = Signal(kept.time_s, kept.values * unit.factor)
    turning = None if rate is None or not len(rate.signal) else _turning(rate, motion)
    sign = _relative_sign(motion, beside_mps2, turning, linear.title, gravity.title)
    conversions += [one for one in (unit, sign) if one.decision]
    if abs(shaking) > _SURELY_APART:
        conversions.append(
            Conversion(
                1.0,
                "",
                f"{gravity.title} shakes as {linear.title} does (correlation {shaking:+.2f}) and may hold the total "
                "acceleration: name it so with --map if that is true, or do not trust the track",
            )
        )
    removed = len(linear.signal) - len(kept)
    if removed:
        text = f"acceleration: {removed} of {len(linear.signal)} rows are left out: no gravity at their time"
        conversions.append(Conversion(1.0, "", text))
    return Total(Signal(kept.time_s, sign.factor * motion.values + beside_mps2), tuple(conversions))


def _at_times_of(linear: Signal, gravity: Signal) -> tuple[Signal, Array]:
    """Return the rows of the acceleration at which there is gravity, and gravity (n, 3) at their times."""
    if np.array_equal(linear.time_s, gravity.time_s):
        return linear, gravity.values
    first_s, last_s = gravity.time_s.min() - _MARGIN_S, gravity.time_s.max() + _MARGIN_S
    inside = (linear.time_s >= first_s) & (linear.time_s <= last_s)
    kept = Signal(linear.time_s[inside], linear.values[inside])
    return kept, gravity.interpolated_at(kept.time_s)


def _turning(rate: RawSignal, motion: Signal) -> Array:
    """Return the rotation rate, rad/s, at the times of the motion, m/s²."""
    factor = rate.factor or detect_rotation_unit(rate.signal, motion).factor
    return rate.signal.interpolated_at(motion.time_s) * factor


def _shaking_in_common(linear: Signal, gravity: Array) -> float:
    """Correlate the second differences of both parts, whatever their units; 0 where one of them is too short."""
    period_s = _period_s(linear.time_s)
    lag = max(1, round(_LAG_S / period_s)) if period_s > 0.0 else 1
    if len(gravity) < 4 * lag + 4:
        return 0.0
    first, second = (one[2 * lag :] - 2.0 * one[lag:-lag] + one[: -2 * lag] for one in (linear.values, gravity))
    usable = np.isfinite(first).all(axis=1) & np.isfinite(second).all(axis=1)
    power = float(np.square(first[usable]).sum() * np.square(second[usable]).sum())
    return float((first[usable] * second[usable]).sum() / np.sqrt(power)) if power > 0.0 else 0.0


def _unit_of_motion(values: Array, linear: RawSignal, gravity_factor: float) -> Conversion:
    """Find the factor of the part without gravity: stated, else that of gravity unless the motion contradicts it."""
    if linear.factor is not None:
        return Conversion(linear.factor, "")
    finite = values[np.isfinite(values).all(axis=1)]
    size = float(np.sqrt(np.square(finite).sum(axis=1).mean())) if len(finite) else 0.0
    if size == 0.0:
        return Conversion(gravity_factor, "")
    costs = {}
    for name, factor in ACCELERATION_UNITS.items():
        away = (np.log(size * factor) - _USUAL_LOG_MOTION) / _MOTION_SIGMA
        prior = _ONE_UNIT if factor == gravity_factor else (1.0 - _ONE_UNIT) / (len(ACCELERATION_UNITS) - 1)
        costs[name] = float(0.5 * away**2 - np.log(prior))
    best = min(costs, key=costs.__getitem__)
    factor = ACCELERATION_UNITS[best]
    if factor == gravity_factor:
        return Conversion(factor, "")
    probability = 1.0 / sum(np.exp(costs[best] - cost) for cost in costs.values())
    text = f"{linear.title} is in {best}, unlike gravity: its root mean square is {size:.3g}"
    doubt = (
        ""
        if probability >= _CERTAIN_UNIT
        else f"{text} (probability {probability:.0%}); write the unit into the header"
    )
    return Conversion(factor, text, doubt)


def _relative_sign(
    linear: Signal, gravity: Array, turning: Array | None, title: str, gravity_title: str
) -> Conversion:
    """Find whether both parts have one sign: the factor of the part without gravity, +1 or -1.

    Parameters
    ----------
    linear
        (n, 3) part without gravity, m/s².
    gravity, turning
        (n, 3) gravity, m/s², and rotation rate, rad/s, at the same times; the rate is None when there is none.
    title, gravity_title
        What they come from.
    """
    skewness = _upward_skewness(linear.values, gravity)
    drift = 0.0 if turning is None else _drift_correlation(linear, gravity, turning)
    by_drift = float(np.clip(_BY_DRIFT * drift, -_MOST_BY_DRIFT, _MOST_BY_DRIFT))
    by_skewness = float(np.clip(_BY_SKEWNESS * skewness, -_MOST_BY_SKEWNESS, _MOST_BY_SKEWNESS))
    log_odds = _ONE_SIGN_LOG_ODDS + by_drift + by_skewness
    probability = float(1.0 / (1.0 + np.exp(-abs(log_odds))))
    sign = 1.0 if log_odds >= 0.0 else -1.0
    reasons = (
        f"probability {probability:.1%}; skewness of the motion along gravity {skewness:+.2f}, correlation of the "
        f"drift of gravity with it {drift:+.2f}"
    )
    words = f"specific force is {gravity_title} + {title}"
    if sign < 0.0:
        words = f"specific force is {gravity_title} - {title}, which have opposite signs"
    doubt = (
        f"whether {gravity_title} and {title} have the same sign is not certain: "
        f"{'the same' if sign > 0.0 else 'the opposite'} is taken ({reasons}); state it with --map, by a minus in "
        "front of the columns that point the other way"
    )
    return Conversion(sign, f"{words} ({reasons})", "" if probability >= _CERTAIN_SIGN else doubt)


def _upward_skewness(linear: Array, gravity: Array) -> float:
    """Compute the skewness of the part without gravity along gravity; 0 without motion."""
    along = (linear * gravity).sum(axis=1) / STANDARD_GRAVITY_MPS2
    along = along[np.isfinite(along)]
    if not len(along):
        return 0.0
    along = along - along.mean()
    power = float(np.square(along).mean())
    return float((along**3).mean()) / power**1.5 if power > 0.0 else 0.0


def _drift_correlation(linear: Signal, gravity: Array, turning: Array) -> float:
    """Correlate the drift of recorded gravity, in axes that do not turn, with the level part of the motion.

    Returns
    -------
    float
        Mean over stretches of the recording: positive where gravity drifts towards gravity plus motion; 0 where there
        are too few samples.
    """
    period_s = _period_s(linear.time_s)
    count = len(gravity) // _STRETCH
    if count < _FEWEST_STRETCHES or period_s <= 0.0:
        return 0.0
    cut = [one[: count * _STRETCH].reshape(count, _STRETCH, 3) for one in (linear.values, gravity, turning)]
    whole = np.isfinite(np.concatenate(cut, axis=2)).all(axis=(1, 2))
    if whole.sum() < _FEWEST_STRETCHES:
        return 0.0
    motion, beside, rates = (one[whole] for one in cut)
    turned = turned_by(rates, period_s)
    beside, motion = (np.einsum("kjab,kjb->kja", turned, one) for one in (beside, motion))
    up = beside.mean(axis=1, keepdims=True)
    up /= np.maximum(np.linalg.norm(up, axis=2, keepdims=True), 1e-9)
    drift, motion = (_level(one, up) for one in (np.diff(beside, axis=1), 0.5 * (motion[:, 1:] + motion[:, :-1])))
    power = np.sqrt(np.square(drift).sum(axis=(1, 2)) * np.square(motion).sum(axis=(1, 2)))
    return float(((drift * motion).sum(axis=(1, 2)) / np.maximum(power, 1e-12)).mean())


def _level(vectors: Array, up: Array) -> Array:
    """Return vectors (k, n, 3) of stretches about their mean, without what lies along up (k, 1, 3)."""
    about: Array = vectors - vectors.mean(axis=1, keepdims=True)
    level: Array = about - (about * up).sum(axis=2, keepdims=True) * up
    return level


def _period_s(time_s: Array) -> float:
    """Return the median step of time stamps that advance; 0 without any."""
    steps = np.diff(time_s)
    rises = steps[steps > 0.0]
    return float(np.median(rises)) if len(rises) else 0.0
