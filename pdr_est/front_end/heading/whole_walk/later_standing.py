"""Correct the headings by what standing later in the walk tells of the gyroscope's bias.

Online the bias is known from the samples so far. At the end of a walk, a backward pass over the steps (Rauch, Tung
and Striebel) gives the bias at each of them from all samples. The bias is a vector in the phone: about the vertical
it is another one in a phone that was turned over, by as much as the direction of gravity in it has changed.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.attitude import BRIDGED_S
from pdr_est.front_end.heading.phone_posture import wrapped
from pdr_est.records import changed
from pdr_est.types.steps import Step, TurnHypothesis

_WALK_RADPS_PER_SQRT_S = np.deg2rad(0.01)  # random walk of the bias, as VQF's
_LEAST_RAD = 0.01  # correction of a whole walk below which it is left as it is


def with_later_standing(steps: Sequence[Step]) -> list[Step]:
    """Take the error of the bias, as all samples tell it, off the headings.

    Over a gap of the recording that is not bridged the yaw stays as it was, so that no bias has turned it there. Over
    one of unknown duration the bias may have become any other one: what is known after it tells nothing before it.

    Parameters
    ----------
    steps : sequence of Step
        All steps of a walk, at least one.
    """
    known = [step.samples.turn_bias_radps for step in steps]
    present = [(one.item(-2), one.item(-1)) for one in known if one is not None]
    if len(present) < len(steps):
        return list(steps)
    bias, sigma = np.array(present).T
    time_s = np.array([step.event.time_s for step in steps])
    passed_s = np.diff(time_s, prepend=time_s[0])
    cut = np.array([_follows_a_cut(step, before) for before, step in pairwise(steps)], dtype=np.bool_)
    ups = [step.samples.up for step in steps]
    up = np.array([(one.item(-3), one.item(-2), one.item(-1)) for one in ups])
    error = _smoothed(bias, sigma, np.where(cut, np.inf, passed_s[1:]), up) - bias
    unseen_s = [_unseen_s(step) if step.holes else 0.0 for step in steps]
    turned = error * np.maximum(passed_s - unseen_s, 0.0)
    total = np.cumsum(turned)
    if np.abs(total).max() < _LEAST_RAD:
        return list(steps)
    heading_rad = wrap_angle(np.array([step.heading_rad for step in steps]) - total).tolist()
    return [
        changed(step, heading_rad=heading, turn_hypotheses=_turned_back(step.turn_hypotheses, here))
        if step.turn_hypotheses
        else changed(step, heading_rad=heading)
        for step, heading, here in zip(steps, heading_rad, turned.tolist(), strict=True)
    ]


def _turned_back(hypotheses: Sequence[TurnHypothesis], by_rad: float) -> tuple[TurnHypothesis, ...]:
    """Take an angle off the heading changes of hypotheses."""
    return tuple(changed(one, heading_change_rad=wrapped(one.heading_change_rad - by_rad)) for one in hypotheses)


def _unseen_s(step: Step) -> float:
    """Compute how much of the time since the last step, on the clock of the steps, lies in gaps without rotation."""
    return sum(hole.end_s - hole.start_s for hole in step.holes if hole.duration_s > BRIDGED_S)


def _follows_a_cut(step: Step, before: Step) -> bool:
    """Return True for a step that an unknown time passed before, since the last one."""
    if not step.holes:
        return step.event.segment != before.event.segment
    return not all(hole.duration_known for hole in step.holes)


def _smoothed(bias: Array, sigma: Array, passed_s: Array, up: Array) -> Array:
    """Compute the bias about the vertical (n,) at each step from all steps.

    Parameters
    ----------
    bias, sigma : ndarray, shape (n,)
        Bias and standard deviation as known at each step.
    passed_s : ndarray, shape (n - 1,)
        Time from each step to the next one; infinite where it is not known.
    up : ndarray, shape (n, 3)
        Unit vectors upwards in the phone.
    """
    variance = sigma[:-1] ** 2
    alike = np.clip((up[1:] * up[:-1]).sum(axis=1), 0.0, 1.0)
    gain = alike * variance / (variance + _WALK_RADPS_PER_SQRT_S**2 * passed_s)
    smoothed, later = bias.tolist(), float(bias[-1])
    for k, share, same in zip(range(len(gain) - 1, -1, -1), gain[::-1].tolist(), alike[::-1].tolist(), strict=True):
        later = smoothed[k] = smoothed[k] + share * (later - same * smoothed[k])
    return np.array(smoothed)
