"""Weigh what tells whether an acceleration points up or down at rest, where there is no attitude.

The motion of walking cannot tell. Reversing the sign of the acceleration reverses up and forward alike, which is the
same walk reflected in the body's own plane of symmetry: the length of the vector, the rhythm, the sharp peaks of the
heel strikes and the phase between up and forward stay the same. Only what is not symmetric helps, each as log odds:

* how phones are carried: nobody walks with the screen facing down,
* which sign recorders of a unit use, and which one the titles name,
* the dip of the earth's magnetic field,
* the turns of position fixes, against those by the gyroscope. They alone prove it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, wrap_angle
from pdr_est.io.conversion.units import sampled_rows
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Signal

_BY_SCREEN = 4.0
_UP_IN_MPS2, _UP_IN_G, _UP_IN_G_APART = 2.2, 0.0, -2.2
_PARTS_OF_G, _G_RTOL = (1.0, 1e-3, 1e-6), 1e-2
_BY_DIP = 1.2
_BY_TITLES = 3.4
_LEAST_DIP_COSINE = 0.25
_EQUATOR_DEG = 20.0  # within this latitude the dip may be of either sign
_UP_S = 2.0  # the acceleration is averaged over this time for the axis of yaw
_DAMAGED = 20.0  # times the usual acceleration
_LEG_M = 12.0
_LEG_SIGMAS = 3.0
_SIGMA_TURN_RAD = 0.4  # of the difference of a turn by fixes and by gyroscope, besides the accuracy of the fixes
_MOST_BY_TURNS = 8.0  # in case the fixes have another clock or wander indoors
_USELESS_LEG = 0.1  # probability that the turn between two legs tells nothing


@dataclass(frozen=True)
class SignEvidence:
    """Evidence about the sign of an acceleration.

    Attributes
    ----------
    log_odds
        Logarithm of the probability that it points up at rest (Android's sign) over that of down (Apple's).
    words
        What it is, for the decision.
    """

    log_odds: float
    words: str


def screen_evidence(force: Signal) -> SignEvidence:
    """Judge by the screen, which faces up while a phone is held.

    The logarithm of the odds is 4 times the share of gravity along the axis out of the screen: a logistic regression
    on 22 sets of phones of equal weight. With sets left out, its log score is 0.37 a set (0.69 for ignorance); the
    other axes improve nothing, because phones are put into pockets either way up. Where it says 98 %, all of 121
    recordings of ten sets are right, where 50 to 70 %, 55 % of 170 are.

    Parameters
    ----------
    force
        (n, 3) acceleration with gravity, in the axes of a phone.
    """
    sample = sampled_rows(force.values)
    norm = max(float(np.median(np.linalg.norm(sample, axis=1))), 1e-9)
    share = float(np.clip(sample[:, 2].mean() / norm, -1.0, 1.0))
    facing = "up" if share > 0.0 else "down"
    return SignEvidence(_BY_SCREEN * share, f"the screen would face {facing} ({share:+.2f} g)")


def unit_evidence(unit_factor: float, gravity_apart: bool = False) -> SignEvidence:
    """Judge by the unit: Apple's own is g, and recorders in m/s² mostly have Android's sign.

    The odds, 9 to 1 in m/s², even in g and 1 to 9 for gravity in g apart from the motion, as Apple's Core Motion
    gives it, are a judgement of the recorders that are known.

    Parameters
    ----------
    unit_factor
        Factor from the recorded unit to m/s².
    gravity_apart
        True where gravity and the acceleration without it were recorded as two signals.
    """
    if unit_factor == 1.0:
        return SignEvidence(_UP_IN_MPS2, "recorders in m/s^2 mostly have Android's sign")
    if gravity_apart:
        return SignEvidence(_UP_IN_G_APART, "gravity in g, apart from the motion, is mostly Core Motion's")
    in_g = any(math.isclose(unit_factor, part * STANDARD_GRAVITY_MPS2, rel_tol=_G_RTOL) for part in _PARTS_OF_G)
    return SignEvidence(_UP_IN_G, f"recorders in {'g' if in_g else 'this unit'} have either sign")


def title_evidence(sign: float, reason: str) -> SignEvidence:
    """Judge by titles that name a recorder's convention, where its unit is another one: odds of 30 to 1, ours."""
    return SignEvidence(_BY_TITLES * sign, reason)


def dip_evidence(force: Signal, field: Signal, latitude_deg: float | None = None) -> SignEvidence | None:
    """Judge by the magnetic field, which points down in the northern half of the earth.

    It counts little (odds of 3 to 1): in one of eight sets, of a phone that was not calibrated, the raw field pointed
    up. Without a latitude the northern half is assumed.

    Parameters
    ----------
    force
        (n, 3) acceleration with gravity.
    field
        (m, 3) magnetic field of the same device.
    latitude_deg
        Latitude of the walk; None where it is unknown.

    Returns
    -------
    SignEvidence or None
        None near the equator, or when the field lies level.
    """
    if latitude_deg is not None and abs(latitude_deg) < _EQUATOR_DEG:
        return None
    time_s, values = sampled_rows(force.time_s), sampled_rows(force.values)
    along = field.interpolated_at(time_s)
    lengths = np.linalg.norm(along, axis=1) * np.linalg.norm(values, axis=1)
    usable = lengths > 0.0
    if not usable.any():
        return None
    cosine = float(np.median((along * values).sum(axis=1)[usable] / lengths[usable]))
    if abs(cosine) < _LEAST_DIP_COSINE:
        return None
    south = -1.0 if latitude_deg is not None and latitude_deg < 0.0 else 1.0
    return SignEvidence(
        -south * float(np.sign(cosine)) * _BY_DIP, f"cosine of the magnetic field to the acceleration {cosine:+.2f}"
    )


def turn_evidence(force: Signal, rate: Signal, fixes: Sequence[PositionFix]) -> SignEvidence | None:
    """Judge by the turns between legs of position fixes, which the gyroscope sees with one sign or the other.

    Parameters
    ----------
    force
        (n, 3) acceleration with gravity.
    rate
        (m, 3) rotation rate, rad/s.
    fixes
        Positions of the same walk on the same clock.

    Returns
    -------
    SignEvidence or None
        None when there are fewer than two legs.
    """
    legs = _legs(fixes)
    if len(legs) < 2 or len(rate) < 2:
        return None
    time_s, yaw_rad = _yaw(force, rate)
    turns: list[tuple[float, float, float]] = []
    for before, after in pairwise(legs):
        directions = [_mean_direction(time_s, yaw_rad, leg[0], leg[1]) for leg in (before, after)]
        if None in directions or after[0] - before[1] > 1e-6:
            continue
        seen = float(wrap_angle(float(directions[1] or 0.0) - float(directions[0] or 0.0)))
        turned = float(wrap_angle(after[2] - before[2]))
        turns.append((turned, seen, before[3] ** 2 + after[3] ** 2 + _SIGMA_TURN_RAD**2))
    if not turns:
        return None
    by_fixes, seen_rad, variance = (np.array(column) for column in zip(*turns, strict=True))
    gains = _log_density(by_fixes - seen_rad, variance) - _log_density(by_fixes + seen_rad, variance)
    log_odds = float(np.clip(gains.sum(), -_MOST_BY_TURNS, _MOST_BY_TURNS))
    return SignEvidence(log_odds, f"{len(turns)} turns of the position fixes compared with the gyroscope's")


def _legs(fixes: Sequence[PositionFix]) -> list[tuple[float, float, float, float]]:
    """Chain fixes to legs that are long enough: first and last time, course, and its standard deviation."""
    legs = []
    first = None
    for fix in sorted(fixes, key=lambda one: one.time_s):
        if first is None:
            first = fix
            continue
        away = fix.position_m - first.position_m
        length_m = float(np.hypot(*away))
        sigma_m = float(np.sqrt(0.5 * (np.trace(fix.covariance_m2) + np.trace(first.covariance_m2))))
        if length_m > max(_LEG_M, _LEG_SIGMAS * sigma_m):
            legs.append((first.time_s, fix.time_s, float(np.arctan2(away[1], away[0])), sigma_m / length_m))
            first = fix
    return legs


def _yaw(force: Signal, rate: Signal) -> tuple[Array, Array]:
    """Integrate the rotation rate about the direction of the averaged acceleration; times and angles (m,)."""
    order = np.argsort(rate.time_s, kind="stable")
    time_s, values = rate.time_s[order], rate.values[order]
    largest = _DAMAGED * float(np.median(np.abs(force.values).max(axis=1)))
    sums = np.cumsum(np.clip(force.values, -largest, largest), axis=0)
    half = 0.5 * _UP_S
    integral = [
        np.interp(time_s + half, force.time_s, column) - np.interp(time_s - half, force.time_s, column)
        for column in sums.T
    ]
    up = np.stack(integral, axis=1)
    up /= np.maximum(np.linalg.norm(up, axis=1, keepdims=True), 1e-9)
    yaw_rate = np.einsum("ij,ij->i", values, up)
    step_s = np.diff(time_s, prepend=time_s[0])
    return time_s, np.cumsum(yaw_rate * step_s)


def _mean_direction(time_s: Array, yaw_rad: Array, start_s: float, end_s: float) -> float | None:
    inside = slice(*np.searchsorted(time_s, [start_s, end_s]))
    if inside.stop <= inside.start:
        return None
    return float(np.angle(np.exp(1j * yaw_rad[inside]).mean()))


def _log_density(angle_rad: Array, variance_rad2: Array) -> Array:
    """Compute the log density of an angle about zero, or uniform on the circle for one in ten."""
    folded = np.square(wrap_angle(angle_rad)) / variance_rad2
    normal = np.exp(-0.5 * folded) / np.sqrt(2.0 * np.pi * variance_rad2)
    density: Array = np.log((1.0 - _USELESS_LEG) * normal + _USELESS_LEG / (2.0 * np.pi))
    return density
