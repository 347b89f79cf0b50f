"""The turn of a walker who puts one phone elsewhere, as the other phones of the walk tell it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.placement_change.turn_density import mean_and_sigma
from pdr_est.types.measurements import DeviceMeasurements, StepOdometry, TurnHypothesis

_WINDOW_STEPS = 12  # steps back from which the turns of two devices are compared: before the hand took the phone
_LEAST_STEPS = 8  # of these steps: fewer may begin in the hand
_SIGMA_POSE_RAD = 0.1  # of the heading of a step of either device around that of the walker, by the swing of limbs
_AGREES = 0.98  # probability that the other device turns as the walker does, and is not moved unnoticed
_LEAST_PROBABILITY = 1e-3  # hypotheses below this are left out


@dataclass(frozen=True)
class _Headings:
    """Heading (n,) of a device at each step, the variance that it has gained, and the number of undecided turns."""

    time_s: Array
    heading_rad: Array
    variance: Array
    undecided: Array

    @classmethod
    def of(cls, device: DeviceMeasurements) -> "_Headings":
        steps = [one for one in device.measurements if isinstance(one, StepOdometry)]
        doubtful = [bool(step.turn_hypotheses) or not step.observed for step in steps]
        variance = [0.0 if step.turn_hypotheses else float(step.covariance[2, 2]) for step in steps]
        return cls(
            np.array([step.time_s for step in steps]),
            np.cumsum([step.heading_change_rad for step in steps]),
            np.cumsum(variance),
            np.cumsum(doubtful),
        )

    def change(self, from_s: float, to_s: float) -> tuple[float, float] | None:
        """Compute the change of heading and its variance between two times; None where it is not known."""
        if len(self.time_s) < 2 or from_s < self.time_s[0] or to_s > self.time_s[-1]:
            return None
        heading, variance, undecided = (
            np.interp([from_s, to_s], self.time_s, values)
            for values in (self.heading_rad, self.variance, self.undecided)
        )
        if undecided[1] > undecided[0]:
            return None
        return float(heading[1] - heading[0]), float(variance[1] - variance[0])


def with_turns_of_others(devices: Sequence[DeviceMeasurements]) -> list[DeviceMeasurements]:
    """Weigh the possible turns of each device by the headings of the other devices at the same time.

    Over some steps up to the one with several possible turns, a device that stayed in its place turned as the walker
    did. So the turn between is known up to the errors of both headings. A device that was put elsewhere at the same
    time tells nothing.

    Parameters
    ----------
    devices
        Measurements of all devices of the walk.
    """
    if len(devices) == 1:
        return list(devices)
    headings = [_Headings.of(device) for device in devices]
    return [
        _weighed(device, headings[number], headings[:number] + headings[number + 1 :])
        for number, device in enumerate(devices)
    ]


def _weighed(device: DeviceMeasurements, own: _Headings, others: Sequence[_Headings]) -> DeviceMeasurements:
    """Weigh the possible turns of a device by the headings of the others."""
    number, found = 0, []
    for one in device.measurements:
        if isinstance(one, StepOdometry):
            if one.turn_hypotheses:
                for other in others:
                    one = _with_turn_of_other(one, own, number, other)
            number += 1
        found.append(one)
    return replace(device, measurements=tuple(found))


def _with_turn_of_other(step: StepOdometry, own: _Headings, number: int, other: _Headings) -> StepOdometry:
    """Weigh the possible turns of a step, the `number`-th of its device, by the turn of one other device."""
    if not len(other.time_s):
        return step
    first = max(number - _WINDOW_STEPS, int(np.searchsorted(own.time_s, other.time_s[0])))
    if number - first < _LEAST_STEPS:
        return step
    change = other.change(own.time_s[first], own.time_s[number])
    if change is None or own.undecided[number - 1] > own.undecided[first]:
        return step
    before_rad = own.heading_rad[number - 1] - own.heading_rad[first]
    variance = change[1] + own.variance[number] - own.variance[first] + 4.0 * _SIGMA_POSE_RAD**2
    turn_rad = float(wrap_angle(change[0] - before_rad))
    return with_hypotheses(step, _product(step.turn_hypotheses, turn_rad, variance))


def _product(hypotheses: Sequence[TurnHypothesis], turn_rad: float, variance: float) -> tuple[TurnHypothesis, ...]:
    """Multiply a mixture by the likelihood of a turn that was measured with a variance, or is of no use."""
    found = []
    for one in hypotheses:
        total = one.sigma_rad**2 + variance
        off = float(wrap_angle(turn_rad - one.heading_change_rad))
        likelihood = np.sqrt(2.0 * np.pi / total) * np.exp(-0.5 * off**2 / total)  # relative to the uniform one
        gain = one.sigma_rad**2 / total
        angle = float(wrap_angle(one.heading_change_rad + gain * off))
        sigma = float(one.sigma_rad * np.sqrt(1.0 - gain))
        weight = float(one.probability * _AGREES * likelihood)
        found.append(TurnHypothesis(weight, angle, sigma, "other device" if gain > 0.5 else one.origin))
        found.append(replace(one, probability=one.probability * (1.0 - _AGREES)))
    total = sum(one.probability for one in found)
    kept = [one for one in found if one.probability >= _LEAST_PROBABILITY * total]
    total = sum(one.probability for one in kept)
    kept.sort(key=lambda one: -one.probability)
    return tuple(replace(one, probability=one.probability / total) for one in kept)


def with_hypotheses(step: StepOdometry, hypotheses: tuple[TurnHypothesis, ...]) -> StepOdometry:
    """Return a step with other possible turns, and with their mean and covariance."""
    change_rad, sigma_rad = mean_and_sigma(hypotheses)
    more = sigma_rad**2 - mean_and_sigma(step.turn_hypotheses)[1] ** 2
    lever = np.array([0.0, step.length_m, 1.0])  # a turn moves the end of the step to the left
    return replace(
        step,
        heading_change_rad=change_rad,
        covariance=step.covariance + more * np.outer(lever, lever),
        turn_hypotheses=hypotheses,
    )
