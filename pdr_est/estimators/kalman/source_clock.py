"""Doubt about the clock of a source of fixes: where the walker was at the time that a fix really has.

The clock of a source is either right or wrong by a few seconds. A state of the filter holds its correction. Which of
the two it is, is a prior of this state, and a Gaussian can be given another prior at any later time: the distribution
of everything else for a given correction does not depend on it. The filter therefore keeps the probability that the
clock is wrong, and gives the state a prior with the variance of the mixture of both.

A source whose clock is certainly right has no such doubt: its correction is zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.common.nodes import Node
from pdr_est.frames import Array

CLOCK_WRONG_PRIOR = 0.05
"""Probability that the clock of a source is wrong, the same that the comparison of fixes with steps takes (ours)."""

_SIGMA_RIGHT_S, _SIGMA_WRONG_S = 0.1, 3.0  # of a right and of a wrong clock; ours
_LEAST_WRONG = 0.002  # probability that always remains, because the filter is no more than an approximation; ours
_TRAIL_S = 10.0  # past that is kept: 3 standard deviations of a wrong clock
_PACE_S = 2.0  # over which the pace ahead is taken
_LEAST_S = 0.3  # of a step, for the pace
_TURN_SHARE = 0.5  # error of a position that is foreseen, over its distance: walkers turn; ours


@dataclass(frozen=True)
class Shifted:
    """Place of the walker at the corrected time of a fix, seen from the pose at the time that it states.

    Attributes
    ----------
    offset_m
        (2,) displacement from there, forward and left, m, at the length scale 1.
    per_s
        (2,) its change with the correction of the clock, m/s.
    noise_m2
        (2, 2) covariance of what the line through both leaves out, m².
    """

    offset_m: Array
    per_s: Array
    noise_m2: Array


PRIOR_VARIANCES_S2 = (_SIGMA_RIGHT_S**2, _SIGMA_WRONG_S**2)
"""Prior variances of the correction of a right and of a wrong clock, s²."""


def clock_variance(wrong: float) -> float:
    """Return the prior variance of the correction of a clock that is wrong with some probability, s².

    It is that of the mixture of a right and a wrong clock; 0 for a clock that is certainly right.
    """
    right, of_wrong = PRIOR_VARIANCES_S2
    return (1.0 - wrong) * right + wrong * of_wrong if wrong > 0.0 else 0.0


def with_node(trail: tuple[Node, ...], node: Node) -> tuple[Node, ...]:
    """Return the last nodes of a device after one more."""
    first = 0
    while first < len(trail) and trail[first].time_s < node.time_s - _TRAIL_S:
        first += 1
    return (*trail[first:], node)


class RecentPath:
    """Path over the last nodes of a device, and straight ahead from there.

    Parameters
    ----------
    trail
        Last nodes of the device, of which the last one is that of the fix; without any the walker stands.
    time_s
        Time of the fix, s.
    """

    def __init__(self, trail: Sequence[Node], time_s: float) -> None:
        self._time_s, self._pace = time_s, 0.0
        self._times_s, self._place_m = np.array([time_s]), np.zeros((1, 2))
        if not trail:
            return
        turn_rad, length_m, ends_s = np.array(
            [(node.heading_change_rad, node.length_m, node.time_s) for node in trail]
        ).T
        self._times_s = np.append(trail[0].moving_from_s, ends_s)
        later_rad = turn_rad.sum() - np.cumsum(turn_rad)
        steps_m = length_m[:, None] * np.stack([np.cos(later_rad), -np.sin(later_rad)], axis=1)
        self._place_m = np.zeros((len(trail) + 1, 2))
        self._place_m[:-1] = -np.cumsum(steps_m[::-1], axis=0)[::-1]
        recent = ends_s > ends_s[-1] - _PACE_S
        if time_s - ends_s[-1] < _PACE_S:
            since_s = max(ends_s[-1] - float(self._times_s[:-1][recent][0]), _LEAST_S)
            self._pace = float(length_m[recent].sum()) / since_s

    def shifted(self, correction_s: float, sigma_s: float) -> Shifted:
        """Return where the walker is at the time of the fix plus a correction with a standard deviation, s."""
        at_s = correction_s + sigma_s * np.array([-1.0, 0.0, 1.0])
        ahead_s = np.maximum(at_s, 0.0)
        points = np.stack([np.interp(self._time_s + at_s, self._times_s, one) for one in self._place_m.T], axis=1)
        points[:, 0] += self._pace * ahead_s
        before, here, after = points
        bent = 0.5 * (before + after) - here
        unforeseen_m2 = float((_TURN_SHARE * self._pace) ** 2 * np.mean(ahead_s**2))
        return Shifted(here, (after - before) / (2.0 * sigma_s), np.outer(bent, bent) + unforeseen_m2 * np.eye(2))


def variance_after(variance: Array, before: float, after: float) -> Array:
    """Return the variances (k,) of the correction of a clock with another variance of its prior, s²."""
    learnt = np.maximum(1.0 / variance - 1.0 / before, 0.0)
    return np.asarray(1.0 / (learnt + 1.0 / after))


def repriored(mean: Array, covariance: Array, row: int, before: float, after: float) -> tuple[Array, Array]:
    """Give a state another prior of the correction of a clock.

    Parameters
    ----------
    mean, covariance
        States (k, n) and their covariances (k, n, n).
    row
        Row of the correction.
    before, after
        Variances of the prior so far, and of the new one, both about zero, s².
    """
    variance = covariance[:, row, row]
    new = variance_after(variance, before, after)
    per_s = covariance[:, :, row] / variance[:, None]
    moved = mean + per_s * (mean[:, row] * (new / variance - 1.0))[:, None]
    spread = covariance + (new - variance)[:, None, None] * per_s[:, :, None] * per_s[:, None, :]
    return moved, spread


def wrong_after(wrong: float, log_likelihood: Array) -> float:
    """Return the probability that a clock is wrong from the log-likelihoods (2,) of a fix: clock right, and wrong."""
    odds = np.log([1.0 - wrong, wrong]) + log_likelihood
    odds = np.exp(odds - odds.max())
    return float(np.clip(odds[1] / odds.sum(), _LEAST_WRONG, 1.0 - _LEAST_WRONG))
