"""HDE controller of PSP: heuristic drift elimination by the dominant directions of the building.

While the walker goes straight, an integral controller pushes the heading towards the nearest dominant direction of
the building by a small constant increment. The heading is folded modulo the spacing of the dominant directions so
that they all fall on the middle of the range: with the paper's four directions on its 45 degrees, the set point of
eq. 3. When the heading has crossed the dominant direction, the compensation restarts at 0 (eq. 4).

Readings of the paper. (1) The increment for every sample at about 100 Hz, of which no value is given, is a rate here:
n c is `increment_radps` times the duration of the stride. (2) In eq. 2 a change of exactly the threshold is straight.
(3) In a turn HDE suspends its action: I stays as it is, and goes on from there on the next straight stride. (4)
Before the first stride the heading has been 0, the direction in which the walk begins.

References
----------
PSP: Hong et al. 2013, eqs. 2 to 4, after Borenstein and Ojeda 2010.
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
    """Parameters of PSP's HDE controller."""

    threshold_rad: Positive = math.radians(10.0)
    """Th of eq. 2, rad: a change of heading from stride to stride above it is a turn."""
    increment_radps: Positive = 0.01
    """c of eq. 3, rad/s: growth of the compensation with each second of straight walking; ours, the best for the
    pockets of OxIOD.
    """
    dominant_spacing_rad: Annotated[Positive, Le(6.3)] = np.pi / 2.0
    """Angle between neighbouring dominant directions, rad."""
    first_direction_rad: _Turn = 0.0
    """Angle of one dominant direction, rad, relative to the heading at the beginning."""
    sigma_straight_rad: NonNegative = 0.05
    """Standard deviation, rad, of a straight path around its dominant direction, for heading priors; ours."""


class HdeController:
    """Feedback from the latest two headings to the compensation of the next stride.

    Parameters
    ----------
    parameters : HdeParams
        Threshold, increment and dominant directions.
    """

    def __init__(self, parameters: HdeParams) -> None:
        self._parameters = parameters
        self._compensation_rad = 0.0

    def update(self, latest_rad: float, before_rad: float, duration_s: float) -> tuple[int, float]:
        """Compute T (eq. 2) and I_i (eqs. 3 and 4) of the next stride.

        Parameters
        ----------
        latest_rad, before_rad : float
            Headings psi_{i-1} and psi_{i-2}, not wrapped.
        duration_s : float
            Duration of the next stride.

        Returns
        -------
        tuple of int and float
            T, and the compensation I_i, rad.
        """
        turn = turn_sign(latest_rad - before_rad, self._parameters.threshold_rad)
        if turn == 0:
            latest, before = self.deviation_rad(latest_rad), self.deviation_rad(before_rad)
            self._compensation_rad -= float(np.sign(latest)) * self._parameters.increment_radps * duration_s
            if latest * before <= 0.0:
                self._compensation_rad = 0.0
        return turn, self._compensation_rad

    def deviation_rad(self, heading_rad: float) -> float:
        """Compute the angle, rad, by which a heading points to the left of the nearest dominant direction.

        It is the folded heading less the middle of its range.
        """
        spacing = self._parameters.dominant_spacing_rad
        middle = 0.5 * spacing
        return (heading_rad - self._parameters.first_direction_rad + middle) % spacing - middle

    def dominant_rad(self, heading_rad: float) -> float:
        """Return the dominant direction nearest to a heading, in [-pi, pi)."""
        return float(wrap_angle(heading_rad - self.deviation_rad(heading_rad)))


def turn_sign(change_rad: float, threshold_rad: float) -> int:
    """Compute T of eq. 2: 1 for a turn to the left, -1 for one to the right, 0 for straight walking."""
    if abs(change_rad) > threshold_rad:
        return 1 if change_rad > 0.0 else -1
    return 0
