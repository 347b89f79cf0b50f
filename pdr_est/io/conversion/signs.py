"""Detect sign conventions: that of the acceleration at rest, and the direction of the attitude.

Android's specific force points up when the device lies still, Apple's points down. Attitudes are recorded from device
to level axes or the other way round. Gravity in the acceleration decides, with the attitude or, without one, with
what the format implies. Where neither is known, the odds of `pdr_est.io.conversion.sign_evidence` are weighed.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array, up_in_device
from pdr_est.io.conversion.sign_evidence import SignEvidence, screen_evidence, unit_evidence
from pdr_est.io.conversion.units import Conversion
from pdr_est.types.recording import Signal

_VERTICAL_COSINE = 0.6  # median over the walk; 0.85 for a swung phone, whose acceleration is far from gravity
_CLEARLY_BETTER = 0.1
_CERTAIN = 0.99  # probability of a sign that needs no warning; what the screen alone can give, 98 %, is less (ours)


def gravity_cosine(force: Signal, attitude: Signal) -> float | None:
    """Compute the median cosine between an acceleration with gravity and the up direction of the attitude.

    Parameters
    ----------
    force
        Acceleration including gravity, (n, 3), device axes.
    attitude
        Quaternions (m, 4), w first, device to level axes.

    Returns
    -------
    float or None
        Near +1 for Android's signs and near -1 for Apple's; None without overlap in time.
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


def detect_force_sign(
    force: Signal,
    attitude: Signal | None,
    expected: float | None,
    reason: str,
    evidence: Sequence[SignEvidence] | None = None,
) -> Conversion:
    """Find the sign that turns an acceleration with gravity into specific force that points up at rest.

    Parameters
    ----------
    force
        Acceleration including gravity, (n, 3), device axes.
    attitude
        Attitude of the device; it decides where it fits. None when there is none.
    expected
        Sign (+1 or -1) that the format or the metadata imply; None when they do not tell.
    reason
        Why that sign is expected, for the decision.
    evidence
        What is weighed where neither attitude nor expectation decides; None for the direction of the screen, of an
        acceleration that was recorded in m/s^2.

    Returns
    -------
    Conversion
        Its factor is +1 or -1. Without attitude and expectation it is the more probable one, with a warning unless
        that is almost certain. How phones are carried never suffices: a phone may be at the ear or face down.
    """
    cosine = None if attitude is None else gravity_cosine(force, attitude)
    if cosine is not None and abs(cosine) >= _VERTICAL_COSINE:
        return _sign_by_attitude(float(np.sign(cosine)), cosine, expected, reason)
    if expected is not None:
        warning = "" if cosine is None else f"acceleration and attitude do not agree: median cosine {cosine:.2f}"
        return Conversion(expected, f"{_describe_sign(expected)}: {reason}; no attitude confirms it", warning)
    return _weighed((screen_evidence(force), unit_evidence(1.0)) if evidence is None else evidence)


def resolve_attitude_direction(force: Signal, attitude: Signal) -> tuple[Signal | None, Conversion]:
    """Return the attitude as rotation from device to level axes, judged by gravity in the acceleration.

    Returns
    -------
    attitude : Signal or None
        The attitude, its conjugate if only that fits, or None if neither fits.
    conversion : Conversion
        How that was decided; its factor has no meaning.
    """
    cosine = gravity_cosine(force, attitude)
    if cosine is None:
        text = "the attitude does not overlap the acceleration in time and could not be checked"
        return attitude, Conversion(1.0, text, text)
    conjugate = Signal(attitude.time_s, attitude.values * np.array([1.0, -1.0, -1.0, -1.0]))
    inverted = gravity_cosine(force, conjugate) or 0.0
    if abs(inverted) > max(abs(cosine) + _CLEARLY_BETTER, _VERTICAL_COSINE):
        return conjugate, Conversion(
            1.0,
            f"attitude was recorded as level -> device and is inverted: median cosine to gravity {inverted:+.2f} "
            f"instead of {cosine:+.2f}",
        )
    if abs(cosine) >= _VERTICAL_COSINE:
        text = f"attitude rotates from device to level axes: cosine to gravity {cosine:+.2f}"
        return attitude, Conversion(1.0, text)
    text = f"the attitude contradicts gravity in the acceleration (median cosine {cosine:.2f}) and is left out"
    return None, Conversion(1.0, text, text)


def _sign_by_attitude(sign: float, cosine: float, expected: float | None, reason: str) -> Conversion:
    """Take the sign from the attitude; warn if it contradicts the expected one."""
    decision = f"{_describe_sign(sign)}: median cosine to the attitude's up direction {cosine:+.2f}"
    if expected is None or expected == sign:
        return Conversion(sign, decision if expected is None else f"{decision}, as expected ({reason})")
    warning = (
        f"the sign of the acceleration contradicts the metadata ({reason}): the sign by the attitude is used, median "
        f"cosine to up {cosine:+.2f}"
    )
    return Conversion(sign, decision, warning)


def _weighed(evidence: Sequence[SignEvidence]) -> Conversion:
    """Take the more probable sign; warn unless it is almost certain."""
    log_odds = sum(one.log_odds for one in evidence)
    sign = 1.0 if log_odds >= 0.0 else -1.0
    probability = float(1.0 / (1.0 + np.exp(-abs(log_odds))))
    reasons = "; ".join(one.words for one in evidence) or "nothing tells"
    decision = f"{_describe_sign(sign)}: probability {probability:.2%} ({reasons})"
    if probability >= _CERTAIN:
        return Conversion(sign, decision)
    name = "up (Android's sign)" if sign > 0.0 else "down (Apple's sign)"
    return Conversion(
        sign,
        decision,
        f"the sign of the acceleration is not certain: {name} at rest with a probability of {probability:.1%} "
        f"({reasons}); with the other sign the track is mirrored: state the sign with --map, or record the attitude",
    )


def _describe_sign(sign: float) -> str:
    return "acceleration points up at rest" if sign > 0 else "acceleration points down at rest (Apple) and is negated"


def _nearest(times_s: Array, wanted_s: Array) -> NDArray[np.intp]:
    """Find the index of the sample that follows each wanted time, whatever the order of the clock."""
    order = np.argsort(times_s, kind="stable")
    following: NDArray[np.intp] = order[np.searchsorted(times_s[order], wanted_s).clip(0, len(times_s) - 1)]
    return following
