"""Units and signs of raw sensor values, found from the values themselves where a recorder does not tell.

Every function returns a `Finding`: the factor that leads to the project's convention, a sentence that says how it
was found, and a warning where the values do not settle the question. Nothing is guessed silently.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, up_in_device
from pdr_est.types.recording import Signal

_STATIC_MPS2 = (6.5, 20.0)  # a swung phone has a mean of 12: the swing's centripetal acceleration points one way
_STATIC_G = (0.65, 2.0)
_GRAVITY_SHARE = 0.65
_PARTS = 10
_FULL_SCALE_RADPS = 40.0  # phones' gyroscopes end at 2000 deg/s = 34.9 rad/s
_WALKING_RADPS = (0.3, 12.0)  # 95th percentile of the norm, from a phone held calmly to one in a runner's pocket
_PEAK_PERCENTILE = 99.9
_CALMEST_WALK_DEGPS = 15.0
_VERTICAL_COSINE = 0.6  # median over the walk; 0.85 for a swung phone, whose acceleration is far from gravity
_CLEARLY_BETTER = 0.1
_FACE_UP_SHARE = 0.3
_PRESSURE_UNITS = (("Pa", 1.0), ("hPa", 1e2), ("kPa", 1e3))
_PRESSURE_RANGE_PA = (3e4, 1.2e5)
_CLOCK_UNITS = (("ns", 1e9), ("us", 1e6), ("ms", 1e3), ("s", 1.0))
_UNIX_RANGE_S = (9e8, 4e9)  # 1998 to 2096
_SAMPLING_RATE_HZ = (2.0, 1500.0)


@dataclass(frozen=True)
class Conversion:
    """factor: multiply raw values by it. decision: how it was found. warning: what stays uncertain, or ""."""

    factor: float
    decision: str
    warning: str = ""

    @property
    def warnings(self) -> tuple[str, ...]:
        """The warning as a tuple, empty when there is none."""
        return (self.warning,) if self.warning else ()


def detect_acceleration_unit(values: Array) -> Conversion:
    """g or m/s^2, from the mean vector of an acceleration (n, 3) that contains gravity.

    The mean is taken in parts, so that it survives a change of the way of carrying. With gravity its length is at
    least 0.7 of the median norm in any gait, without at most 0.6 (MotionSense, all activities).
    """
    mean = float(
        np.median([np.linalg.norm(part.mean(axis=0)) for part in np.array_split(values, _parts(len(values)))])
    )
    share = mean / max(_median_norm(values), 1e-9)
    if share >= _GRAVITY_SHARE:
        if _STATIC_MPS2[0] <= mean <= _STATIC_MPS2[1]:
            return Conversion(1.0, f"acceleration is in m/s^2: its mean is {mean:.2f} long")
        if _STATIC_G[0] <= mean <= _STATIC_G[1]:
            return Conversion(STANDARD_GRAVITY_MPS2, f"acceleration is in g: its mean is {mean:.3f} long")
    return Conversion(
        1.0,
        f"acceleration is taken as m/s^2, although its mean is {mean:.3g} long ({share:.0%} of the median norm)",
        f"the mean acceleration is {mean:.3g} long, {share:.0%} of the median norm: with gravity it would be 1 (g) "
        "or 9.8 (m/s^2) and above 70 %; gravity may be missing, check the recorder's settings",
    )


def detect_rotation_rate_unit(values: Array) -> Conversion:
    """deg/s or rad/s, from the size of a rotation rate (n, 3) of a walking person's phone.

    A component above 40 would exceed any phone's full scale in rad/s. Otherwise the 95th percentile of the norm
    is 0.3 to 12 rad/s in every way of carrying, while even a calmly held phone exceeds 15 deg/s in 5 % of the time.
    """
    # A single damaged number must not decide, however large it is.
    peak = float(np.percentile(np.abs(values).max(axis=1), _PEAK_PERCENTILE, method="lower"))
    high = float(np.percentile(np.linalg.norm(values, axis=1), 95))
    numbers = f"the largest component is {peak:.3g} and the 95th percentile of the norm {high:.3g}"
    if peak > _FULL_SCALE_RADPS or high > _CALMEST_WALK_DEGPS:
        return Conversion(np.pi / 180.0, f"rotation rate is in deg/s: {numbers}")
    if _WALKING_RADPS[0] <= high <= _WALKING_RADPS[1]:
        return Conversion(1.0, f"rotation rate is in rad/s: {numbers}")
    return Conversion(
        1.0,
        f"rotation rate is taken as rad/s: {numbers}",
        f"the unit of the rotation rate cannot be told from its size ({numbers}); rad/s is assumed, write the unit "
        "into the header to be sure",
    )


def detect_pressure_unit(values: Array) -> Conversion:
    """Pa, hPa or kPa, from the median of an air pressure."""
    median = float(np.median(values))
    for unit, factor in _PRESSURE_UNITS:
        if _PRESSURE_RANGE_PA[0] <= median * factor <= _PRESSURE_RANGE_PA[1]:
            return Conversion(factor, f"air pressure is in {unit}: the median is {median:.5g}")
    return Conversion(
        1.0,
        f"air pressure is taken as Pa, although its median is {median:.5g}",
        f"the median air pressure {median:.5g} fits neither Pa nor hPa nor kPa; the pressure is not usable",
    )


def detect_clock_unit(ticks: NDArray[np.float64] | NDArray[np.int64]) -> Conversion:
    """Seconds a tick of a numeric clock: from its value if that is a Unix time of our days, else from its steps."""
    first = float(ticks[0])
    for unit, per_s in _CLOCK_UNITS:
        if _UNIX_RANGE_S[0] <= first / per_s <= _UNIX_RANGE_S[1]:
            return Conversion(1.0 / per_s, f"the clock counts Unix time in {unit}: the first value is {ticks[0]}")
    steps = np.diff(ticks)
    step = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    for unit, per_s in reversed(_CLOCK_UNITS):
        if step > 0 and _SAMPLING_RATE_HZ[0] <= per_s / step < _SAMPLING_RATE_HZ[1]:
            return Conversion(1.0 / per_s, f"the clock counts {unit}: the median step is {step:.4g}")
    return Conversion(
        1.0,
        f"the clock is taken as seconds, although its median step is {step:.4g}",
        f"the unit of the clock cannot be told from its median step of {step:.4g}; seconds are assumed, write the "
        "unit into the header to be sure",
    )


def gravity_cosine(force: Signal, attitude: Signal) -> float | None:
    """Median cosine between an acceleration that contains gravity and the attitude's up direction.

    +1 for Android's signs, -1 for Apple's; None without overlap in time.
    """
    start = max(force.time_s.min(), attitude.time_s.min())
    end = min(force.time_s.max(), attitude.time_s.max())
    inside = (force.time_s >= start) & (force.time_s <= end)
    norm = np.linalg.norm(force.values, axis=1)
    inside &= norm > 0.0
    if not inside.any():
        return None
    up = up_in_device(attitude.values[_nearest(attitude.time_s, force.time_s[inside])])
    return float(np.median((up * force.values[inside]).sum(axis=1) / norm[inside]))


def detect_force_sign(force: Signal, attitude: Signal | None, expected: float | None, reason: str) -> Conversion:
    """+1 or -1: what turns an acceleration that contains gravity into specific force upwards at rest.

    The attitude decides when there is one that fits. expected: the sign that the recorder's metadata imply, with
    the reason in words; None when they do not tell. Without both, the values are left as they are.
    """
    cosine = None if attitude is None else gravity_cosine(force, attitude)
    if cosine is not None and abs(cosine) >= _VERTICAL_COSINE:
        return _sign_by_attitude(float(np.sign(cosine)), cosine, expected, reason)
    if expected is not None:
        doubt = "" if cosine is None else f"acceleration and attitude do not fit together: median cosine {cosine:.2f}"
        return Conversion(expected, f"{_sign_in_words(expected)}: {reason}; no attitude could confirm it", doubt)
    return _sign_unknown(force)


def resolve_attitude_direction(force: Signal, attitude: Signal) -> tuple[Signal | None, Conversion]:
    """The attitude as device -> frame with z up (or down), judged by gravity in the acceleration.

    The conjugate is taken when only that fits, nothing when neither fits.
    """
    cosine = gravity_cosine(force, attitude)
    if cosine is None:
        text = "the attitude has no overlap in time with the acceleration and could not be checked"
        return attitude, Conversion(1.0, text, text)
    conjugate = Signal(attitude.time_s, attitude.values * np.array([1.0, -1.0, -1.0, -1.0]))
    turned = gravity_cosine(force, conjugate) or 0.0
    if abs(turned) > max(abs(cosine) + _CLEARLY_BETTER, _VERTICAL_COSINE):
        return conjugate, Conversion(
            1.0,
            f"attitude was recorded as level -> device and is inverted: median cosine to gravity {turned:+.2f} "
            f"against {cosine:+.2f}",
        )
    if abs(cosine) >= _VERTICAL_COSINE:
        return attitude, Conversion(1.0, f"attitude leads from device to level axes: cosine to gravity {cosine:+.2f}")
    text = f"the attitude does not fit gravity in the acceleration (median cosine {cosine:.2f}) and is left out"
    return None, Conversion(1.0, text, text)


def _sign_by_attitude(sign: float, cosine: float, expected: float | None, reason: str) -> Conversion:
    words = f"{_sign_in_words(sign)}: median cosine to the attitude's up direction {cosine:+.2f}"
    if expected is None or expected == sign:
        return Conversion(sign, words if expected is None else f"{words}, as expected ({reason})")
    warning = (
        f"the sign of the acceleration contradicts the metadata ({reason}); the attitude was believed: "
        f"median cosine to up {cosine:+.2f}"
    )
    return Conversion(sign, words, warning)


def _sign_unknown(force: Signal) -> Conversion:
    mean = force.values.mean(axis=0)
    share = float(mean[2] / max(_median_norm(force.values), 1e-9))
    if share >= _FACE_UP_SHARE:
        return Conversion(1.0, f"acceleration taken as upwards at rest: the screen then faces up ({share:+.2f} g)")
    side = "points through the back of the phone" if share <= -_FACE_UP_SHARE else "lies in the plane of the screen"
    return Conversion(
        1.0,
        "acceleration taken as upwards at rest, unconfirmed",
        f"the sign of the acceleration cannot be told: gravity {side} and there is no attitude; upwards at rest "
        "(Android's signs) is assumed",
    )


def _sign_in_words(sign: float) -> str:
    return "acceleration points up at rest" if sign > 0 else "acceleration points down at rest (Apple) and is negated"


def _parts(n: int) -> int:
    return max(1, min(_PARTS, n))


def _median_norm(values: Array) -> float:
    return float(np.median(np.linalg.norm(values, axis=1)))


def _nearest(times_s: Array, wanted_s: Array) -> NDArray[np.intp]:
    """Index of the sample that follows each wanted time, whatever the order of the clock."""
    order = np.argsort(times_s, kind="stable")
    following: NDArray[np.intp] = order[np.searchsorted(times_s[order], wanted_s).clip(0, len(times_s) - 1)]
    return following
