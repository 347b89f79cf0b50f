"""Signals of time that carry their first two derivatives, so that every motion is differentiated exactly."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PPoly

from pdr_est.frames import Array


@dataclass(frozen=True)
class Jet:
    """Value, first and second time derivative of one signal at some times, each (n,).

    Sums, products, sines and cosines follow the rules of calculus, so whatever is composed of jets has exact
    rates and accelerations at any sampling rate, without numerical differentiation.
    """

    value: Array
    rate: Array
    acceleration: Array

    def __add__(self, other: "Jet | float") -> "Jet":
        if isinstance(other, Jet):
            return Jet(self.value + other.value, self.rate + other.rate, self.acceleration + other.acceleration)
        return Jet(self.value + other, self.rate, self.acceleration)

    def __mul__(self, other: "Jet | float") -> "Jet":
        if isinstance(other, Jet):
            return Jet(
                self.value * other.value,
                self.rate * other.value + self.value * other.rate,
                self.acceleration * other.value + 2.0 * self.rate * other.rate + self.value * other.acceleration,
            )
        return Jet(self.value * other, self.rate * other, self.acceleration * other)

    def __neg__(self) -> "Jet":
        return self * -1.0

    def __sub__(self, other: "Jet | float") -> "Jet":
        return self + (-other)

    def __getitem__(self, part: slice) -> "Jet":
        return Jet(self.value[part], self.rate[part], self.acceleration[part])

    def sin(self) -> "Jet":
        """Sine of an angle in radians."""
        return self.through(np.sin(self.value), np.cos(self.value), -np.sin(self.value))

    def cos(self) -> "Jet":
        """Cosine of an angle in radians."""
        return self.through(np.cos(self.value), -np.sin(self.value), -np.cos(self.value))

    def through(self, value: Array, slope: Array, bend: Array) -> "Jet":
        """f of this signal, given f and its first two derivatives at the signal's values (chain rule)."""
        return Jet(value, slope * self.rate, slope * self.acceleration + bend * self.rate**2)


def constant(value: float, count: int) -> Jet:
    """A signal that never changes, at `count` times."""
    zero = np.zeros(count)
    return Jet(np.full(count, value), zero, zero)


def joined(parts: list[Jet]) -> Jet:
    """Consecutive pieces of one signal as one."""
    return Jet(*(np.concatenate([getattr(p, name) for p in parts]) for name in ("value", "rate", "acceleration")))


def pulse(cycle: Jet, span: float, waves: float, phase_rad: float) -> Jet:
    """A short swinging jolt behind every whole number of a counting signal, zero elsewhere.

    It lasts a share `span` of a cycle, swings `waves` times within a bell of height 1, with a phase of `phase_rad`
    in its middle (0: highest there), and begins and ends so gently that its acceleration is continuous.
    """
    inside = np.mod(cycle.value, 1.0) < span
    share = Jet(np.where(inside, np.mod(cycle.value, 1.0), 0.0) / span, cycle.rate / span, cycle.acceleration / span)
    rest = 1.0 - share.value
    bell = share.through(
        64.0 * (share.value * rest) ** 3,
        192.0 * (share.value * rest) ** 2 * (rest - share.value),
        384.0 * share.value * rest * (1.0 - 5.0 * share.value * rest),
    )
    jolt = bell * ((share - 0.5) * (2.0 * np.pi * waves) + phase_rad).cos()
    return Jet(*(np.where(inside, part, 0.0) for part in (jolt.value, jolt.rate, jolt.acceleration)))


def jet_of(curve: PPoly, time_s: Array) -> Jet:
    """The jet of a piecewise polynomial of time at some times."""
    return Jet(curve(time_s), curve(time_s, 1), curve(time_s, 2))


def smooth_curve(time_s: Array, value: Array, rate: Array) -> PPoly:
    """Quintic pieces through values with given rates and no acceleration at rising times, all (n,).

    The acceleration is continuous; where the values already move at the given rates, the curve is straight.
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
