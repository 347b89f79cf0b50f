"""Correct the headings by what standing later in the walk tells of the gyroscope's bias.

Online the bias is known from the samples so far. At the end of a walk, a backward pass over the steps (Rauch, Tung
and Striebel) gives the bias at each of them from all samples. The bias is a vector in the phone: about the vertical
it is another one in a phone that was turned over, by as much as the direction of gravity in it has changed.
"""

from collections.abc import Sequence

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.records import changed
from pdr_est.types.steps import Step

_WALK_RADPS_PER_SQRT_S = np.deg2rad(0.01)  # random walk of the bias, as VQF's
_LEAST_RAD = 0.01  # correction of a whole walk below which it is left as it is


def with_later_standing(steps: Sequence[Step]) -> list[Step]:
    """Take the error of the bias, as all samples tell it, off the headings.

    Parameters
    ----------
    steps : sequence of Step
        All steps of a walk, at least one.
    """
    known = [step.samples.turn_bias_radps for step in steps]
    present = [one[-1] for one in known if one is not None]
    if len(present) < len(steps):
        return list(steps)
    bias, sigma = np.array(present).T
    time_s = np.array([step.event.time_s for step in steps])
    error = _smoothed(bias, sigma, time_s, np.array([step.samples.up[-1] for step in steps])) - bias
    turned = error * np.diff(time_s, prepend=time_s[0])
    total = np.cumsum(turned)
    if np.abs(total).max() < _LEAST_RAD:
        return list(steps)
    return [
        changed(
            step,
            heading_rad=float(wrap_angle(step.heading_rad - off)),
            turn_hypotheses=tuple(
                changed(one, heading_change_rad=float(wrap_angle(one.heading_change_rad - here)))
                for one in step.turn_hypotheses
            ),
        )
        for step, off, here in zip(steps, total.tolist(), turned.tolist(), strict=True)
    ]


def _smoothed(bias: Array, sigma: Array, time_s: Array, up: Array) -> Array:
    """Compute the bias about the vertical (n,) at each step from all steps.

    Parameters
    ----------
    bias, sigma, time_s : ndarray, shape (n,)
        Bias and standard deviation as known at each step, and its time.
    up : ndarray, shape (n, 3)
        Unit vectors upwards in the phone.
    """
    variance = sigma[:-1] ** 2
    alike = np.clip((up[1:] * up[:-1]).sum(axis=1), 0.0, 1.0)
    gain = alike * variance / (variance + _WALK_RADPS_PER_SQRT_S**2 * np.diff(time_s))
    smoothed = bias.tolist()
    for k in range(len(gain) - 1, -1, -1):
        smoothed[k] += float(gain[k]) * (smoothed[k + 1] - float(alike[k]) * smoothed[k])
    return np.array(smoothed)
