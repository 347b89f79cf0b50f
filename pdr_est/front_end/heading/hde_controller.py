"""HDE controller of PSP (Hong et al. 2013), eqs. 2 to 4, after Borenstein and Ojeda (2010).

While the walker goes straight, an integral controller pushes the heading towards the nearest dominant direction of
the building by a small constant increment. The heading is folded modulo the spacing of the dominant directions so
that they all fall on the middle of the range: with the paper's four directions on its 45 degrees, the set point of
eq. 3. When the heading has crossed the dominant direction, the compensation begins at 0 again (eq. 4).

Readings of the paper. (1) The increment for every sample at about 100 Hz, of which no value is given, is a rate
here: n c is `increment_radps` times the duration of the stride. (2) In eq. 2 a change of exactly the threshold is
straight. (3) In a turn HDE suspends its action: I stays as it is, and goes on from there on the next straight stride.
(4) Before the first stride the heading has been 0, the direction in which the walk begins.
"""

import math
from typing import Annotated

import numpy as np
from annotated_types import Gt, Le

from pdr_est.frames import wrap_angle
from pdr_est.params import NonNegative, Positive, params

_Turn = Annotated[float, Gt(-6.3), Le(6.3)]


@params
class HdeParams:
    """threshold_rad: Th, a change of heading from stride to stride above it is a turn. increment_radps: c, by which
    the compensation grows with each second of straight walking; ours, the best for the pockets of OxIOD.
    dominant_spacing_rad: between neighbouring dominant directions. first_direction_rad: of one of them, relative to
    the heading at the beginning. sigma_straight_rad: of a straight path around its dominant direction, ours, for
    heading priors."""

    threshold_rad: Positive = math.radians(10.0)
    increment_radps: Positive = 0.01
    dominant_spacing_rad: Annotated[Positive, Le(6.3)] = np.pi / 2.0
    first_direction_rad: _Turn = 0.0
    sigma_straight_rad: NonNegative = 0.05


class HdeController:
    """The feedback from the latest two headings to the compensation of the next stride."""

    def __init__(self, parameters: HdeParams) -> None:
        self._parameters = parameters
        self._compensation_rad = 0.0

    def at(self, latest_rad: float, before_rad: float, duration_s: float) -> tuple[int, float]:
        """T (eq. 2) and I_i (eqs. 3 and 4) of the next stride, which takes duration_s.

        latest_rad, before_rad: psi_{i-1} and psi_{i-2}, not wrapped.
        """
        turn = turning(latest_rad - before_rad, self._parameters.threshold_rad)
        if turn == 0:
            latest, before = self.deviation_rad(latest_rad), self.deviation_rad(before_rad)
            self._compensation_rad -= float(np.sign(latest)) * self._parameters.increment_radps * duration_s
            if latest * before <= 0.0:
                self._compensation_rad = 0.0
        return turn, self._compensation_rad

    def deviation_rad(self, heading_rad: float) -> float:
        """Folded heading less the middle of its range: how far left of the nearest dominant direction it points."""
        spacing = self._parameters.dominant_spacing_rad
        middle = 0.5 * spacing
        return (heading_rad - self._parameters.first_direction_rad + middle) % spacing - middle

    def dominant_rad(self, heading_rad: float) -> float:
        """The dominant direction nearest to a heading, in [-pi, pi)."""
        return float(wrap_angle(heading_rad - self.deviation_rad(heading_rad)))


def turning(change_rad: float, threshold_rad: float) -> int:
    """T of eq. 2: 1 for a turn to the left, -1 for one to the right, 0 for straight walking."""
    if abs(change_rad) > threshold_rad:
        return 1 if change_rad > 0.0 else -1
    return 0
