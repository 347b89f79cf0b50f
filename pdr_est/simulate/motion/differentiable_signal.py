"""Signals that carry their first two time derivatives, so that every simulated motion is differentiated exactly."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PPoly

from pdr_est.frames import Array


@dataclass(frozen=True)
class DifferentiableSignal:
    """Value, first and second time derivative of a scalar signal at sampled times.

    Sums, products, sines and cosines follow the rules of calculus. Whatever is composed of such signals therefore has
    exact rates and accelerations at any sampling rate, without numerical differentiation.

    Attributes
    ----------
    value : Array
        Signal at the sampled times, (n,), in its own unit.
    rate : Array
        First time derivative, (n,), unit per second.
    acceleration : Array
        Second time derivative, (n,), unit per second squared.
    """

    value: Array
    rate: Array
    acceleration: Array

    def __add__(self, other: "DifferentiableSignal | float") -> "DifferentiableSignal":
        if isinstance(other, DifferentiableSignal):
            return DifferentiableSignal(
                self.value + other.value, self.rate + other.rate, self.acceleration + other.acceleration
            )
        return DifferentiableSignal(self.value + other, self.rate, self.acceleration)

    def __mul__(self, other: "DifferentiableSignal | float") -> "DifferentiableSignal":
        if isinstance(other, DifferentiableSignal):
            return DifferentiableSignal(
                self.value * other.value,
                self.rate * other.value + self.value * other.rate,
                self.acceleration * other.value + 2.0 * self.rate * other.rate + self.value * other.acceleration,
            )
        return DifferentiableSignal(self.value * other, self.rate * other, self.acceleration * other)

    def __neg__(self) -> "DifferentiableSignal":
        return self * -1.0

    def __sub__(self, other: "DifferentiableSignal | float") -> "DifferentiableSignal":
        return self + (-other)

    def __getitem__(self, part: slice) -> "DifferentiableSignal":
        return DifferentiableSignal(self.value[part], self.rate[part], self.acceleration[part])

    def sin(self) -> "DifferentiableSignal":
        """Return the sine of an angle in radians."""
        return self.chain_rule(np.sin(self.value), np.cos(self.value), -np.sin(self.value))

    def cos(self) -> "DifferentiableSignal":
        """Return the cosine of an angle in radians."""
        return self.chain_rule(np.cos(self.value), -np.sin(self.value), -np.cos(self.value))

    def chain_rule(self, value: Array, slope: Array, bend: Array) -> "DifferentiableSignal":
        """Compose a function f with this signal.

        Parameters
        ----------
        value, slope, bend : Array
            The function f and its first two derivatives, evaluated at the values of this signal, (n,) each.

        Returns
        -------
        DifferentiableSignal
            The signal f(self) with derivatives by the chain rule.
        """
        return DifferentiableSignal(value, slope * self.rate, slope * self.acceleration + bend * self.rate**2)


def constant_signal(value: float, count: int) -> DifferentiableSignal:
    """Make a signal that has one value at `count` times and does not change."""
    zero = np.zeros(count)
    return DifferentiableSignal(np.full(count, value), zero, zero)


def concatenate_signals(parts: list[DifferentiableSignal]) -> DifferentiableSignal:
    """Join consecutive pieces of one signal."""
    return DifferentiableSignal(
        *(np.concatenate([getattr(p, name) for p in parts]) for name in ("value", "rate", "acceleration"))
    )


def oscillation_burst(
    cycle: DifferentiableSignal, span: float, waves: float, phase_rad: float
) -> DifferentiableSignal:
    """Make a short oscillation after every whole number of a counting signal; it is zero elsewhere.

    The oscillation is a cosine under a bell of height 1, which begins and ends so gently that the acceleration is
    continuous.

    Parameters
    ----------
    cycle : DifferentiableSignal
        Counting signal, for example strides: a burst begins where it passes a whole number.
    span : float
        Duration of the burst as a fraction of a cycle.
    waves : float
        Number of oscillations within the burst.
    phase_rad : float
        Phase of the cosine in the middle of the burst; 0 puts a maximum there.
    """
    inside = np.mod(cycle.value, 1.0) < span
    share = DifferentiableSignal(
        np.where(inside, np.mod(cycle.value, 1.0), 0.0) / span, cycle.rate / span, cycle.acceleration / span
    )
    rest = 1.0 - share.value
    bell = share.chain_rule(
        64.0 * (share.value * rest) ** 3,
        192.0 * (share.value * rest) ** 2 * (rest - share.value),
        384.0 * share.value * rest * (1.0 - 5.0 * share.value * rest),
    )
    jolt = bell * ((share - 0.5) * (2.0 * np.pi * waves) + phase_rad).cos()
    return DifferentiableSignal(*(np.where(inside, part, 0.0) for part in (jolt.value, jolt.rate, jolt.acceleration)))


def evaluate_curve(curve: PPoly, time_s: Array) -> DifferentiableSignal:
    """Evaluate a piecewise polynomial of time and its derivatives at times (n,), s."""
    return DifferentiableSignal(curve(time_s), curve(time_s, 1), curve(time_s, 2))


def quintic_curve(time_s: Array, value: Array, rate: Array) -> PPoly:
    """Interpolate values with given rates and zero acceleration by quintic polynomials.

    The acceleration is continuous; where the values already move at the given rates, the curve is a straight line.

    Parameters
    ----------
    time_s, value, rate : Array
        Ascending times, values and first derivatives at them, (n,) each.
    """
    span = np.diff(time_s)
    gain = np.diff(value)
    begin, end = rate[:-1] * span, rate[1:] * span
    coefficients = [
        (6.0 * gain - 3.0 * begin - 3.0 * end) / span**5,
        (-15.0 * gain + 8.0 * begin + 7.0 * end) / span**4,
        (10.0 * gain - 6.0 * begin - 4.0 * end) / span**3,
        np.zeros(len(span)),
        rate[:-1],
        value[:-1],
    ]
    return PPoly(np.array(coefficients), time_s)
