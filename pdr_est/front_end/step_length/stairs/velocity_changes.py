"""Lasting changes of the vertical velocity, as they are where a flight of stairs begins or ends.

The velocity of a level walk is a straight line, by the constant error of the accelerometer, beside a difference of
left and right steps. A change is how far the last four steps lie off the line of the twelve before them, or the first
four off that of the twelve after them: both parts have the same slope, and the estimate is that of least squares.
Four steps are the shortest flight that matters, and long enough for the sway of an unsteady hand to cancel out.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.step_length.stairs.vertical_motion import VerticalMotion

_MANY, _FEW = 12, 4  # steps on either side of the change
_STEPS = _MANY + _FEW


def _weights() -> Array:
    """Compute the weights (_STEPS,) of the velocities in the change after the first _MANY of them."""
    place = np.arange(_STEPS)
    columns = [np.ones(_STEPS), place, (-1.0) ** place, place >= _MANY]  # constant, slope, left and right, change
    weights: Array = np.linalg.pinv(np.stack(columns, axis=1))[-1]
    return weights


_WEIGHTS = _weights()
CHANGE_VARIANCE = float(_WEIGHTS @ _WEIGHTS)
"""Variance of a change over that of the independent errors of the velocities."""


class VelocityChanges:
    """Changes of the vertical velocity, one step after the other.

    Parameters
    ----------
    unsettled_steps : int
        First steps of a stretch, whose velocities do not count.
    """

    def __init__(self, unsettled_steps: int) -> None:
        self._least = unsettled_steps + _STEPS
        self._walked = 0  # steps of the stretch
        self._before = np.full(_STEPS - 1, np.nan)  # velocities of the last steps

    def after(self, motions: Sequence[VerticalMotion]) -> Array:
        """Take in steps; return the sizes of the changes that each one completes.

        Parameters
        ----------
        motions : Sequence[VerticalMotion]
            Vertical motion of the n next steps.

        Returns
        -------
        ndarray, shape (2, n)
            Size of the change that the last four steps show, and of that which the first four show, m/s; NaN where
            too few steps of the stretch are known. It depends on the last steps only, to the last bit.
        """
        count = len(motions)
        velocity = np.concatenate([self._before, [motion.velocity_mps for motion in motions]])
        changes = np.zeros((2, count))
        for place in range(_STEPS):
            changes[0] += _WEIGHTS[place] * velocity[place : place + count]
            changes[1] += _WEIGHTS[-1 - place] * velocity[place : place + count]
        changes[:, self._steps_walked(motions) < self._least] = np.nan
        self._before = velocity[count:]
        return np.abs(changes)

    def _steps_walked(self, motions: Sequence[VerticalMotion]) -> NDArray[np.intp]:
        """Count the steps of the stretch up to each step."""
        place = np.arange(len(motions))
        begin = np.maximum.accumulate(np.where([motion.begins for motion in motions], place, -self._walked))
        walked: NDArray[np.intp] = place - begin + 1
        self._walked = int(walked[-1])
        return walked
