"""Rise and fall of a runner's trunk: thrown up by each contact with the ground, and in free fall between them.

Each step is a contact and then a flight. In flight the vertical acceleration is that of gravity, exactly. Over a
contact it follows from what comes before and after: the trunk lands at the speed of its fall and leaves at the speed
that its next flight needs, at the same height. A polynomial of the fifth degree has this height, speed and
acceleration at both ends. Its force is a parabola, close to the half sine of the spring-mass model (Blickhan 1989),
with a peak of 1.5 times its mean. Real runners press harder in the middle of the contact: 2.51 body weights at a mean
of 1.40, and 2.83 at 1.70 (Munro et al. 1987). A symmetric term of the sixth degree, which is at rest at both ends,
adds that. So the mean force over a step is the body's weight, and position, velocity and acceleration are continuous.

Where running begins or ends, the contact joins the motion of walking or standing instead of a flight.

References
----------
Blickhan 1989, Journal of Biomechanics 22. Munro, Miller and Fuglevand 1987, Journal of Biomechanics 20.
"""

from collections.abc import Callable, Iterator

import numpy as np
from scipy.interpolate import PPoly

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal, evaluate_curve
from pdr_est.simulate.walker.step_schedule import StepSchedule

PEAK_OVER_MEAN = 1.72  # of the vertical force in a contact: Munro et al., between 1.79 at 3 m/s and 1.66 at 5 m/s

_PARABOLA = 1.5  # peak over mean of a parabola
_MIDDLE = -0.375  # second derivative of s^3 (1 - s)^3 in its middle
_BUMP = np.array([-1.0, 3.0, -3.0, 1.0, 0.0, 0.0, 0.0])  # s^3 (1 - s)^3, highest power first

State = tuple[float, float, float]
"""Height, m, vertical speed, m/s, and vertical acceleration, m/s^2."""


class RunningBounce:
    """Vertical motion of the trunk wherever the steps of a schedule are run.

    Parameters
    ----------
    steps : StepSchedule
        All steps of the walk.
    otherwise : Callable
        Vertical motion in walking and standing at times (n,), s, which running begins from and ends in.
    """

    def __init__(self, steps: StepSchedule, otherwise: Callable[[Array], DifferentiableSignal]) -> None:
        self._curves = [_bounce(steps, run, otherwise) for run in _runs(steps)]

    def replace_in(self, up: DifferentiableSignal, time_s: Array) -> DifferentiableSignal:
        """Replace the vertical motion at times (n,), s, by that of running where somebody runs."""
        for curve in self._curves:
            inside = (time_s >= curve.x[0]) & (time_s < curve.x[-1])
            run = evaluate_curve(curve, np.where(inside, time_s, curve.x[0]))
            up = DifferentiableSignal(
                np.where(inside, run.value, up.value),
                np.where(inside, run.rate, up.rate),
                np.where(inside, run.acceleration, up.acceleration),
            )
        return up


def _runs(steps: StepSchedule) -> Iterator[slice]:
    """Find the ranges of steps that are run without a break."""
    for bout in steps.bouts:
        running = np.concatenate([[False], steps.flight_s[bout] > 0.0, [False]])
        first, last = (np.flatnonzero(np.diff(running.astype(int)) == change) for change in (1, -1))
        yield from (slice(bout.start + a, bout.start + b) for a, b in zip(first.tolist(), last.tolist(), strict=True))


def _bounce(steps: StepSchedule, run: slice, otherwise: Callable[[Array], DifferentiableSignal]) -> PPoly:
    """Compute the height over time of one run, from its first contact to the end of that after its last step."""
    strike_s, flight_s = steps.time_s[run], steps.flight_s[run]
    leave_s = strike_s - flight_s
    begin_s = float(steps.start_s[run.start])
    end_s = float(strike_s[-1] + (leave_s[-1] - steps.start_s[run.stop - 1]))  # the last contact takes as long again
    before, after = (_state(otherwise(np.array([at_s]))) for at_s in (begin_s, end_s))
    edge_s = np.concatenate([np.stack([[begin_s, *strike_s[:-1]], leave_s], axis=1).ravel(), strike_s[-1:], [end_s]])
    gravity = STANDARD_GRAVITY_MPS2
    columns, landing = [], before
    for contact_s, aloft_s in zip(leave_s - np.array([begin_s, *strike_s[:-1]]), flight_s, strict=True):
        speed = 0.5 * gravity * float(aloft_s)
        columns.append(_contact(float(contact_s), landing, (0.0, speed, -gravity)))
        columns.append(np.array([0.0, 0.0, 0.0, 0.0, -0.5 * gravity, speed, 0.0]))
        landing = (0.0, -speed, -gravity)
    columns.append(_contact(end_s - float(strike_s[-1]), landing, after))
    return PPoly(np.stack(columns, axis=1), edge_s)


def _contact(span_s: float, begin: State, end: State) -> Array:
    """Compute the polynomial (7,) of the height in a contact, highest power of the time first."""
    x0, v0, a0 = begin[0], begin[1] * span_s, begin[2] * span_s**2
    x1, v1, a1 = end[0], end[1] * span_s, end[2] * span_s**2
    gain = x1 - x0
    share = np.array(
        [
            0.0,
            6.0 * gain - 3.0 * (v0 + v1) - 0.5 * (a0 - a1),
            -15.0 * gain + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
            10.0 * gain - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
            0.5 * a0,
            v0,
            x0,
        ]
    )
    mean_force = STANDARD_GRAVITY_MPS2 + (end[1] - begin[1]) / span_s
    share += (PEAK_OVER_MEAN - _PARABOLA) * mean_force * span_s**2 / _MIDDLE * _BUMP
    return np.asarray(share / span_s ** np.arange(6, -1, -1))


def _state(signal: DifferentiableSignal) -> State:
    """Read height, speed and acceleration of a signal of one sample."""
    return float(signal.value[0]), float(signal.rate[0]), float(signal.acceleration[0])
